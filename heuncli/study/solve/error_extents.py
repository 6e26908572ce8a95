"""The differences of one quantity between two runs of a motion, the rounding of its sums, and its size."""

from __future__ import annotations

from functools import reduce

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Mask
from heuncli.scene.shapes.rotations import instants_last


class Weights(NamedTuple):
    """The weights of an error: of the difference between the runs, and of the rounding of sums."""

    difference: float
    rounding: float


ESTIMATED = Weights(2.0, 1.0)  # error of a run, estimated by a finer one
DIFFERENCE_ONLY = Weights(1.0, 0.0)  # the difference itself


class Extent:
    """The largest difference, rounding, terms and range of one quantity over the instants added so far.

    claimed: the largest difference before the horizon
    """

    def __init__(self, weights: Weights = ESTIMATED) -> None:
        self.weights = weights
        self.difference = self.claimed = self.rounding = self.terms = 0.0
        self.largest = self.largest_requested = 0.0
        self.low, self.high = np.inf, -np.inf

    def add(
        self,
        values: Array,
        rounding: Array,
        terms: Array,
        which: tuple[Mask, Mask],
        extra_difference: Array | None = None,
    ) -> None:
        """Add values (c n, ...) of c runs, at each instant one run after the other.

        extra_difference (n,): added to the differences
        rounding, terms: (c n,)
        which: masks of the requested instants, and of those before the horizon, (n,)
        """
        is_requested, is_claimed = which
        if not values.size:
            return
        count, last = len(values) // len(is_requested), instants_last(values)
        first_run = last[..., 0::count]
        size = _lengths(first_run)
        difference = reduce(np.maximum, [_lengths(first_run - last[..., k::count]) for k in range(1, count)])
        self.add_difference(difference if extra_difference is None else difference + extra_difference, is_claimed)
        self.rounding = _larger(self.rounding, rounding)
        self.terms = _larger(self.terms, terms)
        self.largest, self.largest_requested = (
            _larger(self.largest, size),
            _larger(self.largest_requested, size[is_requested]),
        )
        self.low, self.high = min(self.low, float(first_run.min())), max(self.high, float(first_run.max()))

    def add_difference(self, difference: Array, is_claimed: Mask) -> None:
        """Add differences (n,); is_claimed: which of them are before the horizon."""
        self.difference, self.claimed = (
            _larger(self.difference, difference),
            _larger(self.claimed, difference[is_claimed]),
        )

    @property
    def error(self) -> float:
        """The estimated error over the whole run."""
        return self.weights.difference * self.difference + self.weights.rounding * self.rounding

    @property
    def claimed_error(self) -> float:
        """The estimated error before the horizon, up to which results are claimed."""
        return self.weights.difference * self.claimed + self.weights.rounding * self.rounding

    @property
    def range_or_largest(self) -> float:
        """The range between lowest and highest value, or the largest magnitude if that is smaller."""
        return max(min(self.high - self.low, self.largest), 0.0)


def norms(vectors: Array) -> Array:
    """The lengths of vectors (n, m, 3), (n, m)."""
    return np.asarray(np.sqrt(np.einsum("tni,tni->tn", vectors, vectors)))


def lengths(values: Array) -> Array:
    """The largest length of the vectors (n, ..., 3), or magnitude of the numbers (n,), at each instant."""
    return _lengths(instants_last(values))


def _lengths(values: Array) -> Array:
    """The same for values with the instants last, (..., 3, n) or (n,)."""
    if values.ndim == 1:
        return np.abs(values)
    squares = (values * values).sum(axis=-2).reshape(-1, values.shape[-1])
    return np.asarray(np.sqrt(squares.max(axis=0)))


def _larger(so_far: float, values: Array) -> float:
    """Return the largest; nan counts as infinite."""
    largest = float(values.max(initial=0.0))
    return max(so_far, largest) if np.isfinite(largest) else np.inf


def relative_error(error: float, terms: float, *scales: float) -> float:
    """Divide an error by the first of the scales that exceeds the rounding of its terms; 0 if none does."""
    scale = next((x for x in scales if x > tolerances.NO_LOAD * terms), 0.0)
    if scale == 0.0:
        return 0.0
    found = error / scale if np.isfinite(scale) else np.inf
    return min(found, tolerances.UNKNOWN)
