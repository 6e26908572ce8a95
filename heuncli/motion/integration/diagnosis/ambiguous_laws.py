"""Explain where a law has no unique value: points that coincide, half turns, jamming friction, drives that contradict.

A load along the line between two points has no direction where they coincide. A spring without free length has a force
proportional to its length, so it needs no direction. If it is damped and its points separate, the damping force does.

The moment of a bushing has two values at half a turn, where the global chart of Rodrigues parameters ends, too:

    cos(theta / 2) = w,  2 wdot = -sigma . v        of the quaternion (w, v): the time left until w = 0

Drives may require of coupled joints what the couplings do not allow:

    sum of factor q' = 0    and the same of q'', for each sum of couplings' conditions whose coordinates are all driven
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.spelling import join_names
from heuncli.kernel.choose import scene as kernel
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.integration.integrated_scene import IntegratedScene
from heuncli.multibody.mechanism.couplings import Coordinate, Coupling
from heuncli.multibody.mechanism.loads import BushingLoad, JointLoad, PairLoad, ThreadLoad
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.response import Workspace
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

# Coincident points

COINCIDENCE_HINT = "in a pin or slide use type: torque; otherwise keep its points apart"


def find_undirected_loads(layout: Layout, evaluation: Evaluation, is_motion_start: bool = False) -> list[Problem]:
    """Return a problem for each load without a direction, at its first instant.

    is_motion_start: a motion starts here, so what may push later counts too
    """
    tolerance = tolerances.NO_LENGTH * layout.size
    problems = []
    for load, rows in layout.mechanism.iter_load_rows():
        if not isinstance(load, PairLoad):
            continue
        load_rows = evaluation.loads[:, rows][:, 0]
        is_coincident = load_rows["span"] <= tolerance
        if not is_coincident.any():
            continue
        if not load.needs_direction:
            separation_speed = np.sqrt(np.sum(find_separation_velocity(layout, load, evaluation) ** 2, axis=1))
            is_coincident &= (load_rows["span"] == 0.0) & (load.damping * separation_speed > 0.0)
        elif load.value is not None:
            is_coincident &= is_motion_start | (load_rows["value"] != 0.0)
        if is_coincident.any():
            problems.append(make_coincidence_problem(load.name, float(evaluation.times[int(np.argmax(is_coincident))])))
    return problems


def find_separation_velocity(layout: Layout, load: PairLoad, evaluation: Evaluation) -> Array:
    """Return the velocity of the second point relative to the first, (n_t, 3) [m/s]."""
    speeds = []
    for body, end in ((load.a, "from_at"), (load.b, "at")):
        if body < 0:
            speeds.append(np.zeros((len(evaluation.times), 3)))
            continue
        body_rows = evaluation.bodies[:, layout.place[body]]
        position = next(
            evaluation.loads[:, rows][:, 0][end] for one, rows in layout.mechanism.iter_load_rows() if one is load
        )
        speeds.append(body_rows["v"] + np.cross(body_rows["omega"], position - body_rows["r"]))
    return np.asarray(speeds[1] - speeds[0])


def make_coincidence_problem(name: str, t: float) -> Problem:
    """Make the problem of a load at an instant."""
    return Problem("no-direction", f"at t = {t:.9g} s the points of forces.{name} coincide: its force has no direction",
                   hint=COINCIDENCE_HINT)  # fmt: skip


# Turned bushings

BUSHING_HINT = "bushings allow less than half a revolution; for more use a joint, such as a pin with a turn_spring"


def find_turning_bushings(mechanism: Mechanism) -> list[tuple[BushingLoad, int]]:
    """Return the bushings that resist rotation, each with its row in the kernel's table of loads."""
    return [
        (load, rows.start + 1)
        for load, rows in mechanism.iter_load_rows()
        if isinstance(load, BushingLoad)
        and (load.turn.stiffness.any() or any(e.constant != 0.0 for e in load.turn.extra_load))
    ]


def make_bushing_problem(name: str, t: float) -> Problem:
    """Make the problem of a bushing at an instant."""
    message = (
        f"at t = {t:.9g} s forces.{name} has rotated by half a revolution: the direction of its moment is undefined"
    )
    return Problem("bushing-turned", message, hint=BUSHING_HINT, entry_path=f"forces.{name}")


