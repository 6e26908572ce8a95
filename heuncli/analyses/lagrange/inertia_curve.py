"""`--over`: inertia and forces over a range of the one free coordinate, without integration.
    e(q) = sum m x'^2 + w' . I w'      de/dq / 2 = sum m x' . x'' + ...: C at unit rate      k_i = sum F . x'_P
The drives are removed, the coordinate is followed from its start value at unit rate (x' = dx/dq), and every instant is
solved separately. Loads are those at the start's time, and at the rate that the coordinate has there.
"""

from __future__ import annotations

import numpy as np

from heuncli.analyses.lagrange.coordinate_rates import compute_accelerations, compute_length, compute_rates
from heuncli.analyses.lagrange.equations import get_velocity_motion
from heuncli.analyses.lagrange.freed_scene import FreedScene, free_drives, get_start_time, make_start_state
from heuncli.analyses.lagrange.results import InertiaCurve
from heuncli.base.errors import LimitError, Problem, SolveError
from heuncli.base.joint_kinds import RATES
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.actions import Action, collect_applied_loads
from heuncli.loads.kinetostatics.bodies import BodyStates, make_body_states
from heuncli.loads.kinetostatics.coordinates import evaluate_joint_coordinates
from heuncli.loads.kinetostatics.couplings import find_coupling_loads, list_rope_actions
from heuncli.loads.kinetostatics.foundation import find_inertia_loads
from heuncli.loads.kinetostatics.shares import GRAVITY
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.integration.integrated_scene import find_determined_motion
from heuncli.motion.integration.methods.method import DRIVE_DETERMINED
from heuncli.motion.integration.run.request import MotionTask
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.tree.layout import Layout, find_speed_rows, rate_indices
from heuncli.results.results import Array
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.scope import Scope
from heuncli.scene.file_format.models import Analysis, Drive, Spec
from heuncli.study.model.setup import Setup, attach_locations, set_up

MEAN_TOLERANCE = 1e-7  # of the mean of e: permitted change with half as many values, below the six digits shown
MIN_VALUES, MAX_VALUES = 17, 4097  # least and largest number of values for the mean
DRIVE_NAME = "over"  # of the drive that moves the coordinate along the range


@record
class CoordinateRange:
    """A coordinate, joint.quantity, and the values (n,) over which it is followed."""

    name: str
    joint: str
    quantity: str
    values: Array


def make_refusal(coordinate_range: CoordinateRange, message: str, hint: str) -> SolveError:
    """Return the error for a range that cannot be followed."""
    return SolveError(Problem("no-course", f"{coordinate_range.name}: {message}", hint=hint))


def find_inertia_curve(spec: Spec, coordinate_range: CoordinateRange) -> InertiaCurve:
    """Return inertia and forces over a range. Raises SolveError [no-course] if more motions are free, or the path
    ends.
    """
    with attach_locations(spec):
        curve = finer = compute_curve(spec, coordinate_range)
        mean, error = compute_mean(curve)
        while error > MEAN_TOLERANCE * abs(mean) and 2 * len(finer.values) <= MAX_VALUES:
            count = max(2 * len(finer.values) - 1, MIN_VALUES)
            values = np.linspace(coordinate_range.values[0], coordinate_range.values[-1], count)
            finer = compute_curve(spec, replace(coordinate_range, values=values))
            mean, error = compute_mean(finer)
        return replace(curve, mean=mean if error <= MEAN_TOLERANCE * abs(mean) else np.nan)


def compute_mean(curve: InertiaCurve) -> tuple[float, float]:
    """Return the mean of e over the range, and its difference from that of every other value.

    By the Euler-Maclaurin sum:
        integral = sum h (e_i + e_i+1)/2 + h^2 (e'_i - e'_i+1)/12
    Over a whole turn the slopes cancel, and the trapezoidal rule is as accurate as e is smooth.
    """
    e, slope, length = curve.epsilon, 2.0 * curve.half, float(curve.values[-1] - curve.values[0])

    def compute_mean_with_stride(stride: int) -> float:
        """Return the mean by the trapezoidal rule with end correction, over every `stride`-th value."""
        f = e[::stride]
        h = length / (len(f) - 1)
        ends = h * (slope[0] - slope[-1]) / 12.0
        return float((0.5 * (f[0] + f[-1]) + f[1:-1].sum() + ends) / (len(f) - 1))

    if len(e) < MIN_VALUES or len(e) % 2 == 0:
        return compute_mean_with_stride(1), np.inf
    mean = compute_mean_with_stride(1)
    return mean, abs(mean - compute_mean_with_stride(2))


