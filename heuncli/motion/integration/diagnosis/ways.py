"""Ends of ways: of the paths along which points run, and of the lifts over which discs of cams turn."""

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


class OpenWay(NamedTuple):
    """A way with two ends. of: whose coordinate runs along it; told: what leaves it, where; unit: told in how many."""

    path: Path
    of: tuple[str, str]
    told: str
    longer: str
    unit: tuple[str, float]
    about: str


def ways_of(mechanism: Mechanism) -> Iterator[OpenWay]:
    """All that have ends."""
    for joint in mechanism.joints:
        if joint.path is not None and not joint.path.period:
            told = f"the point of joint {joint.name} runs off its path, which covers travel"
            yield OpenWay(
                joint.path, (joint.name, "travel"), told, "a longer path,", ("m", 1.0), f"joints.{joint.name}"
            )
    for coupling in mechanism.couplings:
        shape = coupling.rows[0].parts[0].cam if coupling.rows else None
        if shape is not None and not shape.lift.period:
            shaft = mechanism.joints[coupling.rows[0].parts[0].coordinates[0].joint].name
            told = f"the disc of cam {coupling.name} turns off its lift, which covers {shaft}.angle"
            longer, about = "a longer lift, or one with a period,", f"couplings.{coupling.name}"
            yield OpenWay(shape.lift, (shaft, "angle"), told, longer, ("deg", math.degrees(1.0)), about)


def ways_left(mechanism: Mechanism, t: float, beyond: float, coordinates: Moving) -> list[Problem]:
    """The ways at whose ends something is at t, or by its rate just beyond them; nothing of what is not known."""
    problems = []
    for way in ways_of(mechanism):
        path, (unit, factor) = way.path, way.unit
        s, u = coordinates.get(way.of, (math.nan, 0.0))
        if math.isnan(s) or path.first <= s + beyond * u <= path.last:
            continue
        first, last = (factor * end for end in (path.first, path.last))
        message = f"at t = {t:.9g} s {way.told} from {first:.9g} to {last:.9g} {unit}"
        end = f"> {last:.6g}" if s > 0.5 * (path.first + path.last) else f"< {first:.6g}"
        until = f"{'.'.join(way.of)} {end}{'' if unit == 'm' else ' ' + unit}"
        hint = f"{way.longer} or end the run before: until: {until}"
        problems.append(Problem("path-ends", message, None, hint, way.about))
    return problems


def along_cut_paths(layout: Layout, state: Array, bodies: np.ndarray[Any, Any]) -> dict[tuple[str, str], Any]:
    """Of the joints along paths that were cut, as the state counts them: travel, speed; bodies: as recovered there."""
    found: dict[tuple[str, str], Any] = {}
    for k, at in layout.counters.items():
        joint = layout.mechanism.joints[k]
        if joint.path is None:
            continue
        seen, own = _moved(layout, bodies, joint.b, joint.q, None), _moved(layout, bodies, joint.a, joint.p, None)
        D, v = seen[0] - own[0], seen[1] - _moved(layout, bodies, joint.a, joint.p, seen[0])[1]
        if joint.a != GROUND:
            D, v = (x @ bodies["R"][layout.place[joint.a]] for x in (D, v))
        s = float(state[at])
        if math.isnan(s):  # it flies beside an end, which is nearest
            end = float(joint.path.nearest(D)) > 0.5 * (joint.path.first + joint.path.last)
            s = math.inf if end else -math.inf
        slope = joint.path.at(float(np.clip(s, joint.path.first, joint.path.last)) if math.isinf(s) else s)[1]
        u = float(slope @ v) / float(slope @ slope)
        found[joint.name, "travel"], found[joint.name, "speed"] = (s, u), (u, 0.0)
    return found


def _moved(
    layout: Layout, bodies: np.ndarray[Any, Any], body: int, point: Array, at: Array | None
) -> tuple[Array, Array]:
    """Place and velocity of a body's point, or of what of it is at a place of the world."""
    if body == GROUND:
        return (point if at is None else at), np.zeros(3)
    own = bodies[layout.place[body]]
    arm = own["R"] @ (point - layout.reference[layout.place[body]]) if at is None else at - own["r"]
    return own["r"] + arm, own["v"] + cross_rows(own["omega"], arm)
