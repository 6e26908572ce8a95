"""Which point of which body a value names: points.BODY.POINT.x, or points.POINT.x where that is one alone."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from heuncli.base.errors import Finding
from heuncli.base.nearest import did_you_mean
from heuncli.scene.expressions.programs import POINTS

GROUND = "ground"
QUANTITIES = ("x", "y", "z", "vx", "vy", "vz")
FORM = f"a point is {POINTS}.BODY.POINT.x, y, z [m] or .vx, .vy, .vz [m/s], along the axes of the world"

Points = Mapping[str, Collection[str]]  # of each body and of the ground


def point_meant(written: str, words: Sequence[str], points: Points) -> tuple[str, str, str]:
    """Body, point and quantity of the words behind `points`. Raises Finding."""
    *names, quantity = words
    if quantity not in QUANTITIES or len(names) not in (1, 2):
        raise Finding("unknown-coordinate", f"'{written}' is no coordinate of a point", form(names, quantity, points))
    if len(names) == 1:
        names = [of_one_body(written, names[0], points), names[0]]
    elif names[0] not in points:
        hint = did_you_mean(names[0], points, "bodies")
        raise Finding("unknown-body", f"'{written}': '{names[0]}' is not a body", hint)
    elif names[1] not in points[names[0]]:
        hint = did_you_mean(names[1], points[names[0]], f"points of {names[0]}")
        raise Finding("unknown-point", f"'{written}': {names[0]} has no point '{names[1]}'", hint)
    return names[0], names[1], quantity


def form(names: Sequence[str], quantity: str, points: Points) -> str:
    """What was meant: of points.drill.bit.position.x, as results have it, points.drill.bit.x."""
    if len(names) == 3 and names[0] in points and names[2] in ("position", "velocity") and quantity in tuple("xyz"):
        key = quantity if names[2] == "position" else f"v{quantity}"
        return f"write {POINTS}.{names[0]}.{names[1]}.{key}"
    return FORM


def of_one_body(written: str, point: str, points: Points) -> str:
    """The body that alone has a point of that name, else the ground. Raises Finding."""
    owners = [body for body, own in points.items() if point in own and body != GROUND]
    if not owners and point in points.get(GROUND, ()):
        return GROUND
    if len(owners) == 1:
        return owners[0]
    if owners:
        named = ", ".join(f"{POINTS}.{body}.{point}" for body in owners)
        raise Finding("unknown-point", f"'{written}': several bodies have a point {point}", f"name one: {named}")
    if point in points:
        own = [f"{POINTS}.{point}.{name}" for name in points[point]]
        hint = f"name a point of it: {', '.join(own)}" if own else f"bodies: {point}: has no points"
        raise Finding("unknown-point", f"'{written}': {point} is a body", hint)
    known = [name for own in points.values() for name in own]
    raise Finding("unknown-point", f"'{written}': no body has a point '{point}'", did_you_mean(point, known, "points"))
