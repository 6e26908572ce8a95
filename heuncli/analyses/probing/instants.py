"""Instants along a motion at which something is passed: half turns, gimbal locks, dead centres.

What is looked at is a vector whose sign means nothing, a quaternion or the shares of a loop's coordinates: it is
continued from instant to instant, which lie so close that no body turns far between them, and a component passes zero
where its sign changes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from heuncli.analyses.probing.numerics.attitudes import SEQUENCES, condition, off_upright, quaternions
from heuncli.analyses.probing.numerics.shares import Loop, continued, loops_of, motions
from heuncli.analyses.probing.results import DEAD_CENTRE, GIMBAL, HALF_TURN, AttitudeResults, Event
from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.redundancy.neighbours import neighbours
from heuncli.motion.integration.evaluator import Recovered
from heuncli.results.results import Array, Indices, Mask
from heuncli.study.ask.study import Study
from heuncli.study.search.crossings import Bracket, roots
from heuncli.study.search.instants import search_times
from heuncli.study.solve.history import resample

CHUNK = 200_000  # body-instants whose answers are kept at a time
NEWTON = 12  # steps towards the nearest approach
Track = Callable[[Recovered], Array]  # of recovered instants the vector there, (n_t, d), of any sign


class SearchedMotion:
    """The instants of a motion at which it is looked at, and the kernel's answers at any of it."""

    def __init__(self, study: Study) -> None:
        self.study, self.layout = study, study.setup.scene.layout
        self.times = search_times(study.setup, study.history)[0] if study.history.checked else study.history.times
        self.span = float(np.ptp(self.times))
        found = study.history.checked
        # None of one instant, and of a motion that a slack rope ends at its start
        self.checked = found if found is not None and len(found.run.ends) else None

    def at(self, times: Array) -> Recovered:
        """The answers at instants, ascending."""
        return resample(self.study.setup.runner, self.study.history, times)

    def parts(self) -> list[Recovered]:
        """The answers at all instants, in parts that fit the memory."""
        many = max(1, CHUNK // max(len(self.layout.place), 1))
        return [self.at(self.times[i : i + many]) for i in range(0, len(self.times), many)]


class ZeroStretch(NamedTuple):
    """Where a component is zero, from one instant to another [s]: equal ones where it passes, others where it stays."""

    begin: float
    end: float


def zeros(along: SearchedMotion, track: Track, x: Array, component: int) -> list[ZeroStretch]:
    """Where a component of a continued vector (n_t, d) is zero."""
    h, times = x[:, component], along.times
    # of unit vectors; a pose that is assembled is known to nine digits
    still = np.abs(h) <= (tolerances.GAP_ROUNDING if len(times) > 1 else tolerances.RANK)
    found = []
    for run in np.split(np.flatnonzero(still), np.flatnonzero(np.diff(np.flatnonzero(still)) > 1) + 1):
        if len(run):
            found.append(ZeroStretch(float(times[run[0]]), float(times[run[-1]])))
    k = np.flatnonzero((h[1:] * h[:-1] < 0.0) & ~still[1:] & ~still[:-1])
    if len(k):

        def aligned(instants: Array) -> Array:
            """The component at instants, with the sign that it has at the instant of the grid before."""
            found = track(along.at(instants))
            left = x[np.searchsorted(times, instants, side="right") - 1]
            return np.asarray(found[:, component] * np.where(np.sum(found * left, axis=1) < 0.0, -1.0, 1.0))

        at = roots(aligned, Bracket(times[k], times[k + 1], h[k], h[k + 1]), np.zeros(len(k)))
        found += [ZeroStretch(t, t) for t in at.tolist()]
    return sorted(found)


def attitudes(along: SearchedMotion) -> tuple[list[Event], list[AttitudeResults]]:
    """Half turns and gimbal locks of the bodies whose turns are all free."""
    layout = along.layout
    balls = [k for k in range(len(layout.place)) if layout.bodies["ball"][k]]
    if not balls:
        return [], []
    parts = [(part.bodies["R"][:, balls], part.bodies["omega"][:, balls]) for part in along.parts()]
    R, omega = (np.concatenate([part[i] for part in parts]) for i in (0, 1))
    events, rows = [], []
    for i, k in enumerate(balls):
        name = layout.mechanism.bodies[layout.spanning.hangs[k].body].name
        passed = zeros(along, attitude_of(k), quaternions(R[:, i]), 0)
        events += [half_turn(name, one, along) for one in passed]
        euler = {}
        for sequence, axis in SEQUENCES.items():
            locks, worst = nearest_to_lock(along, k, axis, (R[:, i], omega[:, i]))
            events += [locked(name, sequence, one, along) for one in locks]
            euler[sequence] = worst
        rows.append(AttitudeResults(name, len(passed), euler))
    return events, rows


def attitude_of(place: int) -> Track:
    """The quaternion of a body at a place of the tree."""
    return lambda at: quaternions(at.bodies["R"][:, place])


def half_turn(name: str, passed: ZeroStretch, along: SearchedMotion) -> Event:
    """The event of a half turn at an instant, or of an attitude that stays at one."""
    what = "is turned by 180 deg against the drawing: its global Rodrigues parameters are without bound"
    return Event(passed.begin, HALF_TURN, f"bodies.{name}", f"{name} {what}{until(passed, along)}")


def until(passed: ZeroStretch, along: SearchedMotion) -> str:
    """Words on until when it stays there; none where it only passes."""
    if passed.end - passed.begin <= tolerances.SAME_INSTANT * along.span:
        return ""
    return ", all the time" if passed.end - passed.begin >= along.span else f", until t = {passed.end:.6g} s"


class Lock(NamedTuple):
    """A nearest approach to a gimbal lock, or a stay there; sine of the angle that is left."""

    passed: ZeroStretch
    sine: float


def nearest_to_lock(
    along: SearchedMotion, k: int, axis: int, known: tuple[Array, Array]
) -> tuple[list[Lock], tuple[float, float]]:
    """The approaches of a body to a lock within GIMBAL, and the largest condition of its angles with its instant."""
    times = along.times
    p, _ = off_upright(*known, axis)
    s = np.sqrt(np.sum(p * p, axis=1))
    stays = runs_of(s <= tolerances.GIMBAL)
    locks = [Lock(ZeroStretch(float(times[i]), float(times[j])), float(s[i : j + 1].min())) for i, j in stays]
    padded = np.concatenate([[np.inf], s, [np.inf]])
    low = np.flatnonzero((s <= padded[:-2]) & (s < padded[2:]))
    for i, j in stays:
        low = low[(low < i) | (low > j)]
    best = (float(s.min()), float(times[np.argmin(s)]))
    if len(low):
        at, found = approach(along, k, axis, low)
        best = min(best, (float(found.min()), float(at[np.argmin(found)])))
        passed = found <= tolerances.GIMBAL
        locks += [Lock(ZeroStretch(t, t), x) for t, x in zip(at[passed].tolist(), found[passed].tolist(), strict=True)]
    return locks, (float(condition(best[0])), best[1])


def runs_of(held: Mask) -> list[tuple[int, int]]:
    """The first and last places of stretches of more than one instant."""
    places = np.flatnonzero(held)
    stretches = np.split(places, np.flatnonzero(np.diff(places) > 1) + 1)
    return [(int(run[0]), int(run[-1])) for run in stretches if len(run) > 1]


def approach(along: SearchedMotion, k: int, axis: int, low: Indices) -> tuple[Array, Array]:
    """The nearest approaches about instants of the grid, and the sines there: p . p' = 0 by Gauss and Newton."""
    times = along.times
    first, last = times[np.maximum(low - 1, 0)], times[np.minimum(low + 1, len(times) - 1)]
    t = times[low].copy()
    best, least = t.copy(), np.full(len(t), np.inf)
    for _ in range(NEWTON):
        instants, where = np.unique(t, return_inverse=True)
        rows = along.at(instants).bodies
        p, rate = (x[where] for x in off_upright(rows["R"][:, k], rows["omega"][:, k], axis))
        s = np.sqrt(np.sum(p * p, axis=1))
        best, least = np.where(s < least, t, best), np.minimum(s, least)
        square = np.sum(rate * rate, axis=1)
        step = np.sum(p * rate, axis=1) / np.where(square > 0.0, square, np.inf)
        t = np.clip(t - step, first, last)
    return best, least


def locked(name: str, sequence: str, lock: Lock, along: SearchedMotion) -> Event:
    """A lock, or a pose so near to it that digits are lost."""
    k = float(condition(lock.sine))
    how = f"condition {k:.2g} of its angle matrix" if np.isfinite(k) and k < 1.0 / tolerances.EPS else "locked"
    what = f"{sequence} Euler angles of {name}: {how}{until(lock.passed, along)}"
    return Event(lock.passed.begin, GIMBAL, f"bodies.{name}", what)


def dead_centres(along: SearchedMotion) -> tuple[list[Event], list[str]]:
    """Dead centres of the closed chains; and of which loops none are looked for, why."""
    loops = loops_of(along.layout)
    if not loops:
        return [], []
    parts = along.parts()
    events, left = [], []
    around = poses_around(along)
    for loop in loops:
        found = [motions(along.layout, loop, part) for part in parts]
        shares, count = (np.concatenate([part[i] for part in found]) for i in (0, 1))
        beside = shares if around is None else motions(along.layout, loop, around)[0]
        if np.median(count) != 1:
            left.append(several(along, loop, int(np.median(count))))
            continue
        c = len(loop.coordinates)
        largest = np.max(np.abs(np.nan_to_num(np.vstack([shares, beside])[:, :c])), axis=0)
        events += of_loop(along, loop, continued(shares), largest > tolerances.MOVES)
    return events, left


def several(along: SearchedMotion, loop: Loop, count: int) -> str:
    """Why no dead centre of a loop is looked for."""
    names = named(along, loop)
    if count == 0:
        return f"the coordinates of {names} do not move"
    return f"the coordinates of {names} take part in {count} motions at once: no single one is driven through another"


def named(along: SearchedMotion, loop: Loop) -> str:
    """The joints of a loop."""
    return ", ".join(dict.fromkeys(along.layout.mechanism.joints[k].name for k, _ in loop.coordinates))


def poses_around(along: SearchedMotion) -> Recovered | None:
    """Poses beside the only one of a scene, which tell what moves at all; None of a motion."""
    if len(along.times) > 1:
        return None
    at = along.study.history.recovered
    return neighbours(
        along.study.setup.runner, float(at.times[0]), at.states[0], (tolerances.NEIGHBOUR,), holding=at.holding[0]
    )


def of_loop(along: SearchedMotion, loop: Loop, shares: Array, moves: Mask) -> list[Event]:
    """The dead centres of one loop; moves: which of its coordinates move at all."""
    joints, events = along.layout.mechanism.joints, []
    for i, (k, name) in enumerate(loop.coordinates):
        if not moves[i]:
            continue
        for one in zeros(along, lambda at: motions(along.layout, loop, at)[0], shares, i):
            others = [f"{joints[j].name}.{what}" for j, what in loop.coordinates if (j, what) != (k, name)]
            mine = f"{joints[k].name}.{name}"
            move = f"{' and '.join(others[:2])} {'moves' if len(others) == 1 else 'move'}"
            message = f"{mine} stands while {move}: nothing there drives the mechanism"
            events.append(Event(one.begin, DEAD_CENTRE, f"joints.{joints[k].name}", message + until(one, along)))
    return events


def distinct_events(events: Sequence[Event], span: float) -> list[Event]:
    """Events by time, each kind and place once at an instant."""
    kept: list[Event] = []
    for event in sorted(events):
        same = [e for e in kept[-8:] if e[1:3] == event[1:3] and event.time - e.time <= tolerances.SAME_INSTANT * span]
        if not same or same[-1].message != event.message:
            kept.append(event)
    return kept
