"""What an element exerts on the ground is told about its first point, however far its other points are from it."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.results.results_schema import REPORTS
from tests.shared.said_again import error_of
from tests.shared.scenes import study

G = 9.81


def hoist(rng: np.random.Generator) -> tuple[str, float, float, float, float]:
    """A load on a rope that leads over a sheave to a far anchor, and starts in equilibrium with a speed.

    With its mass [kg], stiffness [N/m], speed [m/s] and the place of the falling strand [m].
    """
    m, f, speed = rng.uniform(1.0, 3000.0), rng.uniform(0.5, 4.0), rng.uniform(0.1, 1.0)
    r, far, low = rng.uniform(0.05, 0.5), 10.0 ** rng.uniform(-0.3, 2.0), rng.uniform(1.0, 20.0)
    x, y = rng.uniform(-3.0, 3.0, 2).tolist()
    k = m * (2.0 * np.pi * f) ** 2
    length = far + 0.5 * np.pi * r + low - m * G / k
    text = f"""
heun: 1
space: planar
gravity: [0, -{G}]
ground: {{points: {{anchor: [{x - far!r}, {y + r!r}], head: [{x!r}, {y!r}], rail: [{x + r!r}, {y - low!r}]}}}}
bodies: {{hook: {{mass: {m!r}, center: [0, 0], inertia: 1, points: {{eye: [0, 0]}}}}}}
joints:
  guide: {{type: slide, from: ground.rail, to: hook.eye, axis: [0, 1], initial: {{travel: 0, speed: {-speed!r}}}}}
couplings:
  rope: {{type: rope, through: [ground.anchor, {{sheave: ground.head, radius: {r!r}, side: over}}, hook.eye],
         stiffness: {k!r}, length: {length!r}}}
analysis: {{duration: 1, samples: 41, tolerance: {10.0 ** rng.uniform(-9.0, -5.0)!r}}}
"""
    return text, m, k, speed, x + r


@pytest.mark.parametrize("seed", range(12))
def test_the_moment_of_a_rope_on_the_ground_is_as_wrong_as_stated_at_most(seed: int) -> None:
    text, m, k, speed, place = hoist(np.random.default_rng([seed, 1901]))
    run = study(text, requested_reports=frozenset(REPORTS))
    told = run.results.foundation["elements"]["rope"]
    tension = m * G + speed * np.sqrt(k * m) * np.sin(np.sqrt(k / m) * run.results.time)
    off = np.abs(told["moment"][:, 2] + (place - told["point"][:, 0]) * tension).max()
    assert 0.0 < off <= error_of(run, ("foundation", "elements", "rope", "moment"), "N·m")
