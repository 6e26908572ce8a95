"""The format as models of pydantic, made of the classes that read it: for JSON Schema.

They judge as `judging` does, which tests hold: one format, told to pydantic in two ways.
"""

from __future__ import annotations

import types
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, ConfigDict, create_model, model_validator
from pydantic import Field as PydanticField

from heuncli.scene.file_format.entries import Entry, Field, fields_of, once


class Strict(BaseModel):
    """A mapping with known keys."""

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)


@once
def model_of(entry: type[Entry]) -> type[BaseModel]:
    """The model of an entry, of its name, its docstring and its keys."""
    keys: dict[str, Any] = {
        name: (with_models(field.annotation), told(field)) for name, field in fields_of(entry).items()
    }
    own = vars(entry).get("before")
    before: dict[str, Any] = {"before": model_validator(mode="before")(own)} if own is not None else {}
    made: type[BaseModel] = create_model(
        entry.__name__, __base__=Strict, __module__=entry.__module__, __validators__=before, **keys
    )
    made.__doc__ = entry.__doc__
    return made


def told(field: Field) -> Any:
    """A key's alias and default, in pydantic's words."""
    if field.default_factory is not None:
        return PydanticField(alias=field.alias, default_factory=field.default_factory)
    return PydanticField(... if field.is_required else field.default, alias=field.alias)


def with_models(annotation: Any) -> Any:
    """An annotation with models in the place of entries."""
    origin, parts = get_origin(annotation), get_args(annotation)
    if isinstance(annotation, type) and issubclass(annotation, Entry):
        return model_of(annotation)
    if origin is Annotated:
        return Annotated[with_models(parts[0]), *parts[1:]]
    if origin in (Union, types.UnionType):
        return Union[tuple(map(with_models, parts))]  # noqa: UP007 - of as many as there are
    if origin is None or origin is Literal:
        return annotation
    return origin[tuple(map(with_models, parts))]
