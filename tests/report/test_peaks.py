"""Extremes between the samples: met to rounding where smooth, never worse than the samples, all in few batches."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.results import Array
from heuncli.study.extremes import MOST_COLUMNS, search

GRID = np.linspace(0.0, 2.0, 61)


def smooth(t: Array) -> Array:
    return np.stack([np.sin(7.0 * t + 0.3), np.exp(-t) * np.cos(3.0 * t), t, 5.0 + 0.0 * t], axis=1)


def test_a_smooth_peak_is_met_to_rounding() -> None:
    found = search(smooth, GRID)
    assert found.searched
    assert found.high[0] == pytest.approx(1.0, abs=1e-14)
    assert found.low[0] == pytest.approx(-1.0, abs=1e-14)
    assert np.sin(7.0 * found.high_at[0] + 0.3) == found.high[0]
    damped = (np.pi - np.arctan(1.0 / 3.0)) / 3.0  # tan 3t = -1/3
    assert found.low[1] == pytest.approx(np.exp(-damped) * np.cos(3.0 * damped), abs=1e-14)


def test_extremes_at_the_ends_and_of_constants() -> None:
    found = search(smooth, GRID)
    assert (found.low[2], found.low_at[2], found.high[2], found.high_at[2]) == (0.0, 0.0, 2.0, 2.0)
    assert found.low[3] == found.high[3] == 5.0


def test_the_higher_of_two_summits_wins_though_its_samples_are_lower() -> None:
    grid = np.linspace(0.0, 2.0, 21)

    def two(t: Array) -> Array:
        return (np.exp(-(((t - 0.4) / 0.2) ** 2)) + 1.01 * np.exp(-(((t - 1.45) / 0.2) ** 2)))[:, None]

    assert grid[two(grid).argmax()] == pytest.approx(0.4)
    assert search(two, grid).high_at[0] == pytest.approx(1.45, abs=1e-4)


def test_a_peak_between_the_first_two_samples_is_found() -> None:
    found = search(lambda t: -((t - 0.01)[:, None] ** 2), GRID)
    assert found.high[0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_never_worse_than_the_samples_and_never_above_the_truth(seed: int) -> None:
    random = np.random.default_rng(seed)
    rates, phases, kink = random.uniform(1.0, 9.0, 5), random.uniform(0.0, 6.0, 5), random.uniform(0.2, 1.8)

    def wild(t: Array) -> Array:
        return np.cos(np.outer(t, rates) + phases) + np.abs(t - kink)[:, None] * random_sign + (t > kink)[:, None]

    random_sign = random.choice([-1.0, 1.0])
    found = search(wild, GRID)
    dense = wild(np.linspace(0.0, 2.0, 200_001))
    assert (found.high >= wild(GRID).max(axis=0)).all()
    assert (found.low <= wild(GRID).min(axis=0)).all()
    assert (found.high <= dense.max(axis=0) + 1e-4).all()
    assert np.allclose(wild(np.sort(found.high_at))[np.argsort(np.argsort(found.high_at)), range(5)], found.high)


def test_groups_compare_their_columns() -> None:
    found = search(smooth, GRID, [[0, 2], [1, 3]])
    assert found.high.tolist() == [2.0, 5.0]
    assert found.high_column.tolist() == [2, 3]
    assert found.low_column.tolist() == [0, 1]


def test_what_is_open_is_passed_over() -> None:
    def partly(t: Array) -> Array:
        return np.stack([np.where(t < 1.0, t, np.nan), np.full_like(t, np.nan)], axis=1)

    found = search(partly, GRID)
    assert 0.9 < found.high[0] < 1.0
    assert np.isnan([found.low[1], found.high[1]]).all()


def test_few_batches_and_none_beyond_the_cap() -> None:
    calls: list[int] = []

    def counted(t: Array) -> Array:
        calls.append(len(t))
        return np.sin(np.outer(t, np.arange(1.0, MOST_COLUMNS + 2.0)))

    search(lambda t: counted(t)[:, :50], GRID)
    assert len(calls) == 4
    assert max(calls) <= 50 * 16
    calls.clear()
    assert not search(counted, GRID).searched
    assert calls == [len(GRID)]


def test_nothing_is_searched_for_nothing() -> None:
    found = search(lambda t: np.zeros((len(t), 0)), GRID)
    assert found.low.shape == found.high_at.shape == (0,)
