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

from heuncli.analyses.balancing.cycle import Cycle
from heuncli.analyses.balancing.effects import mass_effects
from heuncli.analyses.balancing.legendre import polynomials
from heuncli.analyses.balancing.load_torque import rounding_in, torques
from heuncli.analyses.balancing.loaded import CycleNumbers, LoadedScene
from heuncli.analyses.balancing.results import Flywheel
from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.multibody.mechanism.model import (
    BushingLoad,
    JointLoad,
    Load,
    Mechanism,
    PairLoad,
    RopeLoad,
    ThreadLoad,
    path_of_load,
)
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression
from heuncli.study.compose.recovery import Recovery

FINE = 1080  # intervals of a turn, at least, on each of which extremes are those of a cubic
LEAST_INTERVALS = 8  # of a piece
HALVINGS = 2  # of pieces, where the time of a cycle is added up: a rate that nearly stops makes it steep
RATES = frozenset({"rate", "speed", "vx", "vy", "vz"})
TYPED = 1e-6  # of the work done to and fro: digits of a load that takes just the work of a gas; less is not told
MOST_CHORDS = 200
NEWTON, LOOKS = 4, 3


@record
class WorkCourse:
    """Work, reduced inertia and what they change by along a cycle, piece after piece with both ends of each, (m,).

    x (m,): their places. weights, W_at, eps_at (n,): where the time of a cycle is added up, by weights of sum 1. steady
    [kg m2]: the inertia of the bodies whose part of it does not change. between: W, k, ε and ½ε' at any places.
    """

    x: Array
    W: Array
    k: Array
    eps: Array
    half_slope: Array
    weights: Array
    W_at: Array
    eps_at: Array
    steady: float
    between: Callable[[Array], tuple[Array, Array, Array, Array]]

    def rates(self, E0: float, J: float) -> Array:
        """ω along the cycle [rad/s], (m,); 0 where the energy does not suffice."""
        return np.asarray(np.sqrt(2.0 * np.maximum(E0 + self.W, 0.0) / (self.eps + J)))

    def mean(self, E0: float, J: float) -> float:
        """The mean rate: the angle over the time that it takes."""
        w = np.sqrt(2.0 * np.maximum(E0 + self.W_at, 0.0) / (self.eps_at + J))
        with np.errstate(divide="ignore"):
            return float(1.0 / (self.weights @ (1.0 / w)))

    def energy_for(self, mean: float, J: float) -> float:
        """E0 with that mean rate."""
        low = -float(self.W.min())
        high = float(np.ptp(self.W)) + (float(self.eps.max()) + J) * mean**2 + low
        return root(lambda E0: self.mean(E0, J) - mean, low, high)

    def extremes(self, mean: float, J: float) -> tuple[float, float]:
        """The slowest and the fastest rate at a mean one."""
        E0 = self.energy_for(mean, J)
        w = self.rates(E0, J)
        if w.min() == 0.0:
            return 0.0, float(w.max())

        def at(x: Array) -> tuple[Array, Array]:
            W, k, eps, half = self.between(x)
            own = np.sqrt(2.0 * np.maximum(E0 + W, 0.0) / (eps + J))
            with np.errstate(divide="ignore", invalid="ignore"):
                return own, (k - half * own * own) / (own * (eps + J))

        return extremes_of(self.x, w, (self.k - self.half_slope * w * w) / (w * (self.eps + J)), at)

    def swing(self, mean: float) -> float:
        """ΔE, what work and inertia give and take at an even rate [J]."""

        def at(x: Array) -> tuple[Array, Array]:
            W, k, eps, half = self.between(x)
            return W - 0.5 * eps * mean**2, k - half * mean**2

        own = self.W - 0.5 * self.eps * mean**2
        low, high = extremes_of(self.x, own, self.k - self.half_slope * mean**2, at)
        return high - low

    def unevenness(self, mean: float, J: float) -> float:
        """δ with a wheel J at a mean rate."""
        slowest, fastest = self.extremes(mean, J)
        return (fastest - slowest) / mean


def extremes_of(
    x: Array, values: Array, slopes: Array, at: Callable[[Array], tuple[Array, Array]]
) -> tuple[float, float]:
    """The least and the largest of a number, by its values and slopes at places (m,), and by `at` between them.

    Where a cubic through two neighbours turns the number itself is looked at, and once more where its slope leads.
    """
    steps = np.maximum(np.diff(x), 0.0)
    p, q = steps * slopes[:-1], steps * slopes[1:]
    turns = p * q < 0.0
    a, b, p, q = values[:-1][turns], values[1:][turns], p[turns], q[turns]
    begin, step = x[:-1][turns], steps[turns]
    c2, c3 = 3.0 * (b - a) - 2.0 * p - q, 2.0 * (a - b) + p + q
    s = p / (p - q)
    found = [values]
    with np.errstate(divide="ignore", invalid="ignore"):
        for _ in range(NEWTON):
            s = within(s - (p + s * (2.0 * c2 + 3.0 * c3 * s)) / (2.0 * c2 + 6.0 * c3 * s), s)
        for _ in range(LOOKS if len(s) else 0):
            value, slope = at(begin + s * step)
            found.append(value)
            s = within(s - step * slope / (2.0 * c2 + 6.0 * c3 * s), s)
    every = np.concatenate(found)
    return float(every.min()), float(every.max())


def within(s: Array, before: Array) -> Array:
    """Shares between 0 and 1; where one is no number that before it."""
    return np.asarray(np.clip(np.where(np.isfinite(s), s, before), 0.0, 1.0))


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


