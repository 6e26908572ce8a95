"""A step that is rounding of the time, onto an event beside the start, is done again as it was."""

from __future__ import annotations

import random

import numpy as np
import pytest

from tests.shared.scenes import study


def pendulum(seed: int) -> str:
    """A bar that is let go where the condition that is watched has its kink."""
    draw = random.Random(seed)
    start = draw.uniform(-2.0, 2.0)
    return f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bar: {{mass: 1, center: [0.5, 0, 0], inertia: [0.01, 0.1, 0.1], points: {{O: [0, 0, 0]}}}}
joints:
  pin: {{type: pin, from: ground.O, to: bar.O, axis: [0, 1, 0],
        initial: {{angle: {start!r}, rate: {draw.uniform(-3.0, 3.0)!r}}}}}
analysis:
  {{duration: 1, samples: 4, events: {{away: "abs(pin.angle - ({start!r})) > {draw.uniform(0.05, 0.2)!r}"}}}}
"""


@pytest.mark.parametrize("seed", [2, 4, 7, 9, 12, 13, 16, 17])
def test_what_is_between_is_the_runs_own(seed: int) -> None:
    run = study(pendulum(seed), time_limit=20)
    assert run.history.checked_run is not None
    steps = run.history.checked_run.run
    assert np.diff(np.append(0.0, steps.ends)).min() < 1e-14  # else the scene shows nothing
    assert run.results.accuracy["estimate"]["motion"] < 1e-8
    between = run.resample(np.linspace(0.0, 1.0, 101))
    total = between.energy["kinetic"] + between.energy["potential"]
    assert np.ptp(total) <= 1e-8 * np.abs(between.energy["kinetic"]).max()
