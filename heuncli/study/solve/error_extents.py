"""Of one quantity over a motion: how far two runs lie apart, what its sums lose by rounding, how large it is."""

from __future__ import annotations

from functools import reduce

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Mask
from heuncli.scene.shapes.by_component import rows


class Weights(NamedTuple):
    """What an error is made of: so many times the difference between the runs, and the rounding of sums."""

    difference: float
    rounding: float


ESTIMATED = Weights(2.0, 1.0)  # of a run, by one that is finer
APART = Weights(1.0, 0.0)  # the difference itself


class Extent:
    """What is known of one quantity from the instants so far: largest difference, rounding, terms; its range.

    claimed: the largest difference before the horizon.
    """

    def __init__(self, weights: Weights = ESTIMATED) -> None:
        self.weights = weights
        self.difference = self.claimed = self.rounding = self.terms = 0.0
        self.largest = self.told = 0.0
        self.low, self.high = np.inf, -np.inf

    def add(
        self, values: Array, rounding: Array, terms: Array, which: tuple[Mask, Mask], more: Array | None = None
    ) -> None:
        """values (c n, ...): of c runs, at each instant one after the other; more (n,): difference beside.

        rounding, terms (c n,); which: the instants that are asked ones, and those before the horizon, (n,).
        """
        asked, before = which
        if not values.size:
            return
        count, last = len(values) // len(asked), rows(values)
        own = last[..., 0::count]
        size = _lengths(own)
        difference = reduce(np.maximum, [_lengths(own - last[..., k::count]) for k in range(1, count)])
        self.differ(difference if more is None else difference + more, before)
        self.rounding = _larger(self.rounding, rounding)
        self.terms = _larger(self.terms, terms)
        self.largest, self.told = _larger(self.largest, size), _larger(self.told, size[asked])
        self.low, self.high = min(self.low, float(own.min())), max(self.high, float(own.max()))

    def differ(self, difference: Array, before: Mask) -> None:
        """More differences, and which are before the horizon, (n,)."""
        self.difference, self.claimed = _larger(self.difference, difference), _larger(self.claimed, difference[before])

    @property
    def error(self) -> float:
        """The estimated error over the whole run."""
        return self.weights.difference * self.difference + self.weights.rounding * self.rounding

    @property
    def claimed_error(self) -> float:
        """The estimated error before the horizon, up to which numbers are told."""
        return self.weights.difference * self.claimed + self.weights.rounding * self.rounding

    @property
    def exchanged(self) -> float:
        """What lies between the lowest and the highest value, if less than the largest."""
        return max(min(self.high - self.low, self.largest), 0.0)


def norms(vectors: Array) -> Array:
    """The lengths of vectors (n, m, 3), (n, m)."""
    return np.asarray(np.sqrt(np.einsum("tni,tni->tn", vectors, vectors)))


def lengths(values: Array) -> Array:
    """The largest length of the vectors (n, ..., 3), or magnitude of the numbers (n,), at each instant."""
    return _lengths(rows(values))


def _lengths(values: Array) -> Array:
    """The same of values with the instants last, (..., 3, n) or (n,)."""
    if values.ndim == 1:
        return np.abs(values)
    squares = (values * values).sum(axis=-2).reshape(-1, values.shape[-1])
    return np.asarray(np.sqrt(squares.max(axis=0)))


def _larger(so_far: float, values: Array) -> float:
    """The largest; what is no number is unboundedly large."""
    largest = float(values.max(initial=0.0))
    return max(so_far, largest) if np.isfinite(largest) else np.inf


def relative(error: float, terms: float, *scales: float) -> float:
    """An error against the first of the scales that is more than rounding of its terms; 0 where none is."""
    scale = next((x for x in scales if x > tolerances.NO_LOAD * terms), 0.0)
    if scale == 0.0:
        return 0.0
    found = error / scale if np.isfinite(scale) else np.inf
    return min(found, tolerances.UNKNOWN)
