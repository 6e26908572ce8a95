"""The JSON Schema of `collectives` in `heun run --collective --json` (output/tables/collective_tables.py)."""

from __future__ import annotations

from typing import Any

NUMBER = {"type": "number"}
LIST = {"type": "array", "items": NUMBER}
ROWS = {"type": "array", "items": LIST}


def collectives_schema(version: dict[str, Any]) -> dict[str, Any]:
    """The object as a whole; version: what stands under `heun`."""
    head = {"heun": version, "title": {"type": "string"}, "spec": {}, "version": {}, "axes": {}, "status": {}}
    return whole(head | {"collectives": {"type": "object", "additionalProperties": collective_schema()}}, {"axes"})


def collective_schema() -> dict[str, Any]:
    """One collective."""
    share = whole({"slope": NUMBER, "shares": about(LIST, "of each class in the damage")})
    equivalent = whole({"slope": NUMBER, "cycles": NUMBER, "range": NUMBER, "error": NUMBER})
    ranges = {
        "limits": about(LIST, "of the classes, n + 1"), "cycles": about(LIST, "in each class, n"),
        "damage": {"type": "array", "items": share},
    }  # fmt: skip
    crossings = {
        "reference": NUMBER, "levels": LIST, "counted": about(LIST, "as E1049, 5.1"), "up": LIST, "down": LIST,
    }  # fmt: skip
    matrix = {"ranges": about(LIST, "limits"), "means": about(LIST, "limits"), "cycles": about(ROWS, "by range, mean")}
    return whole({
        "unit": about({"type": "string"}, "SI, of ranges, means and levels"),
        "magnitude": about({"type": "boolean"}, "whether it is one, which has no sign"),
        "time": about(LIST, "first and last instant [s]"),
        "repeat": about({"type": ["integer", "string"]}, "how often the motion is run through, or closed"),
        "error": about(NUMBER, "of each value of the history"),
        "lowest": NUMBER, "highest": NUMBER, "turning_points": {"type": "integer"},
        "cycles": about(NUMBER, "how many, halves as halves, without those below the error"),
        "below_error": about(whole({"cycles": NUMBER, "range": NUMBER}), "no larger than that range, in no class"),
        "equivalent": about({"type": "array", "items": equivalent}, "damage-equivalent ranges"),
        "ranges": whole(ranges), "matrix": whole(matrix), "crossings": whole(crossings),
        "rainflow": about(whole({"from": LIST, "to": LIST, "count": LIST}), "every cycle, and half cycle"),
    })  # fmt: skip


def whole(properties: dict[str, Any], optional: set[str] | None = None) -> dict[str, Any]:
    """An object with these keys and no others."""
    required = [key for key in properties if key not in (optional or ())]
    return {"type": "object", "properties": properties, "required": required, "additionalProperties": False}


def about(schema: dict[str, Any], words: str) -> dict[str, Any]:
    """A schema with a description."""
    return {**schema, "description": words}
