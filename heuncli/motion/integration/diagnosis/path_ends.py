"""Find where a point runs off its path, or a cam's disc turns off its lift."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.mechanism.model import GROUND, Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.expressions.paths import Path
from heuncli.scene.shapes.rotations import cross_rows

Moving = Mapping[tuple[str, str], tuple[float, float]]  # a joint's coordinate or a point's, and its rate of change


class OpenPath(NamedTuple):
    """A path with two ends.

    coordinate: the coordinate along it
    message: sentence on what leaves it
    longer: what to propose instead
    unit: the unit in which the coordinate is reported, and its factor
    owner: the object that the problem is about
    """

    path: Path
    coordinate: tuple[str, str]
    message: str
    longer: str
    unit: tuple[str, float]
    owner: str


def iter_open_paths(mechanism: Mechanism) -> Iterator[OpenPath]:
    """Yield all paths and lifts that have ends."""
    for joint in mechanism.joints:
        if joint.path is not None and not joint.path.period:
            message = f"the point of joint {joint.name} leaves its path, which covers travel"
            yield OpenPath(
                joint.path, (joint.name, "travel"), message, "use a longer path,", ("m", 1.0), f"joints.{joint.name}"
            )
    for coupling in mechanism.couplings:
        shape = coupling.rows[0].parts[0].cam if coupling.rows else None
        if shape is not None and not shape.lift.period:
            shaft = mechanism.joints[coupling.rows[0].parts[0].coordinates[0].joint].name
            message = f"the disc of cam {coupling.name} rotates past its lift curve, which covers {shaft}.angle"
            longer, owner = "use a longer lift, or one with a period,", f"couplings.{coupling.name}"
            yield OpenPath(shape.lift, (shaft, "angle"), message, longer, ("deg", math.degrees(1.0)), owner)


def find_left_paths(mechanism: Mechanism, t: float, later: float, coordinates: Moving) -> list[Problem]:
    """Return problems of the paths at whose ends a point is at t, or will be just after it; unknown coordinates are
    skipped.
    """
    problems = []
    for open_path in iter_open_paths(mechanism):
        path, (unit, factor) = open_path.path, open_path.unit
        s, u = coordinates.get(open_path.coordinate, (math.nan, 0.0))
        if math.isnan(s) or path.first <= s + later * u <= path.last:
            continue
        first, last = (factor * end for end in (path.first, path.last))
        message = f"at t = {t:.9g} s {open_path.message} from {first:.9g} to {last:.9g} {unit}"
        end = f"> {last:.6g}" if s > 0.5 * (path.first + path.last) else f"< {first:.6g}"
        until = f"{'.'.join(open_path.coordinate)} {end}{'' if unit == 'm' else ' ' + unit}"
        hint = f"{open_path.longer} or end the run earlier: until: {until}"
        problems.append(Problem("path-ends", message, None, hint, open_path.owner))
    return problems


def cut_path_coordinates(layout: Layout, state: Array, bodies: np.ndarray[Any, Any]) -> dict[tuple[str, str], Any]:
    """Return travel and speed of the cut joints along paths, as the state counts them; bodies: results at that
    state.
    """
    coordinates: dict[tuple[str, str], Any] = {}
    for k, index in layout.counters.items():
        joint = layout.mechanism.joints[k]
        if joint.path is None:
            continue
        point_motion, path_motion = (
            _point_motion(layout, bodies, joint.b, joint.q, None),
            _point_motion(layout, bodies, joint.a, joint.p, None),
        )
        D, v = (
            point_motion[0] - path_motion[0],
            point_motion[1] - _point_motion(layout, bodies, joint.a, joint.p, point_motion[0])[1],
        )
        if joint.a != GROUND:
            D, v = (x @ bodies["R"][layout.place[joint.a]] for x in (D, v))
        s = float(state[index])
        if math.isnan(s):  # it is in flight next to the nearest end
            end = float(joint.path.find_nearest(D)) > 0.5 * (joint.path.first + joint.path.last)
            s = math.inf if end else -math.inf
        slope = joint.path.evaluate(float(np.clip(s, joint.path.first, joint.path.last)) if math.isinf(s) else s)[1]
        u = float(slope @ v) / float(slope @ slope)
        coordinates[joint.name, "travel"], coordinates[joint.name, "speed"] = (s, u), (u, 0.0)
    return coordinates


def _point_motion(
    layout: Layout, bodies: np.ndarray[Any, Any], body: int, point: Array, world_place: Array | None
) -> tuple[Array, Array]:
    """Return position and velocity of a body's point, or of the body's material at a world position."""
    if body == GROUND:
        return (point if world_place is None else world_place), np.zeros(3)
    body_row = bodies[layout.place[body]]
    arm = (
        body_row["R"] @ (point - layout.reference[layout.place[body]])
        if world_place is None
        else world_place - body_row["r"]
    )
    return body_row["r"] + arm, body_row["v"] + cross_rows(body_row["omega"], arm)
