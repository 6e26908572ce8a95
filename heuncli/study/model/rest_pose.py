"""Solve `analysis: {type: rest}`: the scene at rest becomes the start of a state, with sentences on its equilibrium."""

from __future__ import annotations

import time

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record, replace
from heuncli.base.spelling import MAX_NAMES, format_count, list_some
from heuncli.loads.equilibrium.pose import Pose, make_bearing_pose, make_no_rest_problem
from heuncli.loads.equilibrium.rest_law import separate_indifferent
from heuncli.loads.equilibrium.search import RestSearch
from heuncli.loads.equilibrium.steady_states import (
    NamedMotion,
    Stability,
    find_moving_drives,
    find_stability,
    require_common_motion,
    require_constant,
    require_steady,
)
from heuncli.loads.equilibrium.verification import (
    VerifiedPose,
    find_indistinguishable_states,
    find_verified_pose,
    perturb_states,
    require_at_rest,
)
from heuncli.loads.kinetostatics.bodies import make_body_states
from heuncli.loads.kinetostatics.coordinates import evaluate_joint_coordinates
from heuncli.motion.integration.diagnosis.solvability import ErrorWording, require_solvable
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.linearisation.displacements import find_displacement
from heuncli.motion.linearisation.indifference import find_indifference
from heuncli.motion.linearisation.smoothness import examine_laws, find_roots
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.layout import Layout, find_speed_rows, rate_indices
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array, Status

UNITS = {"angle": "rad", "travel": "m"}
MIN_DIFFERENCE = 1e-3  # rad, or parts of the size: smaller differences are not shown


def describe_other_pose(layout: Layout, here: Pose, there: Pose) -> str:
    """Describe the differences of the pose `there` from `here`, the largest first."""
    own_coordinates, other_coordinates = (
        evaluate_joint_coordinates(layout, pose.evaluation, make_body_states(layout, pose.evaluation))
        for pose in (here, there)
    )
    differences: list[tuple[float, str]] = []
    for joint, values in other_coordinates.items():
        for name, unit in UNITS.items():
            if name in values:
                value = float(values[name][0])
                difference = abs(value - float(own_coordinates[joint][name][0])) / (layout.size if unit == "m" else 1.0)
                differences.append((difference, f"{joint}.{name} = {value:.6g} {unit}"))
    centres, other_centres = (make_body_states(layout, pose.evaluation).centre[0] for pose in (here, there))
    bodies = [body.name for body in layout.mechanism.bodies]
    if max((difference for difference, _ in differences), default=0.0) <= MIN_DIFFERENCE:
        for name, c, d in zip(bodies, centres, other_centres, strict=True):
            x, y, z = d
            differences.append((float(np.abs(d - c).max()) / layout.size, f"{name} at ({x:.6g}, {y:.6g}, {z:.6g}) m"))
    return list_some(
        [text for difference, text in sorted(differences, key=lambda each: -each[0]) if difference > MIN_DIFFERENCE]
    )


@record
class Rest:
    """How a rest pose was found.

    nearby_states: states that rounding does not distinguish from it
    sentences: how the scene rests
    """

    steps: int
    evaluations: int
    seconds: float
    nearby_states: tuple[Array, ...]
    sentences: tuple[str, ...]
    warnings: tuple[str, ...]

    @property
    def status(self) -> Status:
        """How the search ended."""
        return {"code": "completed", "message": f"at rest after {format_count(self.steps, 'step')} from the start"}


class SceneAtRest(NamedTuple):
    """A scene whose start is its rest pose, its runner, and how the pose was found."""

    scene: PreparedScene
    runner: Runner
    rest: Rest


def start_at_rest(scene: PreparedScene, runner: Runner, *, with_time: bool = False) -> SceneAtRest:
    """Find the rest pose and make it the start of the scene. Raises SolveError [no-rest-pose].

    with_time: whether loads may depend on time; they are those at t = 0
    """
    start_time = time.perf_counter()
    if not with_time:
        require_constant(scene.mechanism)
    first = runner.evaluate(np.zeros(1), runner.layout.y0[None, :])
    require_solvable(scene, first, ErrorWording("accelerations at the start"))
    search = RestSearch(scene, runner, 0.0, tolerances.REST_BENT)
    require_common_motion(runner, search.coordinates, search.start_pose())
    search_result = find_verified_pose(scene, runner, 0.0)
    found = search_result.equilibrium
    if find_speed_rows(runner.layout).any():
        require_no_rolling(runner.layout, found.pose.state)
    if runner.layout.friction_contacts:
        require_no_slip(runner, found.pose.state)
    require_steady(runner, found.coordinates, found.pose, found.law)
    equations = found.law.equations
    indifferent_directions = find_indifference(scene, 0.0, found.pose.holding, equations)
    found = replace(found, law=separate_indifferent(found.law, indifferent_directions))
    states, curvatures = find_indistinguishable_states(runner, found, indifferent_directions)
    found_stability = find_stability(
        scene, found.coordinates, equations, found.pose.evaluation, indifferent_directions, curvatures
    )
    layout = replace(scene.layout, y0=found.pose.state)
    without_slope = list(find_roots(examine_laws(layout, 0.0, layout.y0)))
    warnings = (
        warn_ridge(layout, search_result)
        if without_slope
        else (*warn_unstable(found_stability), *warn_ridge(layout, search_result))
    )
    rest_runner = Runner(layout)
    require_at_rest(rest_runner, found.coordinates, make_bearing_pose(rest_runner, found.coordinates, 0.0, layout.y0))
    rest = Rest(
        steps=search_result.steps, evaluations=search_result.evaluations, seconds=time.perf_counter() - start_time,
        nearby_states=(*states, *perturb_states(runner, found, search_result.displacement)),
        sentences=tuple(describe_rest(scene.mechanism, found_stability, without_slope)), warnings=tuple(warnings),
    )  # fmt: skip
    return SceneAtRest(replace(scene, layout=layout), rest_runner, rest)


