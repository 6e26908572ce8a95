"""`--over`: inertia and forces over a range of the one coordinate that is free, without integrating.

    e(q) = sum m x'^2 + w' . I w'      de/dq / 2 = sum m x' . x'' + ...: C at unit rate      k_i = sum F . x'_P
The drives are let go, the coordinate is followed from where it stands at unit rate (x' = dx/dq), and every instant is
answered by itself. Loads are those at the start's instant, and at the rate that the coordinate has there.
"""

from __future__ import annotations

import numpy as np

from heuncli.analyses.lagrange.coordinates import accelerations, length_of, rates
from heuncli.analyses.lagrange.equations import motion_alone
from heuncli.analyses.lagrange.freed import FreedScene, freed
from heuncli.analyses.lagrange.results import InertiaCourse
from heuncli.base.errors import LimitError, Problem, SolveError
from heuncli.base.joint_kinds import RATES
from heuncli.base.records import record, replace
from heuncli.loads.kinetostatics.actions import Action, applied_loads
from heuncli.loads.kinetostatics.bodies import BodyStates, body_states
from heuncli.loads.kinetostatics.coordinates import coordinates
from heuncli.loads.kinetostatics.couplings import coupling_loads, rope_actions
from heuncli.loads.kinetostatics.foundation import inertia_loads
from heuncli.loads.kinetostatics.shares import GRAVITY
from heuncli.motion.integration.determined_motion import determined
from heuncli.motion.integration.evaluator import Recovered
from heuncli.motion.integration.methods.followed import FOLLOWED
from heuncli.motion.integration.run.request import MotionTask
from heuncli.multibody.mechanism.model import GROUND
from heuncli.multibody.tree.held_speeds import holds_speed
from heuncli.multibody.tree.layout import Layout, places_of_rates
from heuncli.results.results import Array
from heuncli.scene.expressions.grammar import Scope, compile_expression
from heuncli.scene.file_format.models import Analysis, Drive, Spec
from heuncli.study.model.error_places import placed
from heuncli.study.model.setup import set_up

MEAN = 1e-7  # of the mean of e: what half as many values may change, below the six digits that are told
FEW, MANY = 17, 4097  # values, at least and at most, by which the mean is taken


@record
class Range:
    """A coordinate, joint.quantity, and the values (n,) over which it is followed."""

    name: str
    joint: str
    quantity: str
    values: Array


def refused(asked: Range, message: str, hint: str) -> SolveError:
    """The error of a range that cannot be followed."""
    return SolveError(Problem("no-course", f"{asked.name}: {message}", hint=hint))


def over(spec: Spec, asked: Range) -> InertiaCourse:
    """The course of the inertia and of the forces. Raises SolveError where more is free, or the way ends."""
    with placed(spec):
        found = finer = course(spec, asked)
        mean, off = mean_of(found)
        while off > MEAN * abs(mean) and 2 * len(finer.values) <= MANY:
            count = max(2 * len(finer.values) - 1, FEW)
            finer = course(spec, replace(asked, values=np.linspace(asked.values[0], asked.values[-1], count)))
            mean, off = mean_of(finer)
        return replace(found, mean=mean if off <= MEAN * abs(mean) else np.nan)


def mean_of(found: InertiaCourse) -> tuple[float, float]:
    """The mean of e over the range, and what it is off from that by every other value: Euler and Maclaurin's sum.

        integral = sum h (e_i + e_i+1)/2 + h^2 (e'_i - e'_i+1)/12
    Of a whole turn the slopes cancel, and its trapezoids are as good as e is smooth.
    """
    e, slope, length = found.epsilon, 2.0 * found.half, float(found.values[-1] - found.values[0])

    def by(every: int) -> float:
        f = e[::every]
        h = length / (len(f) - 1)
        ends = h * (slope[0] - slope[-1]) / 12.0
        return float((0.5 * (f[0] + f[-1]) + f[1:-1].sum() + ends) / (len(f) - 1))

    if len(e) < FEW or len(e) % 2 == 0:
        return by(1), np.inf
    return by(1), abs(by(1) - by(2))


