"""The course of a measure over an interval: what is known of it at some places, and what lies between these.

    g(x) = measure(x) - value       known at x within an error e, which its run states

Between two neighbours g is taken for the cubic through them and one more on either side. How far that may be off is
seen from the parabolas that leave one of the four out, from the corner at which the lines through either two would meet
(a measure such as the largest of several bends there), and from how far off it was wherever it was asked since.

No polynomial follows a resonance or a pole. There 1/measure^2 is smooth: the parabola through its three values about a
largest magnitude says how far that may grow between them, also beyond all bounds.
"""

from __future__ import annotations

import math
from bisect import bisect_left, insort
from collections.abc import Callable, Iterator
from itertools import groupby, pairwise

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.tolerances import EPS
from heuncli.results.results import Array

APART = 0.25  # of an interval: what stands nearer to another place tells of the noise, not of the course
GRID = np.linspace(0.0, 1.0, 35)[1:-1]  # places in an interval, of its width
NOISE = 8.0  # times the errors of four places at least so far apart: what their polynomials differ by for nothing
UNSEEN = 1e-3  # of the range of the four: what a course may do between places of the scan beside a cubic
UNEVEN = 0.25  # of the spacing: by so much places of the scan are shifted at most, so that no wave hides in their beat
GOLDEN = 0.5 * (5.0**0.5 - 1.0)
DISTRUST = 1.25
MOST_DISTRUST = 16.0
GRADED = 4.0  # times: magnitudes of neighbours that run through more are followed by their logarithms
LARGEST_LOG = 690.0  # of a magnitude that is a number
ISOLATED = 1e-3  # of the spacing: singular poses over less than that are places, not a part of the course
SINGULAR = "the run passes a singular pose there and not beside it: its number is no neighbour of the others"
BEYOND_POLE = 0.5  # of an interval: by so much the pole that one side foretells may lie outside of it


class Sample(NamedTuple):
    """What is known at a place: how far the measure lies above the value, and its error.

    gap: None where there is none, and why stands for a reason: its code and a sentence. singular: its run passes a
    singular pose; withheld: what its gap is, where it is not taken for a neighbour of the others because of that.
    """

    x: float
    gap: float | None
    error: float = 0.0
    why: tuple[str, str] = ("", "")
    singular: bool = False
    withheld: float | None = None

    @property
    def side(self) -> int | None:
        """1 above the value, -1 below it, 0 not told from it; None where there is no measure."""
        if self.gap is None:
            return None
        return 0 if abs(self.gap) <= self.error else 1 if self.gap > 0.0 else -1


class Between(NamedTuple):
    """What is expected at places between two neighbours: g (n,), by how much it may be off (n,), and the noise.

    off: beyond what noise makes polynomials differ by; most_off (n,): with that, and the errors of the neighbours.
    """

    places: Array
    gaps: Array
    off: Array
    noise: float
    most_off: Array


class CoursePeak(NamedTuple):
    """Where the magnitude of the measure may be greatest between two neighbours, and how large; inf: a pole."""

    place: float
    size: float


class SpentError(Exception):
    """As many places have been asked as may be."""


