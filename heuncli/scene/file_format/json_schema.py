"""The format as a JSON Schema (draft-07, which editors read), made from the classes that read a spec and from the
manual.

What a schema cannot express is left to `heun validate`: that a name exists, that a unit fits, which keys exclude each
other. `space: planar` allows vectors of two components and pins without an axis; the schema allows both forms.

Unit, default and meaning of each key are those of the manual's page on the format, by chapter. Impure: reads the page.

The schema is that of pydantic models, made from the classes that read the format. They validate like `validation`,
which tests verify: one format, described to pydantic in two ways.
"""

from __future__ import annotations

import re
import types
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, ConfigDict, create_model, model_validator
from pydantic import Field as PydanticField
from pydantic.json_schema import models_json_schema

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_couplings as fc
from heuncli.scene.file_format import format_joints as fj
from heuncli.scene.file_format import format_loads as fl
from heuncli.scene.file_format import format_shapes as fs
from heuncli.scene.file_format.entries import Entry, Field, cached_by_model, fields_of
from heuncli.scene.file_format.fields import TEXT_SCHEMA
from heuncli.scene.file_format.foreign_words import TYPE_ALIASES, list_aliases, replace_type_aliases
from heuncli.scene.file_format.format_couplings import RollingEntry
from heuncli.scene.file_format.labels import EVENTS, POINTS, VALUE_KEYS
from heuncli.scene.file_format.segment_entries import CamSegmentEntry, DriveSegmentEntry
from heuncli.scene.file_format.source import read_source

# Chapters

# by heading: the model whose keys the first table below it lists, or the models by type
CHAPTERS: dict[str, type[Entry] | Mapping[str, type[Entry]]] = {
    "Tables": f.TableEntry,
    "Bodies": f.BodyEntry,
    "Shapes": fs.SHAPES,
    "Orientation": fs.Orientation,
    "Piece": f.PieceEntry,
    "Joints": fj.JOINTS,
    "Bearing of joints": fj.BearingEntry,
    "Bearings": fj.BearingPairEntry,
    "Initial": {"pin": fj.Turning, "slide": fj.Sliding, "cylinder": fj.TurningAndSliding},
    "Stiffness of joints": fj.StiffnessParts,
    "Drives": f.DriveEntry,
    "Segments": {"drive": DriveSegmentEntry, "cam": CamSegmentEntry},
    **fl.LOADS,
    "Impulses": f.ImpulseEntry,
    "Stops": f.StopEntry,
    "Latches": f.LatchEntry,
    **fc.COUPLINGS,
    "Rolling": RollingEntry,
    "Sections": f.SectionEntry,
    "Properties": f.PropertiesEntry,
    "Sensors": f.SensorEntry,
    "Analysis": f.AnalysisEntry,
    "Conditions": f.ResultConditionEntry,
    "Expect": f.ExpectEntry,
    "Cases": f.CaseEntry,
    "Report": f.ReportEntry,
}
TOP = "Top level"
# small mappings that are described in the row of the key that holds them
INLINE: dict[type[Entry], tuple[str, str]] = {
    f.GroundEntry: (TOP, "ground"),
    f.FoundationEntry: (TOP, "foundation"),
    f.NearEntry: ("Bodies", "near"),
    f.VelocityInFrame: ("Bodies", "velocity"),
    f.RateInFrame: ("Bodies", "velocity"),
    f.CircleEntry: ("Properties", "circle"),
    f.TubeEntry: ("Properties", "tube"),
    f.RectangleEntry: ("Properties", "rectangle"),
    f.MemberEntry: ("Properties", "I"),
    f.HollowEntry: ("Properties", "box"),
}


# Key rows

PAGE = Path(__file__).parents[2] / "manual" / "format.md"
HEADING = re.compile(r"^#+ (.+)$", re.MULTILINE)
LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")


class KeyRow(NamedTuple):
    """A row of a chapter's table: the keys, the types that have them (empty: all), unit, default and meaning."""

    keys: tuple[str, ...]
    types: tuple[str, ...]
    unit: str
    default: str
    meaning: str

    @property
    def description(self) -> str:
        """Meaning, unit and default in one line."""
        parts = [strip_markup(self.meaning)]
        parts += [f"[{strip_markup(self.unit)}]"] if self.unit else []
        parts += [f"default: {strip_markup(self.default)}"] if self.default not in ("", "required", "none") else []
        return "; ".join(part for part in parts if part)


def read_rows_by_chapter() -> dict[str, list[KeyRow]]:
    """Read the rows of the key tables, by the heading above each table."""
    text = PAGE.read_text(encoding="utf-8")
    _, *parts = HEADING.split(text)
    return {heading: [*_iter_rows(body)] for heading, body in zip(parts[::2], parts[1::2], strict=True)}


