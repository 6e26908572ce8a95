"""Time: drift, chaos, stiffness. Methods of fixed steps, and single runs that nothing checks."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.results.results import Array
from tests.limits.methods import rk4, stepped
from tests.shared.bars import rods
from tests.shared.published import course, spec_at
from tests.shared.scenes import near, solved

G = 9.81


# ---- drift of a closure that is only kept in accelerations
def cartesian(y: Array) -> Array:
    """A point mass on a massless bar in x, y: the bar's pull by x x'' + y y'' + x'² + y'² = 0."""
    a, b, u, v = y.tolist()
    pull = (u * u + v * v - G * b) / (a * a + b * b)
    return np.array([u, v, -pull * a, -pull * b - G])


POINT = """
heun: 1
gravity: [0, -9.81, 0]
ground: {points: {O: [0, 0, 0]}}
bodies: {mass: {mass: 1, center: [0, 0, 0], inertia: [0, 0, 0], points: {p: [0, 0, 0]}, position: [1, 0, 0]}}
joints: {bar: {type: rod, from: ground.O, to: mass.p}}
analysis: {duration: 100, samples: 101}
"""


@pytest.mark.parametrize(("h", "off"), [(0.02, -6.1e-2), (0.01, -3.6e-3), (0.005, -2.2e-4)])
def test_a_bar_gets_shorter_that_is_held_in_accelerations_alone(h: float, off: float) -> None:
    """RK4 over 100 s: 6 cm of 1 m at steps of 0.02 s, a sixteenth of it at half the step."""
    *_, last = stepped(rk4, cartesian, np.array([1.0, 0.0, 0.0, 0.0]), h, round(100 / h))
    assert math.hypot(last[0], last[1]) - 1.0 == pytest.approx(off, rel=0.03)


def test_heun_keeps_its_length() -> None:
    """And is where A01 has it after 42 periods."""
    found = solved(POINT)
    near(np.linalg.norm(found.bodies["mass"]["position"], axis=1), 1.0, 1.0, 1e-14)
    assert found.accuracy["constraint_gap"] <= 1e-14
    near(found.bodies["mass"]["position"][-1], [0.181513351427, -0.983388480334, 0.0], 1.0, 1e-9)  # mirrored


# ---- a double pendulum that forgets its start
REFERENCE = {2: (-2.78689971182110, -1.73651330809759), 10: (7.32792296542072, 25.6852343346577)}  # "Chaos"


def double_pendulum(y: Array) -> Array:
    """Uniform rods of 1 kg and 1 m, angles from the downward vertical, and their rates."""
    a, b, u, v = y.tolist()
    c, s = math.cos(a - b) / 2, math.sin(a - b) / 2
    f, h = -s * v * v - 1.5 * G * math.sin(a), s * u * u - 0.5 * G * math.sin(b)
    D = 4 / 9 - c * c
    return np.array([u, v, (f / 3 - c * h) / D, (4 / 3 * h - c * f) / D])


def energy(y: Array) -> float:
    a, b, u, v = y.tolist()
    kinetic = 2 / 3 * u * u + v * v / 6 + u * v * math.cos(a - b) / 2
    return kinetic - G * (1.5 * math.cos(a) + 0.5 * math.cos(b))


def test_a_single_run_is_wrong_and_does_not_know_it() -> None:
    """RK4 at 0.01 s: the energy holds to 1e-3 of what moves, the angles are right at 2 s and off by radians at 10 s."""
    passed = list(stepped(rk4, double_pendulum, np.array([2.5, 2.5, 0.0, 0.0]), 0.01, 1000))
    near(passed[200][:2], REFERENCE[2], 1.0, 2e-3)
    assert np.abs(passed[1000][:2] - REFERENCE[10]).max() > 1.0
    assert abs(energy(passed[1000]) - energy(passed[0])) < 1e-3 * 40.0


def test_heun_says_where_it_ends_and_is_right_before() -> None:
    """At the default tolerance. Nothing in double precision holds beyond 15 s: references/test_double_pendulum.py."""
    found = solved(rods([2.5, 2.5], [0.0, 0.0], "{times: [2, 10, 20], tolerance: 1e-9}"))
    upper = found.coordinates["pin0"]["angle"]
    angles = np.stack([upper, upper + found.coordinates["pin1"]["angle"]], axis=1)
    near(angles[0], REFERENCE[2], 1.0, 1e-8)
    near(angles[1], REFERENCE[10], 1.0, 1e-2)
    assert 11.0 < found.accuracy["horizon"] < 16.0


# ---- a stiff spring
SPRING = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies: {mass: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {p: [0, 0, 0]}}}
joints: {guide: {type: slide, from: ground.O, to: mass.p, axis: [1, 0, 0], initial: {travel: 1.01}}}
forces: {s: {type: spring, from: ground.O, to: mass.p, stiffness: 1e8, length: 1}}
analysis: {times: [0, 0.01, 0.1]}
"""
OMEGA = 1e4  # 1/s, of 1e8 N/m and 1 kg


def spring(y: Array) -> Array:
    return np.array([y[1], -OMEGA * OMEGA * y[0]])


@pytest.mark.parametrize(("h", "grows"), [(2.80e-4, False), (2.86e-4, True)])
def test_explicit_steps_on_a_stiff_spring_have_a_bound(h: float, grows: bool) -> None:
    """RK4 is stable up to h = 2 √2/ω = 2.83e-4 s: beside it 0.01 m die out or grow without bound in 0.3 s."""
    *_, last = stepped(rk4, spring, np.array([0.01, 0.0]), h, round(0.3 / h))
    amplitude = math.hypot(last[0], last[1] / OMEGA)
    assert amplitude > 1e3 if grows else amplitude < 1e-3


def test_heun_s_own_steps_of_given_length_own_up() -> None:
    """--method RK4: beyond the bound nothing is claimed from the first steps on, or the run ends; below it, as told."""
    lost = solved(SPRING, method="RK4", step=2.86e-4).accuracy
    assert lost["horizon"] < 1e-3 and lost["estimate"]["motion"] > 1e-3
    with pytest.raises(SolveError) as caught:
        solved(SPRING, method="RK4", step=4e-4)
    assert caught.value.problems[0].code in ("not-a-number", "step-collapsed")
    found = solved(SPRING, method="RK4", step=1e-5)
    true = [1 + 0.01 * math.cos(OMEGA * t) for t in (0, 0.01, 0.1)]
    off = float(np.abs(found.coordinates["guide"]["travel"] - true).max())
    assert 1e-7 < off < found.accuracy["estimate"]["motion"] * 1.5 < 1e-4


def test_heun_follows_it() -> None:
    found = solved(SPRING)
    near(found.coordinates["guide"]["travel"], [1 + 0.01 * math.cos(OMEGA * t) for t in (0, 0.01, 0.1)], 1.0, 1e-9)
    assert found.accuracy["estimate"]["motion"] <= 1e-9


# ---- A05, the stiff governor
def test_the_governor_s_struts_are_too_stiff_for_given_steps() -> None:
    """RK4 with 1e-3 s ends at once; auto takes an implicit method and has the ten seconds' digits."""
    scene, travel = spec_at("governor", [0, 2, 10], 1e-8), course("governor", "coordinates.sleeve.travel")
    with pytest.raises(SolveError):
        solved(scene, method="RK4", step=1e-3)
    found = solved(scene)
    assert found.model["method"].startswith("Radau")
    near(found.coordinates["sleeve"]["travel"][1:], [travel[2], travel[10]], 1.0, 2e-8)
