"""Samples of a measure at places of an interval, and polynomials and corners through neighbouring ones."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from heuncli.analyses.variants.measures import NoisyValue, Reason
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array

SINGULAR = Reason(
    "singular-pose", "the run passes a singular position only there: its value does not follow its neighbours"
)


BELOW, AT_VALUE, ABOVE = -1, 0, 1  # the side of the value on which a sample lies; the numbers are signs of its gap
LEFT, RIGHT = -1, 1  # the direction from a sample to others; the numbers are steps of its index


class Sample(NamedTuple):
    """What is known of a measure at a place.

    gap: how far the measure lies above the value, None where there is none
    error: of the gap
    why: the reason why there is none
    singular: whether its run passes a singular pose
    withheld_gap: the gap of a sample that is not used as a neighbour of the others because of that
    """

    x: float
    gap: float | None
    error: float = 0.0
    why: Reason = Reason()
    singular: bool = False
    withheld_gap: float | None = None

    @property
    def side(self) -> int | None:
        """ABOVE or BELOW the value, AT_VALUE if not distinguishable from it; None where there is no measure."""
        if self.gap is None:
            return None
        return AT_VALUE if abs(self.gap) <= self.error else ABOVE if self.gap > 0.0 else BELOW

    @property
    def gap_or_zero(self) -> float:
        """The gap g; 0 where there is no measure."""
        return self.gap or 0.0

    @property
    def distance(self) -> float:
        """Distance |g| of the measure from the value; 0 where there is no measure."""
        return abs(self.gap or 0.0)


def make_sample(x: float, measure: NoisyValue, value: float, singular: bool = False) -> Sample:
    """Make the sample at a place from the measure there; value: what its gap is taken from."""
    if measure.value is None:
        return Sample(x, None, why=measure.why)
    return Sample(x, measure.value - value, measure.error, singular=singular)


def withhold(sample: Sample) -> Sample:
    """Return a sample without its gap, because that belongs only to a singular pose."""
    if sample.gap is None:
        return sample
    return sample._replace(gap=None, withheld_gap=sample.gap, why=SINGULAR)


def restore(sample: Sample) -> Sample:
    """Return a sample with its gap again, if it was withheld."""
    return (
        sample
        if sample.withheld_gap is None
        else sample._replace(gap=sample.withheld_gap, withheld_gap=None, why=Reason())
    )


def find_intersection(first: Sample, left: Sample, right: Sample, last: Sample) -> float:
    """Return where the line through two samples meets that through two others, clipped to the middle interval."""
    before, after = ((b.gap_or_zero - a.gap_or_zero) / (b.x - a.x) for a, b in ((first, left), (right, last)))
    if before == after:
        return 0.5 * (left.x + right.x)
    x = (right.gap_or_zero - left.gap_or_zero + before * left.x - after * right.x) / (before - after)
    return min(max(x, left.x), right.x)


def interpolate_corner(left_samples: list[Sample], right_samples: list[Sample], x: Array, smooth: Array) -> Array:
    """Interpolate by the lines through two samples on the left and two on the right, where both bend in the same
    direction.
    """
    before, after = interpolate(left_samples, x), interpolate(right_samples, x)
    line = interpolate([left_samples[-1], right_samples[0]], x)
    if (np.minimum(before, after) >= line).all():
        return np.minimum(before, after)
    return np.maximum(before, after) if (np.maximum(before, after) <= line).all() else smooth


def interpolate(samples: list[Sample], x: Array) -> Array:
    """Evaluate the polynomial through some samples at some places, by Newton's divided differences."""
    nodes, heads = _divided_differences(samples)
    value = np.full_like(x, heads[-1])
    for node, head in zip(reversed(nodes[:-1]), reversed(heads[:-1]), strict=True):
        value = value * (x - node) + head
    return value


def interpolate_slope(samples: list[Sample], x: float) -> float:
    """Evaluate the derivative of the polynomial through some samples at a place."""
    nodes, heads = _divided_differences(samples)
    value, derivative = heads[-1], 0.0
    for node, head in zip(reversed(nodes[:-1]), reversed(heads[:-1]), strict=True):
        derivative = derivative * (x - node) + value
        value = value * (x - node) + head
    return derivative


def _divided_differences(samples: list[Sample]) -> tuple[list[float], list[float]]:
    """Return nodes and divided differences."""
    nodes = [sample.x for sample in samples]
    row = [sample.gap_or_zero for sample in samples]
    heads = [row[0]]
    for order in range(1, len(nodes)):
        row = [(b - a) / (nodes[k + order] - nodes[k]) for k, (a, b) in enumerate(pairwise(row))]
        heads.append(row[0])
    return nodes, heads