def require_no_slip(runner: Runner, state: Array) -> None:
    """Raise SolveError where friction that sticks does not hold at the start: motion then decides where it rests."""
    from heuncli.motion.integration.contacts.sticking import read_places  # few scenes have such friction

    layout = runner.layout
    moved = np.abs(read_places(runner, 0.0, state) - read_places(runner, 0.0, layout.y0))
    weights = layout.tables["closures"]["weight"][[layout.contacts[i].row for i in layout.friction_contacts]]
    moved *= weights / layout.size  # an angle, or a way relative to the size
    slipping = [
        layout.contacts[i].name
        for i, displacement in zip(layout.friction_contacts, moved, strict=True)
        if displacement > tolerances.AT_LIMIT
    ]
    if slipping:
        message = f"{list_some(slipping)} does not hold the start position"
        hint = "where it comes to rest depends on the motion: give analysis a duration; or more static friction"
        raise SolveError(make_no_rest_problem(message, hint))


def require_no_rolling(layout: Layout, state: Array) -> None:
    """Raise SolveError [no-rest-pose] where wheels would have to roll to a rest pose, which then depends on their
    path.
    """
    rate_places = rate_indices(layout)
    travel = layout.weights[rate_places[rate_places >= 0]] * find_displacement(layout, layout.y0, state)
    if np.abs(travel).max(initial=0.0) <= tolerances.OFF_BALANCE:
        return
    message = "no rest position: the start is not at rest, and where wheels roll to depends on their path"
    hint = "run a motion with dampers: analysis: {duration: ...}; or start at the rest position"
    raise SolveError(Problem("no-rest-pose", message, hint=hint))


def describe_rest(mechanism: Mechanism, stability: Stability, without_slope: list[str]) -> list[str]:
    """Describe in sentences how the scene rests: in which frame, stable or not, and along which motions it is
    indifferent.

    without_slope: sentences on loads that have no slope in the pose; then no stiffness decides its stability
    """
    drives = list_some(list(find_moving_drives(mechanism)))
    texts = [f"at rest in the frame that moves with {drives}"] if drives else []
    if without_slope:
        return [*texts, f"stability not decided: {'; '.join(without_slope)}"]
    least = f"smallest eigenvalue stiffness/inertia {stability.least:.4g} 1/s² ({stability.slowest})"
    indifferent_motions = stability.indifferent + stability.flat + stability.edge
    if stability.growth > 0.0:
        texts.append(f"unstable: {stability.grows} departs as exp({stability.growth:.4g} t); {least}")
    elif stability.slowest:
        swings = f", lowest natural frequency {stability.frequency:.4g} Hz" if stability.frequency else ""
        texts.append(f"stable{' except where indifferent' if indifferent_motions else ''}: {least}{swings}")
    elif not indifferent_motions:
        texts.append("0 degrees of freedom")
    if stability.indifferent:
        what = f"{list_motions(stability.indifferent)}, without restoring force{describe_lone_motion(stability)}"
        texts.append(f"indifferent: {what}; the position along it depends on the path")
    if stability.edge:
        texts.append(
            f"at the limit of stability: {list_motions(stability.edge)}, which if displaced starts "
            "a motion without restoring force"
        )
    if stability.flat:
        texts.append(
            f"indifferent to first order: {list_motions(stability.flat)}, stability decided by higher-order terms"
        )
    return texts


def list_motions(motions: tuple[NamedMotion, ...]) -> str:
    """List motions by what moves in them: one coordinate alone, or several in proportion."""
    return list_some(list(dict.fromkeys(describe_motion(motion) for motion in motions)))


def describe_motion(motion: NamedMotion) -> str:
    """Describe a motion: what moves, and by how much relative to the first."""
    if len(motion.names) == 1:
        return motion.names[0]
    units = motion.units if len(set(motion.units)) > 1 else ("",) * len(motion.units)
    shares = [f"{share:.3g} {unit}".strip() for share, unit in zip(motion.shares, units, strict=True)]
    more = len(motion.names) - MAX_NAMES
    names = " and ".join(motion.names[:MAX_NAMES]) + (f" and {more} more" if more > 0 else "")
    return f"{names} moved together as {' : '.join(shares[:MAX_NAMES])}"


def describe_lone_motion(stability: Stability) -> str:
    """Say that the slowest coordinate also moves in an indifferent motion, but is held or pushed off when it moves
    alone.
    """
    joint_names = {name for motion in stability.indifferent if len(motion.names) > 1 for name in motion.names}
    if stability.slowest not in joint_names:
        return ""
    return f" ({stability.slowest} alone is {'restored' if stability.least > 0.0 else 'repelled'})"


def warn_unstable(stability: Stability) -> tuple[str, ...]:
    """Warn that the smallest disturbance ends the pose."""
    if not stability.growth:
        return ()
    return (f"the rest position is unstable: if disturbed, {stability.grows} departs as exp({stability.growth:.4g} t)",)


def warn_ridge(layout: Layout, search_result: VerifiedPose) -> tuple[str, ...]:
    """Warn that the relaxation path may also end in another pose, and describe that one."""
    if search_result.alternative is None:
        return ()
    warning = (
        "the damped motion to the rest position passes so close to a ridge that its last digits decide where it ends"
    )
    return (
        f"{warning}: possibly with "
        f"{describe_other_pose(layout, search_result.equilibrium.pose, search_result.alternative.pose)}",
    )
