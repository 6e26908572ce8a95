"""The format as a JSON Schema (draft-07, which editors read), made from the classes that read a spec and from the
manual.

What a schema cannot express is left to `heun validate`: that a name exists, that a unit fits, which keys exclude each
other. `space: planar` allows vectors of two components and pins without an axis; the schema allows both forms.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from pydantic.json_schema import models_json_schema

from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_shapes as fs
from heuncli.scene.file_format.chapters import CHAPTERS, INLINE, TOP
from heuncli.scene.file_format.entries import Entry
from heuncli.scene.file_format.key_rows import KeyRow, read_rows_by_chapter
from heuncli.scene.file_format.pydantic_models import make_model
from heuncli.scene.file_format.source import read_source
from heuncli.scene.file_format.type_aliases import TYPE_ALIASES, list_aliases, replace_type_aliases

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
    for model, entry in _iter_examples():
        definitions[model.__name__].setdefault("examples", [entry])
    head = definitions.pop("HeadEntry")
    top_level = head["properties"] | dict(_iter_blocks())
    schema = {
        "$schema": DRAFT, "title": "heun spec", "type": "object", "properties": top_level,
        "required": head["required"], "additionalProperties": False, "definitions": definitions,
        "if": {"properties": {"space": {"const": "planar"}}, "required": ["space"]},
        "else": {"properties": {"joints": {"additionalProperties": {"allOf": spatial_conditions}}}},
    }  # fmt: skip
    _describe(schema, rows[TOP], "")
    return schema


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
    for kind, model in f.JOINTS.items():
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


def _iter_blocks() -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the keys of the top level that hold entries; a block may be empty."""
    value = {"anyOf": [{"type": "number"}, {"type": "string"}]}
    yield "parameters", _make_named_block(value)
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
