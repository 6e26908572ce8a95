"""The derivative of what is known within an error only, by differences.

    D(h) = (m(+h) - m(-h)) / 2h          off by m''' h^2/6, and by the noise e/h
    R    = (4 D(h/2) - D(h)) / 3         off by less than |D(h/2) - D(h)|, and by 3 e/h
    K(h) = (m(+h) - 2 m(0) + m(-h)) / h  halves with h where m is smooth, stays where it bends, doubles where it jumps

The step is the one at which what two steps differ by is about the noise: it begins at the cube root of the stated
error, and goes on from there by fours.
"""

from __future__ import annotations

from collections.abc import Callable

from heuncli.commands.sensitivity.results import NoisyDerivative, NoisyValue
from heuncli.named_tuples import NamedTuple
from heuncli.tolerances import EPS

FIRST, LARGEST, LEAST = 2.0**-8, 2.0**-4, 2.0**-24  # steps, of the number's size
ENOUGH = 1e-6  # of the derivative: an error that needs no better step
UNEQUAL = 4.0  # times the other: of noise and difference of two steps the larger one sends to the next step
MOST_MOVES = 5
BENDS, JUMPS = 0.75, 1.5  # K(h/2) / K(h): between 1/2 and 1, between 1 and 2
DOUBT = 0.1  # of a derivative: two steps that differ by more, far beyond the noise, tell of none
CLEAR = 4.0  # times its noise: what K is to be to tell of a bend
NOT_SMOOTH = "not-smooth"


class StepPair(NamedTuple):
    """Differences at a step and its half: the derivative, what both differ by, and the noise."""

    step: float
    value: float
    difference: float
    noise: float

    @property
    def error(self) -> float:
        """What the derivative may be off by."""
        return self.difference + self.noise


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

    def pair(self, h: float) -> StepPair:
        """Central differences at a step and its half."""
        whole, half = ((self.value(x) - self.value(-x)) / (2.0 * x) for x in (h, 0.5 * h))
        value = (4.0 * half - whole) / 3.0
        noise = 3.0 * self.error(h, -h, 0.5 * h, -0.5 * h) / h + abs(value) * self.rounding / h
        return StepPair(h, value, abs(half - whole), noise)

    def side(self, h: float, way: int) -> StepPair:
        """Differences on one side, at a step, its half and its quarter."""
        first, second, third = ((self.value(way * x) - self.value(0.0)) / (way * x) for x in (h, 0.5 * h, 0.25 * h))
        value, coarser = 2.0 * third - second, 2.0 * second - first
        noise = 20.0 * self.error(0.0, way * h, way * 0.5 * h, way * 0.25 * h) / h
        return StepPair(h, value, abs(value - coarser), noise + 4.0 * abs(value) * self.rounding / h)

    def bend(self, h: float) -> tuple[float, float]:
        """K at a step, and its noise."""
        found = (self.value(h) - 2.0 * self.value(0.0) + self.value(-h)) / h
        return abs(found), 4.0 * self.error(0.0, h, -h) / h


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
    while step**3 > 3.0 * relative and step > 2.0**-12:
        step *= 0.5
    return step * size


def central(about: Differences, h: float, size: float) -> NoisyDerivative:
    """By differences on both sides."""
    if all(about.value(x) == about.value(0.0) for x in (h, -h, 0.5 * h, -0.5 * h)):
        return NoisyDerivative(0.0, kind="nothing", step=h)
    best = best_pair(about.pair, lambda x: about.solved(x, -x, 0.5 * x, -0.5 * x), h, size)
    odd = not_smooth(about, best.step)
    if odd is not None:
        return odd
    if best.difference > CLEAR * best.noise and best.difference > DOUBT * abs(best.value):
        reason = (
            f"two steps differ by {best.difference:.2g} of {best.value:.3g}: it jumps or bends right beside the value"
        )
        return NoisyDerivative(None, kind="refused", why=(NOT_SMOOTH, reason), step=best.step)
    return NoisyDerivative(best.value, best.error, step=best.step)


def one_sided(about: Differences, h: float, way: int, size: float) -> NoisyDerivative:
    """By differences on the side that is solved."""
    best = best_pair(
        lambda x: about.side(x, way), lambda x: about.solved(*(0.25 * x * way * k for k in (1, 2, 4))), h, size
    )
    why = about.ask(-way * h).why
    if best.difference > CLEAR * best.noise and best.difference > DOUBT * abs(best.value):
        return NoisyDerivative(None, kind="refused", why=why, step=best.step)
    return NoisyDerivative(best.value, best.error, "one-sided", why, step=best.step)


def best_pair(pair: Callable[[float], StepPair], solved: Callable[[float], bool], h: float, size: float) -> StepPair:
    """The differences with the least error, at steps that go where the larger share of it becomes less."""
    best = pair(h)
    for _ in range(MOST_MOVES):
        if best.error <= ENOUGH * abs(best.value):
            break
        if best.difference > UNEQUAL * best.noise:
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


def not_smooth(about: Differences, h: float) -> NoisyDerivative | None:
    """What is told where the measure bends or jumps at the number itself; None: it does not."""
    (whole, _), (half, noise) = about.bend(h), about.bend(0.5 * h)
    if half <= CLEAR * noise or half <= BENDS * whole or not about.solved(0.25 * h, -0.25 * h):
        return None
    quarter, noise = about.bend(0.25 * h)
    if quarter <= CLEAR * noise or quarter <= BENDS * half:
        return None
    if quarter > JUMPS * half:
        change = quarter * 0.25 * h
        return NoisyDerivative(
            None, kind="refused", why=(NOT_SMOOTH, f"it jumps at the value, by {change:.3g}"), step=h
        )
    left, right = about.side(h, -1), about.side(h, 1)
    ends = (left.value, left.error), (right.value, right.error)
    reason = "it bends at the value: left and right of it the derivatives differ"
    return NoisyDerivative(None, kind="kink", why=("kink", reason), left=ends[0], right=ends[1], step=h)
