"""The format as a JSON Schema (draft-07, which editors read), from the classes that read a spec and the manual's words.

What a schema cannot say is left to `heun validate`: that a name is there, that a unit fits, what goes with what. Where
`space: planar` lets vectors have two components and a pin no axis, both are allowed.
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
from heuncli.scene.file_format.key_rows import KeyRow, rows_by_chapter
from heuncli.scene.file_format.pydantic_models import model_of
from heuncli.scene.file_format.source import read

STARTERS = Path(__file__).parents[2] / "starters"
DRAFT = "http://json-schema.org/draft-07/schema#"
REF = "#/definitions/{model}"
NULL = {"type": "null"}
IN_A_PLANE = frozenset({"axis", "normal"})  # directions that follow from `space: planar`


def spec_schema() -> dict[str, Any]:
    """The schema of a spec."""
    models = [*_all_models()]
    _, made = models_json_schema([(model_of(model), "validation") for model in models], ref_template=REF)
    definitions = {name: _draft_07(block) for name, block in made["$defs"].items()}
    rows = rows_by_chapter()
    for heading, of in CHAPTERS.items():
        for kind, model in of.items() if isinstance(of, Mapping) else [("", of)]:
            _describe(definitions[model.__name__], rows[heading], kind)
    for model, (heading, key) in INLINE.items():
        about = next(row.description for row in rows[heading] if key in row.keys)
        definitions[model.__name__].setdefault("description", about)
    in_space = [_needing(kind, keys) for kind, keys in _taken_from_the_plane(definitions)]
    shapes = [_ref(model) for model in fs.SHAPES.values()]
    own = definitions[f.BodyEntry.__name__]["properties"]["shapes"]
    own.pop("anyOf", None)
    own |= {"type": "array", "items": {"oneOf": shapes}}
    for model, entry in _examples():
        definitions[model.__name__].setdefault("examples", [entry])
    head = definitions.pop("HeadEntry")
    top = head["properties"] | dict(_blocks())
    schema = {
        "$schema": DRAFT, "title": "A scene of heun", "type": "object", "properties": top,
        "required": head["required"], "additionalProperties": False, "definitions": definitions,
        "if": {"properties": {"space": {"const": "planar"}}, "required": ["space"]},
        "else": {"properties": {"joints": {"additionalProperties": {"allOf": in_space}}}},
    }  # fmt: skip
    _describe(schema, rows[TOP], "")
    return schema


def _taken_from_the_plane(definitions: dict[str, Any]) -> Iterator[tuple[str, list[str]]]:
    """Make optional the directions of joints that a planar scene gives; yields them by type."""
    for kind, model in f.JOINTS.items():
        block = definitions[model.__name__]
        needed = [key for key in block["required"] if key in IN_A_PLANE]
        block["required"] = [key for key in block["required"] if key not in IN_A_PLANE]
        if needed:
            yield kind, needed


def _needing(kind: str, keys: list[str]) -> dict[str, Any]:
    """That a joint of a type has these keys."""
    return {"if": {"properties": {"type": {"const": kind}}, "required": ["type"]}, "then": {"required": keys}}


def _all_models() -> Iterator[type[Entry]]:
    for of in (*f.ENTRIES.values(), *f.SINGLE.values(), f.HeadEntry, f.ExpectEntry, f.TableEntry, fs.SHAPES):
        yield from of.values() if isinstance(of, Mapping) else [of]


def _examples() -> Iterator[tuple[type[Entry], Any]]:
    """Entries of the specs to start from, with the models that read them."""
    for path in sorted(STARTERS.glob("*.yaml")):
        spec = read(str(path), None).data
        for block, of in f.ENTRIES.items():
            for entry in spec.get(block, {}).values():
                yield of[entry["type"]] if isinstance(of, Mapping) else of, entry
        for key, model in f.SINGLE.items():
            yield from [(model, spec[key])] if key in spec else []
        yield from ((f.ExpectEntry, item) for item in spec.get("expect", ()))


def _ref(model: type[Entry]) -> dict[str, Any]:
    return {"$ref": REF.format(model=model.__name__)}


def _blocks() -> Iterator[tuple[str, dict[str, Any]]]:
    """The keys of the top level that hold entries; a block may be left empty."""
    value = {"anyOf": [{"type": "number"}, {"type": "string"}]}
    yield "parameters", _named(value)
    for key, of in (*f.ENTRIES.items(), ("tables", f.TableEntry)):
        yield key, _named({"oneOf": [*map(_ref, of.values())]} if isinstance(of, Mapping) else _ref(of))
    for key, model in f.SINGLE.items():
        yield key, {"anyOf": [_ref(model), NULL]} if key == "ground" else _ref(model)
    yield "expect", {"type": "array", "items": _ref(f.ExpectEntry)}


def _named(entry: dict[str, Any]) -> dict[str, Any]:
    """A block of entries by name."""
    return {"type": ["object", "null"], "additionalProperties": entry}


def _describe(block: dict[str, Any], rows: list[KeyRow], kind: str) -> None:
    """Put the manual's words to the keys of a model."""
    for row in rows:
        for key in row.keys:
            if key in block["properties"] and (not row.of or kind in row.of or not kind):
                own = block["properties"][key]
                if "$ref" in own:  # beside which draft-07 reads nothing
                    own["allOf"] = [{"$ref": own.pop("$ref")}]
                own["description"] = row.description


def _draft_07(value: Any) -> Any:
    """A block of a later draft as draft-07 says it; vectors may lie in a plane."""
    if isinstance(value, list):
        return [_draft_07(member) for member in value]
    if not isinstance(value, dict):
        return value
    block = {key: _draft_07(member) for key, member in value.items() if key != "title" or isinstance(member, dict)}
    if "prefixItems" in block:
        block["items"] = block.pop("prefixItems")
        block["additionalItems"] = False
        if len(block["items"]) == 3:
            block["minItems"] = 2
    if "$defs" in block:
        block["definitions"] = block.pop("$defs")
    if block.get("default", ...) is None:  # that a key may be left out is said by `required`
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
