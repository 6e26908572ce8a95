"""Constant-velocity joints beside Hooke's: shafts at a constant bend, their rates, torques and couples."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from tests.shared.scenes import solved

BENDS = [0.0, 0.5235987755982988, 1.2]


def shafts(bend: float, joint: str, driven: str) -> str:
    """Two shafts of inertias 0.01 and 0.03, the second one's end on a line."""
    c, s = float(np.cos(bend)), float(np.sin(bend))
    return f"""
heun: 1
ground: {{points: {{A: [0, 0, 0], B: [{0.5 + 0.5 * c!r}, {0.5 * s!r}, 0]}}}}
bodies:
  a: {{mass: 1, center: [0, 0, 0], inertia: [0.01, 0.02, 0.02], points: {{o: [0, 0, 0], tip: [0.5, 0, 0]}}}}
  b: {{mass: 1, center: [0, 0, 0], inertia: [0.03, 0.05, 0.05], position: [0.5, 0, 0],
      orientation: {{axis: [0, 0, 1], angle: {bend!r}}}, points: {{o: [0, 0, 0], tip: [0.5, 0, 0]}}}}
joints:
  first: {{type: pin, from: ground.A, to: a.o, axis: [1, 0, 0]}}
  bent: {{{joint}, from: a.tip, to: b.o}}
  second: {{type: line, from: ground.B, to: b.tip, axis: [{c!r}, {s!r}, 0]}}
{driven}
analysis: {{duration: 0.5, samples: 26}}
"""


CV = "type: cv, axis: [1, 0, 0]"


@pytest.mark.parametrize("bend", BENDS)
def test_both_shafts_turn_at_one_rate(bend: float) -> None:
    """One angular acceleration, by the sum of the inertias; the couple stands on the plane that halves the bend."""
    results = solved(shafts(bend, CV, "forces: {motor: {type: torque, joint: first, value: 3}}"))
    c, s = np.cos(bend), np.sin(bend)
    rate = 3.0 / 0.04 * results.time
    omega: Any = results.bodies["b"]["angular_velocity"]
    assert omega == pytest.approx(rate[:, None] * np.array([c, s, 0.0]), abs=1e-8 * rate[-1])
    bent = results.joints["bent"]
    assert bent["torque"] == pytest.approx(np.full(26, 2.25), rel=1e-8)
    halving = np.array([np.cos(bend / 2), np.sin(bend / 2), 0.0])
    assert bent["moment"] == pytest.approx(np.outer(np.full(26, 2.25 / np.cos(bend / 2)), halving), abs=1e-8)
    turning = omega - results.bodies["a"]["angular_velocity"]
    assert np.einsum("ti,ti->t", bent["moment"], turning) == pytest.approx(np.zeros(26), abs=1e-6)


@pytest.mark.parametrize("bend", BENDS[1:])
def test_beside_a_hooke_joint(bend: float) -> None:
    """The first at 20 rad/s: behind a cv joint the second, too, behind Hooke's 20 cos b / (1 - sin^2 b cos^2 angle)."""
    driven = "drives: {motor: {joint: first, angle: 20*t}}"
    axis = np.array([np.cos(bend), np.sin(bend), 0.0])
    angle = 20.0 * np.linspace(0.0, 0.5, 26)
    hooke = 20.0 * np.cos(bend) / (1.0 - np.sin(bend) ** 2 * np.cos(angle) ** 2)
    cross = "type: universal, axis: [0, 1, 0], to_axis: [0, 0, 1]"
    for joint, wanted in ((CV, np.full(26, 20.0)), (cross, hooke)):
        omega: Any = solved(shafts(bend, joint, driven)).bodies["b"]["angular_velocity"]
        assert omega @ axis == pytest.approx(wanted, rel=1e-7)


def test_axes_that_point_against_each_other() -> None:
    with pytest.raises(SolveError) as refused:
        solved(shafts(0.5, f"{CV}, to_axis: [-1, 0, 0]", ""))
    (problem,) = refused.value.problems
    assert problem.code == "cv-bend"
    assert "151.4 deg" in problem.message
    assert "reverse one of them" in problem.hint
