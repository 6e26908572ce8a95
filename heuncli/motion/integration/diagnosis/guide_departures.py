"""Find where something leaves what guides it: a rope its sheave, a point its path, a cam's disc its lift.

No rope may lift off a sheave or leave its plane too far. This is checked where loads are reported and compared,
including the ends of all steps; a slack rope is on no sheave.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.named_tuples import NamedTuple
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.couplings import Coupling, CouplingPart
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.expressions.paths import Path
from heuncli.scene.shapes.rotations import cross_rows

# Off sheaves

WOUND_UP = "winds up: a strand has no length left between a sheave and the next point"
WOUND_UP_HINT = "end the run before it is wound up, or start further from the sheave"
WOUND_ROUND = "lies on a sheave over more than 315 deg: heun counts an arc up to that"
WOUND_ROUND_HINT = "end the run before, or use slip: none with a pin that winds the rope (a drum)"
GONE_AROUND = "is slack, and its end goes round behind a sheave: heun does not know how it lies on it then"
GONE_AROUND_HINT = "end the run before"
NO_INDICES: Indices = np.zeros(0, dtype=np.intp)
HINT = "mount the sheave on a bearing that swivels with the rope, or use a plain point instead"


def require_on_sheaves(layout: Layout, evaluation: Evaluation, *, has_all_steps: bool = False) -> None:
    """Raise SolveError at the first instant at which a rope has left a sheave or its plane, or lies all around one.

    has_all_steps: whether the ends of all steps are there; then a rope that becomes slack where its arc is counted anew
    is found, too
    """
    problems: list[tuple[float, Problem]] = []
    for coupling, part, k, is_taut in iter_rope_parts(layout, evaluation):
        if part.kind == "arc":
            angle = evaluation.parts["gap"][:, k] / abs(part.radius)
            violations = np.flatnonzero(is_taut & (angle < -tolerances.OFF_SHEAVE))
            message, hint = (
                "lifts off a sheave",
                "end the run earlier; a rope that touches a sheave only at times cannot be modelled",
            )
            recounted = find_recounted(evaluation.times, angle) if has_all_steps else NO_INDICES
            violations = np.union1d(violations, recounted)
            if len(violations) and is_counted_round(float(angle[violations[0]])):
                message, hint = WOUND_ROUND, WOUND_ROUND_HINT
            elif len(violations) and violations[0] in recounted:
                message, hint = GONE_AROUND, GONE_AROUND_HINT
        elif part.kind == "strand":
            violations = np.flatnonzero(
                is_taut & (np.abs(find_slant_angle(layout, evaluation, part, k)) > tolerances.FLEET_ANGLE)
            )
            message, hint = f"leaves a sheave's plane by more than {FLEET}", HINT
            wound_up = np.flatnonzero(is_taut & (evaluation.parts["gap"][:, k] <= 0.0))
            if len(wound_up) and not (len(violations) and violations[0] <= wound_up[0]):
                violations, message, hint = wound_up, WOUND_UP, WOUND_UP_HINT
            skewed_instants = np.flatnonzero(is_taut & is_skewed(layout, evaluation, part))
            if len(skewed_instants) and not (len(violations) and violations[0] <= skewed_instants[0]):
                violations, message = skewed_instants, "runs between two sheaves whose axes are no longer parallel"
        else:
            continue
        if len(violations):
            t = float(evaluation.times[violations[0]])
            path = f"couplings.{coupling.name}"
            problems.append((t, Problem("rope-off-sheave", f"at t = {t:.9g} s {path} {message}", None, hint, path)))
    if problems:
        raise SolveError(min(problems, key=lambda one: one[0])[1])


def is_counted_round(angle: float) -> bool:
    """Return whether an arc of less than 0 is one of more than 315 degrees, which the kernel counts from -45 on."""
    return angle < -tolerances.COUNTED_ROUND


def find_recounted(times: Array, angle: Array) -> Indices:
    """Return the instants at which an arc is counted anew: as none where it was all around the sheave, or the reverse.

    A taut rope that stretches is slack from there on, for it seems shorter by the sheave's circumference.
    """
    order = np.argsort(times, kind="stable")
    return np.asarray(order[1:][np.abs(np.diff(angle[order])) > tolerances.RECOUNTED], dtype=np.intp)


FLEET = f"{math.degrees(tolerances.FLEET_ANGLE):.0f} deg"


def format_slant_warnings(layout: Layout, evaluation: Evaluation) -> list[str]:
    """Format a sentence on each rope that leaves a sheave's plane so far that its forces become visibly inexact."""
    largest_angles: dict[str, float] = {}
    for coupling, part, k, is_taut in iter_rope_parts(layout, evaluation):
        if part.kind == "strand":
            angles = np.where(is_taut, np.abs(find_slant_angle(layout, evaluation, part, k)), 0.0)
            largest_angles[coupling.name] = max(largest_angles.get(coupling.name, 0.0), float(angles.max(initial=0.0)))
    return [
        f"couplings.{name} leaves a sheave's plane by up to {math.degrees(angle):.2g} deg: relative error of "
        f"its forces {1.0 - math.cos(angle):.1g}"
        for name, angle in largest_angles.items()
        if angle > tolerances.FLEET_SEEN
    ]


