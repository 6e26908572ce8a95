"""Mass effects whose parts are told, and err against each other: of what floats freely their sum stays 0."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.results_paths import find
from heuncli.spec.load import load
from heuncli.study.ask.measure import stated_error
from heuncli.study.ask.study import Study
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve

SCENE = """heun: 1
bodies:
  a: {mass: 1, center: [0, 0, 0], inertia: [0.1, 0.2, 0.25], points: {end: [0.5, 0, 0]}, position: [0, 0, 0],
    angular_velocity: [3, 1, 2], velocity: [0, 0, 0]}
  b: {mass: 2, center: [0.3, 0, 0], inertia: [0.3, 0.2, 0.4], points: {end: [0, 0, 0]}, angular_velocity: [-1, 4, -3]}
joints: {elbow: {type: ball, from: a.end, to: b.end}}
analysis: {duration: 1.5, samples: 31}
"""


def found(tolerance: float) -> Study:
    wanted = frozenset({"foundation"})
    return solve(load("scene.yaml", SCENE), Options(wanted=wanted, tolerance=tolerance))


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
def test_each_part_of_the_mass_effects_has_its_error(tolerance: float) -> None:
    own, exact = found(tolerance), found(1e-11)
    for part in ("moment_spin", "moment_orbital"):
        it, its = (find(study.results, f"foundation.mass_effect.{part}") for study in (own, exact))
        off = float(np.linalg.norm(it.values - its.values, axis=1).max())
        assert 1e-3 * stated_error(own, it.keys) < off <= stated_error(own, it.keys)
