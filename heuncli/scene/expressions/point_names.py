"""Resolve the point of a body that a value names: points.BODY.POINT.x, or points.POINT.x if only one body has it."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from heuncli.base.errors import Finding
from heuncli.base.spelling import suggest
from heuncli.scene.expressions.programs import POINTS

GROUND = "ground"
QUANTITIES = ("x", "y", "z", "vx", "vy", "vz")
POINT_FORM_HINT = f"a point is {POINTS}.BODY.POINT.x, y, z [m] or .vx, .vy, .vz [m/s], world axes"

Points = Mapping[str, Collection[str]]  # of each body and of the ground


def resolve_point(text: str, words: Sequence[str], points: Points) -> tuple[str, str, str]:
    """Return body, point and quantity of the words after `points`. Raises Finding."""
    *names, quantity = words
    if quantity not in QUANTITIES or len(names) not in (1, 2):
        raise Finding(
            "unknown-coordinate",
            f"'{text}' is not a coordinate of a point",
            suggest_point_form(names, quantity, points),
        )
    if len(names) == 1:
        names = [find_owner(text, names[0], points), names[0]]
    elif names[0] not in points:
        hint = suggest(names[0], points, "bodies")
        raise Finding("unknown-body", f"'{text}': '{names[0]}' is not a body", hint)
    elif names[1] not in points[names[0]]:
        hint = suggest(names[1], points[names[0]], f"points of {names[0]}")
        raise Finding("unknown-point", f"'{text}': {names[0]} has no point '{names[1]}'", hint)
    return names[0], names[1], quantity


def suggest_point_form(names: Sequence[str], quantity: str, points: Points) -> str:
    """Suggest the valid form: for points.drill.bit.position.x, as in results, points.drill.bit.x."""
    if len(names) == 3 and names[0] in points and names[2] in ("position", "velocity") and quantity in tuple("xyz"):
        key = quantity if names[2] == "position" else f"v{quantity}"
        return f"write {POINTS}.{names[0]}.{names[1]}.{key}"
    return POINT_FORM_HINT


def find_owner(text: str, point: str, points: Points) -> str:
    """Find the only body that has a point of that name, else the ground. Raises Finding."""
    owners = [body for body, body_points in points.items() if point in body_points and body != GROUND]
    if not owners and point in points.get(GROUND, ()):
        return GROUND
    if len(owners) == 1:
        return owners[0]
    if owners:
        named = ", ".join(f"{POINTS}.{body}.{point}" for body in owners)
        raise Finding("unknown-point", f"'{text}': several bodies have a point {point}", f"name one: {named}")
    if point in points:
        body_points = [f"{POINTS}.{point}.{name}" for name in points[point]]
        hint = f"name a point of it: {', '.join(body_points)}" if body_points else f"bodies: {point}: has no points"
        raise Finding("unknown-point", f"'{text}': {point} is a body", hint)
    known = [name for body_points in points.values() for name in body_points]
    raise Finding("unknown-point", f"'{text}': no body has a point '{point}'", suggest(point, known, "points"))
