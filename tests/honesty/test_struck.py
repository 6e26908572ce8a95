"""Chaotic scenes that are struck on the way: what is told before the horizon is right, energy goes on through it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.base import tolerances
from tests.honesty.chaotic import chaotic_scene, grid
from tests.shared.scenes import study
from tests.shared.truth import KNOWN, SECOND, TRUTH, off

pytestmark = pytest.mark.heavy  # a family at random: with the compiled kernel, which has the same bits


@pytest.mark.parametrize("seed", range(15))
@pytest.mark.third
def test_right_before_the_horizon(seed: int) -> None:
    """A point of some body, by 1 to 3 N s, in the first half of the run."""
    _, scene = chaotic_scene(seed)
    rng = np.random.default_rng(seed)
    at = float(scene["analysis"]["duration"] * rng.uniform(0.02, 0.6))
    bodies = scene["bodies"]
    name = list(bodies)[rng.integers(len(bodies))]
    vector = rng.standard_normal(3) * ([1, 1, 0] if scene.get("space") == "planar" else [1, 1, 1])
    hit = {"on": f"{name}.{next(iter(bodies[name]['points']))}", "vector": vector.tolist(), "time": at}
    run = study({**scene, "impulses": {"hit": hit}})
    (block,) = run.results.impulses
    times = np.unique([*grid(run), math.nextafter(at, 0.0), at])
    shown, horizon = run.resample(times), run.results.accuracy["horizon"]
    before = times < (np.inf if horizon is None else horizon)
    stated = run.results.accuracy["estimate"]["motion"] if horizon is None else tolerances.CLAIMED
    worst, other = (float(off(run, shown, times, t, (at,))[before].max()) for t in (TRUTH, SECOND))
    if abs(worst - other) > KNOWN * stated:
        pytest.skip("the truth is not known so well")
    assert worst <= stated
    e = shown.energy
    total = (e["kinetic"] + e["potential"] - e["work"])[before]
    size = float(np.ptp(e["potential"])) + float(e["kinetic"].max())
    assert float(np.abs(total - total[0]).max()) / size <= 1e4 * run.spec.analysis.tolerance
    k = int(np.searchsorted(times, at))
    assert e["kinetic"][k] - e["kinetic"][k - 1] == pytest.approx(float(block["energy_jump"]), abs=1e-12 * size)