def course(spec: Spec, asked: Range) -> InertiaCourse:
    """The course at the values asked for."""
    start, rate = begun(spec, asked)
    t = float(spec.analysis.times[0]) if spec.analysis.type == "state" else 0.0
    order = np.argsort(asked.values)
    values = asked.values[order]
    ways = [values[values < start][::-1], values[values >= start]]
    parts = [along(*followed(spec, asked, start, way), t, rate, way) for way in ways if len(way)]
    parts = [part.reversed if len(part.values) > 1 and part.values[0] > part.values[-1] else part for part in parts]
    whole = joined(parts)
    whole = whole if asked.values[0] < asked.values[-1] else whole.reversed
    driven = any(drive.joint == asked.joint and drive.quantity == asked.quantity for drive in spec.drives.values())
    return replace(whole, title=spec.title, name=asked.name, driven=driven)


def begun(spec: Spec, asked: Range) -> tuple[float, float]:
    """Where the coordinate stands at the start, and its rate."""
    t = float(spec.analysis.times[0]) if spec.analysis.type == "state" else 0.0
    analysis = spec.analysis._replace(type="state", times=(t,), duration=None, conditions=())
    setup = set_up(spec._replace(analysis=analysis), reduce=False)
    layout = setup.scene.layout
    there = setup.runner.recovered(np.array([t]), layout.y0[None, :])
    states = body_states(layout, there)
    rate = float(rates(layout, [f"{asked.joint}.{asked.quantity}"], states)[0, 0])
    if asked.quantity == "length":
        return length_of(layout, states, asked.joint), rate
    return float(coordinates(layout, there, states)[asked.joint][asked.quantity][0]), rate


def followed(spec: Spec, asked: Range, start: float, way: Array) -> tuple[FreedScene, Recovered, float]:
    """The scene without drives, it answered at the values of a way, and the rate at which it was followed.

    Raises SolveError where more than the coordinate is free, or contacts open and close.
    """
    span = float(way[-1]) - start or 1.0
    law = compile_expression(f"{start!r} + {span!r}*t", Scope(in_time=True))
    drives = {"over": Drive("over", asked.joint, asked.quantity, law)}  # type: ignore[arg-type]
    joints = dict(spec.joints)
    if asked.quantity in RATES:
        joints[asked.joint] = replace(joints[asked.joint], **{RATES[asked.quantity]: None})
    times = np.maximum((way - start) / span, 0.0)
    analysis = Analysis("motion", tuple(times.tolist()), 1.0, spec.analysis.tolerance, "auto", None)
    setup = set_up(spec._replace(drives=drives, joints=joints, impulses={}, analysis=analysis), reduce=False)
    layout = setup.scene.layout
    for load in layout.mechanism.rubbing:
        where = layout.mechanism.rubs_in(load)
        message = f"friction hangs on what presses, {where}: it is told of an instant, not over a range"
        raise refused(asked, message, "leave it out; or take one instant")
    if holds_speed(layout).any() and not layout.mechanism.planar:
        message = "what rolls comes to poses by its way: no coordinate tells them"
        raise refused(asked, message, "heun run tells its motion; in the plane wheels roll along lines")
    if layout.contacts:
        message = f"{layout.contacts[0].name} may open and close on the way"
        raise refused(asked, message, "leave stops and ropes out")
    if not determined(setup.runner.moving).is_so:
        message = f"with {asked.name} held something is free: the inertia of one motion is told over it"
        raise refused(asked, message, "heun lagrange SPEC tells all of one instant; --at T of a later one")
    try:
        run = setup.runner.trajectory(MotionTask(times, spec.analysis.tolerance, FOLLOWED))
    except LimitError as error:
        if error.problems[0].code != "step-limit":
            raise
        raise refused(asked, "it takes too many steps to be followed so far", "a shorter range") from None
    except SolveError as error:
        ends = "" if error.reached is None else f" beyond {start + span * error.reached:.6g}"
        why = error.problems[0].message
        message = f"it cannot be followed{ends}: {why.partition(' s: ')[2] or why}"
        raise refused(asked, message, "a shorter range; or another coordinate, that turns all the way") from None
    return freed(setup.scene), setup.runner.answers_at(run, times), span


