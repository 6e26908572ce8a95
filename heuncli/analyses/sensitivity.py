"""Derivatives of measures by numbers of a spec, where a measure is known only within an error: by finite differences.

A measure m of a number p is known within an error e. At a step h:
    D(h) = (m(p+h) - m(p-h)) / 2h             central difference
    K(h) = (m(p+h) - 2 m(p) + m(p-h)) / h     change of the chords' slopes at p: of order h where m is smooth
    difference = |D(h/2) - D(h)|              error of (4 D(h/2) - D(h)) / 3, the derivative
    excess = |K(h/2) - K(h)/2|                0 where m is smooth; at a kink half of the jump of the slope
The step is chosen so that the difference is about the noise, a multiple of e/h: it begins at the cube root of the
stated error and changes by factors of four. Where m has a kink or a jump, smaller steps show whether it is at the value
or near it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

from heuncli.analyses.variants.measures import NoisyValue, Reason
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.tolerances import EPS

DerivativeKind = Literal["", "nothing", "one-sided", "kink", "refused"]


class BoundedValue(NamedTuple):
    """A number and its error."""

    value: float
    error: float


class NoisyDerivative(NamedTuple):
    """dm/dp within an error, in units of m and p.

    kind: empty for an ordinary derivative; "nothing" if m does not depend on p; "one-sided" if m exists on one side
    only; "kink", with the derivatives on both sides in `left` and `right`; "refused", with the reason in `why`
    step: half the distance of the variants used; at a kink, how far from the number it may be
    """

    value: float | None
    error: float = 0.0
    kind: DerivativeKind = ""
    why: Reason = Reason()
    left: BoundedValue | None = None
    right: BoundedValue | None = None
    step: float = 0.0


BELOW, ABOVE = -1, 1  # the side of the number; the numbers are signs of the distance
FIRST_STEP, MAX_STEP, MIN_STEP = 2.0**-8, 2.0**-4, 2.0**-24  # steps, relative to the number's size
MIN_FIRST_STEP = 2.0**-12  # the first step is no smaller, however large the run's error
SUFFICIENT_ERROR = 1e-6  # error relative to the derivative, small enough to keep the step
IMBALANCE = 4.0  # ratio of noise and difference of two steps above which the step is changed
STEP_CHANGE = 4.0  # factor by which it is changed
MAX_STEP_CHANGES = 5
EDGE_REDUCTION = 64.0  # factor by which the step shrinks once, if no side has values at the first one
KINK_RATIO = 0.75  # K(h/2) / K(h) of a kink, at least: 1/2 where m is smooth, 1 at a kink
JUMP_RATIO = 1.5  # K(h/2) / K(h) of a jump, at least: 1 at a kink, 2 at a jump
# difference of two steps relative to a one-sided derivative: above it, and far above the noise, there is no derivative
MAX_DISAGREEMENT = 0.1
SIGNIFICANCE = 4.0  # ratio of K or of the excess to its noise that shows a kink
THIRD_STEP = 0.37  # third step, relative to the first of a pair
# deviation of D at the third step from a parabola through the other two, relative to their difference
MAX_DEVIATION = 0.3
STEP_REDUCTION = 1.0 / 16.0  # ratio of each step to the one before, towards a kink or a jump
# noise of a pair in units of e/h: sums of the factors of all values, 3 for the difference, 8 for the excess
NOISE_FACTOR = 3.0 + 8.0
# noise of a one-sided pair in units of e/h: twice the chord over h/4, of 8 e/h, and that over h/2, of 4 e/h
SIDE_NOISE_FACTOR = 2.0 * 8.0 + 4.0
SLOPE_CHANGE_NOISE_FACTOR = 4.0  # noise of K in units of e/h
NOT_SMOOTH_CODE = "not-smooth"


class StepPair(NamedTuple):
    """Differences over a step and its half: the derivative, and the parts of its error.

    value: derivative extrapolated from both
    difference: |D(h/2) - D(h)|
    noise: effect of the errors of the measure
    excess: |K(h/2) - K(h)/2|; 0 on one side, where it is unknown
    """

    step: float
    value: float
    difference: float
    noise: float
    excess: float = 0.0

    @property
    def error(self) -> float:
        """Error bound of the derivative."""
        return self.difference + self.noise + self.excess


class Differences:
    """Finite differences of a measure about a number.

    evaluate: gives the measure at a distance from the number
    rounding: by how much a distance differs from the requested one, because the number is rounded
    base: the measure at the number itself
    """

    def __init__(self, evaluate: Callable[[float], NoisyValue], number: float) -> None:
        """number: the centre, whose rounding limits the distances"""
        self.evaluate, self.rounding = evaluate, 4.0 * EPS * abs(number)
        self.base = evaluate(0.0)

    def has_values(self, *distances: float) -> bool:
        """Return whether the measure exists at all these distances."""
        return all(self.evaluate(distance).value is not None for distance in distances)

    def has_central_values(self, step: float) -> bool:
        """Return whether the measure exists on both sides at a step and its half."""
        return self.has_values(step, -step, 0.5 * step, -0.5 * step)

    def has_side_values(self, step: float, side: int) -> bool:
        """Return whether the measure exists on one side at a step, its half and its quarter."""
        return self.has_values(*(0.25 * step * side * k for k in (1, 2, 4)))

    def get_value(self, distance: float) -> float:
        """Return the measure at a distance; it must exist."""
        value = self.evaluate(distance).value
        assert value is not None
        return value

    def get_largest_error(self, *distances: float) -> float:
        """Return the largest error at these distances."""
        return max(self.evaluate(distance).error for distance in distances)

    def compute_central_difference(self, step: float) -> float:
        """Return the central difference D at a step."""
        return (self.get_value(step) - self.get_value(-step)) / (2.0 * step)

    def compute_slope_change(self, step: float) -> float:
        """Return K, the change of the chords' slopes from one side of the number to the other."""
        return (self.get_value(step) - 2.0 * self.get_value(0.0) + self.get_value(-step)) / step

    def compute_pair(self, step: float) -> StepPair:
        """Return the central differences at a step and its half."""
        full_step, half_step = self.compute_central_difference(step), self.compute_central_difference(0.5 * step)
        value = (4.0 * half_step - full_step) / 3.0
        error = self.get_largest_error(0.0, step, -step, 0.5 * step, -0.5 * step) + 0.25 * abs(value) * self.rounding
        excess = abs(self.compute_slope_change(0.5 * step) - 0.5 * self.compute_slope_change(step))
        return StepPair(step, value, abs(half_step - full_step), NOISE_FACTOR * error / step, excess)

    def is_quadratic(self, pair: StepPair) -> bool:
        """Return whether D is quadratic in the step at a third one, within the error."""
        third_step = THIRD_STEP * pair.step
        if not self.has_values(third_step, -third_step):
            return False
        expected = pair.value + THIRD_STEP**2 * (self.compute_central_difference(pair.step) - pair.value)
        deviation = abs(self.compute_central_difference(third_step) - expected)
        return deviation <= MAX_DEVIATION * pair.difference + pair.excess + pair.noise

    def compute_side_pair(self, step: float, side: int, start: float = 0.0) -> StepPair:
        """Return the differences on one side over a step, its half and its quarter, extrapolated to the number.

        start: distance from the number at which the steps begin
        """
        base, lengths = self.get_value(side * start), (step, 0.5 * step, 0.25 * step)
        ends = [side * (start + length) for length in lengths]
        first, second, third = (
            (self.get_value(end) - base) / (side * length) for end, length in zip(ends, lengths, strict=True)
        )
        value, coarser = 2.0 * third - second, 2.0 * second - first
        error = self.get_largest_error(side * start, *ends)
        noise = SIDE_NOISE_FACTOR * error / step + 4.0 * abs(value) * self.rounding / step
        shift = start * 8.0 * abs(third - second) / step  # by the second derivative, over the start distance
        return StepPair(step, value, abs(value - coarser) + shift, noise)

    def measure_slope_change(self, step: float) -> tuple[float, float]:
        """Return |K| at a step, and its noise."""
        error = self.get_largest_error(0.0, step, -step)
        return abs(self.compute_slope_change(step)), SLOPE_CHANGE_NOISE_FACTOR * error / step


