"""200 chaotic scenes asked for at two to five instants: what is told before the horizon is right, and it is told.

The truth is a run whose steps err less than its rounding, and another such run, of other steps, tells how well it is
known: what rounding itself makes of the motion is the same start's, and grows as the error that is judged.
"""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base import tolerances
from tests.honesty.chaotic import SEEDS, chaotic_scene, grid, run_of
from tests.shared.seeds import list_daily_seeds
from tests.shared.truth import KNOWN, SECOND, TRUTH, off


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.third
def test_right_before_the_horizon_and_told_where_it_is(seed: int) -> None:
    run = run_of(seed)
    times = grid(run)
    shown, horizon = run.resample(times), run.results.accuracy["horizon"]
    before = times < (np.inf if horizon is None else horizon)
    worst, other = (float(off(run, shown, times, t)[before].max(initial=0.0)) for t in (TRUTH, SECOND))
    stated = run.results.accuracy["estimate"]["motion"] if horizon is None else tolerances.CLAIMED
    if abs(worst - other) > KNOWN * stated:
        pytest.skip("the truth is not known so well")
    assert worst <= stated, f"{chaotic_scene(seed)[0]}: {worst:.1e} before the horizon {horizon}, {stated:.1e} stated"


@pytest.mark.long
def test_the_scenes_are_chaotic() -> None:
    """Some of them have a horizon even so."""
    told = [run_of(seed).results.accuracy["horizon"] for seed in list_daily_seeds(range(200))]
    assert sum(h is not None for h in told) >= 3, told
