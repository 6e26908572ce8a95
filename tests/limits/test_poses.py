"""Poses at which closed chains lose rank, and near them: where normal equations and mean solutions go wrong unseen."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.base.tolerances import EPS
from heuncli.results.results import Array
from tests.limits.methods import Equations, rk4
from tests.limits.windows import accelerated, normal_equations, upright
from tests.oracle.published import windows
from tests.shared.parallelogram import parallelogram_in_line
from tests.shared.scenes import near, solved
from tests.shared.three_rods import three_rods


# ---- a parallelogram that lies flat
@pytest.mark.parametrize(("rates", "left"), [((1, 1), 0.0), ((1, -3), 0.0), ((1, 2), 0.625), ((1, 0), 0.375)])
def test_a_mean_solution_answers_what_has_no_acceleration(rates: tuple[float, float], left: float) -> None:
    """(φ' − ψ')(3 φ' + ψ') = 0: of other rates least squares give accelerations all the same, and say nothing.

    The exact ones of a branch leave nothing over; heun refuses the others.
    """
    V, over = Equations(parallelogram_in_line(*rates)).least_squares()
    assert np.isfinite(V).all() and over == pytest.approx(left, abs=1e-12)
    if left == 0.0:
        found = solved(parallelogram_in_line(*rates))
        near(found.bodies["crank"]["angular_velocity"][0, 2], rates[0], 1.0, 1e-15)
        return
    with pytest.raises(SolveError) as caught:
        solved(parallelogram_in_line(*rates))
    assert caught.value.problems[0].code == "singular-pose"


# ---- three rods that nearly meet in one point
def three_rods_of(off: float) -> tuple[Array, Array]:
    """A = J M^-1 J^T of `three_rods`, and what the couple of 1 N m makes of its right-hand side."""
    at, along = np.array([[-1, 0], [0, 1], [off, -1]]), np.array([[1, 0], [0, -1], [0, 1]])
    J = np.column_stack([along, at[:, 0] * along[:, 1] - at[:, 1] * along[:, 0]]).astype(float)
    return J @ J.T, -J[:, 2]


@pytest.mark.parametrize(("off", "wrong"), [(1e-6, 1e-4), (1e-7, 1e-2), (1e-8, 0.3)])
def test_normal_equations_square_the_condition(off: float, wrong: float) -> None:
    """The third rod carries 1/off: to `wrong` by Cholesky's factor of A, if there is one; by heun to a rounding/off."""
    A, right = three_rods_of(off)
    try:
        L = np.linalg.cholesky(A)
        pull = abs(np.linalg.solve(L.T, np.linalg.solve(L, right))[2])
    except np.linalg.LinAlgError:
        pull = 0.0
    assert abs(pull * off - 1.0) > wrong / 30
    found = solved(three_rods(off))
    near(abs(found.joints["r3"]["tension"][0]), 1.0 / off, 1.0 / off, 8 * EPS / off)


# ---- A02, windows of equal bars
def test_normal_equations_lose_the_windows() -> None:
    """RK4, J M^-1 J^T solved as it is, 200 steps a second: through three flat poses, at the fourth the bars part."""
    h, state, parted = 0.005, upright(2), math.inf
    n = len(state) // 2

    def slope(y: Array) -> Array:
        return np.concatenate([y[n:], accelerated(y[:n], y[n:], 2)])

    for k in range(round(5.5 / h)):
        with np.errstate(all="ignore"):
            state = rk4(slope, state, h)
        bars = state[2 : 3 * 3 : 3]
        if not np.ptp(bars) < 1e-2:
            parted = k * h
            break
    assert 4.0 < parted < 5.5


def outer_pin(e: float) -> float:
    """What bar 0 pushes its pin with along x, e before the flat pose: −0.2725/e N and what stays finite.

    The tip's force by the bar's moment about its pin, a third of the turning θ'' = (3.5 g/3) sin θ, and half a coupler.
    """
    g, sin, cos = 9.81, math.cos(e), math.sin(e)
    turning = 3.5 * g / 3 * sin
    tip_y = -(g - turning * sin - cos) / 2
    tip_x = (turning / 3 - g / 2 * sin + tip_y * sin) / cos
    return tip_x - (turning * cos - sin) / 2


