"""The base class of the format's entries, whose annotations are its keys, and its validation.

To its users an Entry behaves like a frozen pydantic model. Its schema is one of pydantic_core, by which an entry is
judged that is not read without a doubt (scene/file_format/plain_reading.py): a spec without errors does not import
pydantic_core, a fifth of a small run. A kind costs nothing until its first entry is read. Where real pydantic models
are needed, `pydantic_models` makes them from the same classes.

The markers in an annotation follow pydantic's protocol (`__get_pydantic_core_schema__`), so that both understand them.
"""

from __future__ import annotations

import sys
import types
from collections.abc import Callable, Iterator
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar, Union, get_args, get_origin

from heuncli.base import spelling
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.plain_reading import CoreSchema, DoubtfulError, Reader, ReadInfo, make_reader

if TYPE_CHECKING:
    from pydantic_core import SchemaValidator

# Entries

E = TypeVar("E", bound="Entry")
V = TypeVar("V")
REQUIRED: Any = object()  # marks a key without a default


class Field(NamedTuple):
    """A key: its type, its name in a spec if that is not a Python name, and its default or a factory of it."""

    annotation: Any
    alias: str | None = None
    default: Any = REQUIRED
    default_factory: Callable[[], Any] | None = None

    @property
    def is_required(self) -> bool:
        """Whether a spec must contain the key."""
        return self.default is REQUIRED and self.default_factory is None

    def make_default(self) -> Any:
        """Return the value of a key that is left out."""
        return self.default_factory() if self.default_factory is not None else self.default


def key(alias: str | None = None, default: Any = REQUIRED, default_factory: Callable[[], Any] | None = None) -> Any:
    """Declare a key that needs more than a type and a plain default."""
    return Field(None, alias, default, default_factory)


class Entry:
    """A mapping with known keys; its slots are those that pydantic_core fills."""

    __slots__ = ("__dict__", "__pydantic_extra__", "__pydantic_fields_set__", "__pydantic_private__")
    __pydantic_fields_set__: set[str]

    @classmethod
    def before(cls, data: Any) -> Any:
        """Return the data to validate; a subclass may convert them first. Raises Finding if they cannot be used."""
        return data

    @classmethod
    def model_construct(cls: type[E], **values: Any) -> E:
        """Make an entry from valid values without validation; missing values take their defaults."""
        entry = object.__new__(cls)
        defaults = {name: field.make_default() for name, field in fields_of(cls).items() if name not in values}
        entry.__dict__.update({name: value for name, value in defaults.items() if value is not REQUIRED}, **values)
        object.__setattr__(entry, "__pydantic_fields_set__", set(values))
        return entry

    @property
    def model_fields_set(self) -> set[str]:
        """Names of the fields that the spec gave."""
        return self.__pydantic_fields_set__

    def model_copy(self: E, update: dict[str, Any]) -> E:
        """Return a copy with some fields replaced."""
        entry = type(self).model_construct(**{**self.__dict__, **update})
        object.__setattr__(entry, "__pydantic_fields_set__", self.__pydantic_fields_set__ | update.keys())
        return entry

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"{type(self).__name__}.{name} cannot be changed: entries are frozen")

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and self.__dict__ == other.__dict__

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in self.__dict__.items())})"


def cached_by_model(function: Callable[[type[Entry]], V]) -> Callable[[type[Entry]], V]:
    """Cache a function of an Entry class; keeps its type."""
    cached_function: Callable[..., V] = cache(function)
    return cached_function


@cached_by_model
def fields_of(model: type[Entry]) -> dict[str, Field]:
    """Return the fields of an entry by their Python names, those of its base classes first."""
    fields = {}
    for base in reversed(model.__mro__[: model.__mro__.index(Entry)]):
        for name, declared_annotation in base.__annotations__.items():
            declared = getattr(model, name, REQUIRED)
            annotation = _evaluate_annotation(base.__module__, declared_annotation)
            fields[name] = (
                declared._replace(annotation=annotation)
                if type(declared) is Field
                else Field(annotation, None, declared)
            )
    return fields


@cache
def _evaluate_annotation(module: str, annotation: Any) -> Any:
    """Evaluate an annotation in its module. Cached, because many keys share a few types."""
    return eval(annotation, vars(sys.modules[module])) if type(annotation) is str else annotation


def keys_of(model: type[Entry]) -> tuple[str, ...]:
    """Return the keys of an entry as users write them."""
    return tuple(field.alias or name for name, field in fields_of(model).items())


class Tag(NamedTuple):
    """Name of one of the forms that a value may have."""

    name: str


class OneOf:
    """Marks a value of several forms, each a type with a Tag; `tag_of` selects the tag of a value."""

    def __init__(self, tag_of: Callable[[Any], str]) -> None:
        self.tag_of = tag_of

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        choices = {tag: handler.generate_schema(form) for tag, form in iter_tagged_forms(source)}
        return {"type": "tagged-union", "choices": choices, "discriminator": self.tag_of}


