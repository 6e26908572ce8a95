"""How evenly a machine runs under its own loads, and the flywheel that makes it run more evenly.

    ½ (ε(φ) + J) ω² = E0 + W(φ),   W = ∫ k dφ,   k the power of the loads and the weight at unit rate
    δ = (ω_max - ω_min)/ω_m,       ω_m = angle of the cycle / its time
ε is the machine's own reduced inertia, which goes to and fro with φ; W must come back with the cycle, so that an even
torque is added where the loads do work on the whole. E0 follows from ω_m, J from δ, each by bracketing. The textbook's
J is ΔE/(δ ω_m²) less the inertia of what turns evenly with the shaft, where ΔE lies between the lowest and the highest
W - ½ ε ω_m², the work of loads and inertia in its diagram of turning moments at an even rate.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from heuncli import tolerances
from heuncli.balancing.cost import LoadedCycle
from heuncli.balancing.cycle import Cycle
from heuncli.balancing.effects import mass_effects
from heuncli.balancing.load_torque import torques
from heuncli.balancing.results import Flywheel
from heuncli.errors import Problem, SolveError
from heuncli.expressions.programs import Expression
from heuncli.mechanism.model import (
    BushingLoad,
    JointLoad,
    Load,
    Mechanism,
    PairLoad,
    RopeLoad,
    ThreadLoad,
    path_of_load,
)
from heuncli.records import record
from heuncli.results import Array

INTERVALS = 1080  # of a turn: thirds of a degree, on which the points of most tables lie; Simpson's rule on each
RATES = frozenset({"rate", "speed", "vx", "vy", "vz"})
TYPED = 1e-6  # of the work done to and fro: digits of a load that takes just the work of a gas; less is not told
MOST_CHORDS = 200
NEWTON = 4


@record
class WorkCourse:
    """Work, reduced inertia and what they change by, at equal angles over a cycle with both ends, (n + 1,).

    steady [kg m2]: the inertia of the bodies whose part of it does not change.
    """

    step: float
    W: Array
    k: Array
    eps: Array
    half_slope: Array
    steady: float

    def rates(self, E0: float, J: float) -> Array:
        """ω at the angles [rad/s]; 0 where the energy does not suffice."""
        return np.asarray(np.sqrt(2.0 * np.maximum(E0 + self.W, 0.0) / (self.eps + J)))

    def mean(self, E0: float, J: float) -> float:
        """The mean rate: the angle over the time that it takes."""
        with np.errstate(divide="ignore"):
            return float(1.0 / np.mean(1.0 / self.rates(E0, J)[:-1]))

    def energy_for(self, mean: float, J: float) -> float:
        """E0 with that mean rate."""
        low = -float(self.W.min())
        high = float(np.ptp(self.W)) + (float(self.eps.max()) + J) * mean**2 + low
        return root(lambda E0: self.mean(E0, J) - mean, low, high)

    def extremes(self, mean: float, J: float) -> tuple[float, float]:
        """The slowest and the fastest rate at a mean one."""
        w = self.rates(self.energy_for(mean, J), J)
        if w.min() == 0.0:
            return 0.0, float(w.max())
        return between(w, (self.k - self.half_slope * w * w) / (w * (self.eps + J)), self.step)

    def unevenness(self, mean: float, J: float) -> float:
        """δ with a wheel J at a mean rate."""
        slowest, fastest = self.extremes(mean, J)
        return (fastest - slowest) / mean


def between(values: Array, slopes: Array, step: float) -> tuple[float, float]:
    """The least and the largest of values (n,) at equal steps and of the cubics between them, by their slopes."""
    a, b, p, q = values[:-1], values[1:], step * slopes[:-1], step * slopes[1:]
    turns = p * q < 0.0
    a, b, p, q = a[turns], b[turns], p[turns], q[turns]
    c2, c3 = 3.0 * (b - a) - 2.0 * p - q, 2.0 * (a - b) + p + q
    s = p / (p - q)
    for _ in range(NEWTON):
        s = np.clip(s - (p + s * (2.0 * c2 + 3.0 * c3 * s)) / (2.0 * c2 + 6.0 * c3 * s), 0.0, 1.0)
    every = np.concatenate([values, a + s * (p + s * (c2 + s * c3))])
    return float(every.min()), float(every.max())


def root(f: Callable[[float], float], low: float, high: float) -> float:
    """Where a function that is below 0 at one place and above at the other is 0, by chords (Illinois)."""
    fl, fh = f(low), f(high)
    for _ in range(MOST_CHORDS):
        x = (low * fh - high * fl) / (fh - fl)
        fx = f(x)
        if fx == 0.0 or abs(high - low) <= 4.0 * tolerances.EPS * abs(high):
            return x
        if fx * fh < 0.0:
            low, fl = high, fh
        else:
            fl *= 0.5
        if abs(x - high) <= 2.0 * tolerances.EPS * abs(x):
            return x
        high, fh = x, fx
    return high


def flywheel(cycle: LoadedCycle, joint: str, mean: float, delta: float) -> Flywheel:
    """The wheel on the cycle's shaft; cycle: solved at unit rate, at the ends and middles of all intervals.

    Raises SolveError for loads that are not told by where things are.
    """
    require_placed(cycle.setup.scene.mechanism)
    course, even = course_of(cycle)
    diagram = course.W - 0.5 * course.eps * mean**2
    low, high = between(diagram, course.k - course.half_slope * mean**2, course.step)
    energy, own = high - low, float(np.mean(course.eps[:-1]))
    present = course.unevenness(mean, 0.0)
    added = 0.0
    if present > delta:
        most = energy / (delta * mean**2) + float(course.eps.max())
        while course.unevenness(mean, most) > delta:
            most *= 2.0
        added = root(lambda J: delta - course.unevenness(mean, J), 0.0, most)
    slowest, fastest = course.extremes(mean, added)
    start = float(course.rates(course.energy_for(mean, added), added)[0])
    textbook = energy / (delta * mean**2) - course.steady
    return Flywheel(joint, delta, present, mean, energy, own, added, textbook, even, start, fastest, slowest)


def course_of(cycle: LoadedCycle) -> tuple[WorkCourse, float]:
    """The course of a cycle, and the even torque [N m] that closes it where that is no matter of digits.

    Simpson's rule over each interval, whose ends are every other instant.
    """
    mechanism, states, begin = cycle.setup.scene.mechanism, cycle.states, cycle.angles
    effects = mass_effects(Cycle(mechanism, 1, begin, states, cycle.setup.scene.layout.size), np.zeros(3))
    k = torques(cycle, mechanism).sum(axis=1)
    ends, middles = np.append(k[0::2], k[0]), k[1::2]
    step = float(begin[2] - begin[0])
    parts = step / 6.0 * (ends[:-1] + 4.0 * middles + ends[1:])
    left, cycle_angle = float(parts.sum()), step * len(parts)
    even = 0.0 if abs(left) <= TYPED * float(np.abs(parts).sum()) else -left / cycle_angle
    W = np.append(0.0, np.cumsum(parts - left / len(parts)))
    ends = ends - left / cycle_angle
    eps, slope = (np.append(own[0::2], own[0]) for own in (effects.eps.sum(axis=1), effects.half_slope.sum(axis=1)))
    same = np.ptp(effects.eps, axis=0) <= tolerances.SAME_VALUE * effects.eps.max()
    return WorkCourse(step, W, ends, eps, slope, float(effects.eps[0, same].sum())), even


def require_placed(mechanism: Mechanism) -> None:
    """Raise SolveError for loads that hang on rates or on the time: their work is not told by the angle."""
    found = dict.fromkeys((path_of_load(load), why) for load in mechanism.loads for why in unplaced(load))
    hint = "leave it out of the scene, or run the motion with the wheel in it"
    if found:
        raise SolveError(*(
            Problem("no-flywheel", f"{name} {why}: its work over a cycle is not told by the angle", hint=hint,
                    about=name)
            for name, why in found
        ))  # fmt: skip


def unplaced(load: Load) -> Iterator[str]:
    """Why the work of a load is not told by where things are; nothing where it is."""
    if isinstance(load, JointLoad) and load.kind in ("damper", "friction"):
        yield "hangs on the rate of its joint"
    if isinstance(load, ThreadLoad):
        yield "hangs on the way that its thread turns"
    if isinstance(load, JointLoad) and load.kind == "turn_spring" and load.turning:
        yield "has damping"
    if isinstance(load, PairLoad | RopeLoad) and load.damping:
        yield "has damping"
    if isinstance(load, BushingLoad) and (load.shift.damping.any() or load.turn.damping.any()):
        yield "has damping"
    values: tuple[Expression, ...] = load.values
    if any(value.time_dependent for value in values):
        yield "depends on t"
    if any(quantity in RATES for value in values for _, quantity in value.uses):
        yield "depends on a rate"
