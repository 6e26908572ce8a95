"""The format as pydantic models, made from the classes that read it, for the JSON Schema.

They validate like `validation`, which tests verify: one format, described to pydantic in two ways.
"""

from __future__ import annotations

import types
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, ConfigDict, create_model, model_validator
from pydantic import Field as PydanticField

from heuncli.scene.file_format.entries import Entry, Field, cached_by_model, fields_of


class Strict(BaseModel):
    """A mapping with known keys."""

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)


@cached_by_model
def make_model(entry: type[Entry]) -> type[BaseModel]:
    """Make the pydantic model of an entry class, with its name, its docstring and its keys."""
    keys: dict[str, Any] = {
        name: (replace_entries(field.annotation), to_pydantic_field(field)) for name, field in fields_of(entry).items()
    }
    own_validator = vars(entry).get("before")
    before: dict[str, Any] = (
        {"before": model_validator(mode="before")(own_validator)} if own_validator is not None else {}
    )
    model: type[BaseModel] = create_model(
        entry.__name__, __base__=Strict, __module__=entry.__module__, __validators__=before, **keys
    )
    model.__doc__ = entry.__doc__
    return model


def to_pydantic_field(field: Field) -> Any:
    """Convert a key's alias and default to a pydantic field."""
    if field.default_factory is not None:
        return PydanticField(alias=field.alias, default_factory=field.default_factory)
    return PydanticField(... if field.is_required else field.default, alias=field.alias)


def replace_entries(annotation: Any) -> Any:
    """Replace entry classes by pydantic models in an annotation."""
    origin, parts = get_origin(annotation), get_args(annotation)
    if isinstance(annotation, type) and issubclass(annotation, Entry):
        return make_model(annotation)
    if origin is Annotated:
        return Annotated[replace_entries(parts[0]), *parts[1:]]
    if origin in (Union, types.UnionType):
        return Union[tuple(map(replace_entries, parts))]  # noqa: UP007 - of as many as there are
    if origin is None or origin is Literal:
        return annotation
    return origin[tuple(map(replace_entries, parts))]