def _iter_rows(body: str) -> Iterator[KeyRow]:
    """Yield the rows of the first key table."""
    heads: list[str] = []
    for line in body.splitlines():
        cells = [cell.strip().replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if cells[:1] == ["key"]:
            heads = cells
        elif heads and not cells:
            return
        elif heads and not set(line) <= set("|-"):
            row = dict(zip(heads, cells, strict=True))
            types = () if row.get("of", "all") == "all" else find_code_words(row["of"])
            yield KeyRow(
                find_code_words(row["key"]), types, row.get("unit", ""), row.get("default", ""), row.get("meaning", "")
            )


def find_code_words(cell: str) -> tuple[str, ...]:
    """Return the words in a cell that are marked as code."""
    return tuple(re.findall(r"`([^`]*)`", cell))


def strip_markup(cell: str) -> str:
    """Return a cell without markup."""
    return LINK.sub(r"\1", cell).replace("`", "")


# Pydantic models


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


# Json schema

STARTERS = Path(__file__).parents[2] / "starters"
DRAFT = "http://json-schema.org/draft-07/schema#"
REF = "#/definitions/{model}"
NULL = {"type": "null"}
PLANAR_DIRECTIONS = frozenset({"axis", "normal"})  # directions that follow from `space: planar`


def make_spec_schema() -> dict[str, Any]:
    """Make the schema of a spec."""
    models = [*_iter_models()]
    _, pydantic_schema = models_json_schema([(make_model(model), "validation") for model in models], ref_template=REF)
    definitions = {name: _to_draft_07(block) for name, block in pydantic_schema["$defs"].items()}
    rows = read_rows_by_chapter()
    for heading, models_of_chapter in CHAPTERS.items():
        for kind, model in (
            models_of_chapter.items() if isinstance(models_of_chapter, Mapping) else [("", models_of_chapter)]
        ):
            _describe(definitions[model.__name__], rows[heading], kind)
    for model, (heading, key) in INLINE.items():
        description = next(row.description for row in rows[heading] if key in row.keys)
        definitions[model.__name__].setdefault("description", description)
    _accept_type_aliases(definitions)
    spatial_conditions = [_require_keys(kind, keys) for kind, keys in _make_planar_directions_optional(definitions)]
    shapes = [_make_reference(model) for model in fs.SHAPES.values()]
    shapes_block = definitions[f.BodyEntry.__name__]["properties"]["shapes"]
    shapes_block.pop("anyOf", None)
    shapes_block |= {"type": "array", "items": {"oneOf": shapes}}
    label = {**TEXT_SCHEMA, "description": rows["Labels"][0].description}
    _accept_labels(definitions, label)
    for model, entry in _iter_examples():
        definitions[model.__name__].setdefault("examples", [entry])
    head = definitions.pop("HeadEntry")
    top_level = head["properties"] | dict(_iter_blocks(label))
    schema = {
        "$schema": DRAFT, "title": "heun spec", "type": "object", "properties": top_level,
        "required": head["required"], "additionalProperties": False, "definitions": definitions,
        "if": {"properties": {"space": {"const": "planar"}}, "required": ["space"]},
        "else": {"properties": {"joints": {"additionalProperties": {"allOf": spatial_conditions}}}},
    }  # fmt: skip
    _describe(schema, rows[TOP], "")
    return schema


def _accept_labels(definitions: dict[str, Any], label: dict[str, Any]) -> None:
    """Accept the key `label` where the loader takes it out of the data (labels.py)."""
    for model in (*f.list_labelled_models(), f.ResultConditionEntry):
        definitions[model.__name__]["properties"]["label"] = label
    for model, key in ((f.BodyEntry, POINTS), (f.GroundEntry, POINTS), (f.AnalysisEntry, EVENTS)):
        block = definitions[model.__name__]["properties"][key]
        block["additionalProperties"] = _make_labelled_value(block["additionalProperties"], VALUE_KEYS[key], label)


def _make_labelled_value(value: dict[str, Any], key: str, label: dict[str, Any]) -> dict[str, Any]:
    """Return the schema of a value that may also be given as a mapping with a label."""
    mapping = {"type": "object", "properties": {key: value, "label": label}, "additionalProperties": False}
    return {"anyOf": [value, {**mapping, "required": [key]}]}


def _accept_type_aliases(definitions: dict[str, Any]) -> None:
    """Accept the other words for the types of joints and loads."""
    for block, models in ((block, f.ENTRY_BLOCKS[block]) for block in TYPE_ALIASES):
        for kind, model in models.items() if isinstance(models, Mapping) else ():
            aliases = list_aliases(block, kind)
            type_schema = definitions[model.__name__]["properties"]["type"]
            if aliases:
                type_schema["enum"] = [type_schema.pop("const"), *aliases]


def _make_planar_directions_optional(definitions: dict[str, Any]) -> Iterator[tuple[str, list[str]]]:
    """Make those directions of joints optional that a planar scene implies; yield them by type of joint."""
    for kind, model in fj.JOINTS.items():
        block = definitions[model.__name__]
        required = [key for key in block["required"] if key in PLANAR_DIRECTIONS]
        block["required"] = [key for key in block["required"] if key not in PLANAR_DIRECTIONS]
        if required:
            yield kind, required


def _require_keys(kind: str, keys: list[str]) -> dict[str, Any]:
    """Return the condition that a joint of a type has these keys."""
    words = {"enum": [kind, *list_aliases("joints", kind)]}
    return {"if": {"properties": {"type": words}, "required": ["type"]}, "then": {"required": keys}}


def _iter_models() -> Iterator[type[Entry]]:
    for models in (
        *f.ENTRY_BLOCKS.values(),
        *f.SINGLE_BLOCKS.values(),
        f.HeadEntry,
        f.ExpectEntry,
        f.TableEntry,
        fs.SHAPES,
    ):
        yield from models.values() if isinstance(models, Mapping) else [models]


def _iter_examples() -> Iterator[tuple[type[Entry], Any]]:
    """Yield entries of the starter specs, with the models that read them."""
    for path in sorted(STARTERS.glob("*.yaml")):
        spec = replace_type_aliases(read_source(str(path), None).data)
        for block, models_of_block in f.ENTRY_BLOCKS.items():
            for entry in spec.get(block, {}).values():
                yield models_of_block[entry["type"]] if isinstance(models_of_block, Mapping) else models_of_block, entry
        for key, model in f.SINGLE_BLOCKS.items():
            yield from [(model, spec[key])] if key in spec else []
        yield from ((f.ExpectEntry, item) for item in spec.get("expect", ()))


def _make_reference(model: type[Entry]) -> dict[str, Any]:
    return {"$ref": REF.format(model=model.__name__)}


def _iter_blocks(label: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the keys of the top level that hold entries; a block may be empty."""
    value = {"anyOf": [{"type": "number"}, {"type": "string"}]}
    yield "parameters", _make_named_block(_make_labelled_value(value, VALUE_KEYS["parameters"], label))
    for key, models in (*f.ENTRY_BLOCKS.items(), ("tables", f.TableEntry)):
        yield (
            key,
            _make_named_block(
                {"oneOf": [*map(_make_reference, models.values())]}
                if isinstance(models, Mapping)
                else _make_reference(models)
            ),
        )
    for key, model in f.SINGLE_BLOCKS.items():
        yield key, {"anyOf": [_make_reference(model), NULL]} if key == "ground" else _make_reference(model)
    yield "expect", {"type": "array", "items": _make_reference(f.ExpectEntry)}


def _make_named_block(entry: dict[str, Any]) -> dict[str, Any]:
    """Return the schema of a block of entries by name."""
    return {"type": ["object", "null"], "additionalProperties": entry}


def _describe(block: dict[str, Any], rows: list[KeyRow], kind: str) -> None:
    """Add the manual's descriptions to the keys of a model."""
    for row in rows:
        for key in row.keys:
            if key in block["properties"] and (not row.types or kind in row.types or not kind):
                key_schema = block["properties"][key]
                if "$ref" in key_schema:  # draft-07 ignores other keys next to it
                    key_schema["allOf"] = [{"$ref": key_schema.pop("$ref")}]
                key_schema["description"] = row.description


def _to_draft_07(value: Any) -> Any:
    """Convert a block of a later draft to draft-07; vectors of three may have two components (planar)."""
    if isinstance(value, list):
        return [_to_draft_07(member) for member in value]
    if not isinstance(value, dict):
        return value
    block = {key: _to_draft_07(member) for key, member in value.items() if key != "title" or isinstance(member, dict)}
    if "prefixItems" in block:
        block["items"] = block.pop("prefixItems")
        block["additionalItems"] = False
        if len(block["items"]) == 3:
            block["minItems"] = 2
    if "$defs" in block:
        block["definitions"] = block.pop("$defs")
    if block.get("default", ...) is None:  # `required` already says that the key is optional
        del block["default"]
        members = [member for member in block.get("anyOf", ()) if member != NULL]
        if len(members) == 1 and "anyOf" in block:
            del block["anyOf"]
            block = members[0] | block if "$ref" not in members[0] or not block else {"allOf": members, **block}
        elif members:
            block["anyOf"] = members
    if isinstance(block.get("additionalProperties"), bool) and "properties" in block and "type" not in block:
        block["type"] = "object"
    return block