def compute_curve(spec: Spec, coordinate_range: CoordinateRange) -> InertiaCurve:
    """Return inertia and forces at the requested values."""
    start, rate = find_start(spec, coordinate_range)
    t = get_start_time(spec)
    values = np.sort(coordinate_range.values)
    # each branch leads away from the start
    branches = [values[values < start][::-1], values[values >= start]]
    curves = [
        compute_branch(follow_branch(spec, coordinate_range, start, branch), t, rate)
        for branch in branches
        if len(branch)
    ]
    curves = [
        curve.reversed_curve if len(curve.values) > 1 and curve.values[0] > curve.values[-1] else curve
        for curve in curves
    ]
    curve = join_branches(curves)
    curve = curve if coordinate_range.values[0] < coordinate_range.values[-1] else curve.reversed_curve
    is_driven = any(
        drive.joint == coordinate_range.joint and drive.quantity == coordinate_range.quantity
        for drive in spec.drives.values()
    )
    return replace(curve, title=spec.title, name=coordinate_range.name, is_driven=is_driven)


def find_start(spec: Spec, coordinate_range: CoordinateRange) -> tuple[float, float]:
    """Return the value of the coordinate at the start, and its rate."""
    t = get_start_time(spec)
    setup = set_up(make_start_state(spec), reduce=False)
    layout = setup.scene.layout
    recovered = setup.runner.evaluate(np.array([t]), layout.y0[None, :])
    states = make_body_states(layout, recovered)
    rate = float(compute_rates(layout, [f"{coordinate_range.joint}.{coordinate_range.quantity}"], states)[0, 0])
    if coordinate_range.quantity == "length":
        return compute_length(layout, states, coordinate_range.joint), rate
    coordinates = evaluate_joint_coordinates(layout, recovered, states)[coordinate_range.joint]
    return float(coordinates[coordinate_range.quantity][0]), rate


class FollowedBranch(NamedTuple):
    """A branch of a range that was followed from the start: its values (n,), and the solutions there.

    scene: the scene without drives
    span: rate of the coordinate while it was followed, per second
    """

    values: Array
    scene: FreedScene
    solutions: Evaluation
    span: float


def follow_branch(spec: Spec, coordinate_range: CoordinateRange, start: float, values: Array) -> FollowedBranch:
    """Follow the coordinate from its start along the values of a branch.

    Raises SolveError [no-course] if more than the coordinate is free, or if contacts may open and close.
    """
    span = float(values[-1]) - start or 1.0
    law = compile_expression(f"{start!r} + {span!r}*t", Scope(in_time=True))
    drive = Drive(DRIVE_NAME, coordinate_range.joint, coordinate_range.quantity, law)  # type: ignore[arg-type]
    joints = dict(spec.joints)
    if coordinate_range.quantity in RATES:
        joints[coordinate_range.joint] = replace(
            joints[coordinate_range.joint], **{RATES[coordinate_range.quantity]: None}
        )
    times = np.maximum((values - start) / span, 0.0)
    analysis = Analysis("motion", tuple(times.tolist()), 1.0, spec.analysis.tolerance, "auto", None)
    driven_spec = spec._replace(drives={DRIVE_NAME: drive}, joints=joints, impulses={}, analysis=analysis)
    setup = set_up(driven_spec, reduce=False)
    require_determined(setup, coordinate_range)
    try:
        run = setup.runner.run(MotionTask(times, spec.analysis.tolerance, DRIVE_DETERMINED))
    except LimitError as error:
        if error.problems[0].code != "step-limit":
            raise
        raise make_refusal(coordinate_range, "following it this far takes too many steps", "a shorter range") from None
    except SolveError as error:
        ends = "" if error.reached is None else f" past {start + span * error.reached:.6g}"
        reason = error.problems[0].message
        message = f"it cannot be followed{ends}: {reason.partition(' s: ')[2] or reason}"
        raise make_refusal(
            coordinate_range, message, "a shorter range, or a coordinate that makes full revolutions"
        ) from None
    return FollowedBranch(values, free_drives(setup.scene), setup.runner.evaluate_run(run, times), span)


def require_determined(setup: Setup, coordinate_range: CoordinateRange) -> None:
    """Raise SolveError [no-course] if the driven coordinate does not determine the motion and the loads."""
    layout = setup.scene.layout
    for load in layout.mechanism.joint_friction:
        joint_path = layout.mechanism.describe_friction(load)
        message = f"friction depends on the joint reaction, {joint_path}: available at one instant, not over a range"
        raise make_refusal(coordinate_range, message, "leave it out, or use one instant")
    if find_speed_rows(layout).any() and not layout.mechanism.planar:
        message = "positions of rolling bodies depend on the path: no coordinate determines them"
        raise make_refusal(
            coordinate_range, message, "heun run computes the motion; in a planar model wheels roll along lines"
        )
    if layout.contacts:
        message = f"{layout.contacts[0].name} may open and close within the range"
        raise make_refusal(coordinate_range, message, "leave stops and ropes out")
    if not find_determined_motion(setup.runner.integrated_scene).is_determined:
        message = f"with {coordinate_range.name} fixed something is still free: a range needs 1 degree of freedom"
        raise make_refusal(
            coordinate_range, message, "heun lagrange SPEC gives all of them at one instant; --at T at a later one"
        )


