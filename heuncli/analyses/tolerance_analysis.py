"""Combined effect on a measure of the tolerances of several numbers, as given by `--spread`."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from heuncli.analyses.sensitivity import Contribution, NoisyDerivative, SpreadSum
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

LINEARITY_TOLERANCE = 0.05  # of the change predicted by the derivative
INNER_FRACTION = 0.61  # of a tolerance: inner places between its ends and the value
SCAN_COUNT, MAX_VARIANTS = 9, 60  # variants over a tolerance range that is searched: at first, and in all
EXTREME_TOLERANCE = 1e-3  # of the range of the measure: error of its extremes
MAX_STEPS = 30  # towards one extreme
MAX_ROUNDS = 3  # through all numbers, one by one


class NumberSpread(NamedTuple):
    """A number and its tolerance, each way, in its unit."""

    number: SpecNumber
    size: float


class SpreadExtremes(NamedTuple):
    """Effect of one number within its tolerance, with the distances at which the measure is smallest and largest."""

    contribution: Contribution
    lowest_at: float
    highest_at: float


Evaluate = Callable[[Mapping[str, float]], NoisyValue]  # the measure, for given distances of numbers from their values


def combine_tolerances(
    evaluate: Evaluate, spreads: Sequence[NumberSpread], slopes: Mapping[str, NoisyDerivative]
) -> SpreadSum:
    """Combine the tolerances of several numbers; slopes: dm/dp by name."""
    base = evaluate({})
    extremes = [find_tolerance_extremes(evaluate, base, spread, slopes[spread.number.name]) for spread in spreads]
    contributions = tuple(entry.contribution for entry in extremes)
    lowest = {entry.contribution.name: entry.lowest_at for entry in extremes}
    highest = {entry.contribution.name: entry.highest_at for entry in extremes}
    corners = evaluate(lowest), evaluate(highest)
    largest = max(
        (change for end in corners if (change := compute_change(end, base))), key=_get_magnitude, default=None
    )
    nonlinear = [entry for entry in contributions if entry.bent or entry.why[0]]
    if nonlinear and len(contributions) > 1:
        for sign, start in ((-1.0, lowest), (1.0, highest)):
            climbed_change = climb_from_corner(evaluate, base, spreads, start, sign)
            largest = max(
                (entry for entry in (largest, climbed_change) if entry is not None), key=_get_magnitude, default=None
            )
    sizes = [(entry.size, entry.error) for entry in contributions if entry.size is not None]
    if len(sizes) < len(contributions):
        return SpreadSum(contributions, None, None, corners)
    worst = sum(size for size, _ in sizes), sum(error for _, error in sizes)
    by_variant = largest is not None and abs(largest[0]) > worst[0]
    if by_variant and largest is not None:
        worst = abs(largest[0]), largest[1] + worst[1] + abs(largest[0]) - worst[0]
    root = math.sqrt(sum(size * size for size, _ in sizes))
    error = sum(size * error for size, error in sizes) / root if root else worst[1]
    return SpreadSum(contributions, worst, (root, error), corners, by_variant, largest)


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
    below, above = (changes[x][0] if x in changes else None for x in (-t, t))
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
    low, high, missing, runs = search_extremes(evaluate, base, name, t)
    error = max(low.error, high.error) + base.error + missing
    size = max(-low.gap_or_zero, high.gap_or_zero)
    contribution = Contribution(
        *labels,
        size,
        error,
        linear,
        below,
        above,
        True,
        (low.x, low.gap_or_zero),
        (high.x, high.gap_or_zero),
        runs,
        why,
    )
    return SpreadExtremes(contribution, low.x, high.x)


def search_extremes(evaluate: Evaluate, base: NoisyValue, name: str, t: float) -> tuple[Sample, Sample, float, int]:
    """Search the smallest and the largest change within a tolerance.

    Returns both samples, by how much the search may have missed the true extremes (inf if it was cut short), and the
    number of variants.
    """

    value = base.value or 0.0  # it is known where the tolerance is searched

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
    return low, high, missing, len(course.samples)


def climb_from_corner(
    evaluate: Evaluate, base: NoisyValue, spreads: Sequence[NumberSpread], start: Mapping[str, float], sign: float
) -> tuple[float, float] | None:
    """Return the largest change in one direction that varying one number after the other reaches from a corner."""
    distances = dict(start)
    best = compute_change(evaluate(distances), base)
    for _ in range(MAX_ROUNDS):
        previous = best
        for spread in spreads:
            name, t = spread.number.name, spread.size
            for x in (-t, -INNER_FRACTION * t, 0.0, INNER_FRACTION * t, t):
                change = compute_change(evaluate(distances | {name: x}), base)
                if change is not None and (best is None or sign * change[0] > sign * best[0]):
                    best, distances = change, distances | {name: x}
        if best == previous:
            break
    return best


def matches_derivative(slope: NoisyDerivative, distance: float, change: tuple[float, float]) -> bool:
    """Return whether the change at a distance agrees with the derivative."""
    predicted = (slope.value or 0.0) * distance
    return abs(change[0] - predicted) <= LINEARITY_TOLERANCE * abs(predicted) + slope.error * abs(distance) + change[1]


def compute_change(variant: NoisyValue, base: NoisyValue) -> tuple[float, float] | None:
    """Return the change of a measure and its error; None if unknown."""
    if variant.value is None or base.value is None:
        return None
    return variant.value - base.value, variant.error + base.error


def _get_magnitude(change: tuple[float, float]) -> float:
    """Return the magnitude of a change."""
    return abs(change[0])


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
