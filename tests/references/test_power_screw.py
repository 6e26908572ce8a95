"""Shigley's Mechanical Engineering Design, example 8-1: a square-thread power screw with its collar."""

from __future__ import annotations

import math

import pytest

from tests.shared.scenes import near, solved

PRESS = """
heun: 1
ground: {points: {A: [0, 0, 0], B: [0.2, 0, 0]}}
bodies:
  screw: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}
  nut: {mass: 1, center: [0.2, 0, 0], inertia: [1, 1, 1], points: {o: [0.2, 0, 0]}}
joints:
  spin: {type: pin, from: ground.A, to: screw.o, axis: [0, 0, 1]}
  guide: {type: slide, from: ground.B, to: nut.o, axis: [0, 0, 1]}
couplings:
  thread: {type: screw, of: [spin, guide], lead: 8 mm, friction: {coefficient: 0.08, radius: 15 mm, speed: 0.01}}
forces:
  load: {type: torque, joint: guide, value: -6400}
  collar: {type: friction, joint: spin, coefficient: 0.08, radius: 20 mm, speed: 0.01}
drives: {motor: {joint: spin, rate: RATE}}
analysis: {type: state}
"""


@pytest.mark.parametrize(("rate", "torque", "of_thread"), [("10", 26.18, 15.94), ("-10", -9.77, 0.466)])
def test_example_8_1(rate: str, torque: float, of_thread: float) -> None:
    """Major diameter 32 mm, pitch 4 mm, double thread; 6.4 kN are raised, then lowered."""
    found = solved(PRESS.replace("RATE", rate))
    drive, own = found.joints["spin"]["drive"][0], found.couplings["thread"]
    near(drive, torque, 1.0, 5e-3)
    near(own["force"], 6400, 6400, 1e-12)
    near(abs(own["torque"][0]), of_thread, 1.0, 5e-3)
    near(found.forces["collar"]["value"], -math.copysign(10.24, drive), 1.0, 5e-3)
    if torque > 0.0:
        near(6400 * 0.008 / math.tau / drive, 0.311, 1.0, 5e-4)