def compute_branch(branch: FollowedBranch, t: float, rate: float) -> InertiaCurve:
    """Return inertia and forces along a branch, with loads of time t at a rate of the coordinate."""
    scene, layout = branch.scene, branch.scene.layout
    rate_places = rate_indices(layout)
    rate_places = rate_places[rate_places >= 0]
    unit_rate_states, states_at_rate = (scene.convert_states(branch.solutions) for _ in range(2))
    unit_rate_states[:, rate_places] /= branch.span
    states_at_rate[:, rate_places] *= rate / branch.span
    times = np.full(len(branch.values), t)
    unit_recovered = scene.runner.evaluate(times, unit_rate_states, causes=True, holding=layout.open_contacts)
    load_recovered = scene.runner.evaluate(times, states_at_rate, holding=layout.open_contacts)
    unit_states = make_body_states(layout, unit_recovered)
    epsilon, half = compute_inertia(scene, unit_recovered, unit_states)
    forces, force_scale = compute_forces(layout, unit_states, load_recovered)
    return InertiaCurve("", "", False, 0.0, branch.values, rate, epsilon, half, forces, force_scale)


def compute_inertia(scene: FreedScene, unit_recovered: Evaluation, states: BodyStates) -> tuple[Array, Array]:
    """Return e and de/dq / 2, (n,) each, from solutions at unit rate of the coordinate and their body states."""
    layout = scene.layout
    masses = np.array([body.mass for body in layout.mechanism.bodies])
    angular_momentum = np.einsum("tnij,tnj->tni", states.R, compute_body_spins(layout, states))
    epsilon = np.sum(masses * np.sum(states.v_centre**2, axis=2), axis=1) + np.sum(
        states.omega * angular_momentum, axis=(1, 2)
    )
    velocity_motion = get_velocity_motion(layout, unit_recovered)
    force, moment = find_inertia_loads(layout.mechanism, velocity_motion)
    power = np.sum(force * states.v_centre + moment * states.omega, axis=(1, 2))
    (coordinate,) = scene.driven_coordinates
    # without loads the coordinate may accelerate: that part is no change of e
    return epsilon, power - epsilon * compute_accelerations(layout, [coordinate], velocity_motion)[:, 0]


def compute_forces(layout: Layout, states: BodyStates, load_recovered: Evaluation) -> tuple[dict[str, Array], float]:
    """Return k (n,) by cause, and the size of its terms.

    states: of the bodies at unit rate of the coordinate
    load_recovered: solutions at the rate at which the loads act
    """
    masses, gravity = np.array([body.mass for body in layout.mechanism.bodies]), layout.mechanism.gravity
    speeds = np.sqrt(np.sum(states.v_centre**2, axis=2)), np.sqrt(np.sum(states.omega**2, axis=2))
    forces = {GRAVITY: states.v_centre @ gravity @ masses} if gravity.any() else {}
    force_scale = float((speeds[0] @ masses).max()) * float(np.sqrt(gravity @ gravity))
    load_states = make_body_states(layout, load_recovered)
    named_actions = [
        (load.load.name, load.action) for load in collect_applied_loads(layout.mechanism, load_states, load_recovered)
    ]
    ropes = list_rope_actions(find_coupling_loads(layout, load_recovered, load_states))
    for name, action in [*named_actions, *((action.name, action) for action in ropes)]:
        forces[name] = forces.get(name, 0.0) + compute_power(states, action)
        force_scale = max(force_scale, bound_power(speeds, action))
    return forces, force_scale


def bound_power(speeds: tuple[Array, Array], action: Action) -> float:
    """Return the largest possible power of an action at the speeds and angular speeds of the bodies, (n_t, n) each."""
    bound = 0.0
    for end, force, moment in action.iter_ends():
        if end.body != GROUND:
            sizes = (np.sqrt(np.sum(load**2, axis=-1)) for load in (force, moment))
            bound += sum(float((size * speed[:, end.body]).max()) for size, speed in zip(sizes, speeds, strict=True))
    return bound


def compute_body_spins(layout: Layout, states: BodyStates) -> Array:
    """Return I w of every body, (n_t, n, 3), body axes."""
    inertia = np.array([body.inertia for body in layout.mechanism.bodies])
    return np.asarray(np.einsum("nij,tnkj,tnk->tni", inertia, states.R, states.omega))


def compute_power(states: BodyStates, action: Action) -> Array:
    """Return the power of an action at the velocities of states, (n_t,)."""
    total = np.zeros(len(states.x))
    for end, force, moment in action.iter_ends():
        if end.body != GROUND:
            total = total + np.sum(force * states.point_velocity(end.body, end.position), axis=1)
            total = total + np.sum(moment * states.omega[:, end.body], axis=1)
    return total


def join_branches(parts: list[InertiaCurve]) -> InertiaCurve:
    """Join the branches one after the other."""
    if len(parts) == 1:
        return parts[0]
    first, second = parts
    return replace(
        first,
        values=np.concatenate([first.values, second.values]),
        epsilon=np.concatenate([first.epsilon, second.epsilon]),
        half=np.concatenate([first.half, second.half]),
        forces={name: np.concatenate([k, second.forces[name]]) for name, k in first.forces.items()},
        force_scale=max(first.force_scale, second.force_scale),
    )