def compute_derivative(evaluate: Callable[[float], NoisyValue], number: float, size: float) -> NoisyDerivative:
    """Compute dm/dp at a number.

    evaluate: function that gives m at a distance from the number
    size: range over which the number is expected to change the measure; all steps are relative to it
    """
    differences = Differences(evaluate, number)
    if differences.base.value is None:
        return NoisyDerivative(None, kind="refused", why=differences.base.why)
    step = choose_first_step(differences.base, size)
    for _ in range(2):
        has_below, has_above = differences.has_values(-step, -0.5 * step), differences.has_values(step, 0.5 * step)
        if has_below and has_above:
            return compute_central(differences, step, size)
        side = ABOVE if has_above else BELOW
        if (has_below or has_above) and differences.has_side_values(step, side):
            return compute_one_sided(differences, step, side, size)
        step /= EDGE_REDUCTION
    return NoisyDerivative(None, kind="refused", why=evaluate(EDGE_REDUCTION * step).why)


def choose_first_step(base: NoisyValue, size: float) -> float:
    """Return `size` times the power of two at which the run's error balances a third derivative of its own size."""
    relative = base.error / abs(base.value) if base.value else 0.0
    step = FIRST_STEP
    while step**3 > 8.0 * NOISE_FACTOR * relative and step > MIN_FIRST_STEP:
        step *= 0.5
    return step * size


