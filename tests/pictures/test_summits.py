"""The bounds of curves from samples: to what a parabola leaves, over no jump, of what is known alone."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.study.queries.curves import MAX_ADDED, find_bounds, halve_steps
from heuncli.study.search.grid import find_jump_sides


def sines(times: np.ndarray) -> np.ndarray:
    """Sines of all phases, (n_t, 50), each with a highest of 1 and a lowest of -1."""
    return np.sin(times[:, None] + np.linspace(0.0, 6.0, 50))


@pytest.mark.parametrize("step", [0.05, 0.2, 0.4])
def test_summits_are_known_to_three_halves_of_the_square_of_what_is_added(step: float) -> None:
    times = np.arange(0.0, 12.0, step)
    found = find_bounds(times, sines(times), smooth=np.ones((len(times) - 1, 50), dtype=bool), error=0.0)
    added = step**2 / 8.0
    assert found.is_fine
    assert np.abs(found.high - 1.0).max() <= 1.5 * added**2
    assert np.abs(found.low + 1.0).max() <= 1.5 * added**2
    assert np.abs(sines(times).max(axis=0) - 1.0).max() > 0.5 * added, "the samples alone would not do"


def test_too_few_instants_are_told() -> None:
    """And twice as many of them, where that is so, until they are enough."""
    times = np.arange(0.0, 12.0, 1.1)
    smooth = np.ones((len(times) - 1, 50), dtype=bool)
    assert not find_bounds(times, sines(times), smooth, error=0.0).is_fine
    assert find_bounds(times, sines(times), smooth, error=2.0).is_fine, "it is not known better"
    finer = halve_steps(times, find_jump_sides(times))
    assert len(finer) == 2 * len(times) - 1
    found = find_bounds(finer, sines(finer), np.ones((len(finer) - 1, 50), dtype=bool), error=0.0)
    assert np.abs(found.high - 1.0).max() <= MAX_ADDED


def test_no_parabola_leads_over_a_jump() -> None:
    """From 0 to 1 within no time: the highest is 1, not what lies beyond it on a curve through both sides."""
    times = np.array([0.0, 1.0, 2.0, np.nextafter(2.0, 3.0), 3.0, 4.0])
    values = np.array([0.0, 0.2, 0.3, 1.0, 0.9, 0.7])[:, None]
    jumps = find_jump_sides(times)
    assert jumps.tolist() == [False, False, True, False, False]
    found = find_bounds(times, values, ~jumps[:, None], error=0.0)
    assert (found.low[0], found.high[0]) == (0.0, 1.0)
    assert len(halve_steps(times, jumps)) == len(times) + 4


def test_what_is_not_known_is_passed_over() -> None:
    values = np.column_stack([[1.0, np.nan, 3.0, 2.0], [np.nan] * 4])
    found = find_bounds(np.arange(4.0), values, np.ones((3, 2), dtype=bool), error=0.0)
    assert (found.low[0], found.high[0]) == (1.0, 3.0)
    assert np.isnan([found.low[1], found.high[1]]).all()
