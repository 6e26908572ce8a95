"""Energy, momentum and gaps over long runs."""

from __future__ import annotations

import numpy as np
import pytest

from tests.shared.bars import HEAD, double
from tests.shared.scenes import near, solved
from tests.shared.tops import free_top


@pytest.mark.parametrize(("tolerance", "allowed"), [(1e-8, 1e-7), pytest.param(1e-11, 1e-10, marks=pytest.mark.heavy)])
def test_energy_of_two_bars(tolerance: float, allowed: float) -> None:
    """Ten seconds of the double pendulum in space: the drift stays ten tolerances small, gaps are none in a tree."""
    found = solved(double(f"{{duration: 10, samples: 11, tolerance: {tolerance}}}")).accuracy
    assert found["energy_drift"] <= allowed
    assert found["constraint_gap"] == 0.0
    assert found["balance_residual"] <= 1e-12


@pytest.mark.heavy
def test_momentum_of_a_free_top() -> None:
    """A thousand seconds: the moment of momentum stays where it was, the attitude stays a rotation."""
    found = solved(free_top("[0, 100, 1000]", False).replace("1e-13", "1e-10"))
    body = found.bodies["top"]
    L = np.einsum("tij,j,tkj,tk->ti", body["rotation"], [1.0, 2.0, 3.0], body["rotation"], body["angular_velocity"])
    near(L, L[0], float(np.abs(L[0]).max()), 1e-9)
    near(np.einsum("tij,tkj->tik", body["rotation"], body["rotation"]), np.eye(3), 1.0, 1e-14)


def test_a_free_body_falls_on_its_parabola() -> None:
    """No joint at all: the centre of mass of a spinning body under its weight and a push that turns with the time."""
    found = solved(HEAD + """
bodies:
  stone: {mass: 2, center: [0.1, 0.2, 0], inertia: [0.3, 0.4, 0.5], points: {c: [0.1, 0.2, 0]},
          velocity: [1, 2, 3], angular_velocity: {vector: [3, -1, 2], frame: body}}
forces: {push: {type: force, on: stone.c, vector: ["4*sin(3*t)", 0, "4*cos(3*t)"]}}
analysis: {duration: 5, samples: 6, tolerance: 1e-12}
""").bodies["stone"]  # fmt: skip
    t = np.arange(6.0)
    x0, v0 = found["center"][0], found["center_velocity"][0]
    a, w = 2.0, 3.0
    push = np.stack([a / w * t - a / w**2 * np.sin(w * t), 0 * t, a / w**2 * (1 - np.cos(w * t))], axis=1)
    fall = np.outer(t * t / 2, [0.0, 0.0, -9.81])
    near(found["center"], x0 + np.outer(t, v0) + fall + push, 100.0, 1e-13)
