"""The derivative of what is known within an error only, by differences.

    D(h) = (m(+h) - m(-h)) / 2h          off by m''' h^2/6, and by the noise e/h
    R    = (4 D(h/2) - D(h)) / 3         off by less than |D(h/2) - D(h)|, and by 3 e/h
    K(h) = (m(+h) - 2 m(0) + m(-h)) / h  halves with h where m is smooth, stays where it bends, doubles where it jumps
    X    = K(h/2) - K(h)/2               of third order where m is smooth; known within 8 e/h

If m bends by J at c, within the step, R is off by J (1/2 - 7c/6h) at c < h/2, else by J (1 - c/h)/6, and that is never
more than |D(h/2) - D(h)| + |X|: the error that is told holds both, and the noise of both. A third step, of no simple
ratio to the first, tells whether D goes with h^2 between them: waves shorter than the step do not.

The step is the one at which what two steps differ by is about the noise: it begins at the cube root of the stated
error, and goes on from there by fours. Where m bends or jumps, smaller ones tell whether at the value or beside it.
"""

from __future__ import annotations

from collections.abc import Callable

from heuncli.analyses.sensitivity.results import NoisyDerivative, NoisyValue
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.tolerances import EPS

FIRST, LARGEST, LEAST = 2.0**-8, 2.0**-4, 2.0**-24  # steps, of the number's size
ENOUGH = 1e-6  # of the derivative: an error that needs no better step
UNEQUAL = 4.0  # times the other: of noise and difference of two steps the larger one sends to the next step
MOST_MOVES = 5
BENDS, JUMPS = 0.75, 1.5  # K(h/2) / K(h): between 1/2 and 1, between 1 and 2
DOUBT = 0.1  # of a derivative on one side: two steps that differ by more, far beyond the noise, tell of none
CLEAR = 4.0  # times its noise: what K or X is to be to tell of a bend
BETWEEN = 0.37  # of a step: the third one
STEADY = 0.3  # of what two steps differ by: how far the third may be off h^2 between them
CLOSER = 1.0 / 16.0  # of a step: the next one towards what bends or jumps
NOISES = 3.0 + 8.0  # times e/h: the noise of R and of X
NOT_SMOOTH = "not-smooth"


class StepPair(NamedTuple):
    """Differences at a step and its half: the derivative, what both differ by, the noise, and |X|."""

    step: float
    value: float
    difference: float
    noise: float
    excess: float = 0.0

    @property
    def error(self) -> float:
        """What the derivative may be off by."""
        return self.difference + self.noise + self.excess


class Differences:
    """Differences of a measure about a number; ask: the measure at a distance from it."""

    def __init__(self, ask: Callable[[float], NoisyValue], at: float) -> None:
        """at: the number itself, which rounds its distances."""
        self.ask, self.rounding = ask, 4.0 * EPS * abs(at)
        self.base = ask(0.0)

    def solved(self, *distances: float) -> bool:
        """Whether there is a measure at all of these."""
        return all(self.ask(each).value is not None for each in distances)

    def value(self, distance: float) -> float:
        """The measure at a distance, where there is one."""
        found = self.ask(distance).value
        assert found is not None
        return found

    def error(self, *distances: float) -> float:
        """The largest error there."""
        return max(self.ask(each).error for each in distances)

    def central(self, h: float) -> float:
        """D at a step."""
        return (self.value(h) - self.value(-h)) / (2.0 * h)

    def curved(self, h: float) -> float:
        """K at a step, with its sign."""
        return (self.value(h) - 2.0 * self.value(0.0) + self.value(-h)) / h

    def pair(self, h: float) -> StepPair:
        """Central differences at a step and its half."""
        whole, half = self.central(h), self.central(0.5 * h)
        value = (4.0 * half - whole) / 3.0
        error = self.error(0.0, h, -h, 0.5 * h, -0.5 * h) + 0.25 * abs(value) * self.rounding
        excess = abs(self.curved(0.5 * h) - 0.5 * self.curved(h))
        return StepPair(h, value, abs(half - whole), NOISES * error / h, excess)

    def steady(self, pair: StepPair) -> bool:
        """Whether D goes with the square of the step up to a third one, as far as the error leaves it open."""
        between = BETWEEN * pair.step
        if not self.solved(between, -between):
            return False
        expected = pair.value + BETWEEN**2 * (self.central(pair.step) - pair.value)
        off = abs(self.central(between) - expected)
        return off <= STEADY * pair.difference + pair.excess + pair.noise

    def side(self, h: float, way: int, start: float = 0.0) -> StepPair:
        """Differences on one side, from a distance on as they are at the number: at a step, its half, its quarter."""
        base = self.value(way * start)
        ends = [way * (start + x) for x in (h, 0.5 * h, 0.25 * h)]
        first, second, third = (
            (self.value(x) - base) / (way * step) for x, step in zip(ends, (h, 0.5 * h, 0.25 * h), strict=True)
        )
        value, coarser = 2.0 * third - second, 2.0 * second - first
        noise = 20.0 * self.error(way * start, *ends) / h + 4.0 * abs(value) * self.rounding / h
        shift = start * 8.0 * abs(third - second) / h  # the second derivative, over the distance
        return StepPair(h, value, abs(value - coarser) + shift, noise)

    def bend(self, h: float) -> tuple[float, float]:
        """|K| at a step, and its noise."""
        return abs(self.curved(h)), 4.0 * self.error(0.0, h, -h) / h