def find_half_turned(mechanism: Mechanism, evaluation: Evaluation, instant: int) -> list[Problem]:
    """Return the problems of bushings that have turned so far at one of the instants, or are about to."""
    loads, t = evaluation.loads[instant], float(evaluation.times[instant])
    bushings, limit = find_turning_bushings(mechanism), np.pi - tolerances.NEARLY_TURNED_OVER
    return [make_bushing_problem(b.name, t) for b, row in bushings if loads["span"][row] >= limit]


# Half turns


def make_half_turn_error(
    integrated_scene: IntegratedScene, body: int, t: float, state: Array, *, is_unreduced: bool
) -> SolveError:
    """Make the error of a body, by its number in the tree, whose kappa grows without bound in the state at t.

    is_unreduced: the scene is integrated as drawn, without a reduced one in its place
    """
    layout = integrated_scene.layout
    row = layout.tables["bodies"][body]
    q = state[row["attitude_at"] :][:4]
    rate = -0.5 * float(np.dot(state[row["rate_at"] :][:3], q[1:]))
    w = float(q[0])
    time_left = -w / rate if abs(w) > tolerances.ZERO_COMPONENT and w * rate < 0.0 else 0.0  # else it is there already
    name = layout.mechanism.bodies[layout.spanning.links[body].body].name
    where = f"at t = {t + time_left:.9g} s: {name} reaches half a revolution from its start orientation"
    hint = "use DOP853 or DOP853-recentred, which have no such limit"
    if not is_unreduced:
        hint += "; this is the body of the reduced model, --no-reduce integrates the one specified"
    error = SolveError(
        Problem("half-turn", f"{where}, the limit of the global rotation parametrisation", None, hint, f"bodies.{name}")
    )
    error.reached = t + time_left
    return error


# Jamming

JAMMING_MESSAGES = {  # code, what was found, what to do next
    kernel.JAMS: (
        "friction-jams",
        "the joint jams (no solution): 1 N of friction causes more than 1 N of further friction",
        "use a smaller coefficient or radius, a longer guide, or a load nearer to it",
    ),
    kernel.TWO: (
        "friction-not-unique",
        "two solutions exist: 1 N of friction causes more than 1 N of further friction",
        "use a smaller coefficient or radius, a longer guide, or a load nearer to it",
    ),
    kernel.UNPROVED: (
        "friction-not-unique",
        "the solution may not be unique: 1 N of friction causes nearly 1 N of further friction, or more",
        "use smaller coefficients or radii, longer guides, or a constant friction torque or force in one of the joints",
    ),
}


def make_jamming_problem(mechanism: Mechanism, status: int, row: int, t: float) -> Problem:
    """Make the problem from the status that the kernel found for a row of its table of loads."""
    load = next(load for load, rows in mechanism.iter_load_rows() if row in range(rows.start, rows.stop))
    code, reason, hint = JAMMING_MESSAGES[status]
    if isinstance(load, ThreadLoad):
        hint = (
            "drive the spindle or add inertia to it, such as its motor's; use a smaller coefficient, or a steeper lead"
        )
        reason = reason.replace("the joint jams", "it jams")
        return Problem(code, f"at t = {t:.9g} s friction in the thread couplings.{load.name}: {reason}", hint=hint)
    assert isinstance(load, JointLoad), load
    joint = mechanism.joints[load.joint].name
    return Problem(code, f"at t = {t:.9g} s friction forces.{load.name} in joints.{joint}: {reason}", hint=hint)


def find_jammed(mechanism: Mechanism, evaluation: Evaluation, instant: int) -> list[Problem]:
    """Return the problems of such friction at one of the instants."""
    status = evaluation.loads["friction_outcome"][instant]
    friction_rows = [
        r for load, rows in mechanism.iter_load_rows() if load in mechanism.joint_friction for r in [rows.start]
    ]
    t = float(evaluation.times[instant])
    return [
        make_jamming_problem(mechanism, int(status[row]), row, t)
        for row in friction_rows
        if status[row] != kernel.FOUND
    ]


def find_jammed_after(mechanism: Mechanism, workspace: Workspace, t: float) -> list[Problem]:
    """Return the problem of such friction that was met last, after the instant that a run has reached."""
    status, row, when = workspace.friction_failure
    return [make_jamming_problem(mechanism, status, row, when)] if status != kernel.FOUND and when >= t else []


