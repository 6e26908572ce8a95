"""Masses from a milligram to a thousand tonnes in one closed chain: loads as exact statics and dynamics give them.

The light lever on a heavy slider is told in closed form, the random ones by sixty decimals.
"""

from __future__ import annotations

import pytest

from tests.honesty.faults import faults
from tests.honesty.mass_ratios import weighted_scene
from tests.shared.exact import solution
from tests.shared.scenes import near, solved, study
from tests.shared.seeds import spared

pytestmark = pytest.mark.heavy  # a family at random: with the compiled kernel, which has the same bits

SEEDS = 120


@pytest.mark.parametrize("seed", spared(range(SEEDS), range(40)))
def test_right_whatever_the_masses(seed: int) -> None:
    family, (scene, rates) = weighted_scene(seed)
    run = study(scene)
    wrong = faults(run, scene, solution(scene, rates))
    assert not wrong, f"{family}, {[b['mass'] for b in scene['bodies'].values()]} kg: {wrong[0]}"


@pytest.mark.parametrize("light", [1e-6, 1e-3, 1.0])
@pytest.mark.parametrize("heavy", [1.0, 1e3, 1e6])
def test_a_light_lever_on_a_heavy_slider(light: float, heavy: float) -> None:
    """30 N down at 2 m: 60 N in the rod at 1 m, 30 N in the one at the end, whatever either weighs."""
    found = solved(f"""
heun: 1
space: planar
ground: {{points: {{G: [0, 0, 0]}}}}
bodies:
  slider:
    {{mass: {heavy!r}, center: [0, 0, 0], inertia: 1,
      points: {{o: [0, 0, 0], q: [1, 1, 0], r: [0, -1, 0], s: [-1, 0, 0]}}}}
  lever:
    {{mass: {light!r}, center: [1, 0, 0], inertia: {light!r}, points: {{o: [0, 0, 0], q: [1, 0, 0], end: [2, 0, 0]}}}}
joints:
  guide: {{type: slide, from: ground.G, to: slider.o, axis: [1, 0, 0]}}
  end: {{type: rod, from: slider.r, to: lever.o}}
  across: {{type: rod, from: slider.s, to: lever.o}}
  middle: {{type: rod, from: slider.q, to: lever.q}}
forces:
  push: {{type: force, on: lever.end, vector: [0, -30, 0]}}
""")  # fmt: skip
    near([found.joints[name]["tension"][0] for name in ("end", "across", "middle")], [30, 0, 60], 60, 1e-12)