def derivative(ask: Callable[[float], NoisyValue], at: float, size: float) -> NoisyDerivative:
    """dm/dp at a number; ask: m at a distance from it; size: over which the number is expected to matter."""
    about = Differences(ask, at)
    if about.base.value is None:
        return NoisyDerivative(None, kind="refused", why=about.base.why)
    h = first_step(about.base, size)
    for _ in range(2):
        below, above = about.solved(-h, -0.5 * h), about.solved(h, 0.5 * h)
        if below and above:
            return central(about, h, size)
        if (below or above) and about.solved(*(0.25 * h * (1 if above else -1) * k for k in (1, 2, 4))):
            return one_sided(about, h, 1 if above else -1, size)
        h /= 64.0
    return NoisyDerivative(None, kind="refused", why=ask(64.0 * h).why)


def first_step(base: NoisyValue, size: float) -> float:
    """Where the error of the run balances a third derivative of the measure's own size, as a power of two of `size`."""
    relative = base.error / abs(base.value) if base.value else 0.0
    step = FIRST
    while step**3 > 8.0 * NOISES * relative and step > 2.0**-12:
        step *= 0.5
    return step * size


def central(about: Differences, h: float, size: float) -> NoisyDerivative:
    """By differences on both sides."""
    if all(about.value(x) == about.value(0.0) for x in (h, -h, 0.5 * h, -0.5 * h)):
        return NoisyDerivative(0.0, kind="nothing", step=h)
    tried = [best_pair(about.pair, lambda x: about.solved(x, -x, 0.5 * x, -0.5 * x), h, size)]
    steady = [each for each in tried if about.steady(each)]
    if not steady or tried[0].excess > max(tried[0].noise, tried[0].difference) or bends(about, tried[0], 1.0):
        tried += closer(about, tried[0], size)
        steady = [each for each in tried if about.steady(each)]
    best = min(steady, key=lambda each: each.error, default=None)
    if best is None or (best.excess > CLEAR * best.noise and any(bends(about, each, CLEAR) for each in tried)):
        return not_smooth(about, tried, size)
    return NoisyDerivative(best.value, best.error, step=best.step)


def bends(about: Differences, pair: StepPair, clear: float) -> bool:
    """Whether K stays or grows from a step to its half, by so many times its noise."""
    (whole, _), (half, noise) = about.bend(pair.step), about.bend(0.5 * pair.step)
    return pair.excess > clear * pair.noise and half > max(clear * noise, BENDS * whole)


def closer(about: Differences, first: StepPair, size: float) -> list[StepPair]:
    """Differences at smaller steps, until the noise is more than the error of the first, or than all else."""
    found: list[StepPair] = []
    h = CLOSER * first.step
    while h >= LEAST * size and about.solved(h, -h, 0.5 * h, -0.5 * h):
        found.append(about.pair(h))
        if found[-1].noise > max(found[-1].difference, found[-1].excess):
            break
        h *= CLOSER
    return found


