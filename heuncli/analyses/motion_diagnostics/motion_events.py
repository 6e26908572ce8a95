"""Events along a motion: half turns, gimbal locks and dead centres.

Each follows from a vector with an arbitrary sign: a quaternion, or the shares of a loop's coordinates. It is continued
from instant to instant, which are so close that no body turns far between them; a component passes zero where its sign
changes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from heuncli.analyses.motion_diagnostics.results import DEAD_CENTRE, GIMBAL, HALF_TURN, AttitudeResults, Event
from heuncli.analyses.motion_diagnostics.twists import (
    SEQUENCES,
    Loop,
    compute_condition,
    compute_loop_motions,
    continue_signs,
    find_loops,
    project_axis,
    to_quaternions,
)
from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.redundancy.self_stress import find_neighbour_poses
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.results.results import Array, Indices, Mask
from heuncli.study.queries.study import Study
from heuncli.study.search.columns import choose_search_times
from heuncli.study.search.crossings import Bracket, find_roots
from heuncli.study.solve.history import resample

MAX_BODY_INSTANTS = 200_000  # bodies times instants whose results are in memory at a time
NEWTON_STEPS = 12  # steps towards the closest approach
Track = Callable[[Evaluation], Array]  # maps recovered instants to a vector (n_t, d) of arbitrary sign


class MotionSearch:
    """The instants of a motion at which events are searched, and the kernel's results at any instant."""

    def __init__(self, study: Study) -> None:
        self.study, self.layout = study, study.setup.scene.layout
        self.times = (
            choose_search_times(study.setup, study.history)[0] if study.history.checked_run else study.history.times
        )
        self.span = float(np.ptp(self.times))
        found = study.history.checked_run
        # None for one instant, and for a motion that a slack rope ends at its start
        self.checked = found if found is not None and len(found.run.ends) else None

    def recover(self, times: Array) -> Evaluation:
        """Return the results at ascending instants."""
        return resample(self.study.setup.runner, self.study.history, times)

    def recover_in_parts(self) -> list[Evaluation]:
        """Return the results at all instants, in parts that fit into memory."""
        many = max(1, MAX_BODY_INSTANTS // max(len(self.layout.place), 1))
        return [self.recover(self.times[i : i + many]) for i in range(0, len(self.times), many)]


class ZeroInterval(NamedTuple):
    """The interval [s] where a component is zero; begin equals end where it passes through zero."""

    begin: float
    end: float


def find_zeros(motion: MotionSearch, track: Track, x: Array, component: int) -> list[ZeroInterval]:
    """Return the intervals where a component of a continued vector (n_t, d) is zero."""
    h, times = x[:, component], motion.times
    # components of unit vectors; an assembled pose is accurate to nine digits
    is_zero = np.abs(h) <= (tolerances.GAP_ROUNDING if len(times) > 1 else tolerances.RANK)
    intervals = []
    for run in np.split(np.flatnonzero(is_zero), np.flatnonzero(np.diff(np.flatnonzero(is_zero)) > 1) + 1):
        if len(run):
            intervals.append(ZeroInterval(float(times[run[0]]), float(times[run[-1]])))
    k = np.flatnonzero((h[1:] * h[:-1] < 0.0) & ~is_zero[1:] & ~is_zero[:-1])
    if len(k):

        def evaluate_aligned(instants: Array) -> Array:
            """Return the component at instants, with the sign it has at the preceding instant of the grid."""
            intervals = track(motion.recover(instants))
            left = x[np.searchsorted(times, instants, side="right") - 1]
            return np.asarray(intervals[:, component] * np.where(np.sum(intervals * left, axis=1) < 0.0, -1.0, 1.0))

        zero_times = find_roots(evaluate_aligned, Bracket(times[k], times[k + 1], h[k], h[k + 1]), np.zeros(len(k)))
        intervals += [ZeroInterval(t, t) for t in zero_times.tolist()]
    return sorted(intervals)


def find_attitude_events(motion: MotionSearch) -> tuple[list[Event], list[AttitudeResults]]:
    """Return half turns and gimbal locks of the bodies that rotate freely."""
    layout = motion.layout
    balls = [k for k in range(len(layout.place)) if layout.bodies["ball"][k]]
    if not balls:
        return [], []
    parts = [(part.bodies["R"][:, balls], part.bodies["omega"][:, balls]) for part in motion.recover_in_parts()]
    R, omega = (np.concatenate([part[i] for part in parts]) for i in (0, 1))
    events, rows = [], []
    for i, k in enumerate(balls):
        name = layout.mechanism.bodies[layout.spanning.links[k].body].name
        half_turns = find_zeros(motion, make_attitude_track(k), to_quaternions(R[:, i]), 0)
        events += [make_half_turn_event(name, one, motion) for one in half_turns]
        euler = {}
        for sequence, axis in SEQUENCES.items():
            locks, worst = find_lock_approaches(motion, k, axis, (R[:, i], omega[:, i]))
            events += [make_lock_event(name, sequence, one, motion) for one in locks]
            euler[sequence] = worst
        rows.append(AttitudeResults(name, len(half_turns), euler))
    return events, rows


def make_attitude_track(place: int) -> Track:
    """Return a function that gives the quaternion of the body at a place of the tree."""
    return lambda at: to_quaternions(at.bodies["R"][:, place])


def make_half_turn_event(name: str, interval: ZeroInterval, motion: MotionSearch) -> Event:
    """Return the event of a half turn at an instant, or of an attitude that stays at one."""
    message = "is rotated by 180 deg from the world axes: its global Rodrigues parameters are unbounded"
    return Event(interval.begin, HALF_TURN, f"bodies.{name}", f"{name} {message}{format_duration(interval, motion)}")


def format_duration(interval: ZeroInterval, motion: MotionSearch) -> str:
    """Return the words that say how long a zero lasts; empty if it is passed through."""
    if interval.end - interval.begin <= tolerances.SAME_INSTANT * motion.span:
        return ""
    return ", at all times" if interval.end - interval.begin >= motion.span else f", until t = {interval.end:.6g} s"


class LockApproach(NamedTuple):
    """A closest approach to gimbal lock, or an interval in it, with the sine of the remaining angle."""

    interval: ZeroInterval
    sine: float


def find_lock_approaches(
    motion: MotionSearch, k: int, axis: int, attitudes_and_spins: tuple[Array, Array]
) -> tuple[list[LockApproach], tuple[float, float]]:
    """Return the approaches of a body to gimbal lock within GIMBAL, and the largest condition of its angles with its
    instant.
    """
    times = motion.times
    p, _ = project_axis(*attitudes_and_spins, axis)
    s = np.sqrt(np.sum(p * p, axis=1))
    long_locks = find_stretches(s <= tolerances.GIMBAL)
    locks = [
        LockApproach(ZeroInterval(float(times[i]), float(times[j])), float(s[i : j + 1].min())) for i, j in long_locks
    ]
    padded = np.concatenate([[np.inf], s, [np.inf]])
    minima = np.flatnonzero((s <= padded[:-2]) & (s < padded[2:]))
    for i, j in long_locks:
        minima = minima[(minima < i) | (minima > j)]
    smallest = (float(s.min()), float(times[np.argmin(s)]))
    if len(minima):
        approach_times, sines = refine_minima(motion, k, axis, minima)
        smallest = min(smallest, (float(sines.min()), float(approach_times[np.argmin(sines)])))
        is_locked = sines <= tolerances.GIMBAL
        locks += [
            LockApproach(ZeroInterval(t, t), x)
            for t, x in zip(approach_times[is_locked].tolist(), sines[is_locked].tolist(), strict=True)
        ]
    return locks, (float(compute_condition(smallest[0])), smallest[1])


def find_stretches(mask: Mask) -> list[tuple[int, int]]:
    """Return the first and last indices of the stretches of more than one true value."""
    places = np.flatnonzero(mask)
    stretches = np.split(places, np.flatnonzero(np.diff(places) > 1) + 1)
    return [(int(run[0]), int(run[-1])) for run in stretches if len(run) > 1]


def refine_minima(motion: MotionSearch, k: int, axis: int, minima: Indices) -> tuple[Array, Array]:
    """Refine the closest approaches near instants of the grid, and return them with their sines: p . p' = 0 by
    Gauss-Newton.
    """
    times = motion.times
    lower, upper = times[np.maximum(minima - 1, 0)], times[np.minimum(minima + 1, len(times) - 1)]
    t = times[minima].copy()
    best_times, smallest = t.copy(), np.full(len(t), np.inf)
    for _ in range(NEWTON_STEPS):
        instants, inverse = np.unique(t, return_inverse=True)
        rows = motion.recover(instants).bodies
        p, rate = (x[inverse] for x in project_axis(rows["R"][:, k], rows["omega"][:, k], axis))
        s = np.sqrt(np.sum(p * p, axis=1))
        best_times, smallest = np.where(s < smallest, t, best_times), np.minimum(s, smallest)
        square = np.sum(rate * rate, axis=1)
        step = np.sum(p * rate, axis=1) / np.where(square > 0.0, square, np.inf)
        t = np.clip(t - step, lower, upper)
    return best_times, smallest


def make_lock_event(name: str, sequence: str, lock: LockApproach, motion: MotionSearch) -> Event:
    """Return the event of a gimbal lock, or of a pose so near to it that digits are lost."""
    k = float(compute_condition(lock.sine))
    condition_text = (
        f"condition number {k:.2g} of its angle matrix" if np.isfinite(k) and k < 1.0 / tolerances.EPS else "singular"
    )
    message = f"{sequence} Euler angles of {name}: {condition_text}{format_duration(lock.interval, motion)}"
    return Event(lock.interval.begin, GIMBAL, f"bodies.{name}", message)


def find_dead_centres(motion: MotionSearch) -> tuple[list[Event], list[str]]:
    """Return the dead centres of the closed chains, and the reasons why loops were skipped."""
    loops = find_loops(motion.layout)
    if not loops:
        return [], []
    parts = motion.recover_in_parts()
    events, skipped = [], []
    neighbour_poses = find_adjacent_poses(motion)
    for loop in loops:
        part_motions = [compute_loop_motions(motion.layout, loop, part) for part in parts]
        shares, count = (np.concatenate([part[i] for part in part_motions]) for i in (0, 1))
        neighbour_shares = (
            shares if neighbour_poses is None else compute_loop_motions(motion.layout, loop, neighbour_poses)[0]
        )
        if np.median(count) != 1:
            skipped.append(explain_skipped(motion, loop, int(np.median(count))))
            continue
        c = len(loop.coordinates)
        largest = np.max(np.abs(np.nan_to_num(np.vstack([shares, neighbour_shares])[:, :c])), axis=0)
        events += find_loop_dead_centres(motion, loop, continue_signs(shares), largest > tolerances.REMAINING_RATE)
    return events, skipped


def explain_skipped(motion: MotionSearch, loop: Loop, count: int) -> str:
    """Explain why no dead centre of a loop is searched."""
    names = format_joints(motion, loop)
    if count == 0:
        return f"the coordinates of {names} do not move"
    return f"the coordinates of {names} have {count} degrees of freedom together: no single one drives the others"


def format_joints(motion: MotionSearch, loop: Loop) -> str:
    """Return the names of the joints of a loop."""
    return ", ".join(dict.fromkeys(motion.layout.mechanism.joints[k].name for k, _ in loop.coordinates))


def find_adjacent_poses(motion: MotionSearch) -> Evaluation | None:
    """Return poses close to the only one of a scene, to see which coordinates move; None for a motion."""
    if len(motion.times) > 1:
        return None
    recovered = motion.study.history.solutions
    return find_neighbour_poses(
        motion.study.setup.runner,
        float(recovered.times[0]),
        recovered.states[0],
        (tolerances.NEIGHBOUR,),
        holding=recovered.holding[0],
    )


def find_loop_dead_centres(motion: MotionSearch, loop: Loop, shares: Array, moves: Mask) -> list[Event]:
    """Return the dead centres of one loop; moves: which of its coordinates move at all."""
    joints, events = motion.layout.mechanism.joints, []
    for i, (k, name) in enumerate(loop.coordinates):
        if not moves[i]:
            continue
        for interval in find_zeros(motion, lambda at: compute_loop_motions(motion.layout, loop, at)[0], shares, i):
            others = [f"{joints[j].name}.{what}" for j, what in loop.coordinates if (j, what) != (k, name)]
            coordinate = f"{joints[k].name}.{name}"
            motion_text = f"{' and '.join(others[:2])} {'moves' if len(others) == 1 else 'move'}"
            message = f"{coordinate} stops while {motion_text}: it cannot drive the mechanism there"
            events.append(
                Event(
                    interval.begin, DEAD_CENTRE, f"joints.{joints[k].name}", message + format_duration(interval, motion)
                )
            )
    return events


def distinct_events(events: Sequence[Event], span: float) -> list[Event]:
    """Return the events by time, each kind and place once at an instant."""
    distinct: list[Event] = []
    for event in sorted(events):
        recent = [
            e for e in distinct[-8:] if e[1:3] == event[1:3] and event.time - e.time <= tolerances.SAME_INSTANT * span
        ]
        if not recent or recent[-1].message != event.message:
            distinct.append(event)
    return distinct
