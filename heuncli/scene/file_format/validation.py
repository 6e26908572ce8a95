"""Validate plain data into entries with pydantic_core; the schema of a kind is built when its first entry is read."""

from __future__ import annotations

import types
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin

from pydantic_core import SchemaValidator, core_schema

from heuncli.scene.file_format.entries import Entry, Field, cached_by_model, fields_of

E = TypeVar("E", bound=Entry)
Schemas = dict[Any, core_schema.CoreSchema]


def validate_entry(model: type[E], data: Any, context: Any) -> E:
    """Validate data as an entry. Raises pydantic's ValidationError.

    context: what its values may refer to
    """
    entry: E = make_validator(model).validate_python(data, context=context)
    return entry


@cached_by_model
def make_validator(model: type[Entry]) -> SchemaValidator:
    """Make the validator of a kind of entries."""
    return SchemaValidator(build_entry_schema(model))


class SchemaBuilder:
    """Builds the schema of an annotation, once; plays the part of pydantic's handler for the markers."""

    def __init__(self) -> None:
        self.schemas: Schemas = {  # markers define the schemas of all other types
            Any: core_schema.any_schema(), str: core_schema.str_schema(), int: core_schema.int_schema()
        }  # fmt: skip

    def __call__(self, annotation: Any) -> core_schema.CoreSchema:
        if annotation not in self.schemas:
            self.schemas[annotation] = self.build_schema(annotation)
        return self.schemas[annotation]

    generate_schema = __call__

    def build_schema(self, annotation: Any) -> core_schema.CoreSchema:
        """Build the schema of a new annotation. Raises TypeError for a type that values of a spec do not have."""
        origin, parts = get_origin(annotation), get_args(annotation)
        if origin is Annotated:
            return build_marked_schema(parts[0], parts[1:])
        if origin in (Union, types.UnionType):
            return self.build_union_schema(parts)
        if origin is Literal:
            return core_schema.literal_schema([*parts])
        if origin is tuple:
            return core_schema.tuple_schema([*map(self, parts)])
        if origin is list:
            return core_schema.list_schema(self(parts[0]))
        if origin is dict:
            return core_schema.dict_schema(*map(self, parts))
        if isinstance(annotation, type) and issubclass(annotation, Entry):
            return build_entry_schema(annotation)
        raise TypeError(f"{annotation}: a type that the format has no reading for")

    def build_union_schema(self, parts: tuple[Any, ...]) -> core_schema.CoreSchema:
        """Build the schema of one of several types, or null."""
        schemas = [self(part) for part in parts if part is not types.NoneType]
        combined = schemas[0] if len(schemas) == 1 else core_schema.union_schema([*schemas])
        return core_schema.nullable_schema(combined) if len(schemas) < len(parts) else combined


schema_of = SchemaBuilder()


def build_marked_schema(annotation: Any, markers: tuple[Any, ...]) -> core_schema.CoreSchema:
    """Build the schema of a type by its one marker that defines a schema, if any."""
    readers = [mark for mark in markers if hasattr(mark, "__get_pydantic_core_schema__")]
    if not readers:
        return schema_of(annotation)
    (reader,) = readers
    schema: core_schema.CoreSchema = reader.__get_pydantic_core_schema__(annotation, schema_of)
    return schema


def build_entry_schema(model: type[Entry]) -> core_schema.CoreSchema:
    """Build the schema of an entry: its keys and no others."""
    keys = {name: build_field_schema(field) for name, field in fields_of(model).items()}
    inner: core_schema.CoreSchema = core_schema.model_fields_schema(keys, model_name=model.__name__)
    if model.before.__func__ is not Entry.before.__func__:  # type: ignore[attr-defined]
        inner = core_schema.no_info_before_validator_function(model.before, inner)
    config = core_schema.CoreConfig(title=model.__name__, extra_fields_behavior="forbid")
    return core_schema.model_schema(model, inner, config=config)


def build_field_schema(field: Field) -> core_schema.ModelField:
    """Build the schema of a key with its default."""
    schema = schema_of(field.annotation)
    if field.default_factory is not None:
        schema = core_schema.with_default_schema(schema, default_factory=field.default_factory)
    elif not field.is_required:
        schema = core_schema.with_default_schema(schema, default=field.default)
    return core_schema.model_field(schema, validation_alias=field.alias)
