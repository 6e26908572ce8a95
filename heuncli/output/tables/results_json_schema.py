"""The JSON Schema (draft-07) of the results of `heun run --format json`, made from the definitions of the
quantities.
"""

from __future__ import annotations

import re
from typing import Any

from heuncli.output.documents.document import format_head
from heuncli.output.tables.collective_schema import make_collectives_schema
from heuncli.results.path_words import NAMES, TREE, Node
from heuncli.results.results_schema import IMPULSES, Quantity

DRAFT = "http://json-schema.org/draft-07/schema#"
LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")
IN_LISTS = "NUMBER"
NUMBER = {"type": ["number", "boolean", "null"]}  # the value of a condition is a boolean
FORMAT = {"const": 1, "description": "version of the form of results"}


def make_results_schema() -> dict[str, Any]:
    """Return the schema of a result, of load collectives, or of either for all load cases."""
    result = _make_block_schema(TREE, is_timed=True)
    result["properties"]["heun"] = FORMAT
    result["properties"] |= {key: {} for key in ("spec", "version", "warnings") if key not in result["properties"]}
    result["required"] = ["heun", "status", "time"]
    bound = {"type": ["object", "null"], "properties": {"value": NUMBER, "at": NUMBER, "case": {"type": "string"}}}
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
    depths = {len(member.instant_axes(run)) + over_time for run in (False, True)}
    return {**schema, "anyOf": [_make_nested_schema(n) for n in sorted(depths)]}


def _make_nested_schema(depth: int) -> dict[str, Any]:
    """Return the schema of numbers in lists nested to a depth; null stands for an indeterminate number."""
    return {"type": "array", "items": _make_nested_schema(depth - 1)} if depth else dict(NUMBER)