@pytest.mark.parametrize("e", [1e-6, 1e-7, 1e-8])
def test_normal_equations_lose_the_reactions(e: float) -> None:
    """Shortly before the flat pose: to a rounding over e by heun, which says so; to one over e² by A λ = ...

    At the pose itself they are open, and told so: tests/references/test_windows.py has the run through all of them.
    """
    found = solved(windows(2, math.pi / 2 - e, 1.0))
    near(found.joints["G0"]["force"][0, 0], outer_pin(e), 0.2725 / e, 30 * EPS / e)
    assert any("nearly singular" in w for w in found.warnings)
    _, _, pins = normal_equations(*np.split(upright(2, math.pi / 2 - e), 2), 2)
    assert abs(pins[0] / outer_pin(e) + 1.0) > EPS / e**2 / 10


def test_at_the_flat_pose_it_is_open() -> None:
    found = solved(windows(2, math.pi / 2, 1.0))
    for k in range(3):
        assert np.isnan(found.joints[f"G{k}"]["force"][0]).tolist() == [True, False, True]
    assert any(w.startswith("singular position at t = 0") for w in found.warnings)
    with pytest.raises(np.linalg.LinAlgError):
        np.linalg.cholesky(normal_equations(*np.split(upright(2, math.pi / 2), 2), 2)[0])


# ---- a slider-crank at its dead centre
def crank(phi: float, r: float = 0.1, l: float = 0.3) -> tuple[float, float]:
    """dx/dφ of the slider, and the mass felt at the crank: its own inertia and the slider, x = r cos φ + √(...)."""
    root = math.sqrt(l * l - (r * math.sin(phi)) ** 2)
    slope = -r * math.sin(phi) - r * r * math.sin(phi) * math.cos(phi) / root
    return slope, 1.0 / 300 + 1.5 * slope**2


def dead_centre(angle: str) -> dict[str, Any]:
    """A slider-crank whose rod weighs nothing, its slider struck by 1 N s along its guide."""
    (found,) = solved(f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  crank:
    shapes: [{{type: rod, from: [0, 0, 0], to: [0.1, 0, 0], mass: 1}}]
    points: {{O: [0, 0, 0], A: [0.1, 0, 0]}}
  slider:
    mass: 1.5
    center: [0, 0, 0]
    inertia: [1, 1, 1]
    points: {{B: [0, 0, 0]}}
    near: {{position: [0.4, 0, 0]}}
joints:
  shaft: {{type: pin, from: ground.O, to: crank.O, axis: [0, 0, 1], initial: {{angle: {angle}}}}}
  guide: {{type: slide, from: ground.O, to: slider.B, axis: [1, 0, 0]}}
  rod: {{type: rod, from: crank.A, to: slider.B, length: 0.3}}
impulses: {{blow: {{on: slider.B, vector: [1, 0, 0]}}}}
""").impulses
    return dict(found)


@pytest.mark.parametrize("angle", ["0", "1e-9", "1e-3"])
def test_the_slider_is_no_coordinate_at_the_dead_centre(angle: str) -> None:
    """The inertia felt at the slider is that at the crank over (dx/dφ)²: a division by zero where both lie in line.

    There the blow turns nothing and goes to the bearing. More, with a heavy rod, in tests/closed_forms/test_blows.py.
    """
    phi = float(angle)
    slope, inertia = crank(phi)
    if phi == 0.0:
        with pytest.raises(ZeroDivisionError):
            inertia / slope**2
    blow = dead_centre(angle)
    near(blow["bodies"]["crank"]["angular_velocity_jump"][2], slope / inertia, max(abs(slope) / inertia, 1e-12), 1e-9)
    near(blow["foundation"]["force"][0], 1.0 - 1.5 * slope**2 / inertia, 1.0, 1e-3)
    if phi == 0.0:
        near(blow["foundation"]["force"], [1.0, 0.0, 0.0], 1.0, 1e-14)


# ---- a chain stretched out
def test_the_tip_is_no_coordinate_of_a_stretched_chain() -> None:
    """(J M^-1 J^T)^-1, the inertia felt at the tip of two rods in line, does not exist along them: J has rank 1 of 2.

    heun needs none: r = h exactly, in every joint and every cut (tests/closed_forms/test_blows.py).
    """
    J = np.array([[0.0, 0.0], [1.0, 1.0]])  # of the tip along and across, two rods of 1 m along x
    M = np.array([[4 / 3, 1 / 2], [1 / 2, 1 / 3]])
    felt = J @ np.linalg.solve(M, J.T)
    with pytest.raises(np.linalg.LinAlgError):
        np.linalg.inv(felt)
