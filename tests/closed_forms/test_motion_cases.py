"""manual/theory.md, "Closed cases" of motion: 1 free top, 2 heavy top, 3 pendulum, 8, 10 rods in line, 11 cone.

Tolerances: the digits printed there, or the motion's tolerance where that is larger.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.shared.bars import HEAD, rods
from tests.shared.scenes import near, solved
from tests.shared.tops import PERIOD, free_top, heavy_top

G = 9.81


@pytest.mark.parametrize("joint", [True, False], ids=["on a ball", "free"])
def test_case_1_free_top(joint: bool) -> None:
    """σ = (α cn, β sn, γ dn)(pt | m), α = β = .9, γ = 1.1, p = 1.1; period 6.078117841793404."""
    body = solved(free_top("[1, 6.078117841793404, 10]", joint)).bodies["top"]
    spin = np.einsum("tji,tj->ti", body["rotation"], body["angular_velocity"])
    near(spin[0], [0.4389935957999769, 0.7856746291223909, 1.002116988704977], 1.0, 1e-13)
    near(spin[1], [0.9, 0.0, 1.1], 1.0, 1e-12)
    near(spin[2], [-0.5286165061102699, -0.7283986473544353, 1.016437473160094], 1.0, 1e-12)


def test_case_2_heavy_top() -> None:
    """cos θ between 0.5 and .3944487245360107; it precesses .4259411370822 rad a nutation."""
    axis = solved(heavy_top(8, "60 deg", f"[0, {PERIOD / 2}, 1, {PERIOD}]")).bodies["top"]["rotation"][:, :, 2]
    near(axis[:, 2], [0.5, 0.3944487245360107, 0.4050295921774855, 0.5], 1.0, 1e-13)
    near(math.degrees(math.acos(axis[1, 2])), 66.76840313962827, 1.0, 1e-11)
    turned = math.atan2(axis[3, 1], axis[3, 0]) - math.atan2(axis[0, 1], axis[0, 0])
    near(turned, 0.4259411370822, 1.0, 2e-13)
    near(turned / PERIOD, 0.2564992226430964, 1.0, 2e-13)


@pytest.mark.parametrize(("spin", "sleeps"), [(4.2, True), (3.8, False)])
def test_case_2_sleeping_top(spin: float, sleeps: bool) -> None:
    """Upright it sleeps above σ3 = 2 √(A m g l) / C = 4, below it falls over; attitudes have no singular place."""
    axis = solved(heavy_top(spin, "1e-4", "[0, 5, 10, 15]")).bodies["top"]["rotation"][:, :, 2]
    lean = np.hypot(axis[:, 0], axis[:, 1])
    assert lean[0] == pytest.approx(1e-4, rel=1e-7)
    if sleeps:
        assert lean.max() < 4e-4
    else:
        assert lean.max() > 1e-2


PENDULUMS = {10: 2.009892627298601, 90: 2.367841947576237, 170: 4.893524274105486, 179: 7.825796837537683}


@pytest.mark.parametrize("degrees", PENDULUMS)
def test_case_3_pendulum(degrees: int) -> None:
    """A point mass on a massless bar of 1 m: straight down after T/4, over there after T/2, back after T."""
    T, start = PENDULUMS[degrees], math.radians(degrees)
    found = solved(rods([start], [0.0], f"{{times: [{T / 4}, {T / 2}, {T}], tolerance: 1e-13}}", point_masses=True))
    angle, rate = found.coordinates["pin0"]["angle"], found.coordinates["pin0"]["rate"]
    near(angle, [0.0, -start, start], 1.0, 1e-11)
    near(rate, [-math.sqrt(2 * G * (1 - math.cos(start))), 0.0, 0.0], 10.0, 1e-11)


@pytest.mark.parametrize(("degrees", "along", "across"), [
    (60, 12.2625, -2.123927302781336), (0, 24.525, 0.0), (90, 0.0, -2.4525),
])  # fmt: skip
def test_case_3_support_of_a_rod_released_level(degrees: int, along: float, across: float) -> None:
    """s along the rod 2.5 g cos ϑ, across it −g/4 sin ϑ, ϑ from downward vertical; here at the rate it then has."""
    tilt = math.radians(degrees)
    found = solved(rods([tilt], [-math.sqrt(3 * G * abs(math.cos(tilt)))])).foundation["force"][0]
    e, f = np.array([math.sin(tilt), -math.cos(tilt), 0.0]), np.array([math.cos(tilt), math.sin(tilt), 0.0])
    near([found @ e, found @ f, found[2]], [along, across, 0.0], 24.525, 1e-14)


def test_case_8_two_rods_released_level() -> None:
    """α = (9/7, −3/7) g/L downwards, the support bears 2/7 m g, rod 2 is pulled down by m g/14 at the joint."""
    found = solved(rods([math.pi / 2] * 2, [0.0] * 2))
    for k, alpha in enumerate((-9 / 7, 3 / 7)):
        near(found.bodies[f"rod{k}"]["angular_acceleration"][0], [0.0, 0.0, alpha * G], G, 1e-14)
    near(found.foundation["force"][0], [0.0, -2 / 7 * G, 0.0], G, 1e-14)
    near(found.joints["pin0"]["force"][0], [0.0, 2 / 7 * G, 0.0], G, 1e-14)
    near(found.joints["pin1"]["force"][0], [0.0, -G / 14, 0.0], G, 1e-14)


@pytest.mark.parametrize(("point_masses", "squares"), [
    (True, [0.585786437626905, 3.414213562373095]), (False, [0.7322131619446366, 5.267786838055363]),
], ids=["points", "rods"])  # fmt: skip
def test_case_10_small_oscillations(point_masses: bool, squares: list[float]) -> None:
    """ω² l/g of the double pendulum, from the accelerations about rest: differences of 4th order, exact to h⁴."""
    h, weights = 2e-3, {1: 8.0, 2: -1.0}
    K = np.zeros((2, 2))
    for column in range(2):
        for step, weight in weights.items():
            for sign in (1.0, -1.0):
                angles = [0.0, 0.0]
                angles[column] = sign * step * h
                found = solved(rods(angles, [0.0, 0.0], point_masses=point_masses)).bodies
                for row in range(2):
                    alpha = found[f"rod{row}"]["angular_acceleration"][0, 2]
                    K[row, column] -= sign * weight * alpha / (12 * h)
    near(np.sort(np.linalg.eigvals(K).real) / G, squares, 1.0, 1e-9)


def test_case_10_frequencies_of_the_rods() -> None:
    """2.680114012253375 and 7.188670870287714 rad/s: each mode alone, 1e-5 rad large, is back after its period.

    Shapes from (K − ω² M) x = 0 with M = [[4/3, 1/2], [1/2, 1/3]], K = g [[3/2, 0], [0, 1/2]].
    """
    for omega in (2.680114012253375, 7.188670870287714):
        ratio = (1.5 * G - omega**2 * 4 / 3) / (omega**2 / 2)
        start = [1e-5, 1e-5 * ratio]
        T = 2 * math.pi / omega
        found = solved(rods(start, [0.0, 0.0], f"{{times: [{T / 2}, {T}], tolerance: 1e-13}}")).coordinates
        swing = np.stack([found["pin0"]["angle"], found["pin0"]["angle"] + found["pin1"]["angle"]])
        near(swing / 1e-5, np.outer([1, ratio], [-1, 1]), abs(ratio), 1e-7)


def test_case_11_conical_rod() -> None:
    """A uniform rod of 1 m at 40° on a ball goes round at Ω = √(3 g / (2 L cos 40°)) = 4.382815107043016."""
    turn = 2 * math.pi / 4.382815107043016
    found = solved(
        HEAD
        + f"""
bodies:
  rod:
    shapes: [{{type: rod, from: [0, 0, 0], to: [0, 0, -1], mass: 1}}]
    points: {{top: [0, 0, 0], tip: [0, 0, -1]}}
    orientation: {{axis: [0, 1, 0], angle: 40 deg}}
    angular_velocity: [0, 0, 4.382815107043016]
joints: {{pivot: {{type: ball, from: ground.O, to: rod.top}}}}
analysis: {{times: [0, {turn / 4}, {turn / 2}, {turn}], tolerance: 1e-13}}
"""
    )
    r, z = math.sin(math.radians(40)), math.cos(math.radians(40))
    near(found.points["rod.tip"]["position"], [[-r, 0, -z], [0, -r, -z], [r, 0, -z], [-r, 0, -z]], 1.0, 1e-12)
    inward = 4.382815107043016**2 * r / 2
    near(found.foundation["force"][0], [-inward, 0.0, -G], G, 1e-13)
