"""Impulses of couplings have the errors of impulses: a gear in which a blow comes after a coarse run."""

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

SCENE = """heun: 1
space: planar
gravity: [0, -9.81]
ground: {points: {A: [0, 0], B: [1, 0]}}
bodies:
  one: {mass: 2, center: [0.1, 0], inertia: 0.2, points: {p: [0, 0]}}
  two: {mass: 3, center: [0.05, 0.02], inertia: 0.5, points: {p: [0, 0], q: [0.4, 0]}}
  rod: {mass: 1, center: [0.2, 0], inertia: 0.02, points: {p: [0, 0], q: [0.5, 0]}}
joints:
  a: {type: pin, from: ground.A, to: one.p, initial: {angle: 0.3, rate: 4}}
  b: {type: pin, from: ground.B, to: two.p}
  c: {type: pin, from: two.q, to: rod.p, initial: {angle: 0.5, rate: -3}}
couplings: {mesh: {type: gear, of: [a, b], at: {body: ground, at: [0.4, 0]}, pressure_angle: 20 deg}}
impulses: {hit: {on: rod.q, vector: [3, 2], time: 0.7}}
analysis: {duration: 1, samples: 11}
"""


@cache
def found(tolerance: float) -> Study:
    return solve(
        load("gear.yaml", SCENE),
        Options(requested_reports=frozenset({"joints", "impulses", "motion"}), tolerance=tolerance),
    )


@pytest.mark.parametrize("path", ["couplings.mesh.force", "couplings.mesh.normal", "couplings.mesh.on.one.force",
                                  "joints.c.force", "bodies.rod.angular_velocity_jump"])  # fmt: skip
@pytest.mark.parametrize("tolerance", [1e-3, 1e-5])
def test_numbers_of_a_blow_have_their_errors(path: str, tolerance: float) -> None:
    own, exact = found(tolerance), found(1e-11)
    it, its = (find_values(study.results, f"impulses.0.{path}") for study in (own, exact))
    off = float(np.abs(it.values - its.values).max())
    assert 1e-3 * find_search_error(own, it.keys) < off <= find_search_error(own, it.keys)
