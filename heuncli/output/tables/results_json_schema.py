"""The JSON Schema (draft-07) of the results of `heun run --format json`, and of its `collectives`.

It is made from the definitions of the results (results_schema.py)."""

from __future__ import annotations

import re
from typing import Any

from heuncli.output.documents.document import format_head
from heuncli.results.path_words import NAMES, TREE, Node
from heuncli.results.results_schema import IMPULSES, Quantity

DRAFT = "http://json-schema.org/draft-07/schema#"
LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")
IN_LISTS = "NUMBER"
VALUE = {"type": ["number", "boolean", "null"]}  # the value of a condition is a boolean
FORMAT = {"const": 1, "description": "version of the form of results"}


def make_results_schema() -> dict[str, Any]:
    """Return the schema of a result, of load collectives, or of either for all load cases."""
    result = _make_block_schema(TREE, is_timed=True)
    result["properties"]["heun"] = FORMAT
    result["properties"] |= {key: {} for key in ("spec", "version", "warnings") if key not in result["properties"]}
    result["required"] = ["heun", "status", "time"]
    bound = {"type": ["object", "null"], "properties": {"value": VALUE, "at": VALUE, "case": {"type": "string"}}}
    row = {"type": "object", "properties": {"unit": {"type": "string"}, "min": bound, "max": bound}}
    either = [{"$ref": "#/definitions/result"}, {"$ref": "#/definitions/collectives"}]
    cases = {
        "type": "object", "required": ["cases"], "additionalProperties": False,
        "properties": {
            "cases": {"type": "object", "additionalProperties": {"anyOf": either}},
            "envelope": {"type": "object", "additionalProperties": row},
        },
    }  # fmt: skip
    return {
        "$schema": DRAFT, "title": "A result of heun run",
        "definitions": {"result": result, "collectives": make_collectives_schema(FORMAT)}, "anyOf": [*either, cases],
    }  # fmt: skip


def _make_block_schema(node: Node, is_timed: bool) -> dict[str, Any]:
    """Return the schema of a block: its known keys, and what may stand under names of the scene.

    is_timed: whether quantities vary over the instants here; those of an impact do not
    """
    known = {
        key: _make_member_schema(member, is_timed and key != IMPULSES)
        for key, member in node.items()
        if key not in NAMES
    }
    named = [_make_member_schema(member, is_timed) for key, member in node.items() if key in NAMES and key != IN_LISTS]
    if IN_LISTS in node and len(node) == 1:
        return {"type": "array", "items": _make_member_schema(node[IN_LISTS], is_timed)}
    additional: Any = named[0] if named else False
    return {"type": "object", "properties": known, "additionalProperties": additional}


def _make_member_schema(member: Node | Quantity, is_timed: bool) -> dict[str, Any]:
    if not isinstance(member, Quantity):
        return _make_block_schema(member, is_timed)
    meaning = LINK.sub(r"\1", member.meaning).replace("`", "").replace("\\|", "|")
    unit = " or ".join(member.units)
    schema = {"description": format_head(meaning, unit)}
    if member.has_own_form:
        return schema
    if member.is_words:
        return {**schema, "type": ["string", "array", "object", "null"]}
    over_time = member.is_timed and is_timed
    depths = {len(member.instant_axes(in_series)) + over_time for in_series in (False, True)}
    return {**schema, "anyOf": [_make_nested_schema(n) for n in sorted(depths)]}


def _make_nested_schema(depth: int) -> dict[str, Any]:
    """Return the schema of numbers in lists nested to a depth; null stands for an indeterminate number."""
    return {"type": "array", "items": _make_nested_schema(depth - 1)} if depth else dict(VALUE)


NUMBER = {"type": "number"}
NUMBER_LIST = {"type": "array", "items": NUMBER}
NUMBER_ROWS = {"type": "array", "items": NUMBER_LIST}


def make_collectives_schema(version: dict[str, Any]) -> dict[str, Any]:
    """Return the schema of the whole object; version: the schema of its key `heun`."""
    head = {"heun": version, "title": {"type": "string"}, "spec": {}, "version": {}, "axes": {}, "status": {}}
    return make_object_schema(
        head | {"collectives": {"type": "object", "additionalProperties": make_collective_schema()}}, {"axes"}
    )


def make_collective_schema() -> dict[str, Any]:
    """Return the schema of one load collective."""
    share = make_object_schema(
        {"slope": NUMBER, "shares": add_description(NUMBER_LIST, "contribution of each class to the damage")}
    )
    equivalent = make_object_schema({"slope": NUMBER, "cycles": NUMBER, "range": NUMBER, "error": NUMBER})
    ranges = {
        "limits": add_description(NUMBER_LIST, "class limits, n + 1"),
        "cycles": add_description(NUMBER_LIST, "cycles per class, n"),
        "damage": {"type": "array", "items": share},
    }
    crossings = {
        "reference": NUMBER,
        "levels": NUMBER_LIST,
        "counted": add_description(NUMBER_LIST, "as E1049, 5.1"),
        "up": NUMBER_LIST,
        "down": NUMBER_LIST,
    }
    matrix = {
        "ranges": add_description(NUMBER_LIST, "limits"),
        "means": add_description(NUMBER_LIST, "limits"),
        "cycles": add_description(NUMBER_ROWS, "by range, mean"),
    }
    return make_object_schema(
        {
            "unit": add_description({"type": "string"}, "SI unit of ranges, means and levels"),
            "magnitude": add_description({"type": "boolean"}, "whether the path is a magnitude, which has no sign"),
            "time": add_description(NUMBER_LIST, "first and last instant [s]"),
            "repeat": add_description(
                {"type": ["integer", "string"]}, "number of repetitions of the motion, or closed"
            ),
            "error": add_description(NUMBER, "error of each value of the time history"),
            "lowest": NUMBER,
            "highest": NUMBER,
            "turning_points": {"type": "integer"},
            "cycles": add_description(NUMBER, "number of cycles, half cycles as 0.5, without those below the error"),
            "below_error": add_description(
                make_object_schema({"cycles": NUMBER, "range": NUMBER}), "cycles up to this range, not in any class"
            ),
            "equivalent": add_description({"type": "array", "items": equivalent}, "damage-equivalent ranges"),
            "ranges": make_object_schema(ranges),
            "matrix": make_object_schema(matrix),
            "crossings": make_object_schema(crossings),
            "rainflow": add_description(
                make_object_schema({"from": NUMBER_LIST, "to": NUMBER_LIST, "count": NUMBER_LIST}),
                "every cycle and half cycle",
            ),
        }
    )


def make_object_schema(properties: dict[str, Any], optional: set[str] | None = None) -> dict[str, Any]:
    """Return the schema of an object with these keys and no others."""
    required = [key for key in properties if key not in (optional or ())]
    return {"type": "object", "properties": properties, "required": required, "additionalProperties": False}


def add_description(schema: dict[str, Any], words: str) -> dict[str, Any]:
    """Return the schema with a description."""
    return {**schema, "description": words}
