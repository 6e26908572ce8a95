"""The JSON Schema of `collectives` in `heun run --collective --json` (output/tables/collective_tables.py)."""

from __future__ import annotations

from typing import Any

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
