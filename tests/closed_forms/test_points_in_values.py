"""Places and velocities of points in laws and conditions: motions as by coordinates, and instants by formulas."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import ellipk

from heuncli.results.results import Array
from tests.shared.scenes import near, solved, study

G = 9.81
PENDULUM = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  rod: {mass: 1, center: [0.5, 0, 0], inertia: [0, 0.08, 0.08], points: {a: [0, 0, 0], tip: [1, 0, 0]}}
joints:
  pivot: {type: pin, from: ground.O, to: rod.a, axis: [0, 1, 0], initial: {angle: 20 deg, rate: 0.3}}
forces:
  drag: {type: force, on: rod.tip, vector: [VX, 0, VZ]}
  spring: {type: torque, joint: pivot, value: "SPRING"}
analysis: {times: [0, 0.7, 1.9, 3], tolerance: 1e-11, events: {left: LEFT}}
"""
BY_POINT = {
    "VX": '"-0.3*points.tip.vx*hypot(points.tip.vx, points.tip.vz, 1e-3)"',
    "VZ": '"-0.3*points.tip.vz*hypot(points.tip.vx, points.tip.vz, 1e-3)"',
    "SPRING": "2*points.rod.tip.z + 0.4*points.tip.x*points.tip.vz", "LEFT": "points.tip.x < 0 mm",
}  # fmt: skip
SPEED = "hypot(pivot.rate, 1e-3)"
BY_JOINT = {
    "VX": f'"0.3*sin(pivot.angle)*pivot.rate*{SPEED}"', "VZ": f'"0.3*cos(pivot.angle)*pivot.rate*{SPEED}"',
    "SPRING": "-2*sin(pivot.angle) - 0.4*cos(pivot.angle)**2*pivot.rate", "LEFT": "cos(pivot.angle) < 0",
}  # fmt: skip


def written(text: str, names: dict[str, str]) -> str:
    """A scene with its values written in."""
    for name, value in names.items():
        text = text.replace(name, value)
    return text


def test_a_pendulum_by_its_angle_and_by_its_tip() -> None:
    """x = cos(phi), z = -sin(phi); and the same equation by SciPy."""
    by_point, by_joint = (solved(written(PENDULUM, names)) for names in (BY_POINT, BY_JOINT))
    angle = by_point.coordinates["pivot"]["angle"]
    near(angle, by_joint.coordinates["pivot"]["angle"], 1.0, 2e-10)
    near(by_point.events["left"]["time"], by_joint.events["left"]["time"], 1.0, 1e-9)
    near(by_point.energy["work"], by_joint.energy["work"], 1.0, 1e-9)

    def slope(_: float, y: Array) -> list[float]:
        phi, w = y
        drag = -0.3 * w * np.hypot(w, 1e-3)
        spring = -2 * np.sin(phi) - 0.4 * np.cos(phi) ** 2 * w
        return [w, (0.5 * G * np.cos(phi) + drag + spring) / 0.33]

    own = solve_ivp(slope, (0, 3), [np.deg2rad(20), 0.3], "DOP853", [0, 0.7, 1.9, 3], rtol=1e-13, atol=1e-13)
    near(angle, own.y[0], 1.0, 1e-9)


THROWN = """
heun: 1
gravity: [0, 0, -9.81]
bodies:
  ball:
    {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0], e: [0.5, 0, 0]}, position: [0, 0, 1],
     velocity: [1, 0.3, 2], angular_velocity: [0, 7, 0]}
analysis: {duration: 2, until: points.ball.c.z < 0, events: {top: points.c.vz < 0, edge: points.e.x > 60 cm}}
"""


def test_what_is_thrown_lands() -> None:
    found = solved(THROWN)
    near(found.events["until"]["time"], [(2 + np.sqrt(4 + 2 * G)) / G], 1.0, 1e-12)
    near(found.events["top"]["time"], [2 / G], 1.0, 1e-12)
    assert float(found.time[-1]) == found.events["until"]["time"][0]

    def off(t: float) -> float:
        return float(t + 0.5 * np.cos(7 * t) - 0.6)

    near(found.events["edge"]["time"], crossings(off, found.time[-1]), 1.0, 1e-10)


