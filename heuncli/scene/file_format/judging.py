"""Plain data -> entries, judged by pydantic_core: a schema for each kind, made when the first entry of it is read."""

from __future__ import annotations

import types
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin

from pydantic_core import SchemaValidator, core_schema

from heuncli.scene.file_format.entries import Entry, Field, fields_of, once

E = TypeVar("E", bound=Entry)
Schemas = dict[Any, core_schema.CoreSchema]


def judged(model: type[E], data: Any, context: Any) -> E:
    """An entry of data as a spec has it; context: what its values may refer to. Raises pydantic's ValidationError."""
    entry: E = validator_of(model).validate_python(data, context=context)
    return entry


@once
def validator_of(model: type[Entry]) -> SchemaValidator:
    """What judges the entries of a kind."""
    return SchemaValidator(schema_of_entry(model))


class SchemaOf:
    """The schema of an annotation, made once: to markers what pydantic's handler is to them."""

    def __init__(self) -> None:
        self.known: Schemas = {  # of all other types the markers tell how they are read
            Any: core_schema.any_schema(), str: core_schema.str_schema(), int: core_schema.int_schema()
        }  # fmt: skip

    def __call__(self, annotation: Any) -> core_schema.CoreSchema:
        if annotation not in self.known:
            self.known[annotation] = self.made(annotation)
        return self.known[annotation]

    generate_schema = __call__

    def made(self, annotation: Any) -> core_schema.CoreSchema:
        """The schema of what no schema is known of. Raises TypeError for a type that values in a spec do not have."""
        origin, parts = get_origin(annotation), get_args(annotation)
        if origin is Annotated:
            return marked(parts[0], parts[1:])
        if origin in (Union, types.UnionType):
            return self.union(parts)
        if origin is Literal:
            return core_schema.literal_schema([*parts])
        if origin is tuple:
            return core_schema.tuple_schema([*map(self, parts)])
        if origin is list:
            return core_schema.list_schema(self(parts[0]))
        if origin is dict:
            return core_schema.dict_schema(*map(self, parts))
        if isinstance(annotation, type) and issubclass(annotation, Entry):
            return schema_of_entry(annotation)
        raise TypeError(f"{annotation}: a type that the format has no reading for")

    def union(self, parts: tuple[Any, ...]) -> core_schema.CoreSchema:
        """One of several types, or null."""
        given = [self(part) for part in parts if part is not types.NoneType]
        either = given[0] if len(given) == 1 else core_schema.union_schema([*given])
        return core_schema.nullable_schema(either) if len(given) < len(parts) else either


schema_of = SchemaOf()


def marked(annotation: Any, marks: tuple[Any, ...]) -> core_schema.CoreSchema:
    """The schema of a type as the one of its markers that reads has it."""
    readers = [mark for mark in marks if hasattr(mark, "__get_pydantic_core_schema__")]
    if not readers:
        return schema_of(annotation)
    (reader,) = readers
    schema: core_schema.CoreSchema = reader.__get_pydantic_core_schema__(annotation, schema_of)
    return schema


def schema_of_entry(model: type[Entry]) -> core_schema.CoreSchema:
    """The schema of an entry: its keys and no others."""
    keys = {name: schema_of_field(field) for name, field in fields_of(model).items()}
    inner: core_schema.CoreSchema = core_schema.model_fields_schema(keys, model_name=model.__name__)
    if model.before.__func__ is not Entry.before.__func__:  # type: ignore[attr-defined]
        inner = core_schema.no_info_before_validator_function(model.before, inner)
    config = core_schema.CoreConfig(title=model.__name__, extra_fields_behavior="forbid")
    return core_schema.model_schema(model, inner, config=config)


def schema_of_field(field: Field) -> core_schema.ModelField:
    """The schema of a key with its default."""
    schema = schema_of(field.annotation)
    if field.default_factory is not None:
        schema = core_schema.with_default_schema(schema, default_factory=field.default_factory)
    elif not field.is_required:
        schema = core_schema.with_default_schema(schema, default=field.default)
    return core_schema.model_field(schema, validation_alias=field.alias)
