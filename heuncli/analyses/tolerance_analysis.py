"""Combine the effects of the tolerances of several numbers on a measure, as given by `--spread`.

A number whose variants lie on the line of its derivative contributes derivative times tolerance. Otherwise the extremes
within its tolerance are searched. The contributions add up to the worst case, and by their squares; variants with
several numbers at once check the sum.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from heuncli.analyses.sensitivity import BoundedValue, NoisyDerivative
from heuncli.analyses.variants.course import MeasureCourse, SampleLimitError
from heuncli.analyses.variants.course_extremes import GREATEST, LEAST, find_extreme, refine_extreme
from heuncli.analyses.variants.measures import NoisyValue, Reason
from heuncli.analyses.variants.parameters import AxisError, split_at_commas, split_name
from heuncli.analyses.variants.samples import Sample, make_sample
from heuncli.analyses.variants.spec_numbers import SpecNumber, SpecNumbers
from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.units import describe, parse_unit
from heuncli.scene.file_format.quantity import parse_number_with_unit

LINEARITY_TOLERANCE = 0.05  # relative difference from the change that the derivative predicts
INNER_FRACTION = 0.61  # share of a tolerance: inner places between its ends and the value
SCAN_COUNT, MAX_VARIANTS = 9, 60  # variants over a tolerance range that is searched: at first, and in all
EXTREME_TOLERANCE = 1e-3  # share of the range of the measure: error of its extremes
MAX_STEPS = 30  # towards one extreme
MAX_ROUNDS = 3  # through all numbers, one by one


class NumberSpread(NamedTuple):
    """A number and its tolerance, each way, in its unit."""

    number: SpecNumber
    size: float


class ChangeAt(NamedTuple):
    """The change of a measure at a distance of a number from its value."""

    distance: float
    change: float


class Contribution(NamedTuple):
    """Effect of one number's tolerance on a measure: by the derivative, and by the variants within it.

    size: largest known change, within an error; None if unknown
    linear: change predicted by the derivative; below, above: changes at the ends, None if unsolved
    is_nonlinear: the variants do not lie on the derivative's line; the tolerance was then searched with `variants`
    variants for `least` and `greatest`, the extremes
    why: the reason if a part of the tolerance range cannot be solved
    """

    name: str
    spread: float
    unit: str
    size: float | None
    error: float
    linear: float | None
    below: float | None
    above: float | None
    is_nonlinear: bool = False
    least: ChangeAt | None = None
    greatest: ChangeAt | None = None
    variants: int = 0
    why: Reason = Reason()


class SpreadSum(NamedTuple):
    """Combined effect of all tolerances on a measure, each way: worst case and root sum of squares; None if unknown.

    corners: the measure with every number where it lowers it most, and where it raises it most
    by_variant: the worst case comes from a variant, as that exceeds the sum
    largest: the largest change of a variant of several numbers
    """

    contributions: tuple[Contribution, ...]
    worst: BoundedValue | None
    square: BoundedValue | None
    corners: tuple[NoisyValue, NoisyValue]
    by_variant: bool = False
    largest: BoundedValue | None = None


class SpreadExtremes(NamedTuple):
    """Effect of one number within its tolerance, with the distances at which the measure is smallest and largest."""

    contribution: Contribution
    lowest_at: float
    highest_at: float


Evaluate = Callable[[Mapping[str, float]], NoisyValue]  # the measure, for given distances of numbers from their values


def combine_tolerances(
    evaluate: Evaluate, spreads: Sequence[NumberSpread], slopes: Mapping[str, NoisyDerivative]
) -> SpreadSum:
    """Combine the tolerances of several numbers.

    evaluate: the measure with numbers at given distances from their values, by name
    slopes: dm/dp by name
    """
    base = evaluate({})
    extremes = [find_tolerance_extremes(evaluate, base, spread, slopes[spread.number.name]) for spread in spreads]
    contributions = tuple(entry.contribution for entry in extremes)
    lowest = {entry.contribution.name: entry.lowest_at for entry in extremes}
    highest = {entry.contribution.name: entry.highest_at for entry in extremes}
    corners = evaluate(lowest), evaluate(highest)
    changes = [compute_change(corner, base) for corner in corners]
    is_nonlinear = any(entry.is_nonlinear or entry.why.code for entry in contributions)
    if is_nonlinear and len(contributions) > 1:
        changes += [
            climb_from_corner(evaluate, base, spreads, start, sign) for start, sign in ((lowest, -1.0), (highest, 1.0))
        ]
    largest = max((change for change in changes if change is not None), key=lambda each: abs(each.value), default=None)
    sizes = [BoundedValue(entry.size, entry.error) for entry in contributions if entry.size is not None]
    if len(sizes) < len(contributions):
        return SpreadSum(contributions, None, None, corners)
    worst = BoundedValue(sum(each.value for each in sizes), sum(each.error for each in sizes))
    root = math.sqrt(sum(each.value * each.value for each in sizes))
    root_error = sum(each.value * each.error for each in sizes) / root if root else None
    by_variant = largest is not None and abs(largest.value) > worst.value
    if by_variant and largest is not None:
        worst = BoundedValue(abs(largest.value), largest.error + worst.error + abs(largest.value) - worst.value)
    square = BoundedValue(root, worst.error if root_error is None else root_error)
    return SpreadSum(contributions, worst, square, corners, by_variant, largest)


def find_tolerance_extremes(
    evaluate: Evaluate, base: NoisyValue, spread: NumberSpread, slope: NoisyDerivative
) -> SpreadExtremes:
    """Return the effect of one number's tolerance on a measure."""
    name, t = spread.number.name, spread.size
    linear = abs(slope.value) * t if slope.value is not None else None
    variants: dict[float, NoisyValue] = {
        x: evaluate({name: x}) for x in (-t, -INNER_FRACTION * t, INNER_FRACTION * t, t)
    }
    changes = {x: change for x, variant in variants.items() if (change := compute_change(variant, base)) is not None}
    below, above = (changes[x].value if x in changes else None for x in (-t, t))
    why = next((variant.why for variant in variants.values() if variant.value is None), Reason())
    labels = name, t, spread.number.unit
    if (
        len(changes) == len(variants)
        and slope.value is not None
        and all(matches_derivative(slope, x, change) for x, change in changes.items())
    ):
        size, error = max((abs(value), noise) for value, noise in changes.values())
        size, error = max((size, error), (linear or 0.0, slope.error * t))
        error += max(abs(value - slope.value * x) for x, (value, _) in changes.items())  # it may be more between them
        upper = math.copysign(t, slope.value)
        return SpreadExtremes(Contribution(*labels, size, error, linear, below, above), -upper, upper)
    if base.value is None or not changes:
        return SpreadExtremes(Contribution(*labels, None, 0.0, linear, below, above, True, why=why), -t, t)
    found = search_extremes(evaluate, base, name, t)
    low, high = found.lowest, found.highest
    contribution = Contribution(
        *labels,
        size=max(-low.gap_or_zero, high.gap_or_zero),
        error=max(low.error, high.error) + base.error + found.missing,
        linear=linear,
        below=below,
        above=above,
        is_nonlinear=True,
        least=ChangeAt(low.x, low.gap_or_zero),
        greatest=ChangeAt(high.x, high.gap_or_zero),
        variants=found.variants,
        why=why,
    )
    return SpreadExtremes(contribution, low.x, high.x)