def crossings(off: object, last: float) -> Array:
    """Where a function is zero, in order."""
    assert callable(off)
    grid = np.linspace(0, last, 20001)
    values = np.array([off(t) for t in grid])
    return np.array(
        [brentq(off, grid[k], grid[k + 1], xtol=1e-16) for k in np.nonzero(values[:-1] * values[1:] < 0)[0]]
    )


SWING = """
heun: 1
gravity: [0, -9.81, 0]
ground: {points: {O: [0, 0, 0]}}
bodies:
  bob: {mass: 1, center: [0, -1, 0], inertia: [0, 0, 0], points: {o: [0, 0, 0], tip: [0, -1, 0]}}
joints:
  hang: {type: pin, from: ground.O, to: bob.o, axis: [0, 0, 1], initial: {angle: 1}}
analysis: {duration: 6, tolerance: 1e-12, events: {left: points.tip.x < 0}}
"""


def test_a_pendulum_passes_plumb() -> None:
    """Every half period, which is 2 K(sin(phi/2)) / sqrt(g)."""
    quarter = ellipk(np.sin(0.5) ** 2) / np.sqrt(G)
    times = solved(SWING).events["left"]["time"]
    near(times, quarter * (1 + 2 * np.arange(len(times))), 1.0, 1e-10)
    assert len(times) == 6


WHEEL = """
heun: 1
ground: {points: {O: [0, 0, 0], P: [3, 0, 0]}}
gravity: [0, -9.81, 0]
bodies:
  wheel: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0], rim: [0.5, 0, 0]}}
  bob: {mass: 1, center: [0, -1, 0], inertia: [0.1, 0.1, 0.1], points: {o: [0, 0, 0]}}
joints:
  axle: {type: pin, from: ground.O, to: wheel.o, axis: [0, 0, 1]}
  hang: {type: pin, from: ground.P, to: bob.o, axis: [0, 0, 1], initial: {angle: 1}}
drives: {turn: {joint: axle, angle: "ANGLE"}}
analysis: {duration: 0.5, events: {left: points.rim.x < -10 cm, down: points.rim.vy < -100 m/s}}
"""


@pytest.mark.heavy
@pytest.mark.parametrize("law", ["300*t", "300*t + 0.3*sin(40*t)", "30*sin(20*t)"])
def test_no_passing_of_what_is_driven_fast_is_missed(law: str) -> None:
    """Many turns a step, for nothing that is integrated feels them."""

    def angle(t: float) -> float:
        return float({"300*t": 300 * t, "30*sin(20*t)": 30 * np.sin(20 * t)}.get(law, 300 * t + 0.3 * np.sin(40 * t)))

    def rate(t: float) -> float:
        rates = {"300*t": 300.0, "30*sin(20*t)": 600 * np.cos(20 * t)}
        return float(rates.get(law, 300 + 12 * np.cos(40 * t)))

    events = solved(WHEEL.replace("ANGLE", law)).events
    near(events["left"]["time"], crossings(lambda t: 0.5 * np.cos(angle(t)) + 0.1, 0.5), 1.0, 1e-13)
    near(events["down"]["time"], crossings(lambda t: 0.5 * np.cos(angle(t)) * rate(t) + 100, 0.5), 1.0, 1e-13)


LEG = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 1]}}
bodies:
  leg: {mass: 3, center: [0.6, 0, 0], inertia: [0.01, 0.2, 0.2], points: {a: [0, 0, 0], foot: [1.2, 0, 0]}}
joints:
  hip: {type: pin, from: ground.O, to: leg.a, axis: [0, 1, 0], initial: {angle: 20 deg}}
forces:
  floor: {type: force, on: leg.foot, vector: [0, 0, "-5000*min(points.foot.z, 0)"]}
analysis: {type: rest}
"""


def test_a_leg_rests_on_a_floor() -> None:
    """m g c cos(phi) = k (L sin(phi) - h) L cos(phi); about it I w^2 = k (L cos(phi))^2."""
    found = study(LEG)
    phi = np.arcsin((1 + 3 * G * 0.6 / (5000 * 1.2)) / 1.2)
    near(found.results.coordinates["hip"]["angle"], phi, 1.0, 1e-12)
    near(found.results.forces["floor"]["value"], 3 * G * 0.6 / 1.2, 1.0, 1e-10)
    assert found.setup.rest is not None
    stability = " ".join(found.results.model["rest"])
    assert f"{5000 * (1.2 * np.cos(phi)) ** 2 / (0.2 + 3 * 0.36):.4g}" in stability
