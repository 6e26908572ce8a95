"""The results of `heun run --format json` as a JSON Schema (draft-07), from the rows that say what they hold."""

from __future__ import annotations

import re
from typing import Any

from heuncli.output.tables.collective_schema import collectives_schema
from heuncli.results.results_schema import BLOWS, NAMES, TREE, Node, Quantity

DRAFT = "http://json-schema.org/draft-07/schema#"
LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")
IN_LISTS = "NUMBER"
NUMBER = {"type": ["number", "boolean", "null"]}  # a truth of an event is one, too
FORMAT = {"const": 1, "description": "version of the form of results"}


def results_schema() -> dict[str, Any]:
    """The schema of a result, of load collectives, or of either of all load cases."""
    one = _block(TREE, timed=True)
    one["properties"]["heun"] = FORMAT
    one["properties"] |= {key: {} for key in ("spec", "version", "warnings") if key not in one["properties"]}
    one["required"] = ["heun", "status", "time"]
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
        "definitions": {"result": one, "collectives": collectives_schema(FORMAT)}, "anyOf": [*either, cases],
    }  # fmt: skip


def _block(node: Node, timed: bool) -> dict[str, Any]:
    """A block: its known keys, and what stands under names of the scene, of which a block may have any.

    timed: whether quantities that run over the instants do so here; at a blow they do not.
    """
    known = {key: _member(member, timed and key != BLOWS) for key, member in node.items() if key not in NAMES}
    named = [_member(member, timed) for key, member in node.items() if key in NAMES and key != IN_LISTS]
    if IN_LISTS in node and len(node) == 1:
        return {"type": "array", "items": _member(node[IN_LISTS], timed)}
    rest: Any = named[0] if named else False
    return {"type": "object", "properties": known, "additionalProperties": rest}


def _member(member: Node | Quantity, timed: bool) -> dict[str, Any]:
    if not isinstance(member, Quantity):
        return _block(member, timed)
    meaning = LINK.sub(r"\1", member.meaning).replace("`", "").replace("\\|", "|")
    unit = " or ".join(member.units)
    about = {"description": f"{meaning} [{unit}]" if unit and unit != "1" else meaning}
    if member.own_form:
        return about
    if member.is_words:
        return {**about, "type": ["string", "array", "object", "null"]}
    over_time = member.timed and timed
    depths = {len(member.axes(run)) + over_time for run in (False, True)}
    return {**about, "anyOf": [_nested(n) for n in sorted(depths)]}


def _nested(depth: int) -> dict[str, Any]:
    """Numbers in lists of lists, so many deep; null for what is open."""
    return {"type": "array", "items": _nested(depth - 1)} if depth else dict(NUMBER)