class SearchedExtremes(NamedTuple):
    """The variants with the smallest and the largest change within a tolerance.

    missing: by how much the search may have missed the true extremes; infinite if it was cut short
    variants: how many were solved
    """

    lowest: Sample
    highest: Sample
    missing: float
    variants: int


def search_extremes(evaluate: Evaluate, base: NoisyValue, name: str, t: float) -> SearchedExtremes:
    """Search the smallest and the largest change within a tolerance t of a number."""
    assert base.value is not None  # the tolerance is only searched around a solved variant
    value = base.value

    def evaluate_sample(x: float) -> Sample:
        """Sample the measure at a distance from the number's value."""
        return make_sample(x, evaluate({name: x} if x else {}), value)

    course = MeasureCourse(evaluate_sample, -t, t, SCAN_COUNT, MAX_VARIANTS, value)
    missing = math.inf
    try:
        course.scan()
        for x in (0.0, -INNER_FRACTION * t, INNER_FRACTION * t):
            course.sample_at(x)
        missing = max(
            max(refine_extreme(course, sign, share=EXTREME_TOLERANCE, max_steps=MAX_STEPS), 0.0)
            for sign in (LEAST, GREATEST)
        )
    except SampleLimitError:
        pass
    low, high = find_extreme(course, LEAST), find_extreme(course, GREATEST)
    assert low is not None and high is not None  # the value itself is solved
    return SearchedExtremes(low, high, missing, len(course.samples))


