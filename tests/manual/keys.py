"""The keys of the format as the models have them, and where the manual's page on the format describes each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, get_args

from heuncli.base import units as u
from heuncli.scene.file_format import fields
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.entries import Entry, Field, fields_of
from heuncli.scene.file_format.json_schema import CHAPTERS, INLINE, TOP
from tests.shared.manual import headings

ALL = "all"  # in place of the types that have a key, where all have it
NEEDED = {("Tables", "x"), ("Tables", "y")}  # asked for by a rule, not by the model


class Place(NamedTuple):
    """A key below a heading of the page on the format; types: those that have it, where not all entries do."""

    key: str
    heading: str
    types: tuple[str, ...] = ()


def named_fields(model: type[Entry]) -> dict[str, Field]:
    """The fields of a model by their keys, without the `type` by which it is chosen: that stands above its table."""
    by_key = {field.alias or name: field for name, field in fields_of(model).items()}
    return {key: field for key, field in by_key.items() if key != "type" or not field.is_required}


def top_keys() -> list[str]:
    """The keys of a spec's top level."""
    return [*named_fields(f.HeadEntry), *f.BLOCKS_READ_FIRST, *f.ENTRY_BLOCKS, *f.SINGLE_BLOCKS, "expect"]


def pairs(models: Mapping[str, type[Entry]]) -> dict[tuple[str, str], Field]:
    """The fields by type and key."""
    return {(kind, key): field for kind, model in models.items() for key, field in named_fields(model).items()}


def places() -> Iterator[Place]:
    """Every key with the headings below which it stands."""
    for key in top_keys():
        yield Place(key, TOP)
        if key.capitalize() in headings("format"):
            yield Place(key, key.capitalize())
    for key in ("until", "events"):
        yield Place(key, "Conditions")
    for model, (heading, parent) in INLINE.items():
        for key in named_fields(model):
            yield Place(key, heading, (parent,))
    for heading, model_or_models in CHAPTERS.items():
        if isinstance(model_or_models, Mapping):
            have: dict[str, list[str]] = {}
            for kind, key in pairs(model_or_models):
                have.setdefault(key, []).append(kind)
            for key, kinds in have.items():
                yield Place(key, heading, tuple(kinds) if len(kinds) < len(model_or_models) else ())
            yield Place("type", heading)
        else:
            for key in named_fields(model_or_models):
                yield Place(key, heading)
    yield Place("type", "Forces")


PLACES = tuple(dict.fromkeys(places()))
SPELLED = {"*": "·", "^2": "²", "^3": "³", "^4": "⁴"}


def unit_of_value(name: str, value: fields.ValueReader) -> str | None:
    """The unit that the manual writes for a kind of scene/file_format/fields.py; None where other keys decide it."""
    if value.dimension is None or isinstance(value, fields.DirectionComponent):
        return None
    unit = u.si_unit(value.dimension)
    if value.dimension == u.NUMBER and not name.startswith("Angle"):
        unit = "1"
    for typed, written in SPELLED.items():
        unit = unit.replace(typed, written)
    return f"{unit}, in time" if isinstance(value, fields.TimeFunction) else unit


UNITS = {
    id(value): unit_of_value(name, value)
    for name, kind in vars(fields).items()
    for value in getattr(kind, "__metadata__", ())
    if isinstance(value, fields.ValueReader)
}


def unit_of(field: Field) -> str | None:
    """The unit of a field; None where it has none, or several."""
    found = {UNITS[id(value)] for value in values(field) if id(value) in UNITS}
    return found.pop() if len(found) == 1 else None


def values(field: Field) -> Iterator[fields.ValueReader]:
    """The values that stand in a field's annotation."""
    yield from within(field.annotation)


def within(annotation: Any) -> Iterator[fields.ValueReader]:
    """The values within an annotation; those of models apart."""
    for value in getattr(annotation, "__metadata__", ()):
        if isinstance(value, fields.ValueReader):
            yield value
    for part in get_args(annotation):
        yield from within(part)


def words_of(annotation: Any) -> set[str]:
    """The words that an annotation admits by name."""
    found = {part for part in get_args(annotation) if isinstance(part, str)}
    return found.union(*(words_of(part) for part in get_args(annotation)))