class MeasureCourse:
    """What is known of g over an interval; asks for more.

    jumps: neighbours between which it jumps, which part it like what cannot be solved; steep: between which it crosses,
    nearer together than places are told apart. given_up: neighbours between which a place was asked for already;
    certain: places among which it is known that none is to be asked for, and the distrust at which that was found.
    """

    def __init__(
        self, ask: Callable[[float], Sample], low: float, high: float, count: int, most: int, value: float = 0.0
    ) -> None:
        """ask: what is known at a place; count: places of the scan, evenly spaced; most: of all that may be asked.

        value: what g is counted from, the measure less g.
        """
        self.value = value
        self.given_up: set[tuple[float, float]] = set()
        self.usual = math.inf  # magnitude of the measure over the scan
        self.certain: set[tuple[float, ...]] = set()
        self._ask, self._most = ask, most
        self.low, self.high = low, high
        self.finest = max(1e-10 * (high - low), 4.0 * EPS * max(abs(low), abs(high)))
        self.samples: list[Sample] = []
        self.jumps: set[tuple[float, float]] = set()
        self.steep: set[tuple[float, float]] = set()
        self.distrust = DISTRUST
        self.scanned = uneven(low, high, count)
        self.spacing = max(b - a for a, b in pairwise(self.scanned))

    def scan(self) -> None:
        """Look at the places of the scan: the ends first, so that a scan cut short has them."""
        for x in (self.scanned[0], self.scanned[-1], *self.scanned[1:-1]):
            self.at(x)
        self.usual = float(
            np.median([_size(sample._replace(gap=_gap(sample) + self.value)) for sample in self.samples])
        )

    def at(self, x: float) -> Sample:
        """What is known at a place. Raises SpentError."""
        place = bisect_left(self.samples, x, key=lambda sample: sample.x)
        if place < len(self.samples) and self.samples[place].x == x:
            return self.samples[place]
        if len(self.samples) >= self._most:
            raise SpentError
        found = self._ask(x)
        insort(self.samples, found, key=lambda sample: sample.x)
        return found

    def look(self, x: float) -> Sample:
        """What is known at a place between two neighbours of a stretch; how far off it was expected is remembered."""
        i = bisect_left(self.samples, x, key=lambda sample: sample.x) - 1
        expected = self.between(i, np.array([x]))
        found = self.at(x)
        if found.gap is not None:
            gap, off = float(expected.gaps[0]), float(expected.off[0])
            missed = abs(found.gap - gap) - found.error - expected.noise
            if missed > off:
                self.distrust = min(2.0 * self.distrust * (missed / off if off else MOST_DISTRUST), MOST_DISTRUST)
        return found

    def pairs(self) -> Iterator[tuple[int, Sample, Sample]]:
        """All neighbours, with the number of the first."""
        for i in range(len(self.samples) - 1):
            yield i, self.samples[i], self.samples[i + 1]

    def parted(self, i: int) -> bool:
        """Whether the course does not go on from a sample to the next: one is not solved, or it jumps."""
        one, other = self.samples[i], self.samples[i + 1]
        return one.gap is None or other.gap is None or (one.x, other.x) in self.jumps

    def peak(self, i: int) -> CoursePeak | None:
        """How far the magnitude of the measure may grow between a sample and the next; None: no sign of a peak."""
        if self.parted(i):
            return None
        one, other = self.samples[i], self.samples[i + 1]
        if self._measure(i) * self._measure(i + 1) < 0.0:
            place = self._pole(i)
            return None if place is None else CoursePeak(place, math.inf)
        found = [peak for k in (i, i + 1) if (peak := self._top(k)) is not None]
        inside = [peak for peak in found if one.x < peak.place < other.x]
        return max(inside, key=lambda peak: peak.size, default=None)

    def _measure(self, i: int) -> float:
        return _gap(self.samples[i]) + self.value

    def _top(self, k: int) -> CoursePeak | None:
        """The top of 1/measure^2 through a sample that is the largest of three."""
        if not 0 < k < len(self.samples) - 1 or self.parted(k - 1) or self.parted(k):
            return None
        x = [self.samples[j].x for j in (k - 1, k, k + 1)]
        m = [self._measure(j) for j in (k - 1, k, k + 1)]
        noise = NOISE * max(self.samples[j].error for j in (k - 1, k, k + 1))
        if m[0] * m[1] <= 0.0 or m[1] * m[2] <= 0.0 or abs(m[1]) - max(abs(m[0]), abs(m[2])) <= noise:
            return None
        y = [(m[1] / each) ** 2 for each in m]  # of the largest's
        before, after = (y[1] - y[0]) / (x[1] - x[0]), (y[2] - y[1]) / (x[2] - x[1])
        bend = (after - before) / (x[2] - x[0])
        middle = before + bend * (x[1] - x[0])  # the slope at the sample
        place = x[1] - 0.5 * middle / bend
        least = 1.0 - 0.25 * middle * middle / bend
        return CoursePeak(place, abs(m[1]) / math.sqrt(least) if least > 0.0 else math.inf)

    def _pole(self, i: int) -> float | None:
        """Where 1/measure passes 0 between neighbours of different signs, if one side foretells that."""
        one, other = self.samples[i], self.samples[i + 1]
        width = other.x - one.x
        a, b = 1.0 / self._measure(i), 1.0 / self._measure(i + 1)
        foretold = False
        for k, far in ((i, i - 1), (i + 1, i + 2)):
            if not 0 <= far < len(self.samples) or self.parted(min(k, far)):
                continue
            own, outer = self._measure(k), self._measure(far)
            if own * outer > 0.0 and abs(outer) < abs(own):
                fall = 1.0 / abs(outer) - 1.0 / abs(own)
                ahead = abs(self.samples[k].x - self.samples[far].x) / abs(own) / fall
                foretold = foretold or ahead <= (1.0 + BEYOND_POLE) * width
        if not foretold:
            return None
        margin = 0.25 * self.finest
        return min(max(one.x + width * a / (a - b), one.x + margin), other.x - margin)

    def withhold_isolated(self) -> None:
        """Take no sample for a neighbour whose run passes a singular pose, where those beside it do not.

        Where a wider stretch of them is found, it is a course of its own kind, and they are neighbours again.
        """
        for is_singular, members in groupby(range(len(self.samples)), key=lambda i: self.samples[i].singular):
            places = list(members)
            if not is_singular:
                continue
            beside = [k for k in (places[0] - 1, places[-1] + 1) if 0 <= k < len(self.samples)]
            wide = self.samples[places[-1]].x - self.samples[places[0]].x
            alone = wide <= ISOLATED * self.spacing and any(self.samples[k].gap is not None for k in beside)
            for k in places:
                self.samples[k] = withheld(self.samples[k]) if alone else restored(self.samples[k])

    @property
    def range(self) -> float:
        """How far apart the least and the greatest lie that were found."""
        known = [sample.gap for sample in self.samples if sample.gap is not None]
        return max(known) - min(known) if known else 0.0

    def between(self, i: int, places: Array | None = None) -> Between:
        """What is expected between a sample and the next, of one stretch; places: there alone, else at GRID."""
        one, other = self.samples[i], self.samples[i + 1]
        left, right = self.beside(i, -1), self.beside(i, 1)
        whole = [*reversed(left[: 1 if right else 2]), one, other, *right[: 1 if left else 2]]
        x = one.x + GRID * (other.x - one.x) if places is None else places
        if left and right and places is None:
            x = np.sort(np.append(x, meeting(left[0], one, other, right[0])))
        noise = NOISE * max(sample.error for sample in whole)
        if len(whole) == 2:
            expected = polynomial(whole, x)
            off = np.full(len(x), max(self.range, _size(one), _size(other)))
            return Between(x, expected, off, noise, off)
        parts = [part for part in (whole[:-1], whole[1:]) if one in part and other in part]
        models = [[polynomial(part, x) for part in (whole, *parts)]]
        if self._is_graded(whole, bool(left and right)):
            models.append([self._by_logarithm(part, x) for part in (whole, *parts)])
        expected, *others = min(models, key=lambda model: float(np.max(np.abs(np.array(model[1:]) - model[0]))))
        if left and right:
            others.append(corner([left[0], one], [other, right[0]], x, expected))
        apart = np.max([np.abs(each - expected) for each in others], axis=0)
        off = np.maximum(apart - noise, 0.0)
        known = [_gap(sample) for sample in whole]
        steps = (max(known) - min(known)) * (x - one.x) * (other.x - x) / self.spacing**2
        off, most = (self.distrust * np.maximum(each, UNSEEN * steps) for each in (off, apart))
        return Between(x, expected, off, noise, most + max(one.error, other.error))

    def _is_graded(self, samples: list[Sample], on_both_sides: bool) -> bool:
        """Whether the measure runs through magnitudes, as towards a pole, and may be followed by its logarithm.

        Not where it may touch a value at 0 or behind it, which no logarithm reaches.
        """
        m = [_gap(sample) + self.value for sample in samples]
        if min(m) <= 0.0 <= max(m) or max(map(abs, m)) < GRADED * min(map(abs, m)):
            return False
        steps = [abs(b) - abs(a) for a, b in pairwise(m)]
        return m[0] * self.value > 0.0 or (on_both_sides and (min(steps) > 0.0 or max(steps) < 0.0))

    def _by_logarithm(self, samples: list[Sample], x: Array) -> Array:
        """The course through some samples, of which the logarithm of the measure is a polynomial."""
        sign = math.copysign(1.0, _gap(samples[0]) + self.value)
        logs = [sample._replace(gap=math.log(abs(_gap(sample) + self.value))) for sample in samples]
        found: Array = sign * np.exp(np.minimum(polynomial(logs, x), LARGEST_LOG)) - self.value
        return found

    def beside(self, i: int, way: int) -> list[Sample]:
        """Up to two samples of the stretch before a sample (way -1) or behind its next (1); the nearest first."""
        width = self.samples[i + 1].x - self.samples[i].x
        found: list[Sample] = []
        k = i if way < 0 else i + 1
        from_ = self.samples[k].x
        while len(found) < 2 and 0 <= k + way < len(self.samples) and not self.parted(k + min(way, 0)):
            k += way
            if abs(self.samples[k].x - from_) >= APART * width:
                found.append(self.samples[k])
                from_ = self.samples[k].x
        return found


