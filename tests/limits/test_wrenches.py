"""Wrenches that have no axis, no line; supports that would have to pull."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.results.results import Results
from tests.shared.scenes import near, solved


# ---- the central axis of a pure couple
def turned(couple: str, force: str) -> Results:
    return solved(f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{box: {{mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {{c: [0, 0, 0]}}}}}}
joints: {{clamp: {{type: weld, from: ground.O, to: box.c}}}}
forces: {{m: {{type: couple, on: box, vector: {couple}}}, f: {{type: force, on: box.c, vector: {force}}}}}
""")


def test_a_pure_couple_has_no_axis() -> None:
    """p = s × M/s² divides by zero; a force of 1e-6 N is enough to have one, at |M|/|s| from the point."""
    s, M = np.zeros(3), np.array([0.0, 0.0, 3.0])
    with np.errstate(invalid="ignore"):
        assert np.isnan(np.cross(s, M) / (s @ s)).all()
    axis = turned("[0, 0, 3]", "[0, 0, 0]").foundation["axis"]
    assert np.isnan(axis["point"]).all() and np.isnan(axis["direction"]).all() and np.isnan(axis["pitch"]).all()
    near(turned("[0, 0, 3]", "[1e-6, 0, 0]").foundation["axis"]["point"][0], [0.0, -3e6, 0.0], 3e6, 1e-12)


# ---- Heun's reduction line where nothing pulls
def bar(gravity: str) -> Results:
    return solved(f"""
heun: 1
gravity: {gravity}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bar:
    shapes: [{{type: box, center: [1, 0, 0], size: [2, 0.1, 0.1], density: 500}}]
    points: {{a: [0, 0, 0]}}
joints: {{wall: {{type: weld, from: ground.O, to: bar.a}}}}
sections: {{cut: {{body: bar, at: [1, 0, 0], normal: [1, 0, 0], reduce_to: line}}}}
""")


@pytest.mark.parametrize(("gravity", "kind"), [("[0, 0, -9.81]", 1), ("[-9.81, 0, 0]", 2), ("[-1, 0, -9.81]", 0)])
def test_a_cut_in_pure_shear_has_no_reduction_line(gravity: str, kind: int) -> None:
    """p = −n·(Q × M_t)/(N Q²) Q: kind 1, no point, where N = 0; 2, all points, where Q = 0; 0, a line, elsewhere."""
    cut = bar(gravity).sections["cut"]
    N, Q = cut["N"][0], math.hypot(cut["Q1"][0], cut["Q2"][0])
    with np.errstate(divide="ignore", invalid="ignore"):
        assert np.isfinite(np.float64(1.0) / (N * Q * Q)) == (kind == 0)
    assert cut["line"]["kind"].tolist() == [kind]
    assert bool(np.isnan(cut["line"]["point"]).all()) == (kind != 0)


# ---- a ladder at a wall that cannot pull
LADDER = """
heun: 1
gravity: [0, -9.81, 0]
ground: {{points: {{corner: [0, 0, 0]}}}}
bodies:
  ladder:
    shapes: [{{type: rod, from: [0, 0, 0], to: [0, 1, 0], mass: 1}}]
    points: {{foot: [0, 0, 0], head: [0, 1, 0]}}
    near: {{position: [0.3, 0, 0]}}
    orientation: {{axis: [0, 0, 1], angle: 0.3}}
joints:
  floor: {{type: line, from: ground.corner, to: ladder.foot, axis: [1, 0, 0]}}
  wall: {{type: line, from: ground.corner, to: ladder.head, axis: [0, 1, 0]}}
analysis: {{duration: 0.6, samples: 61{until}}}
"""


def test_a_guide_pulls_where_a_wall_could_not() -> None:
    """Both guides hold it throughout; a wall would have let go at cos ϑ = 2/3 cos 0.3, which `until` finds.

    At 0.9 rad the guide pulls with 0.26 N: tests/closed_forms/test_closed_chains.py. A wall: specs/ladder.yaml.
    """
    held = solved(LADDER.format(until=""))
    assert held.joints["wall"]["force"][-1, 0] < 0.0 < held.joints["wall"]["force"][0, 0]
    ends = solved(LADDER.format(until=", until: {of: joints.wall.force.x, below: 0}"))
    near(ends.bodies["ladder"]["rotation"][-1, 1, 1], 2 / 3 * math.cos(0.3), 1.0, 1e-8)
    assert ends.time[-1] < held.time[-1]