def climb_from_corner(
    evaluate: Evaluate, base: NoisyValue, spreads: Sequence[NumberSpread], start: Mapping[str, float], sign: float
) -> BoundedValue | None:
    """Return the largest change in one direction that varying one number after the other reaches from a corner."""
    distances = dict(start)
    best = compute_change(evaluate(distances), base)
    for _ in range(MAX_ROUNDS):
        previous = best
        for spread in spreads:
            name, t = spread.number.name, spread.size
            for x in (-t, -INNER_FRACTION * t, 0.0, INNER_FRACTION * t, t):
                change = compute_change(evaluate(distances | {name: x}), base)
                if change is not None and (best is None or sign * change.value > sign * best.value):
                    best, distances = change, distances | {name: x}
        if best == previous:
            break
    return best


def matches_derivative(slope: NoisyDerivative, distance: float, change: BoundedValue) -> bool:
    """Return whether the change at a distance agrees with the derivative."""
    predicted = (slope.value or 0.0) * distance
    allowed = LINEARITY_TOLERANCE * abs(predicted) + slope.error * abs(distance) + change.error
    return abs(change.value - predicted) <= allowed


def compute_change(variant: NoisyValue, base: NoisyValue) -> BoundedValue | None:
    """Return the change of a measure and its error; None if unknown."""
    if variant.value is None or base.value is None:
        return None
    return BoundedValue(variant.value - base.value, variant.error + base.error)


FORM = "expected NAME=VALUE,..., the tolerance of each parameter"
HINT = "for example --spread L=0.1mm,e=0.02mm"


def parse_spreads(text: str, spec_numbers: SpecNumbers) -> list[NumberSpread]:
    """Return the tolerances of numbers, each in its number's unit. Raises AxisError."""
    spreads: dict[str, NumberSpread] = {}
    for word in split_at_commas(text):
        name, value = split_name(word.strip(), FORM, HINT)
        if name in spreads:
            raise AxisError(name, "has two spreads", HINT)
        number = spec_numbers.find_number(name)
        spreads[name] = NumberSpread(number, _parse_size(word.strip(), value, number))
    return [*spreads.values()]


def _parse_size(word: str, value: str, number: SpecNumber) -> float:
    """Return the tolerance of a number, in its unit. Raises AxisError."""
    quantity = parse_number_with_unit(value)
    if quantity is None or quantity.value <= 0.0:
        raise AxisError(word, "a spread is a positive number, with its unit", HINT)
    if not quantity.unit:
        if number.size != 1.0:
            raise AxisError(word, f"{number.name} is given in {number.unit}: its spread needs a unit", HINT)
        return quantity.value
    try:
        size, dimension = parse_unit(quantity.unit)
    except Finding as finding:
        raise AxisError(word, finding.message, finding.hint) from None
    if number.unit and dimension != parse_unit(number.unit)[1]:
        raise AxisError(word, f"{describe(dimension)}, but {number.name} is given in {number.unit}", HINT)
    return quantity.value * size / number.size