def flywheel(scene: LoadedScene, joint: str, mean: float, delta: float) -> Flywheel:
    """The wheel on the cycle's shaft; scene: with its loads, at unit rate.

    Raises SolveError for loads that are not told by where things are.
    """
    require_placed(scene.setup.scene.mechanism)
    numbers = of_wheel(scene)
    course, even, off = course_of(numbers, len(scene.setup.scene.mechanism.bodies))
    energy, own = course.swing(mean), float(course.weights @ course.eps_at)
    present = course.unevenness(mean, 0.0)
    added = 0.0
    if present > delta:
        most = energy / (delta * mean**2) + float(course.eps.max())
        while course.unevenness(mean, most) > delta:
            most *= 2.0
        added = root(lambda J: delta - course.unevenness(mean, J), 0.0, most)
    slowest, fastest = course.extremes(mean, added)
    E0 = course.energy_for(mean, added)
    start = float(course.rates(E0, added)[0])
    textbook = energy / (delta * mean**2) - course.steady
    errors = errors_of(off, mean, delta, energy, own + added, present)
    return Flywheel(
        joint, delta, present, mean, energy, own, added, textbook, even, start, fastest, slowest, errors, numbers.notes
    )


class WorkErrors(NamedTuple):
    """How far the even torque, the work and the reduced inertia are off."""

    even: float
    work: float
    inertia: float


def errors_of(
    off: WorkErrors, mean: float, delta: float, energy: float, inertia: float, present: float
) -> dict[str, float]:
    """How far a wheel is off, by ΔE = ∫k - ½ ε ω² and J + ε = ΔE/(δ ω²), to which all are proportional."""
    swing = 2.0 * (off.work + 0.5 * off.inertia * mean**2)
    part = swing / energy if energy > 0.0 else 0.0
    rate = swing / (inertia * mean) if inertia > 0.0 else 0.0
    return {
        "energy": swing, "even": off.even, "own": off.inertia, "present": present * part,
        "added": inertia * part + off.inertia, "textbook": swing / (delta * mean**2) + off.inertia,
        "start": rate, "fastest": rate, "slowest": rate,
    }  # fmt: skip


def of_wheel(scene: LoadedScene) -> CycleNumbers:
    """The power of loads and weight, the bodies' reduced inertia and ½ of what it changes by, over the cycle."""
    mechanism, size = scene.setup.scene.mechanism, scene.setup.scene.layout.size

    def columns(recovery: Recovery) -> Array:
        effects = mass_effects(Cycle(mechanism, scene.followed.cycle, recovery.states, size), np.zeros(3))
        return np.concatenate([torques(recovery), effects.eps, effects.half_slope], axis=1)

    bodies, first = len(mechanism.bodies), scene.at_first()
    effects = mass_effects(Cycle(mechanism, scene.followed.cycle, first.states, size), np.zeros(3))
    of_inertia = tolerances.SUM_ROUNDING * effects.terms["torque"]
    parts = [columns(first).shape[1] - 2 * bodies, bodies, bodies]
    return scene.numbers(columns, parts, [rounding_in(first), of_inertia, of_inertia])


def course_of(numbers: CycleNumbers, bodies: int) -> tuple[WorkCourse, float, WorkErrors]:
    """The course of a cycle, the even torque [N m] that closes it where that is no matter of digits, and its errors."""
    nodes, values = numbers.nodes, numbers.values
    eps_of, slopes_of = values[:, -2 * bodies : -bodies], values[:, -bodies:]
    k, eps, slope = values[:, : -2 * bodies].sum(axis=1), eps_of.sum(axis=1), slopes_of.sum(axis=1)
    left, to_and_fro = float(nodes.weights @ k), float(nodes.weights @ np.abs(k))
    even = 0.0 if abs(left) <= TYPED * to_and_fro else -left
    columns = np.stack([k - left, eps, slope], axis=1)
    own = nodes.coefficients(columns)
    work = nodes.integrals(own[:, :, :1])
    parts = np.maximum(np.ceil((nodes.ends - nodes.begins) * FINE * nodes.turns / nodes.length), LEAST_INTERVALS)
    piece = np.repeat(np.arange(len(parts)), parts.astype(int) + 1)
    share = np.concatenate([np.arange(n + 1) / n for n in parts])
    x = nodes.begins[piece] + share * (nodes.ends - nodes.begins)[piece]
    P = polynomials(2.0 * share - 1.0, own.shape[1] + 1)
    W = np.einsum("mn,mn->m", P, work[piece][:, :, 0])
    along = np.einsum("mn,mnc->mc", P[:, :-1], own[piece])
    finer = nodes.halved(HALVINGS)
    errors = nodes.errors(columns)
    rounding = tolerances.SUM_ROUNDING * float(np.abs(W).max())
    off = WorkErrors(
        float(errors.order[0]), 0.5 * nodes.length * float(errors.order[0]) + rounding, float(errors.value[1])
    )
    same = np.ptp(eps_of, axis=0) <= tolerances.SAME_VALUE * eps_of.max()
    course = WorkCourse(
        x, W, along[:, 0], along[:, 1], along[:, 2], finer.weights,
        nodes.at(work, finer.places)[:, 0], nodes.at(own, finer.places)[:, 1], float(eps_of[0, same].sum()),
        lambda at: (nodes.at(work, at)[:, 0], *nodes.at(own, at).T),
    )  # fmt: skip
    return course, even, off


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