def make_indeterminate_friction_problem(
    mechanism: Mechanism, loads: Sequence[JointLoad | ThreadLoad], t: float
) -> Problem:
    """Make the problem of friction that depends on indeterminate reactions of redundant joints."""
    load_names = ", ".join(mechanism.describe_friction(load) for load in loads)
    message = f"at t = {t:.9g} s friction depends on indeterminate reactions of redundant joints: {load_names}"
    hint = "use joints with fewer constraints, as heun run proposes without that friction; or a constant friction"
    return Problem("friction-open", message, hint=hint)


# Fighting drives


def find_fighting_drives(mechanism: Mechanism, t: float, start_time: float) -> Problem | None:
    """Return the problem of drives that couplings hold against each other at an instant t [s]; start_time: the
    reported start.
    """
    relations = [
        (coupling, coordinates)
        for coupling in mechanism.couplings
        for coordinates in iter_relations(mechanism, coupling)
    ]
    keys = list(dict.fromkeys((x.joint, x.quantity) for _, coordinates in relations for x in coordinates))
    factors = np.zeros((len(relations), len(keys)))
    for row, (_, coordinates) in enumerate(relations):
        for x in coordinates:
            factors[row, keys.index((x.joint, x.quantity))] += x.ratio
    drives = [mechanism.joints[joint].drive for joint, _ in keys]
    for weights in eliminate(factors, [drive is None for drive in drives]):
        terms = weights @ factors
        acting = [(drive, term) for drive, term in zip(drives, terms, strict=True) if drive is not None and term != 0.0]
        rates = np.array([[term * rate for rate in drive.value.derivatives(t)[1:3]] for drive, term in acting])
        if len(acting) > 1 and np.any(np.abs(rates.sum(0)) > tolerances.DRIVES_DISAGREE * np.abs(rates).max(0)):
            couplings = [coupling for (coupling, _), weight in zip(relations, weights, strict=True) if weight != 0.0]
            return make_drive_problem(list(dict.fromkeys(couplings)), [drive.name for drive, _ in acting], start_time)
    return None


def eliminate(factors: Array, is_free: Sequence[bool]) -> Iterator[Array]:
    """Yield the weights of sums of rows (n, m) in which no free column is left, the shortest first."""
    sums, weights = factors.copy(), np.eye(len(factors))
    scale = tolerances.DRIVES_DISAGREE * np.abs(factors).max(initial=0.0)
    for column in np.flatnonzero(is_free):
        if not len(sums):
            return
        pivot = int(np.argmax(np.abs(sums[:, column])))
        if abs(sums[pivot, column]) <= scale:
            continue
        ratio = sums[:, column] / sums[pivot, column]
        sums, weights = sums - np.outer(ratio, sums[pivot]), weights - np.outer(ratio, weights[pivot])
        sums, weights = np.delete(sums, pivot, 0), np.delete(weights, pivot, 0)
    yield from sorted(weights, key=np.count_nonzero)


def make_drive_problem(couplings: Sequence[Coupling], drives: Sequence[str], t: float) -> Problem:
    """Make the problem, with the couplings and their drives."""
    texts = [f"{coupling.name} ({coupling.entry.type})" for coupling in couplings]
    coupling_text = f"coupling {texts[0]}" if len(texts) == 1 else f"the couplings {join_names(texts)}"
    message = f"at t = {t:.9g} s the drives {join_names(drives)} begin to violate {coupling_text}"
    hint = "leave out one of them: its joint follows the couplings"
    return Problem("rates-do-not-fit", message, hint=hint, entry_path=f"couplings.{couplings[0].name}")


def iter_relations(mechanism: Mechanism, coupling: Coupling) -> Iterator[Sequence[Coordinate]]:
    """Yield, for each condition of a coupling with fixed ratios, its coordinates with their factors."""
    if coupling.entry.type == "ratio":
        places = {joint.name: k for k, joint in enumerate(mechanism.joints)}
        yield [Coordinate(places[term.joint], term.quantity, term.factor) for term in coupling.entry.terms]
        return
    for row in coupling.rows:
        if all(part.kind in ("turn", "mesh") for part in row.parts):
            yield [x._replace(ratio=part.factor * x.ratio) for part in row.parts for x in part.coordinates]
