"""The course of a measure over an interval: its samples at some places, and predictions between them.

g(x) = measure(x) - value       known at x within an error e, which its run states

Between two neighbours g is predicted by the cubic through them and one more on either side. Its uncertainty follows
from the parabolas that leave one of the four out, from the corner at which the lines through either two would meet (a
measure such as the largest of several bends there), and from how wrong earlier predictions were.

No polynomial follows a resonance or a pole. There 1/measure^2 is smooth: the parabola through its three values about a
largest magnitude shows how far that may grow between them, also without bounds.
"""

from __future__ import annotations

import math
from bisect import bisect_left, insort
from collections.abc import Callable, Iterator
from itertools import groupby, pairwise

import numpy as np

from heuncli.analyses.variants.samples import (
    Sample,
    find_intersection,
    interpolate,
    interpolate_corner,
    restore,
    withhold,
)
from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.tolerances import EPS
from heuncli.results.results import Array

MIN_DISTANCE = 0.25  # of an interval: closer neighbours show the noise, not the course
GRID = np.linspace(0.0, 1.0, 35)[1:-1]  # places in an interval, of its width
NOISE = 8.0  # times the errors of four places: difference of their polynomials that noise alone may cause
MIN_UNCERTAINTY = 1e-3  # of the range of the four: deviation from a cubic that the scan may miss
MAX_SHIFT = 0.25  # of the spacing: largest shift of places of the scan, so that no wave is hidden by aliasing
GOLDEN = 0.5 * (5.0**0.5 - 1.0)
FIRST_DISTRUST = 1.25
MAX_DISTRUST = 16.0
LOG_RATIO = 4.0  # ratio of neighbouring magnitudes from which on their logarithms are interpolated
LARGEST_LOG = 690.0  # of a magnitude that does not overflow
POLE_POWERS = (1.0, 2.0)  # orders of poles towards which the measure may rise
TINY_INVERSE = 1e-3  # of the least: an inverse measure that is interpolated to less counts as this
POLE_MARGIN = 0.5  # of an interval: distance outside of it that a predicted pole may have


class CoursePrediction(NamedTuple):
    """The prediction at places between two neighbours: g (n,), its uncertainty (n,), and the noise.

    uncertainty: without the differences between polynomials that noise causes
    total_uncertainty (n,): with these, and the errors of the neighbours
    """

    places: Array
    gaps: Array
    uncertainty: Array
    noise: float
    total_uncertainty: Array


class CoursePeak(NamedTuple):
    """The place where the magnitude of the measure may be greatest between two neighbours, and its size; inf: a
    pole.
    """

    place: float
    size: float


class SampleLimitError(Exception):
    """The allowed number of samples is used up."""


