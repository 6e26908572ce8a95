"""Couplings of a flat scene, and what of theirs leaves the plane.

Between bodies that cannot tilt a coupling asks for the same in the plane as in space: what of its load points out of it
does no work. Of all others a condition has to be its own mirror image: its points lie in the plane and so do its
forces, what turns does so about the normal. No condition may count by a coordinate that the plane leaves no motion.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from heuncli.base import tolerances
from heuncli.multibody.mechanism.couplings import Coupling, CouplingPart, Place
from heuncli.multibody.reduction.plane.departure import Departure, beside
from heuncli.multibody.reduction.plane.view import View
from heuncli.multibody.reduction.restated_couplings import SeenFrom, first_in, point_in, second_in
from heuncli.results.results import Array

# directions of a part's load that lie in the plane, and axes that stand across it, by the part's kind
LIES: Mapping[str, str] = {
    "guide": "e", "mesh": "e", "touches": "e", "rolls": "e", "rolls_aside": "e", "ball_touches": "e", "ball_rolls": "e",
}  # fmt: skip
STANDS: Mapping[str, str] = {
    "turn": "e", "strand": "e", "arc": "e", "wound": "g", "mesh": "g", "touches": "g", "rolls": "g", "rolls_aside": "g",
    "cam": "e",
}  # fmt: skip
Axes = Callable[[int], Array]


def seen_from(seen: View, axes: Axes, own: Coupling) -> SeenFrom:
    """How the flat scene sees a coupling; axes: (3, 3), what takes a body's components, or the ground's, to it.

    Points keep their heights, over that of the first: strands between two of them stay as long as they are.
    """
    first = own.rows[0].parts[0]
    base = seen.height(point_in(first), np.asarray(first.p))

    def point(body: int, p: Place) -> Array:
        found: Array = axes(body) @ np.asarray(p)
        rise = seen.height(body, np.asarray(p)) - base
        found[2] = rise if abs(rise) > tolerances.FLAT * seen.reach else 0.0
        return found

    def direction(body: int, e: Place) -> Array:
        return untilted(axes(body) @ np.asarray(e))

    return SeenFrom(body=int, joint=int, point=point, direction=direction)


def untilted(x: Array) -> Array:
    """A direction without what rounding turns it by, out of the plane or off its normal."""
    return np.where(np.abs(x) <= tolerances.FLAT * np.sqrt(x @ x), 0.0, x)


def leaving(seen: View, height: float | None) -> Iterator[Departure]:
    """What of the couplings leaves the plane; height: of it, where there are bodies that could tilt out of it."""
    mechanism = seen.scene.mechanism
    for owner, own in enumerate(mechanism.couplings, len(mechanism.joints)):
        name = mechanism.owner(owner)
        still = list(_counted(seen, own, name))
        yield from still
        if height is not None and not still and not all(seen.stays(i) for i in own.bodies):
            for part in (part for row in own.rows for part in row.parts):
                yield from _points(seen, part, name, height)
                yield from _directions(seen, part, name)


def _counted(seen: View, own: Coupling, name: str) -> Iterator[Departure]:
    """Coordinates that keep their start values in the plane."""
    joints = seen.scene.mechanism.joints
    for k, quantity in dict.fromkeys(x[:2] for row in own.rows for part in row.parts for x in part.coordinates):
        if seen.still(k, quantity):
            yield Departure(f"{name} counts {joints[k].name}.{quantity}, a coordinate out of it", 1.0, True)


def _points(seen: View, part: CouplingPart, name: str, height: float) -> Iterator[Departure]:
    """Where a part acts on bodies that could tilt."""
    for body, point in part.places:
        yield from beside(seen, height, body, point, f"a point of {name}")


def _directions(seen: View, part: CouplingPart, name: str) -> Iterator[Departure]:
    """Directions of a part between bodies that could tilt."""
    kind = part.kind
    if kind == "dot":
        yield Departure(f"{name} turns alike what bends out of it", 1.0, True)
    of = {"e": (first_in(part), np.asarray(part.e)), "g": (second_in(part), np.asarray(part.g))}
    lies, stands = ([of[key] for key in keys.get(kind, "")] for keys in (LIES, STANDS))
    if part.cam is not None:
        (stands if part.cam.swings else lies).append(of["g"])
        lies += [] if part.cam.face is None else [(part.b, part.cam.face)]
    for body, x in lies:
        along, _ = _parts(seen, body, x)
        if along > tolerances.FLAT:
            yield Departure(f"the force of {name} points out of it by {along:.1g} (sine)", along, True)
    for body, x in stands:
        _, across = _parts(seen, body, x)
        if across > tolerances.FLAT:
            yield Departure(f"an axis of {name} is off its normal by {across:.1g} (sine)", across, True)


def _parts(seen: View, body: int, x: Array) -> tuple[float, float]:
    """How much of a body's direction is along the normal, and how much across it, of its size; nothing of none."""
    n, size = seen.normal_in(body), float(np.sqrt(x @ x))
    along = float(x @ n)
    off = x - along * n
    return (abs(along) / size, float(np.sqrt(off @ off)) / size) if size > 0.0 else (0.0, 0.0)
