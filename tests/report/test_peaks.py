"""Extremes between the samples: met to rounding where smooth, never worse than the samples, all in few batches."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.output.tables.extremes_tables import NOT_SEARCHED
from heuncli.results.results import Array
from heuncli.study.search.extremes import MAX_COLUMNS, search_extremes
from tests.shared.command import Heun
from tests.shared.folders import ROOT

GRID = np.linspace(0.0, 2.0, 61)


def smooth(t: Array) -> Array:
    return np.stack([np.sin(7.0 * t + 0.3), np.exp(-t) * np.cos(3.0 * t), t, 5.0 + 0.0 * t], axis=1)


def test_a_smooth_peak_is_met_to_rounding() -> None:
    found = search_extremes(smooth, GRID)
    assert found.is_searched
    assert found.high[0] == pytest.approx(1.0, abs=1e-14)
    assert found.low[0] == pytest.approx(-1.0, abs=1e-14)
    assert np.sin(7.0 * found.high_at[0] + 0.3) == found.high[0]
    damped = (np.pi - np.arctan(1.0 / 3.0)) / 3.0  # tan 3t = -1/3
    assert found.low[1] == pytest.approx(np.exp(-damped) * np.cos(3.0 * damped), abs=1e-14)


def test_extremes_at_the_ends_and_of_constants() -> None:
    found = search_extremes(smooth, GRID)
    assert (found.low[2], found.low_at[2], found.high[2], found.high_at[2]) == (0.0, 0.0, 2.0, 2.0)
    assert found.low[3] == found.high[3] == 5.0


def test_the_higher_of_two_summits_wins_though_its_samples_are_lower() -> None:
    grid = np.linspace(0.0, 2.0, 21)

    def two(t: Array) -> Array:
        return (np.exp(-(((t - 0.4) / 0.2) ** 2)) + 1.01 * np.exp(-(((t - 1.45) / 0.2) ** 2)))[:, None]

    assert grid[two(grid).argmax()] == pytest.approx(0.4)
    assert search_extremes(two, grid).high_at[0] == pytest.approx(1.45, abs=1e-4)


def test_a_peak_between_the_first_two_samples_is_found() -> None:
    found = search_extremes(lambda t: -((t - 0.01)[:, None] ** 2), GRID)
    assert found.high[0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_never_worse_than_the_samples_and_never_above_the_truth(seed: int) -> None:
    random = np.random.default_rng(seed)
    rates, phases, kink = random.uniform(1.0, 9.0, 5), random.uniform(0.0, 6.0, 5), random.uniform(0.2, 1.8)

    def wild(t: Array) -> Array:
        return np.cos(np.outer(t, rates) + phases) + np.abs(t - kink)[:, None] * random_sign + (t > kink)[:, None]

    random_sign = random.choice([-1.0, 1.0])
    found = search_extremes(wild, GRID)
    dense = wild(np.linspace(0.0, 2.0, 200_001))
    assert (found.high >= wild(GRID).max(axis=0)).all()
    assert (found.low <= wild(GRID).min(axis=0)).all()
    assert (found.high <= dense.max(axis=0) + 1e-4).all()
    assert np.allclose(wild(np.sort(found.high_at))[np.argsort(np.argsort(found.high_at)), range(5)], found.high)


def test_groups_compare_their_columns() -> None:
    found = search_extremes(smooth, GRID, [[0, 2], [1, 3]])
    assert found.high.tolist() == [2.0, 5.0]
    assert found.high_column.tolist() == [2, 3]
    assert found.low_column.tolist() == [0, 1]


def test_what_is_open_is_passed_over() -> None:
    def partly(t: Array) -> Array:
        return np.stack([np.where(t < 1.0, t, np.nan), np.full_like(t, np.nan)], axis=1)

    found = search_extremes(partly, GRID)
    assert 0.9 < found.high[0] < 1.0
    assert np.isnan([found.low[1], found.high[1]]).all()


def test_few_batches_and_none_beyond_the_cap() -> None:
    calls: list[int] = []

    def counted(t: Array) -> Array:
        calls.append(len(t))
        return np.sin(np.outer(t, 5.0 + 7.0 * np.linspace(0.0, 1.0, MAX_COLUMNS + 1)))

    search_extremes(lambda t: counted(t)[:, :50], GRID, errors=np.full(50, 1e-9))
    assert len(calls) <= 7
    assert sum(calls[1:]) <= 50 * 2 * 8
    calls.clear()
    assert not search_extremes(counted, GRID, max_groups=MAX_COLUMNS).is_searched
    assert calls == [len(GRID)]


def test_one_of_many_equal_summits_is_told_apart() -> None:
    """108 summits in 54 turns, of which one is higher by a millionth: each is looked at, and few instants more."""
    grid, calls = np.linspace(0.0, 54.0, 54 * 16 + 1), []

    def nearly(t: Array) -> Array:
        calls.append(len(t))
        return (np.cos(4.0 * np.pi * t + 0.7) * (1.0 + 1e-6 * np.exp(-(((t - 31.2) / 0.3) ** 2))))[:, None]

    found = search_extremes(nearly, grid, errors=np.array([1e-10]))
    dense = nearly(np.linspace(30.5, 32.0, 300_001)).max()
    assert found.high[0] >= dense
    assert found.high_at[0] == pytest.approx(31.2, abs=0.3)
    assert sum(calls[1:-1]) <= 16 * 2 * 108


@pytest.mark.parametrize("seed", range(40))
def test_no_summit_of_waves_is_missed(seed: int) -> None:
    """Waves of up to half a radian between two instants: as fast as the grid lets anything turn."""
    random = np.random.default_rng(seed)
    rates, phases, sizes = (
        random.uniform(1.0, 14.0, (3, 8)),
        random.uniform(0.0, 6.0, (3, 8)),
        random.uniform(-1, 1, (3, 8)),
    )

    def waves(t: Array) -> Array:
        return np.sum(sizes * np.sin(t[:, None, None] * rates + phases), axis=1)

    found = search_extremes(waves, GRID, errors=np.full(8, 1e-11))
    dense = waves(np.linspace(0.0, 2.0, 20_001))
    assert (found.high >= dense.max(axis=0) - 1e-11).all()
    assert (found.low <= dense.min(axis=0) + 1e-11).all()


def test_kinks_and_jumps_are_met() -> None:
    def broken(t: Array) -> Array:
        return np.stack([-np.abs(t - 0.7123), np.where(t > 0.7123, t - 3.0, t), -np.abs(np.sin(4.0 * t - 3.0))], axis=1)

    found = search_extremes(broken, GRID)
    assert found.high == pytest.approx([0.0, 0.7123, 0.0], abs=1e-11)


def test_squares_are_met_to_the_digits_of_their_roots() -> None:
    found = search_extremes(
        lambda t: np.stack([np.sin(t - 0.9) ** 2], axis=1), GRID, errors=np.array([1e-11]), is_squared=np.array([True])
    )
    assert np.sqrt(found.low[0]) <= 1e-11
    assert found.high[0] == pytest.approx(np.sin(1.1) ** 2, rel=1e-12)


def test_the_two_sides_of_a_jump_are_not_searched_between() -> None:
    """A saw: its value before the jump is its highest, and the instants on either side are given."""
    at = 0.7123
    grid, calls = np.unique([*GRID, np.nextafter(at, 0.0), at]), []

    def saw(t: Array) -> Array:
        calls.append(len(t))
        return (t - 3.0 * (t >= at))[:, None]

    found = search_extremes(saw, grid)
    assert (found.high_at[0], found.low_at[0]) == (np.nextafter(at, 0.0), at)
    assert len(calls) <= 3


def test_nothing_is_searched_for_nothing() -> None:
    found = search_extremes(lambda t: np.zeros((len(t), 0)), GRID)
    assert found.low.shape == found.high_at.shape == (0,)


@pytest.mark.heavy
def test_few_samples_of_many_turns_hide_no_load(heun: Heun, monkeypatch: pytest.MonkeyPatch) -> None:
    """Five cycles of an engine, told at nine instants; where that is too much to look at, it is told first."""
    words = [
        "run",
        str(ROOT / "specs" / "engine.yaml"),
        "--set",
        "analysis.duration=0.4",
        "--set",
        "analysis.samples=9",
    ]
    measured = float(heun(*words, "--measure", "max joints.wrist.force").stdout)
    told = heun(*words, "--only", "joints.wrist").stdout
    assert f"{measured:.1f}" in told and NOT_SEARCHED not in told
    monkeypatch.setattr("heuncli.study.queries.study.MOST_SEARCHED", 0)
    told = heun(*words, "--only", "joints.wrist").stdout
    assert f"{measured:.1f}" not in told and told.index(NOT_SEARCHED) < told.index("JOINTS")