def compute_central(differences: Differences, step: float, size: float) -> NoisyDerivative:
    """Compute the derivative by differences on both sides."""
    if all(differences.get_value(x) == differences.get_value(0.0) for x in (step, -step, 0.5 * step, -0.5 * step)):
        return NoisyDerivative(0.0, kind="nothing", step=step)
    pairs = [find_best_pair(differences.compute_pair, differences.has_central_values, step, size)]
    quadratic = [each for each in pairs if differences.is_quadratic(each)]
    if (
        not quadratic
        or pairs[0].excess > max(pairs[0].noise, pairs[0].difference)
        or has_kink(differences, pairs[0], 1.0)
    ):
        pairs += compute_smaller_steps(differences, pairs[0], size)
        quadratic = [each for each in pairs if differences.is_quadratic(each)]
    best = min(quadratic, key=lambda each: each.error, default=None)
    if best is None or (
        best.excess > SIGNIFICANCE * best.noise and any(has_kink(differences, each, SIGNIFICANCE) for each in pairs)
    ):
        return describe_kink_or_jump(differences, pairs, size)
    return NoisyDerivative(best.value, best.error, step=best.step)


def has_kink(differences: Differences, pair: StepPair, significance: float) -> bool:
    """Return whether K stays or grows from a step to its half, by more than `significance` times its noise."""
    full_change, _ = differences.measure_slope_change(pair.step)
    half_change, noise = differences.measure_slope_change(0.5 * pair.step)
    return pair.excess > significance * pair.noise and half_change > max(significance * noise, KINK_RATIO * full_change)


def compute_smaller_steps(differences: Differences, first_pair: StepPair, size: float) -> list[StepPair]:
    """Compute differences at smaller steps, until the noise exceeds all else."""
    pairs: list[StepPair] = []
    step = STEP_REDUCTION * first_pair.step
    while step >= MIN_STEP * size and differences.has_central_values(step):
        pairs.append(differences.compute_pair(step))
        if pairs[-1].noise > max(pairs[-1].difference, pairs[-1].excess):
            break
        step *= STEP_REDUCTION
    return pairs