def withheld(sample: Sample) -> Sample:
    """A sample whose gap is that of a singular pose alone."""
    if sample.gap is None:
        return sample
    return sample._replace(gap=None, withheld=sample.gap, why=("singular-pose", SINGULAR))


def restored(sample: Sample) -> Sample:
    """A sample with its gap, if it was withheld."""
    return sample if sample.withheld is None else sample._replace(gap=sample.withheld, withheld=None, why=("", ""))


def uneven(low: float, high: float, count: int) -> list[float]:
    """Places from low to high, both among them, at distances that have no common measure."""
    shifts = [UNEVEN * (2.0 * (k * GOLDEN % 1.0) - 1.0) for k in range(count)]
    shifts[0] = shifts[-1] = 0.0
    places = [low + (high - low) * (k + shift) / (count - 1) for k, shift in enumerate(shifts)]
    return [low, *places[1:-1], high]


def meeting(first: Sample, one: Sample, other: Sample, last: Sample) -> float:
    """Where the line through two samples meets that through two others, between the two in the middle."""
    before, after = ((_gap(b) - _gap(a)) / (b.x - a.x) for a, b in ((first, one), (other, last)))
    if before == after:
        return 0.5 * (one.x + other.x)
    x = (_gap(other) - _gap(one) + before * one.x - after * other.x) / (before - after)
    return min(max(x, one.x), other.x)


