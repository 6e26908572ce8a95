"""Attitudes: where three numbers fail to hold one, and where a spin does not stay where it is."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.results.results import Array
from tests.limits.methods import rk4, stepped
from tests.oracle.turns import about
from tests.shared.scenes import near, solved

X, Y, Z = np.eye(3)


def free(inertia: str, spin: list[float], times: list[float], turn: Array | None = None) -> str:
    """A body that nothing holds and nothing loads, its centre at rest; spin in body axes."""
    matrix = (np.eye(3) if turn is None else turn).tolist()
    return f"""
heun: 1
bodies:
  top:
    mass: 1
    center: [0, 0, 0]
    inertia: {inertia}
    points: {{p: [1, 0, 0]}}
    orientation: {{matrix: {matrix}}}
    angular_velocity: {{vector: {spin}, frame: body}}
analysis: {{times: {times}, tolerance: 1e-12}}
"""


# ---- one chart for all attitudes: Rodrigues' κ = tan(θ/2) · axis
def kappa_rate(kappa: Array) -> Array:
    """κ' = (σ + κ (κ·σ) + κ × σ)/2 of a spin σ = (0, 0, 1) about a fixed axis."""
    return 0.5 * (Z + kappa * kappa[2] + np.cross(kappa, Z))


@pytest.mark.parametrize(("h", "off"), [(0.1, 0.058), (0.05, 0.058)])
def test_a_global_chart_does_not_pass_half_a_turn(h: float, off: float) -> None:
    """RK4 at unit spin goes on after t = π as if nothing were, and stands at half a turn: wrong by t − π from there.

    Just before, κ = tan(t/2) = 1256 at t = 3.14, and grows by 7.9e5 in a unit of time.
    """
    passed = list(stepped(rk4, kappa_rate, np.zeros(3), h, round(3.2 / h)))
    angle = 2.0 * math.atan(float(passed[-1][2]))
    assert passed[-1][2] > 1e4  # the chart's own equation leads to infinity
    assert abs(angle - 3.2) == pytest.approx(off, abs=1e-3)
    kappa = math.tan(1.57)
    assert (kappa, (1 + kappa**2) / 2) == (pytest.approx(1255.77, rel=1e-5), pytest.approx(7.9e5, rel=0.01))


def test_two_quarter_turns_have_no_sum_in_a_chart() -> None:
    """κ = (κ2 + κ1 + κ2 × κ1)/(1 − κ1·κ2) divides by zero; quaternions give (0, axis), and so does heun."""
    quarter = math.tan(math.pi / 4) * Z
    assert 1.0 - quarter @ quarter == pytest.approx(0.0, abs=4e-16)
    text = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  inner: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}
  outer: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}
joints:
  one: {type: pin, from: ground.O, to: inner.c, axis: [0, 0, 1], initial: {angle: 90 deg}}
  two: {type: pin, from: inner.c, to: outer.c, axis: [0, 0, 1], initial: {angle: 90 deg}}
"""
    outer = solved(text).bodies["outer"]
    near(outer["quaternion"][0], [0, 0, 0, 1], 1.0, 4e-16)
    near(outer["rotation"][0], np.diag([-1, -1, 1]), 1.0, 4e-16)


def test_heun_turns_on() -> None:
    """Whole turns and half ones, about an axis and tumbling: R(2π) = 1, and the moment of momentum stays."""
    turning = solved(free("[1, 1, 1]", [0, 0, 1], [math.pi, 3.2, 2 * math.pi])).bodies["top"]["rotation"]
    near(turning, [about(Z, t) for t in (math.pi, 3.2, 2 * math.pi)], 1.0, 1e-12)
    body = solved(free("[1, 2, 3]", [0.9, 0, 1.1], [0.0, 5.0, 10.0, 20.0])).bodies["top"]
    L = np.einsum("tij,j,tkj,tk->ti", body["rotation"], [1.0, 2.0, 3.0], body["rotation"], body["angular_velocity"])
    near(L, L[0], float(np.linalg.norm(L[0])), 1e-10)


def test_heun_has_the_failing_chart_in_its_list() -> None:
    """DOP853-rodrigues, Lagrange's form of no. 20, ends at the half turn and names the body.

    The same numbers anew in each step go on. In full: reduced, this is a turn in a plane, which needs no chart.
    """
    scene = free("[1, 2, 3]", [0, 0, 1], [3.0, 3.2, 2 * math.pi])
    with pytest.raises(SolveError) as caught:
        solved(scene, method="DOP853-rodrigues", reduce=False)
    (problem,) = caught.value.problems
    assert problem.code == "half-turn" and "top reaches half a revolution" in problem.message
    assert caught.value.reached == pytest.approx(math.pi, abs=0.01)
    turning = solved(scene, method="DOP853-recentred", reduce=False).bodies["top"]["rotation"]
    near(turning, [about(Z, t) for t in (3.0, 3.2, 2 * math.pi)], 1.0, 1e-11)


# ---- Euler's angles
def euler_rates(theta: float) -> Array:
    """Columns: what the rates of Euler's angles z-x-z add to the angular velocity, at φ = 0."""
    return np.column_stack([Z, X, [0.0, -math.sin(theta), math.cos(theta)]])


