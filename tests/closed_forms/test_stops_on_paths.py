"""Stops and latches along paths: blows, what holds a bead at rest; neither hangs on what the tables are over."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.shared.scenes import near, solved

G = 9.81


def bead(unit: float, more: str, start: float, speed: float, times: str, gravity: float = -G) -> str:
    """A bead of 2 kg on z = x^2/2 from -2 to 2, by tables over travels of which one is `unit` metres along x."""
    x = [-2.0, -1.0, 0.0, 1.0, 2.0]
    s = [at / unit for at in x]
    held = f"travel: {start / unit}, speed: {speed / unit}"
    return f"""
heun: 1
gravity: [0, 0, {gravity}]
tables:
  x: {{x: {s}, y: {x}, interpolation: cubic}}
  z: {{x: {s}, y: {[0.5 * at * at for at in x]}, interpolation: cubic}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bead: {{mass: 2, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{P: [0, 0, 0]}}}}
joints:
  wire: {{type: curve, from: ground.O, to: bead.P, x: x, z: z, initial: {{{held}}}}}
{more}
analysis: {{times: {times}, tolerance: 1e-11}}
"""


def along(x: float) -> list[float]:
    """The way's direction at x."""
    return [1.0 / math.hypot(1.0, x), 0.0, x / math.hypot(1.0, x)]


@pytest.mark.parametrize("unit", [1.0, 0.1, 7.0])
def test_a_strike_and_what_holds_where_a_latch_catches(unit: float) -> None:
    """m v (1 + e) against the way, v^2 = 2 g (z0 - z), then m v, and m g sin at rest."""
    stops = f"""
stops:
  end: {{joint: wire, travel: [{-0.5 / unit}, {1.2 / unit}], restitution: 0.6}}
latches:
  hook: {{stop: end, limit: lower, when: t > 1.2}}"""
    found = solved(bead(unit, stops, 1.0, 0.0, "[0, 0.4, 2.9, 3]"))
    first, last = found.impulses[0], found.impulses[-1]
    v = math.sqrt(G * (1.0 - 0.25))
    e = np.array(along(-0.5))
    near(first["stops"]["end"]["force"], 2.0 * v * 1.6, 10.0, 1e-9)
    near(first["bodies"]["bead"]["center_velocity_jump"], 1.6 * v * e, 10.0, 1e-9)
    near(first["energy_jump"], -(1.0 - 0.36) * v * v, 10.0, 1e-9)
    near(last["stops"]["hook"]["force"], 2.0 * 0.6 * v, 10.0, 1e-9)
    near(found.coordinates["wire"]["travel"][-2:], -0.5 / unit, 1.0 / unit, 1e-9)
    near(found.stops["hook"]["force"][-2:], 2.0 * G * e[2], 20.0, 1e-9)
    near(found.foundation["elements"]["hook"]["force"][-1], -2.0 * G * e[2] * e, 20.0, 1e-9)
    near(found.joints["wire"]["force"][-1], 2.0 * G * e[0] * np.array([-e[2], 0.0, e[0]]), 20.0, 1e-9)


def test_a_stop_at_the_end_of_its_path() -> None:
    """It is struck there, and rests against it: rounding leads it off no path."""
    stop = "stops: {end: {joint: wire, travel: [-2, 2]}}"
    found = solved(bead(1.0, stop, 1.0, 4.0, "[0, 0.1, 1, 2]", gravity=G))
    e, v = np.array(along(2.0)), math.sqrt(32.0 + 2.0 * G * 1.5)
    near(found.impulses[0]["stops"]["end"]["force"], -2.0 * v, 20.0, 1e-9)
    near(found.coordinates["wire"]["travel"][-1], 2.0, 1.0, 1e-12)
    near(found.stops["end"]["force"][-1], -2.0 * G * e[2], 20.0, 1e-9)
    near(found.joints["wire"]["force"][-1], -2.0 * G * e[0] * np.array([-e[2], 0.0, e[0]]), 20.0, 1e-9)


def test_a_latch_anywhere_on_a_path() -> None:
    """It catches where the bead is; what it bears is the force along the path there."""
    latch = "latches: {brake: {joint: wire, when: t > 0.3, release: t > 0.5}}"
    for unit in (1.0, 0.25):
        found = solved(bead(unit, latch, 1.0, 0.0, "[0, 0.4, 0.45, 0.6]"))
        x = found.bodies["bead"]["position"][1, 0]
        e, v = np.array(along(x)), math.sqrt(G * (1.0 - x * x))
        near(found.impulses[0]["stops"]["brake"]["force"], 2.0 * v, 10.0, 1e-9)
        near(found.stops["brake"]["force"][1:3], 2.0 * G * e[2], 20.0, 1e-9)
        assert found.bodies["bead"]["position"][3, 0] < x