def corner(left: list[Sample], right: list[Sample], x: Array, smooth: Array) -> Array:
    """The lines through two samples on the left and two on the right, as far as they bend the way both ends do."""
    before, after = polynomial(left, x), polynomial(right, x)
    line = polynomial([left[-1], right[0]], x)
    if (np.minimum(before, after) >= line).all():
        return np.minimum(before, after)
    return np.maximum(before, after) if (np.maximum(before, after) <= line).all() else smooth


def polynomial(samples: list[Sample], x: Array) -> Array:
    """The polynomial through some samples at some places, by Newton's divided differences."""
    nodes, heads = _newton(samples)
    value = np.full_like(x, heads[-1])
    for node, head in zip(reversed(nodes[:-1]), reversed(heads[:-1]), strict=True):
        value = value * (x - node) + head
    return value


def slope(samples: list[Sample], x: float) -> float:
    """Its derivative at a place."""
    nodes, heads = _newton(samples)
    value, derivative = heads[-1], 0.0
    for node, head in zip(reversed(nodes[:-1]), reversed(heads[:-1]), strict=True):
        derivative = derivative * (x - node) + value
        value = value * (x - node) + head
    return derivative


def _gap(sample: Sample) -> float:
    return sample.gap or 0.0


def _size(sample: Sample) -> float:
    return abs(_gap(sample))


def _newton(samples: list[Sample]) -> tuple[list[float], list[float]]:
    """Nodes and divided differences."""
    nodes = [sample.x for sample in samples]
    row = [_gap(sample) for sample in samples]
    heads = [row[0]]
    for order in range(1, len(nodes)):
        row = [(b - a) / (nodes[k + order] - nodes[k]) for k, (a, b) in enumerate(pairwise(row))]
        heads.append(row[0])
    return nodes, heads