def iter_tagged_forms(union: Any) -> Iterator[tuple[str, Any]]:
    """Yield the forms of a union with their tags."""
    for form in get_args(union):
        yield next(mark.name for mark in form.__metadata__ if isinstance(mark, Tag)), form


class Preprocessor:
    """Converts a value before its type validates it, by a function of the value and the validation info."""

    def __init__(self, function: Callable[[Any, Any], Any]) -> None:
        self.function = function

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        function = {"type": "with-info", "function": self.function}
        return {"type": "function-before", "function": function, "schema": handler(source)}


# Validation

Schemas = dict[Any, CoreSchema]


def validate_entry(model: type[E], data: Any, context: Any) -> E:
    """Validate data as an entry. Raises pydantic's ValidationError.

    context: what its values may refer to
    """
    effort = spelling.remaining_effort()
    try:
        entry: E = make_plain_reader(model)(data, ReadInfo(context))
    except DoubtfulError:
        spelling.restore_effort(effort)
        entry = make_validator(model).validate_python(data, context=context)
    return entry


@cached_by_model
def make_plain_reader(model: type[Entry]) -> Reader:
    """Make the reader of a kind of entries without errors."""
    return make_reader(build_entry_schema(model))


@cached_by_model
def make_validator(model: type[Entry]) -> SchemaValidator:
    """Make the validator of a kind of entries."""
    from pydantic_core import SchemaValidator  # for entries with errors alone

    schema: Any = build_entry_schema(model)
    return SchemaValidator(schema)


class SchemaBuilder:
    """Builds the schema of an annotation, once; plays the part of pydantic's handler for the markers."""

    def __init__(self) -> None:
        self.schemas: Schemas = {  # markers define the schemas of all other types
            Any: {"type": "any"}, str: {"type": "str"}, int: {"type": "int"}
        }  # fmt: skip

    def __call__(self, annotation: Any) -> CoreSchema:
        if annotation not in self.schemas:
            self.schemas[annotation] = self.build_schema(annotation)
        return self.schemas[annotation]

    generate_schema = __call__

    def build_schema(self, annotation: Any) -> CoreSchema:
        """Build the schema of a new annotation. Raises TypeError for a type that values of a spec do not have."""
        origin, parts = get_origin(annotation), get_args(annotation)
        if origin is Annotated:
            return build_marked_schema(parts[0], parts[1:])
        if origin in (Union, types.UnionType):
            return self.build_union_schema(parts)
        if origin is Literal:
            return {"type": "literal", "expected": [*parts]}
        if origin is tuple:
            return {"type": "tuple", "items_schema": [*map(self, parts)]}
        if origin is list:
            return {"type": "list", "items_schema": self(parts[0])}
        if origin is dict:
            keys, values = map(self, parts)
            return {"type": "dict", "keys_schema": keys, "values_schema": values}
        if isinstance(annotation, type) and issubclass(annotation, Entry):
            return build_entry_schema(annotation)
        raise TypeError(f"{annotation}: a type that the format has no reading for")

    def build_union_schema(self, parts: tuple[Any, ...]) -> CoreSchema:
        """Build the schema of one of several types, or null."""
        schemas = [self(part) for part in parts if part is not types.NoneType]
        combined = schemas[0] if len(schemas) == 1 else {"type": "union", "choices": schemas}
        return {"type": "nullable", "schema": combined} if len(schemas) < len(parts) else combined


schema_of = SchemaBuilder()


def build_marked_schema(annotation: Any, markers: tuple[Any, ...]) -> CoreSchema:
    """Build the schema of a type by its one marker that defines a schema, if any."""
    readers = [mark for mark in markers if hasattr(mark, "__get_pydantic_core_schema__")]
    if not readers:
        return schema_of(annotation)
    (reader,) = readers
    schema: CoreSchema = reader.__get_pydantic_core_schema__(annotation, schema_of)
    return schema


def build_entry_schema(model: type[Entry]) -> CoreSchema:
    """Build the schema of an entry: its keys and no others."""
    keys = {name: build_field_schema(field) for name, field in fields_of(model).items()}
    inner: CoreSchema = {"type": "model-fields", "fields": keys, "model_name": model.__name__}
    if model.before.__func__ is not Entry.before.__func__:  # type: ignore[attr-defined]
        function = {"type": "no-info", "function": model.before}
        inner = {"type": "function-before", "function": function, "schema": inner}
    config = {"title": model.__name__, "extra_fields_behavior": "forbid"}
    return {"type": "model", "cls": model, "schema": inner, "config": config}


def build_field_schema(field: Field) -> CoreSchema:
    """Build the schema of a key with its default."""
    schema = schema_of(field.annotation)
    if field.default_factory is not None:
        schema = {"type": "default", "schema": schema, "default_factory": field.default_factory}
    elif not field.is_required:
        schema = {"type": "default", "schema": schema, "default": field.default}
    alias = {"validation_alias": field.alias} if field.alias is not None else {}
    return {"type": "model-field", "schema": schema, **alias}