def iter_rope_parts(layout: Layout, evaluation: Evaluation) -> Iterator[tuple[Coupling, CouplingPart, int, Mask]]:
    """Yield for each part of a rope: the coupling, the part, its number in the kernel, and at which instants it is
    taut.
    """
    mechanism = layout.mechanism
    for owner, coupling in enumerate(mechanism.couplings, len(mechanism.joints)):
        if coupling.entry.type != "rope":
            continue
        if coupling.stretched_row is not None:
            load = mechanism.rope_load_row(coupling.name)
            is_taut = evaluation.loads["value"][:, load] < 0.0
            for k, part in enumerate(coupling.stretched_row.parts, int(layout.tables["loads"][load]["part"])):
                yield coupling, part, k, is_taut
        rows = [r for r, k in enumerate(layout.rows) if k == owner]
        for r, row in zip(rows, coupling.rows, strict=True):
            first = int(layout.tables["closures"][r]["part"])
            is_taut = evaluation.rows["closed"][:, r] != 0.0
            for k, part in enumerate(row.parts, first):
                yield coupling, part, k, is_taut


def find_wound_up(layout: Layout, evaluation: Evaluation) -> list[Problem]:
    """Return the problems of ropes with a strand that all but ends at its sheave, in the one state where a run failed.

    Towards that the strand turns without bound, so that steps collapse a little before.
    """
    problems: dict[str, Problem] = {}
    for coupling, part, k, _ in iter_rope_parts(layout, evaluation):
        limit = tolerances.WOUND_UP * max(abs(part.g[0]), abs(part.g[1]))
        if part.kind == "strand" and evaluation.parts["gap"][0, k] <= limit:
            path = f"couplings.{coupling.name}"
            message = f"at t = {float(evaluation.times[0]):.9g} s {path} {WOUND_UP}"
            problems[path] = Problem("rope-off-sheave", message, None, WOUND_UP_HINT, path)
    return list(problems.values())


def is_skewed(layout: Layout, evaluation: Evaluation, part: CouplingPart) -> Mask:
    """Return whether the axes of a strand's two sheaves are no longer parallel, (n_t,)."""
    if not part.g[1]:
        return np.zeros(len(evaluation.times), dtype=bool)
    a, b = (
        world_direction(layout, evaluation, body, axis) for body, axis in ((part.a, part.e), (part.b, part.other_axis))
    )
    return np.asarray(np.sum((a - b) ** 2, axis=1) > tolerances.ASKEW**2)


def world_direction(layout: Layout, evaluation: Evaluation, body: int, axis: object) -> Array:
    """Return a direction fixed in a body or the ground in world axes, (n_t, 3)."""
    e = np.asarray(axis)
    return np.tile(e, (len(evaluation.times), 1)) if body < 0 else evaluation.bodies["R"][:, layout.place[body]] @ e


def find_slant_angle(layout: Layout, evaluation: Evaluation, part: CouplingPart, k: int) -> Array:
    """Return the angle between a strand and the plane of the sheave it is measured from [rad], (n_t,)."""
    n = world_direction(layout, evaluation, part.a, part.e)
    strand = evaluation.parts["on_b"][:, k] - evaluation.parts["on_a"][:, k]
    length = np.sqrt(np.sum(strand * strand, axis=1))
    return np.asarray(np.arcsin(np.clip(np.sum(strand * n, axis=1) / np.where(length > 0.0, length, 1.0), -1.0, 1.0)))


# Path ends

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
