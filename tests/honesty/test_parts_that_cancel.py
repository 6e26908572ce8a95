"""Numbers whose errors are not those of places: parts that err against each other, attitudes of small bodies.

Of what floats freely the sum of the mass effects stays 0, and momenta stay what they are. A small body in a large scene
turns by more than a part of the scene's size, Rodrigues' vectors by more still.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from heuncli.results.results_paths import find_values
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.queries.measure_uncertainty import find_search_error
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve

JOINED = """heun: 1
bodies:
  a: {mass: 1, center: [0, 0, 0], inertia: [0.1, 0.2, 0.25], points: {end: [0.5, 0, 0]}, position: [0, 0, 0],
    angular_velocity: [3, 1, 2], velocity: [0, 0, 0]}
  b: {mass: 2, center: [0.3, 0, 0], inertia: [0.3, 0.2, 0.4], points: {end: [0, 0, 0]}, angular_velocity: [-1, 4, -3]}
joints: {elbow: {type: ball, from: a.end, to: b.end}}
analysis: {duration: 1.5, samples: 31}
"""
SMALL = """heun: 1
bodies:
  large: {mass: 1, center: [10, 0, 0], inertia: [0.1, 50, 50], points: {o: [0, 0, 0]}}
  a: {mass: 0.1, center: [0.01, 0, 0], inertia: [1e-5, 2e-5, 2.5e-5], position: [3, 0, 0],
    angular_velocity: [30, 10, 20]}
ground: {points: {O: [0, 0, 0]}}
joints: {pivot: {type: pin, from: ground.O, to: large.o, axis: [0, 1, 0]}}
analysis: {duration: 0.5, samples: 11}
"""
OF_JOINED = (
    "foundation.mass_effect.moment_spin", "foundation.mass_effect.moment_orbital", "momentum.moment_spin",
    "momentum.moment_orbital", "momentum.total", "bodies.a.momentum", "bodies.b.moment_of_momentum",
    "system_vector.bodies.b", "bodies.a.rotation", "bodies.b.quaternion", "bodies.a.rodrigues",
)  # fmt: skip
OF_SMALL = ("momentum.moment_spin", "bodies.a.rotation", "bodies.a.quaternion", "bodies.a.rodrigues")


@cache
def found(scene: str, tolerance: float) -> Study:
    wanted = frozenset({"foundation", "motion"})
    return solve(load("scene.yaml", scene), Options(requested_reports=wanted, tolerance=tolerance))


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
@pytest.mark.parametrize(
    ("scene", "path"), [*((JOINED, path) for path in OF_JOINED), *((SMALL, path) for path in OF_SMALL)]
)
@pytest.mark.third
def test_each_has_its_error(scene: str, path: str, tolerance: float) -> None:
    own, exact = found(scene, tolerance), found(scene, 1e-11)
    it, its = (find_values(study.results, path) for study in (own, exact))
    off = float(np.nanmax(np.linalg.norm(np.atleast_3d(it.values - its.values), axis=1)))
    assert 1e-3 * find_search_error(own, it.keys) < off <= find_search_error(own, it.keys)