def compute_one_sided(differences: Differences, step: float, side: int, size: float) -> NoisyDerivative:
    """Compute the derivative on the side that has values, at smaller steps if these give another derivative.

    From one side, a kink at c does not show at steps much larger than c: they give the derivative beyond it. So smaller
    steps are tried until noise dominates; their disagreement, as far as it is significant, is part of the error.
    """

    def has_step(x: float) -> bool:
        """Return whether the side has values at a step."""
        return differences.has_side_values(x, side)

    best = find_best_pair(lambda x: differences.compute_side_pair(x, side), has_step, step, size)
    largest, disagreement, step = abs(best.value), 0.0, best.step / STEP_CHANGE
    while step >= MIN_STEP * size and has_step(step):
        pair = differences.compute_side_pair(step, side)
        largest = max(largest, abs(pair.value))
        if pair.noise > largest:
            break
        difference = abs(pair.value - best.value)
        if difference > pair.error + best.error or pair.error < best.error:
            best, disagreement = pair, 0.0
        elif pair.error <= IMBALANCE * best.error:
            disagreement = max(disagreement, difference)
        step /= STEP_CHANGE
    why = differences.evaluate(-side * best.step).why
    if best.difference > SIGNIFICANCE * best.noise and best.difference > MAX_DISAGREEMENT * abs(best.value):
        return NoisyDerivative(None, kind="refused", why=why, step=best.step)
    return NoisyDerivative(best.value, best.error + disagreement, "one-sided", why, step=best.step)


def find_best_pair(
    compute_pair: Callable[[float], StepPair], has_step: Callable[[float], bool], step: float, size: float
) -> StepPair:
    """Find the differences with the least error, changing the step so that the larger part of the error decreases."""
    best = compute_pair(step)
    for _ in range(MAX_STEP_CHANGES):
        if best.error <= SUFFICIENT_ERROR * abs(best.value):
            break
        if best.difference + best.excess > IMBALANCE * best.noise:
            step /= STEP_CHANGE
        elif best.noise > IMBALANCE * best.difference:
            step *= STEP_CHANGE
        else:
            break
        if not MIN_STEP * size <= step <= MAX_STEP * size or not has_step(step):
            break
        next_pair = compute_pair(step)
        if next_pair.error >= best.error:
            break
        best = next_pair
    return best


def describe_kink_or_jump(differences: Differences, pairs: list[StepPair], size: float) -> NoisyDerivative:
    """Return the result for a measure with a kink or a jump within the steps that were tried, the largest first."""
    kinked = [each for each in pairs if has_kink(differences, each, SIGNIFICANCE)]
    step = min(kinked or pairs, key=lambda each: each.step).step
    distance = 0.5 * step
    (full_change, _), (half_change, _) = (differences.measure_slope_change(x) for x in (step, distance))
    if kinked and half_change > JUMP_RATIO * full_change:
        return make_refusal(f"jump of {half_change * distance:.3g} within {distance:.2g} of the value", step)
    sides = [compute_outside(differences, side, distance, pairs[0].step, size) for side in (BELOW, ABOVE)]
    largest = max((abs(each.value) for each in sides if each), default=0.0)
    side_derivatives = [BoundedValue(each.value, each.error) for each in sides if each and is_determined(each, largest)]
    if not kinked or len(side_derivatives) < 2:
        difference_text = f"two step sizes differ by {pairs[0].difference:.2g} of {pairs[0].value:.3g}"
        return make_refusal(f"{difference_text}: jump, kink or oscillation within {step:.2g} of the value", step)
    reason = f"kink within {distance:.2g} of the value: the derivatives on its two sides differ"
    return NoisyDerivative(
        None,
        kind="kink",
        why=Reason("kink", reason),
        left=side_derivatives[0],
        right=side_derivatives[1],
        step=distance,
    )


def compute_outside(differences: Differences, side: int, distance: float, step: float, size: float) -> StepPair | None:
    """Return the derivative on one side, beyond a distance within which the measure has a kink; None without values."""

    def has_step(x: float) -> bool:
        """Return whether the measure is known at all places of a step."""
        return differences.has_values(*(side * (distance + x * part) for part in (0.0, 0.25, 0.5, 1.0)))

    return (
        find_best_pair(lambda x: differences.compute_side_pair(x, side, distance), has_step, step, size)
        if has_step(step)
        else None
    )


def is_determined(pair: StepPair, largest: float) -> bool:
    """Return whether two steps on a side agree on a derivative; largest: the largest on both sides."""
    return pair.difference <= max(SIGNIFICANCE * pair.noise, MAX_DISAGREEMENT * largest)


def make_refusal(reason: str, step: float) -> NoisyDerivative:
    """Return a result without a derivative, with the reason."""
    return NoisyDerivative(None, kind="refused", why=Reason(NOT_SMOOTH_CODE, reason), step=step)
