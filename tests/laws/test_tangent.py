"""The tangent of the motion, d(ydot)/dy, against closed forms; against dual numbers: test_tangent_duals.py."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.multibody.response import tangent
from heuncli.results.results import Array
from tests.shared.scenes import study

DIGITS = 1e-14  # rounding

PENDULUM = """
heun: 1
gravity: [0, -9.81, 0]
ground: {points: {O: [0, 0, 0], A: [0, 0, 0.5]}}
bodies:
  rod: {mass: 2, center: [0, -0.6, 0], inertia: [0.3, 0.1, 0.3], points: {o: [0, 0, 0], a: [0, 0, 0.5]}}
joints:
  hinge: {type: pin, from: ground.O, to: rod.o, axis: [0, 0, 1], initial: {angle: 0.7, rate: 1.3}}
  second: {type: pin, from: ground.A, to: rod.a, axis: [0, 0, 1]}
forces:
  spring: {type: turn_spring, joint: hinge, stiffness: 50, angle: 0.1}
  damper: {type: damper, joint: hinge, coefficient: 1.7}
  drag: {type: torque, joint: hinge, value: "-0.4*hinge.rate*abs(hinge.rate) + 3*sin(hinge.angle)"}
analysis: {duration: 1, samples: 2}
"""

TOP = """
heun: 1
bodies: {top: {mass: 1, center: [0, 0, 0], inertia: [1, 2, 3], angular_velocity: [0.9, 0.4, 1.1]}}
analysis: {duration: 1, samples: 2}
"""


def tangent_at_start(text: str) -> tuple[Array, Array]:
    """The tangent at the start, and the state there."""
    s = study(text)
    layout = s.setup.runner.integrated_scene.layout
    return tangent(s.setup.runner.integrated_scene.workspace, 0.0, layout.y0), layout.y0


def test_a_pendulum() -> None:
    """J phi'' = -m g l sin phi - k (phi - phi0) - c phi' - 0.4 phi' |phi'| + 3 sin phi, held twice: with closures."""
    J, y = tangent_at_start(PENDULUM)
    inertia, phi, rate = 0.3 + 2 * 0.6**2, 0.7, 1.3
    assert y[:2].tolist() == [phi, rate]
    slope = (-2 * 9.81 * 0.6 * np.cos(phi) - 50 + 3 * np.cos(phi)) / inertia
    damping = (-1.7 - 0.8 * rate) / inertia
    assert J[:2, :2] == pytest.approx(np.array([[0, 1], [slope, damping]]), abs=DIGITS * 100)


def test_a_free_top() -> None:
    """Quaternions by dq/dt = (0, omega) q / 2; Euler's equations in world axes where they are the body's."""
    J, y = tangent_at_start(TOP)
    q, w = y[:4], y[-6:-3] if len(y) > 12 else y[4:7]
    at = next(k for k in range(len(y) - 2) if np.allclose(y[k : k + 3], [0.9, 0.4, 1.1]))
    w = y[at : at + 3]
    to_q = next(k for k in range(len(y) - 3) if np.allclose(y[k : k + 4], q))
    assert np.allclose(q, [1, 0, 0, 0])
    own = 0.5 * np.array([[0, *-w], [w[0], 0, -w[2], w[1]], [w[1], w[2], 0, -w[0]], [w[2], -w[1], w[0], 0]])
    assert J[to_q : to_q + 4, to_q : to_q + 4] == pytest.approx(own, abs=DIGITS)
    A = np.diag([1.0, 2.0, 3.0])
    hat = lambda a: np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])  # noqa: E731
    euler = -np.linalg.solve(A, hat(w) @ A - hat(A @ w))
    assert J[at : at + 3, at : at + 3] == pytest.approx(euler, abs=DIGITS)