def along(scene: FreedScene, there: Recovered, span: float, t: float, rate: float, values: Array) -> InertiaCourse:
    """The course over the values of a way."""
    layout, runner = scene.layout, scene.runner
    place = places_of_rates(layout)
    place = place[place >= 0]
    unit, moved = scene.states(there), scene.states(there)
    unit[:, place] /= span
    moved[:, place] *= rate / span
    at, holding = np.full(len(values), t), layout.all_open
    answered = runner.recovered(at, unit, causes=True, holding=holding)
    states = body_states(layout, answered)
    turning = np.einsum("tnij,tnj->tni", states.R, body_spins(layout, states))
    m = np.array([body.mass for body in layout.mechanism.bodies])
    epsilon = np.sum(m * np.sum(states.v_centre**2, axis=2), axis=1) + np.sum(states.omega * turning, axis=(1, 2))
    alone = motion_alone(layout, answered)
    force, moment = inertia_loads(layout.mechanism, alone)
    half = np.sum(force * states.v_centre + moment * states.omega, axis=(1, 2))
    joint = next(joint for joint in scene.of.mechanism.joints if joint.drive is not None)
    assert joint.drive is not None
    half = half - epsilon * accelerations(layout, [f"{joint.name}.{joint.drive.quantity}"], alone)[:, 0]
    loaded = runner.recovered(at, moved, holding=holding)
    own = body_states(layout, loaded)
    speeds = np.sqrt(np.sum(states.v_centre**2, axis=2)), np.sqrt(np.sum(states.omega**2, axis=2))
    gravity = layout.mechanism.gravity
    forces = {GRAVITY: states.v_centre @ gravity @ m} if gravity.any() else {}
    reach = float((speeds[0] @ m).max()) * float(np.sqrt(gravity @ gravity))
    for load in applied_loads(layout.mechanism, own, loaded):
        forces[load.load.name] = forces.get(load.load.name, 0.0) + power(states, load.action)
        reach = max(reach, largest_power(speeds, load.action))
    for action in rope_actions(coupling_loads(layout, loaded, own)):
        forces[action.name] = forces.get(action.name, 0.0) + power(states, action)
        reach = max(reach, largest_power(speeds, action))
    return InertiaCourse("", "", False, 0.0, values, rate, epsilon, half, forces, reach)


def largest_power(speeds: tuple[Array, Array], action: Action) -> float:
    """What an action could do at most at the speeds of the bodies' centres and of their turning, (n_t, n) each."""
    most = 0.0
    for end, force, moment in action.on_bodies():
        if end.body != GROUND:
            sizes = (np.sqrt(np.sum(load**2, axis=-1)) for load in (force, moment))
            most += sum(float((size * speed[:, end.body]).max()) for size, speed in zip(sizes, speeds, strict=True))
    return most


def body_spins(layout: Layout, states: BodyStates) -> Array:
    """I w of every body, (n_t, n, 3), body axes."""
    inertia = np.array([body.inertia for body in layout.mechanism.bodies])
    return np.asarray(np.einsum("nij,tnkj,tnk->tni", inertia, states.R, states.omega))


def power(states: BodyStates, action: Action) -> Array:
    """What an action does at the velocities of some states, (n_t,)."""
    done = np.zeros(len(states.x))
    for end, force, moment in action.on_bodies():
        if end.body != GROUND:
            done = done + np.sum(force * states.velocity(end.body, end.position), axis=1)
            done = done + np.sum(moment * states.omega[:, end.body], axis=1)
    return done


def joined(parts: list[InertiaCourse]) -> InertiaCourse:
    """Ways one after the other."""
    if len(parts) == 1:
        return parts[0]
    first, second = parts
    return replace(
        first,
        values=np.concatenate([first.values, second.values]),
        epsilon=np.concatenate([first.epsilon, second.epsilon]),
        half=np.concatenate([first.half, second.half]),
        forces={name: np.concatenate([k, second.forces[name]]) for name, k in first.forces.items()},
        reach=max(first.reach, second.reach),
    )