class MeasureCourse:
    """The samples of g over an interval; it samples more places on request.

    jumps: pairs of neighbours between which g jumps; the course is interrupted there, as at variants that fail
    steep: pairs of neighbours between which g crosses the value, closer together than finest
    searched_pairs: pairs of neighbours between which a place was sampled already
    certain: groups of places that need no more samples, each with the distrust for which that was decided
    usual: median magnitude of the measure over the scan
    finest: smallest distance of places that are distinguished
    distrust: factor on the uncertainty of predictions; grows when one was wrong by more than its uncertainty
    """

    def __init__(
        self,
        evaluate: Callable[[float], Sample],
        low: float,
        high: float,
        count: int,
        max_samples: int,
        value: float = 0.0,
    ) -> None:
        """evaluate: returns the sample at a place
        count: places of the scan, evenly spaced
        max_samples: limit of all samples
        value: the measure minus g
        """
        self.value = value
        self.searched_pairs: set[tuple[float, float]] = set()
        self.usual = math.inf  # magnitude of the measure over the scan
        self.followed: set[float] = set()  # minima of |g| that were followed
        self.certain: set[tuple[float, ...]] = set()
        self._evaluate, self._max_samples = evaluate, max_samples
        self.low, self.high = low, high
        self.finest = max(1e-10 * (high - low), 4.0 * EPS * max(abs(low), abs(high)))
        self.samples: list[Sample] = []
        self.jumps: set[tuple[float, float]] = set()
        self.steep: set[tuple[float, float]] = set()
        self.distrust = FIRST_DISTRUST
        self.scanned = make_uneven_places(low, high, count)
        self.spacing = max(b - a for a, b in pairwise(self.scanned))

    def scan(self) -> None:
        """Sample the places of the scan: the ends first, so that an incomplete scan has them."""
        for x in (self.scanned[0], self.scanned[-1], *self.scanned[1:-1]):
            self.sample_at(x)
        self.usual = float(np.median([abs(self.get_measure(sample)) for sample in self.samples]))

    def sample_at(self, x: float) -> Sample:
        """Return the sample at a place, evaluated once. Raises SampleLimitError."""
        index = bisect_left(self.samples, x, key=lambda sample: sample.x)
        if index < len(self.samples) and self.samples[index].x == x:
            return self.samples[index]
        if len(self.samples) >= self._max_samples:
            raise SampleLimitError
        new_sample = self._evaluate(x)
        insort(self.samples, new_sample, key=lambda sample: sample.x)
        return new_sample

    def sample_and_learn(self, x: float) -> Sample:
        """Return the sample at a place between two neighbours, and raise the distrust if the prediction was too far
        off.
        """
        i = bisect_left(self.samples, x, key=lambda sample: sample.x) - 1
        expected = self.predict(i, np.array([x]))
        new_sample = self.sample_at(x)
        if new_sample.gap is not None:
            gap, uncertainty = float(expected.gaps[0]), float(expected.uncertainty[0])
            excess = abs(new_sample.gap - gap) - new_sample.error - expected.noise
            if excess > uncertainty:
                self.distrust = min(
                    2.0 * self.distrust * (excess / uncertainty if uncertainty else MAX_DISTRUST), MAX_DISTRUST
                )
        return new_sample

    def iter_pairs(self) -> Iterator[tuple[int, Sample, Sample]]:
        """Yield all neighbours, with the index of the first."""
        for i in range(len(self.samples) - 1):
            yield i, self.samples[i], self.samples[i + 1]

    def is_interrupted(self, i: int) -> bool:
        """Whether the course does not continue from a sample to the next: one has no measure, or it jumps."""
        one, other = self.samples[i], self.samples[i + 1]
        return one.gap is None or other.gap is None or (one.x, other.x) in self.jumps

    def find_peak(self, i: int) -> CoursePeak | None:
        """Predict how far the magnitude of the measure may grow between a sample and the next; None: no sign of a
        peak.
        """
        if self.is_interrupted(i):
            return None
        one, other = self.samples[i], self.samples[i + 1]
        if self._measure_at(i) * self._measure_at(i + 1) < 0.0:
            place = self.find_pole(i)
            return None if place is None else CoursePeak(place, math.inf)
        peaks = [peak for k in (i, i + 1) if (peak := self._find_top(k)) is not None]
        inside = [peak for peak in peaks if one.x < peak.place < other.x]
        return max(inside, key=lambda peak: peak.size, default=None)

    def get_measure(self, sample: Sample) -> float:
        """Return the measure at a sample: g plus the value."""
        return sample.gap_or_zero + self.value

    def _measure_at(self, i: int) -> float:
        return self.get_measure(self.samples[i])

    def _find_top(self, k: int) -> CoursePeak | None:
        """Find the top of 1/measure^2 through a sample that is the largest of three."""
        if not 0 < k < len(self.samples) - 1 or self.is_interrupted(k - 1) or self.is_interrupted(k):
            return None
        x = [self.samples[j].x for j in (k - 1, k, k + 1)]
        m = [self._measure_at(j) for j in (k - 1, k, k + 1)]
        noise = NOISE * max(self.samples[j].error for j in (k - 1, k, k + 1))
        if m[0] * m[1] <= 0.0 or m[1] * m[2] <= 0.0 or abs(m[1]) - max(abs(m[0]), abs(m[2])) <= noise:
            return None
        y = [(m[1] / each) ** 2 for each in m]  # of the largest's
        before, after = (y[1] - y[0]) / (x[1] - x[0]), (y[2] - y[1]) / (x[2] - x[1])
        bend = (after - before) / (x[2] - x[0])
        middle = before + bend * (x[1] - x[0])  # the slope at the sample
        place = x[1] - 0.5 * middle / bend
        minimum = 1.0 - 0.25 * middle * middle / bend
        return CoursePeak(place, abs(m[1]) / math.sqrt(minimum) if minimum > 0.0 else math.inf)

    def find_pole(self, i: int) -> float | None:
        """Find where 1/measure passes 0 between two neighbours of different signs; None if neither side's rise predicts
        a pole.
        """
        one, other = self.samples[i], self.samples[i + 1]
        width = other.x - one.x
        a, b = self._measure_at(i), self._measure_at(i + 1)
        if not a * b < 0.0:
            return None
        a, b = 1.0 / a, 1.0 / b
        is_predicted = False
        for k, far in ((i, i - 1), (i + 1, i + 2)):
            if not 0 <= far < len(self.samples) or self.is_interrupted(min(k, far)):
                continue
            magnitude, outer_magnitude = self._measure_at(k), self._measure_at(far)
            if magnitude * outer_magnitude > 0.0 and abs(outer_magnitude) < abs(magnitude):
                fall = 1.0 / abs(outer_magnitude) - 1.0 / abs(magnitude)
                distance = abs(self.samples[k].x - self.samples[far].x) / abs(magnitude) / fall
                is_predicted = is_predicted or distance <= (1.0 + POLE_MARGIN) * width
        if not is_predicted:
            return None
        margin = 0.25 * self.finest
        return min(max(one.x + width * a / (a - b), one.x + margin), other.x - margin)

    def withhold_isolated(self) -> None:
        """Withhold samples whose run passes a singular pose, if the samples next to them do not.

        If a wider group of them is found, it is a part of the course, and they are restored.
        """
        for is_singular, members in groupby(range(len(self.samples)), key=lambda i: self.samples[i].singular):
            places = list(members)
            if not is_singular:
                continue
            adjacent = [k for k in (places[0] - 1, places[-1] + 1) if 0 <= k < len(self.samples)]
            width = self.samples[places[-1]].x - self.samples[places[0]].x
            is_isolated = width <= tolerances.ISOLATED_SINGULAR * self.spacing and any(
                self.samples[k].gap is not None for k in adjacent
            )
            for k in places:
                self.samples[k] = withhold(self.samples[k]) if is_isolated else restore(self.samples[k])

    @property
    def gap_range(self) -> float:
        """The difference between the largest and the smallest gap found."""
        known = [sample.gap for sample in self.samples if sample.gap is not None]
        return max(known) - min(known) if known else 0.0

    def predict(self, i: int, places: Array | None = None) -> CoursePrediction:
        """Predict the course between a sample and the next; places: only there, otherwise at GRID."""
        one, other = self.samples[i], self.samples[i + 1]
        left, right = self.find_neighbours(i, -1), self.find_neighbours(i, 1)
        samples = [*reversed(left[: 1 if right else 2]), one, other, *right[: 1 if left else 2]]
        x = one.x + GRID * (other.x - one.x) if places is None else places
        if left and right and places is None:
            x = np.sort(np.append(x, find_intersection(left[0], one, other, right[0])))
        noise = NOISE * max(sample.error for sample in samples)
        if len(samples) == 2:
            expected = interpolate(samples, x)
            uncertainty = np.full(len(x), max(self.gap_range, one.distance, other.distance))
            return CoursePrediction(x, expected, uncertainty, noise, uncertainty)
        parts = [part for part in (samples[:-1], samples[1:]) if one in part and other in part]
        models = [[interpolate(part, x) for part in (samples, *parts)]]
        if left and right:
            models[0].append(interpolate_corner([left[0], one], [other, right[0]], x, models[0][0]))
        if self._is_graded(samples, bool(left and right)):
            models.append([self._interpolate_logarithm(part, x) for part in (samples, *parts)])
            if left and right:
                models[1].append(interpolate_corner([left[0], one], [other, right[0]], x, models[1][0]))
            models.extend(
                self._interpolate_inverses(samples, parts, x, power, has_corner=bool(left and right))
                for power in POLE_POWERS
                if self.value != 0.0  # towards which it may fall instead
            )
        expected, *others = min(
            models, key=lambda model: float(np.max(np.abs(np.array(model[1 : 1 + len(parts)]) - model[0])))
        )
        spread = np.max([np.abs(each - expected) for each in others], axis=0)
        uncertainty = np.maximum(spread - noise, 0.0)
        known = [sample.gap_or_zero for sample in samples]
        steps = (max(known) - min(known)) * (x - one.x) * (other.x - x) / self.spacing**2
        uncertainty, total = (
            self.distrust * np.maximum(each, MIN_UNCERTAINTY * steps) for each in (uncertainty, spread)
        )
        return CoursePrediction(x, expected, uncertainty, noise, total + max(one.error, other.error))

    def _is_graded(self, samples: list[Sample], on_both_sides: bool) -> bool:
        """Whether the measure runs through several magnitudes, as towards a pole, and its logarithm may be
        interpolated.

        Not where it may touch a value at or beyond 0, which no logarithm reaches: towards a zero the logarithm falls
        ever faster, towards a pole it rises ever faster.
        """
        m = [self.get_measure(sample) for sample in samples]
        if min(m) <= 0.0 <= max(m) or max(map(abs, m)) < LOG_RATIO * min(map(abs, m)):
            return False
        steps = [abs(b) - abs(a) for a, b in pairwise(m)]
        if self.value == 0.0 and not _rises_convexly(samples):
            return False
        return m[0] * self.value > 0.0 or (on_both_sides and (min(steps) > 0.0 or max(steps) < 0.0))

    def _interpolate_logarithm(self, samples: list[Sample], x: Array) -> Array:
        """Interpolate some samples by a polynomial of the logarithm of the measure."""
        sign = math.copysign(1.0, self.get_measure(samples[0]))
        logs = [sample._replace(gap=math.log(abs(self.get_measure(sample)))) for sample in samples]
        found: Array = sign * np.exp(np.minimum(interpolate(logs, x), LARGEST_LOG)) - self.value
        return found

    def _interpolate_inverses(
        self, samples: list[Sample], parts: list[list[Sample]], x: Array, power: float, *, has_corner: bool
    ) -> list[Array]:
        """Interpolate samples, parts of them and, if wanted, their corner by polynomials of |m|^(-1/power), as near a
        pole of that order.
        """
        sign = math.copysign(1.0, self.get_measure(samples[0]))
        inverses = {
            sample.x: sample._replace(gap=abs(self.get_measure(sample)) ** (-1.0 / power)) for sample in samples
        }
        least = TINY_INVERSE * min(inverse.gap_or_zero for inverse in inverses.values())
        found = [interpolate([inverses[sample.x] for sample in part], x) for part in (samples, *parts)]
        if has_corner:
            ordered = [inverses[sample.x] for sample in samples]
            found.append(interpolate_corner(ordered[:2], ordered[2:], x, found[0]))
        return [sign * np.maximum(inverse, least) ** -power - self.value for inverse in found]

    def find_neighbours(self, i: int, direction: int) -> list[Sample]:
        """Return up to two samples before a sample (direction -1) or after its next (1), without an interruption; the
        nearest first.
        """
        width = self.samples[i + 1].x - self.samples[i].x
        found: list[Sample] = []
        k = i if direction < 0 else i + 1
        last_place = self.samples[k].x
        while (
            len(found) < 2 and 0 <= k + direction < len(self.samples) and not self.is_interrupted(k + min(direction, 0))
        ):
            k += direction
            if abs(self.samples[k].x - last_place) >= MIN_DISTANCE * width:
                found.append(self.samples[k])
                last_place = self.samples[k].x
        return found


def _rises_convexly(samples: list[Sample]) -> bool:
    """Return whether the slopes of the logarithm of |g| rise from sample to sample."""
    slopes = [(math.log(b.distance) - math.log(a.distance)) / (b.x - a.x) for a, b in pairwise(samples)]
    return all(before <= after for before, after in pairwise(slopes))


def make_uneven_places(low: float, high: float, count: int) -> list[float]:
    """Make places from low to high, including both, at incommensurable distances."""
    shifts = [MAX_SHIFT * (2.0 * (k * GOLDEN % 1.0) - 1.0) for k in range(count)]
    shifts[0] = shifts[-1] = 0.0
    places = [low + (high - low) * (k + shift) / (count - 1) for k, shift in enumerate(shifts)]
    return [low, *places[1:-1], high]