@pytest.mark.parametrize(("theta", "condition"), [(1e-1, 20.0), (1e-4, 2e4), (1e-8, 2e8)])
def test_eulers_angles_lose_their_digits(theta: float, condition: float) -> None:
    assert np.linalg.cond(euler_rates(theta)) == pytest.approx(condition, rel=1e-2)


NEAR = 1e-3  # how near to the vertical the body's axis comes


def tilted(t: float) -> Array:
    """A body that turns about the world's x axis, its own axis passing the vertical at t = 0.5."""
    return about(X, t - 0.5) @ about(Y, NEAR)


def rates_of_euler(y: Array) -> Array:
    """φ, θ, ψ of R = Rz(φ) Rx(θ) Rz(ψ) at the angular velocity (1, 0, 0): the first divides by tan θ."""
    phi, theta, _ = y.tolist()
    spun = math.sin(phi) / math.sin(theta)
    return np.array([-spun * math.cos(theta), math.cos(phi), spun])


def test_eulers_angles_lose_the_attitude_and_heun_keeps_it() -> None:
    """RK4 with a hundred steps a second: right to 2e-12 before the pole, to 1e-2 behind it."""
    R = tilted(0.0)
    start = [math.atan2(R[0, 2], -R[1, 2]), math.acos(R[2, 2]), math.atan2(R[2, 0], R[2, 1])]
    passed = list(stepped(rk4, rates_of_euler, np.array(start), 0.01, 100))
    off = []
    for k in (20, 100):
        phi, theta, psi = passed[k].tolist()
        R = about(Z, phi) @ about(X, theta) @ about(Z, psi)
        off.append(float(np.abs(R - tilted(0.01 * k)).max()))
    assert off[0] < 1e-11 and off[1] > 1e-2
    spin = tilted(0.0).T @ X
    body = solved(free("[1, 1, 1]", spin.tolist(), [0.0, 0.5, 1.0], tilted(0.0))).bodies["top"]
    near(body["rotation"], [tilted(t) for t in (0.0, 0.5, 1.0)], 1.0, 1e-12)


# ---- a spin about the axis of mean inertia
GROWTH = math.sqrt(1.0 / 3.0)  # of a disturbance, A = (1, 2, 3)
FLIP = {1e-2: 20.7546097646692, 1e-4: 36.7078194108336, 1e-8: 68.6133744524741, 1e-12: 100.518929411005}  # half, 2K/p


def euler_equations(y: Array) -> Array:
    """A = (1, 2, 3), body axes."""
    a, b, c = y.tolist()
    return np.array([-b * c, c * a, -a * b / 3.0])


@pytest.mark.parametrize("h", [0.1, 0.02])
def test_eulers_method_flips_at_the_wrong_time(h: float) -> None:
    """y + h y': the disturbance grows by 1 + h/√3 a step, and not by e^(h/√3); the energy grows, too."""
    y, n = np.array([1e-8, 1.0, 0.0]), 0
    while y[1] > 0.0:
        y, n = y + h * euler_equations(y), n + 1
    late = n * h / (FLIP[1e-8] / 2) - 1.0
    assert late == pytest.approx(h * GROWTH / 2, rel=0.2)


@pytest.mark.parametrize("e", [1e-2, 1e-4, 1e-8])
def test_heun_flips_in_time(e: float) -> None:
    """At 2K/p the spin is (ε, −1, 0): to the error of rounding by then, which grows as the flip comes on."""
    found = solved(free("[1, 2, 3]", [e, 1.0, 0.0], [0.0, FLIP[e]]))
    body = found.bodies["top"]
    spin = np.einsum("tji,tj->ti", body["rotation"], body["angular_velocity"])
    near(spin[1], [e, -1.0, 0.0], 1.0, 30 * 2.2e-16 * math.exp(GROWTH * FLIP[e] / 2) ** 2 * e + 1e-11)
    assert found.accuracy["horizon"] is None


def test_heun_says_from_when_rounding_turns_it() -> None:
    """ε = 1e-12 flips at 100.5 s by the theory; rounding decides sooner, and nothing is claimed from 47 s on."""
    found = solved(free("[1, 2, 3]", [1e-12, 1.0, 0.0], [0.0, FLIP[1e-12]]))
    assert found.accuracy["horizon"] == pytest.approx(math.log(1e-3 / 1e-15) / GROWTH, rel=0.1)


def test_without_a_disturbance_nothing_flips() -> None:
    body = solved(free("[1, 2, 3]", [0.0, 1.0, 0.0], [0.0, 200.0])).bodies["top"]
    near(body["angular_velocity"][1], Y, 1.0, 1e-12)
