"""The tops of manual/theory.md, "Closed cases" 1 and 2, as text: a free body and a heavy symmetric top."""

from __future__ import annotations

from tests.shared.bars import HEAD


def free_top(times: str, joint: bool) -> str:
    """A rigid body about its centre, inertia 1, 2, 3, held there by a ball or by nothing."""
    pivot = "joints: {pivot: {type: ball, from: ground.O, to: top.c}}" if joint else ""
    return f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  top:
    mass: 1
    center: [0, 0, 0]
    inertia: [1, 2, 3]
    points: {{c: [0, 0, 0]}}
    angular_velocity: {{vector: [0.9, 0, 1.1], frame: body}}
{pivot}
analysis: {{times: {times}, tolerance: 1e-13}}
"""


def heavy_top(spin: float, tilt: str, times: str) -> str:
    """A = 1 about the tip, C = .5, m g l = 1: 1 kg at 0.1 m under g = 10."""
    return (
        HEAD.replace("-9.81", "-10")
        + f"""
bodies:
  top:
    mass: 1
    center: [0, 0, 0.1]
    inertia: [0.99, 0.99, 0.5]
    points: {{tip: [0, 0, 0]}}
    orientation: {{axis: [1, 0, 0], angle: {tilt}}}
    angular_velocity: {{vector: [0, 0, {spin}], frame: body}}
joints: {{tip: {{type: ball, from: ground.O, to: top.tip}}}}
analysis: {{times: {times}, tolerance: 1e-13}}
"""
    )


PERIOD = 1.660594261039426  # of nutation
