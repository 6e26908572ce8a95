"""No turn is passed over between the instants of a coarse grid: of numbers that a midpoint, by chance, foretells."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from heuncli.results.results import Array
from heuncli.study.rainflow import find_turning_points
from heuncli.study.search.turnings import add_turning_points

COARSE, ERROR = 257, 1e-12
HARD: dict[str, tuple[Callable[[Array], Array], float]] = {
    "chirp": (lambda t: np.sin(400.0 * t * t), 3.0),
    "burst": (lambda t: np.sin(10.0 * t) + 0.02 * np.sin(3e4 * t) * np.exp(-(((t - 1.234) / 1e-3) ** 2)), 3.0),
}


@pytest.mark.parametrize("name", HARD)
def test_every_turn_of_a_dense_sampling_is_met(name: str) -> None:
    """Each turning point is as high as the densely sampled one, and there are as many."""
    law, duration = HARD[name]
    grid = np.linspace(0.0, duration, COARSE)
    errors, even = np.array([ERROR]), np.array([False])
    found = add_turning_points(lambda t: law(t)[:, None], grid, law(grid)[:, None], errors, even)
    assert found.complete
    mine, dense = find_turning_points(found.values[:, 0]), find_turning_points(law(np.linspace(0.0, duration, 400_001)))
    assert len(mine) == len(dense)
    np.testing.assert_allclose(mine, dense, atol=1e-3 * np.ptp(dense))
