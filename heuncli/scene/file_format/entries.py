"""What an entry of the format is: a class whose annotations are its keys, and whose values are judged by `judging`.

An Entry is to its users what a frozen model of pydantic is, and judged by the same engine, pydantic_core. But pydantic
writes a class and its validator anew for each of sixty kinds: with its own modules a third of a small run. Here a kind
costs nothing until the first entry of it is read. Where pydantic's models are wanted, `pydantic_models` makes them of
the same classes.

The markers beside a type are of pydantic's protocol (`__get_pydantic_core_schema__`), so that both understand them.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any, TypeVar, get_args

from pydantic_core import core_schema

from heuncli.base.named_tuples import NamedTuple

E = TypeVar("E", bound="Entry")
V = TypeVar("V")
NEEDED: Any = object()  # the default of a key that has none


class Field(NamedTuple):
    """A key: its type, how users write it where that is no name of Python's, its default or what makes one."""

    annotation: Any
    alias: str | None = None
    default: Any = NEEDED
    default_factory: Callable[[], Any] | None = None

    @property
    def is_required(self) -> bool:
        """Whether the key must be there."""
        return self.default is NEEDED and self.default_factory is None

    def made_default(self) -> Any:
        """The value of a key that is left out."""
        return self.default_factory() if self.default_factory is not None else self.default


def key(alias: str | None = None, default: Any = NEEDED, default_factory: Callable[[], Any] | None = None) -> Any:
    """Says of a key more than its type and its default."""
    return Field(None, alias, default, default_factory)


class Entry:
    """A mapping with known keys; the slots are those that pydantic_core fills."""

    __slots__ = ("__dict__", "__pydantic_extra__", "__pydantic_fields_set__", "__pydantic_private__")
    __pydantic_fields_set__: set[str]

    @classmethod
    def before(cls, data: Any) -> Any:
        """The data as they are judged; raises Finding where they cannot be. Most kinds have none of it."""
        return data

    @classmethod
    def model_construct(cls: type[E], **values: Any) -> E:
        """An entry of values that are as they should be; the rest of them are the defaults."""
        made = object.__new__(cls)
        defaults = {name: field.made_default() for name, field in fields_of(cls).items() if name not in values}
        made.__dict__.update({name: value for name, value in defaults.items() if value is not NEEDED}, **values)
        object.__setattr__(made, "__pydantic_fields_set__", set(values))
        return made

    @property
    def model_fields_set(self) -> set[str]:
        """Names of the fields that were given."""
        return self.__pydantic_fields_set__

    def model_copy(self: E, update: dict[str, Any]) -> E:
        """An entry like this one but for some fields."""
        made = type(self).model_construct(**{**self.__dict__, **update})
        object.__setattr__(made, "__pydantic_fields_set__", self.__pydantic_fields_set__ | update.keys())
        return made

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"{type(self).__name__}.{name} cannot be changed: entries are frozen")

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and self.__dict__ == other.__dict__

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in self.__dict__.items())})"


def once(find: Callable[[type[Entry]], V]) -> Callable[[type[Entry]], V]:
    """A function of a kind of entries that finds out once what does not change."""
    found: Callable[..., V] = cache(find)
    return found


@once
def fields_of(model: type[Entry]) -> dict[str, Field]:
    """The fields of an entry by their names in Python, those of its bases first."""
    found = {}
    for base in reversed(model.__mro__[: model.__mro__.index(Entry)]):
        for name, written in base.__annotations__.items():
            told = getattr(model, name, NEEDED)
            annotation = _meaning(base.__module__, written)
            found[name] = told._replace(annotation=annotation) if type(told) is Field else Field(annotation, None, told)
    return found


@cache
def _meaning(module: str, annotation: Any) -> Any:
    """What is written as an annotation in a module: many keys are of the same few types."""
    return eval(annotation, vars(sys.modules[module])) if type(annotation) is str else annotation


def keys_of(model: type[Entry]) -> tuple[str, ...]:
    """The keys of a mapping, as users write them."""
    return tuple(field.alias or name for name, field in fields_of(model).items())


class Tag(NamedTuple):
    """Names one of the forms that a value may have."""

    name: str


class OneOf:
    """A value of several forms, each a type with a Tag: `tag_of` says which one a value has."""

    def __init__(self, tag_of: Callable[[Any], str]) -> None:
        self.tag_of = tag_of

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        choices = {tag: handler.generate_schema(form) for tag, form in tagged(source)}
        return core_schema.tagged_union_schema(choices, discriminator=self.tag_of)


def tagged(union: Any) -> Iterator[tuple[str, Any]]:
    """The forms of a union by their tags."""
    for form in get_args(union):
        yield next(mark.name for mark in form.__metadata__ if isinstance(mark, Tag)), form


class Before:
    """What is made of a value before its type reads it: a function of the value, and of the reading's circumstances."""

    def __init__(self, function: Callable[[Any, Any], Any]) -> None:
        self.function = function

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.with_info_before_validator_function(self.function, handler(source))