def one_sided(about: Differences, h: float, way: int, size: float) -> NoisyDerivative:
    """By differences on the side that is solved, at smaller steps where these tell of another derivative.

    From one side a bend at c does not show at steps of many c: they tell of what is beyond. So smaller ones are asked
    until they drown in noise; what these differ by, as far as they are known as well, is part of the error.
    """

    def solved(x: float) -> bool:
        return about.solved(*(0.25 * x * way * k for k in (1, 2, 4)))

    best = best_pair(lambda x: about.side(x, way), solved, h, size)
    most, apart, h = abs(best.value), 0.0, 0.25 * best.step
    while h >= LEAST * size and solved(h):
        found = about.side(h, way)
        most = max(most, abs(found.value))
        if found.noise > most:
            break
        differ = abs(found.value - best.value)
        if differ > found.error + best.error or found.error < best.error:
            best, apart = found, 0.0
        elif found.error <= UNEQUAL * best.error:
            apart = max(apart, differ)
        h *= 0.25
    why = about.ask(-way * best.step).why
    if best.difference > CLEAR * best.noise and best.difference > DOUBT * abs(best.value):
        return NoisyDerivative(None, kind="refused", why=why, step=best.step)
    return NoisyDerivative(best.value, best.error + apart, "one-sided", why, step=best.step)


def best_pair(pair: Callable[[float], StepPair], solved: Callable[[float], bool], h: float, size: float) -> StepPair:
    """The differences with the least error, at steps that go where the larger share of it becomes less."""
    best = pair(h)
    for _ in range(MOST_MOVES):
        if best.error <= ENOUGH * abs(best.value):
            break
        if best.difference + best.excess > UNEQUAL * best.noise:
            h *= 0.25
        elif best.noise > UNEQUAL * best.difference:
            h *= 4.0
        else:
            break
        if not LEAST * size <= h <= LARGEST * size or not solved(h):
            break
        found = pair(h)
        if found.error >= best.error:
            break
        best = found
    return best


def not_smooth(about: Differences, tried: list[StepPair], size: float) -> NoisyDerivative:
    """What is told where the measure bends or jumps within the steps that were tried, the largest first."""
    clear = [each for each in tried if bends(about, each, CLEAR)]
    step = min(clear or tried, key=lambda each: each.step).step
    near = 0.5 * step
    (whole, _), (half, _) = about.bend(step), about.bend(near)
    if clear and half > JUMPS * whole:
        return refusal(f"it jumps within {near:.2g} of the value, by {half * near:.3g}", step)
    sides = [beyond(about, way, near, tried[0].step, size) for way in (-1, 1)]
    most = max((abs(each.value) for each in sides if each), default=0.0)
    ends = [(each.value, each.error) for each in sides if each and is_told(each, most)]
    if not clear or len(ends) < 2:
        differ = f"two steps differ by {tried[0].difference:.2g} of {tried[0].value:.3g}"
        return refusal(f"{differ}: it jumps, bends or swings within {step:.2g} of the value", step)
    reason = f"it bends within {near:.2g} of the value: left and right of that the derivatives differ"
    return NoisyDerivative(None, kind="kink", why=("kink", reason), left=ends[0], right=ends[1], step=near)


def beyond(about: Differences, way: int, near: float, h: float, size: float) -> StepPair | None:
    """The derivative on one side of a distance within which the measure bends; None where it is not solved."""

    def solved(x: float) -> bool:
        return about.solved(*(way * (near + x * part) for part in (0.0, 0.25, 0.5, 1.0)))

    return best_pair(lambda x: about.side(x, way, near), solved, h, size) if solved(h) else None


def is_told(side: StepPair, most: float) -> bool:
    """Whether two steps on a side tell of a derivative; most: the largest on both."""
    return side.difference <= max(CLEAR * side.noise, DOUBT * most)


def refusal(reason: str, step: float) -> NoisyDerivative:
    """No derivative, for that reason."""
    return NoisyDerivative(None, kind="refused", why=(NOT_SMOOTH, reason), step=step)
