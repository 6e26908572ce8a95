"""Couplings of a flat scene, and which of them leave the plane.

Between bodies that cannot tilt a coupling sets the same condition in the plane as in space: load components out of the
plane do no work. For all others a condition must be its own mirror image: its points and forces lie in the plane, and
rotations are about the normal. No condition may contain a coordinate that cannot move in the plane.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from heuncli.base import tolerances
from heuncli.multibody.mechanism.couplings import Coupling, CouplingPart, Place
from heuncli.multibody.reduction.plane.view import Departure, PlaneView, height_departures
from heuncli.multibody.reduction.smaller_scene import (
    SceneTransform,
    first_direction_body,
    point_body,
    second_direction_body,
)
from heuncli.results.results import Array

# directions of a part's load that lie in the plane, and axes that are normal to it, by the part's kind
IN_PLANE_DIRECTIONS: Mapping[str, str] = {
    "guide": "e", "mesh": "e", "touches": "e", "rolls": "e", "rolls_aside": "e", "ball_touches": "e", "ball_rolls": "e",
}  # fmt: skip
NORMAL_DIRECTIONS: Mapping[str, str] = {
    "turn": "e", "strand": "e", "arc": "e", "wound": "g", "mesh": "g", "touches": "g", "rolls": "g", "rolls_aside": "g",
    "cam": "e",
}  # fmt: skip
Axes = Callable[[int], Array]


def flat_transform(plane_view: PlaneView, axes: Axes, coupling: Coupling) -> SceneTransform:
    """Make the transformation of a coupling to the flat scene; axes: (3, 3) of a body or the ground, from its
    components.

    Points keep their heights over that of the first point, so that strands between two of them keep their lengths.
    """
    first = coupling.rows[0].parts[0]
    base = plane_view.point_height(point_body(first), np.asarray(first.p))

    def point(body: int, p: Place) -> Array:
        found: Array = axes(body) @ np.asarray(p)
        rise = plane_view.point_height(body, np.asarray(p)) - base
        found[2] = rise if abs(rise) > tolerances.FLAT * plane_view.reach else 0.0
        return found

    def direction(body: int, e: Place) -> Array:
        return remove_tilt(axes(body) @ np.asarray(e))

    return SceneTransform(body=int, joint=int, point=point, direction=direction)


def remove_tilt(x: Array) -> Array:
    """Set to zero the components of a direction that are rounding, out of the plane or off its normal."""
    return np.where(np.abs(x) <= tolerances.FLAT * np.sqrt(x @ x), 0.0, x)


def iter_coupling_departures(plane_view: PlaneView, height: float | None) -> Iterator[Departure]:
    """Yield what leaves the plane in the couplings; height: of the plane, or None if no body could tilt out of it."""
    mechanism = plane_view.scene.mechanism
    for owner, coupling in enumerate(mechanism.couplings, len(mechanism.joints)):
        name = mechanism.owner_path(owner)
        fixed_coordinates = list(_coordinate_departures(plane_view, coupling, name))
        yield from fixed_coordinates
        if height is not None and not fixed_coordinates and not all(plane_view.is_upright(i) for i in coupling.bodies):
            for part in (part for row in coupling.rows for part in row.parts):
                yield from _point_departures(plane_view, part, name, height)
                yield from _direction_departures(plane_view, part, name)


def _coordinate_departures(plane_view: PlaneView, coupling: Coupling, name: str) -> Iterator[Departure]:
    """Yield coordinates of a coupling that keep their start values in the plane."""
    joints = plane_view.scene.mechanism.joints
    for k, quantity in dict.fromkeys(x[:2] for row in coupling.rows for part in row.parts for x in part.coordinates):
        if plane_view.is_fixed_coordinate(k, quantity):
            yield Departure(f"{name} uses {joints[k].name}.{quantity}, an out-of-plane coordinate", 1.0, True)


def _point_departures(plane_view: PlaneView, part: CouplingPart, name: str, height: float) -> Iterator[Departure]:
    """Yield the points outside the plane at which a part acts on bodies that could tilt."""
    for body, point in part.body_points:
        yield from height_departures(plane_view, height, body, point, f"a point of {name}")


def _direction_departures(plane_view: PlaneView, part: CouplingPart, name: str) -> Iterator[Departure]:
    """Yield the directions out of the plane of a part between bodies that could tilt."""
    kind = part.kind
    if kind == "dot":
        yield Departure(f"{name} couples shafts that bend out of the plane", 1.0, True)
    directions = {
        "e": (first_direction_body(part), np.asarray(part.e)),
        "g": (second_direction_body(part), np.asarray(part.g)),
    }
    in_plane, normal = (
        [directions[key] for key in keys.get(kind, "")] for keys in (IN_PLANE_DIRECTIONS, NORMAL_DIRECTIONS)
    )
    if part.cam is not None:
        (normal if part.cam.swings else in_plane).append(directions["g"])
        in_plane += [] if part.cam.face is None else [(part.b, part.cam.face)]
    for body, x in in_plane:
        along, _ = _split_direction(plane_view, body, x)
        if along > tolerances.FLAT:
            yield Departure(f"the force of {name} points out of the plane by {along:.1g} (sine)", along, True)
    for body, x in normal:
        _, across = _split_direction(plane_view, body, x)
        if across > tolerances.FLAT:
            yield Departure(f"an axis of {name} deviates from the plane normal by {across:.1g} (sine)", across, True)


def _split_direction(plane_view: PlaneView, body: int, x: Array) -> tuple[float, float]:
    """Return the relative components of a body's direction along the normal and across it; zeros for a zero vector."""
    n, size = plane_view.normal_components(body), float(np.sqrt(x @ x))
    along = float(x @ n)
    transverse = x - along * n
    return (abs(along) / size, float(np.sqrt(transverse @ transverse)) / size) if size > 0.0 else (0.0, 0.0)
