"""Events along a motion: the search of zeros, half turns and gimbal locks of attitudes.

Each follows from a vector with an arbitrary sign: a quaternion, or the shares of a loop's coordinates. It is continued
from instant to instant, which are so close that no body turns far between them; a component passes zero where its sign
changes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from heuncli.analyses.motion_diagnostics.results import GIMBAL, HALF_TURN, AttitudeResults, Event
from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.shapes.rotations import cross_rows
from heuncli.study.queries.study import Study
from heuncli.study.search.columns import choose_search_times
from heuncli.study.search.crossings import Bracket, find_roots
from heuncli.study.solve.history import resample

MAX_BODY_INSTANTS = 200_000  # bodies times instants whose results are in memory at a time
SEQUENCES = {"zxz": 2, "zyx": 0}  # Euler angles: the body axis that is parallel to the world's z at gimbal lock
NEWTON_STEPS = 12  # steps towards the closest approach
MAX_SIMULTANEOUS = 8  # latest events that an event is compared with
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
            vectors = track(motion.recover(instants))
            previous = x[np.searchsorted(times, instants, side="right") - 1]
            return np.asarray(vectors[:, component] * np.where(np.sum(vectors * previous, axis=1) < 0.0, -1.0, 1.0))

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
    return lambda recovered: to_quaternions(recovered.bodies["R"][:, place])


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


def to_quaternions(R: Array) -> Array:
    """Return the quaternions (n_t, 4) of attitudes along a motion, (n_t, 3, 3), with continuous signs."""
    trace = np.trace(R, axis1=1, axis2=2)
    diagonal = np.diagonal(R, axis1=1, axis2=2)
    squares = np.concatenate([1.0 + trace[:, None], 1.0 - trace[:, None] + 2.0 * diagonal], axis=1)  # 4 q_i^2
    K = np.empty((len(R), 4, 4))  # 4 q_i q_j
    K[:, range(4), range(4)] = squares
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        K[:, 0, 1 + i] = K[:, 1 + i, 0] = R[:, k, j] - R[:, j, k]
        K[:, 1 + i, 1 + j] = K[:, 1 + j, 1 + i] = R[:, i, j] + R[:, j, i]
    best = np.argmax(squares, axis=1)
    rows = np.arange(len(R))
    q = K[rows, best] / (2.0 * np.sqrt(squares[rows, best]))[:, None]
    is_turned = np.sum(q[1:] * q[:-1], axis=1) < 0.0
    sign = np.cumprod(np.concatenate([[1.0], np.where(is_turned, -1.0, 1.0)]))
    return np.asarray(q * sign[:, None])


def project_axis(R: Array, omega: Array, axis: int) -> tuple[Array, Array]:
    """Return the horizontal part (n_t, 2) of a body's axis, and its rate; its length is sin delta."""
    c = R[:, :, axis]
    return c[:, :2], cross_rows(omega, c)[:, :2]


def compute_condition(sine: Array | float) -> Array:
    """Return the condition cot(delta / 2) of the angle matrix, from sin delta."""
    s = np.asarray(sine, dtype=float)
    with np.errstate(divide="ignore"):
        return np.asarray((1.0 + np.sqrt(np.maximum(1.0 - s * s, 0.0))) / s)


def distinct_events(events: Sequence[Event], span: float) -> list[Event]:
    """Return the events by time, each kind and place once at an instant."""
    distinct: list[Event] = []
    for event in sorted(events):
        recent = [
            earlier
            for earlier in distinct[-MAX_SIMULTANEOUS:]
            if (earlier.kind, earlier.where) == (event.kind, event.where)
            and event.time - earlier.time <= tolerances.SAME_INSTANT * span
        ]
        if not recent or recent[-1].message != event.message:
            distinct.append(event)
    return distinct
