"""The highest and lowest value along a run, from its values at the nodes of its pieces."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base import tolerances
from heuncli.loads.kinetostatics.stretch import DEGREE, NODES, TO_COEFFICIENTS, chebyshev_polynomials, find_peaks
from heuncli.results.results import Array

DENSE = np.linspace(-1.0, 1.0, 20_001)


def densely(values: Array) -> Array:
    """The values of the polynomials of one instant at many places, (m, 20001)."""
    coefficients = values.reshape(-1, DEGREE + 1) @ TO_COEFFICIENTS.T
    return np.asarray(coefficients @ chebyshev_polynomials(DENSE).T)


@pytest.mark.parametrize("seed", range(20))
def test_no_place_is_higher(seed: int) -> None:
    """Also of pieces of which several reach nearly the same: the highest sample need not be in the highest piece."""
    rng = np.random.default_rng(seed)
    shift = rng.uniform(-0.9, 0.9, (6, 1))
    summits = 1.0 + 1e-5 * rng.normal(size=(6, 1)) - rng.uniform(0.5, 2.0, (6, 1)) * (NODES - shift) ** 2
    values = summits.ravel() + 1e-6 * rng.normal(size=summits.size)
    low, high = find_peaks(values[None])
    dense = densely(values)
    for found, side in ((low, -1.0), (high, 1.0)):
        assert float(found.height[0]) >= (side * dense).max() - 1e-14
        assert float(found.height[0]) <= (side * dense).max() + 1e-7
        own = densely(values)[int(found.piece[0])]
        assert np.interp(float(found.position[0]), DENSE, side * own) == pytest.approx(float(found.height[0]), abs=1e-6)


@pytest.mark.parametrize("noise", [-1.0, 0.0, 1.0])
def test_rounding_does_not_choose_between_a_summit_and_a_level_of_its_samples(noise: float) -> None:
    """A piece too short for results repeats the value of one node: by rounding it may be above the sample there, which
    is below the summit beside it.
    """
    sampled = 75108.0 - 3e4 * (NODES - 0.02) ** 2
    level = np.full(DEGREE + 1, float(sampled[DEGREE // 2]) * (1.0 + 4.0 * noise * tolerances.EPS))
    for values in (np.concatenate([sampled, level]), np.concatenate([level, sampled])):
        _, high = find_peaks(values[None])
        assert float(high.height[0]) == pytest.approx(75108.0, rel=1e-14)
        assert float(high.position[0]) == pytest.approx(0.02, abs=1e-7)


def test_equal_pieces_are_named_by_their_samples() -> None:
    """The first of the highest samples, whatever the last digit of the others."""
    levels = np.ones((1, 5 * (DEGREE + 1)))
    assert [int(one.piece[0]) for one in find_peaks(levels)] == [0, 0]
    assert [int(one.piece[0]) for one in find_peaks(np.zeros((1, 45)))] == [0, 0]


def test_unknown_values_give_unknown_peaks() -> None:
    values = np.tile(1.0 - NODES**2, (2, 3))
    values[1, 4] = np.nan
    low, high = find_peaks(values)
    assert np.isfinite([low.height[0], high.height[0]]).all()
    assert np.isnan([low.height[1], high.height[1]]).all()
