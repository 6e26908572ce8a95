"""200 chaotic scenes between their two to five samples: other instants are the run's own, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

from tests.honesty.chaotic import SEEDS, grid, run_of

pytestmark = pytest.mark.heavy  # a family at random: with the compiled kernel, which has the same bits

SOME = [3, 17, 31]


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.third
def test_between_the_samples_it_is_the_same_run(seed: int) -> None:
    """An instant by itself, among others, and as asked for: the same bits; and the energy of the start throughout."""
    run = run_of(seed)
    times = grid(run)
    shown, alone = run.resample(times), run.resample(times[SOME])
    asked = np.isin(times, run.results.time)
    for name, block in shown.bodies.items():
        for what, value in block.items():
            assert np.array_equal(value[asked], run.results.bodies[name][what]), f"{name} {what} as asked"
            assert np.array_equal(value[SOME], alone.bodies[name][what]), f"{name} {what} alone"
    total = shown.energy["kinetic"] + shown.energy["potential"]
    size = float(np.ptp(shown.energy["potential"])) + float(shown.energy["kinetic"].max())
    drift = float(np.abs(total - total[0]).max()) / size
    assert drift <= 1e4 * run.spec.analysis.tolerance, f"energy off by {drift:.1e}"
