"""The course of a measure over an interval: its samples, in ascending order, and the places still to be sampled.

g(x) = measure(x) - value       known at x within an error e, which its run states

course_prediction.py predicts g between the samples, course_extremes.py finds where it is least and greatest.
"""

from __future__ import annotations

import math
from bisect import bisect_left, insort
from collections.abc import Callable, Iterator
from itertools import groupby, pairwise

import numpy as np

from heuncli.analyses.variants.samples import LEFT, Sample, restore, withhold
from heuncli.base import tolerances
from heuncli.base.tolerances import EPS

MIN_DISTANCE = 0.25  # share of an interval: closer neighbours show the noise, not the course
MAX_SHIFT = 0.25  # share of the spacing by which the scan shifts its places, so that aliasing hides no wave
GOLDEN = 0.5 * (5.0**0.5 - 1.0)  # its multiples, modulo 1, fill [0, 1) evenly
FINEST = 1e-10  # share of the interval: closer places are not distinguished
FIRST_DISTRUST = 1.25  # factor on the uncertainty of the first predictions


class SampleLimitError(Exception):
    """The allowed number of samples is used up."""


class MeasureCourse:
    """The samples of g over an interval; it samples more places on request.

    low, high: the ends of the interval
    value: what the measure is to reach; g is the measure minus it
    samples: ascending in x
    scanned: the places of the scan; spacing: the largest distance between two of them
    jumps: pairs of neighbours between which g jumps; the course is interrupted there, as at variants that fail
    steep: pairs of neighbours between which g crosses the value, closer together than finest
    searched_pairs: pairs of neighbours between which a place was sampled already
    followed: places of minima of |g| that were followed
    certain: places, distrust and number of range ends, for which no more samples are needed between the middle two
    median_magnitude: median magnitude of the measure over the scan
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
        value: what the measure is to reach; g is the measure minus it
        """
        self.value = value
        self.searched_pairs: set[tuple[float, float]] = set()
        self.median_magnitude = math.inf
        self.followed: set[float] = set()
        self.certain: set[tuple[float, ...]] = set()
        self._evaluate, self._max_samples = evaluate, max_samples
        self.low, self.high = low, high
        self.finest = max(FINEST * (high - low), 4.0 * EPS * max(abs(low), abs(high)))
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
        self.median_magnitude = float(np.median([abs(self.get_measure(sample)) for sample in self.samples]))

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

    def iter_pairs(self) -> Iterator[tuple[int, Sample, Sample]]:
        """Yield all neighbours, with the index of the first."""
        for i in range(len(self.samples) - 1):
            yield i, self.samples[i], self.samples[i + 1]

    def is_interrupted(self, i: int) -> bool:
        """Return whether the course ends between the i-th sample and the next: one has no measure, or it jumps."""
        left, right = self.samples[i], self.samples[i + 1]
        return left.gap is None or right.gap is None or (left.x, right.x) in self.jumps

    def iter_outward(self, k: int, direction: int) -> Iterator[Sample]:
        """Yield the samples on one side (LEFT, RIGHT) of the k-th, nearest first, as far as the course continues."""
        while 0 <= k + direction < len(self.samples) and not self.is_interrupted(k + min(direction, 0)):
            k += direction
            yield self.samples[k]

    def get_measure(self, sample: Sample) -> float:
        """Return the measure at a sample: g plus the value."""
        return sample.gap_or_zero + self.value

    def get_measure_at(self, i: int) -> float:
        """Return the measure at the i-th sample."""
        return self.samples[i].gap_or_zero + self.value

    def withhold_isolated(self) -> None:
        """Withhold samples whose run passes a singular pose, if the samples next to them do not.

        Withheld: the gap is set aside, as if the variant had failed. If a wider group of them is found, it is a part of
        the course, and they are restored.
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

    def find_neighbours(self, i: int, direction: int) -> list[Sample]:
        """Find up to two samples outside of the interval from the i-th sample to the next, the nearest first.

        direction: LEFT or RIGHT of the interval; nothing is found beyond an interruption
        """
        width = self.samples[i + 1].x - self.samples[i].x
        k = i if direction == LEFT else i + 1
        last_place = self.samples[k].x
        found: list[Sample] = []
        for sample in self.iter_outward(k, direction):
            if abs(sample.x - last_place) >= MIN_DISTANCE * width:
                found.append(sample)
                last_place = sample.x
                if len(found) == 2:
                    break
        return found


def make_uneven_places(low: float, high: float, count: int) -> list[float]:
    """Make places from low to high, including both, at incommensurable distances."""
    shifts = [MAX_SHIFT * (2.0 * (k * GOLDEN % 1.0) - 1.0) for k in range(count)]
    shifts[0] = shifts[-1] = 0.0
    places = [low + (high - low) * (k + shift) / (count - 1) for k, shift in enumerate(shifts)]
    return [low, *places[1:-1], high]
