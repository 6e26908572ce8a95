"""manual/theory.md, "Closed cases" 15, golden case A: two links on balls; and what the corrected (49) is for.

(49) as printed lacks N = m''(σ'×c') × (σ''×a''): moment balance of both links together cannot tell, energy can.
"""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.results.results import Array, Results
from tests.shared.golden_a import GOLDEN_A
from tests.shared.scenes import near, solved

M1, M2 = 2.0, 1.5
I1, I2 = np.diag([0.2, 0.5, 0.6]), np.diag([0.1, 0.3, 0.35])  # centroidal, body axes
A1, A2, C1 = np.array([0.5, 0.1, -0.05]), np.array([0.4, -0.1, 0.2]), np.array([1.0, 0.2, 0.1])
G = np.array([0.0, 0.0, -9.81])
N = np.array([-3.171219551979122, -0.63007503262288, 0.063526533275337])
POWER = -41.43487548934319
EXCESS = 2.6468565  # [W] by which the printed (49) breaks the energy balance
EXACT = 1e-13


def hat(a: Array) -> Array:
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def arms(found: Results, k: int) -> tuple[Array, Array, Array]:
    """a', c', a'' in world axes at an instant."""
    R1, R2 = found.bodies["one"]["rotation"][k], found.bodies["two"]["rotation"][k]
    return R1 @ A1, R1 @ C1, R2 @ A2


def spins(found: Results, k: int) -> tuple[Array, Array]:
    """σ', σ'' at an instant."""
    return found.bodies["one"]["angular_velocity"][k], found.bodies["two"]["angular_velocity"][k]


def coupling(found: Results, k: int) -> Array:
    """N from the results."""
    _, c, a2 = arms(found, k)
    s1, s2 = spins(found, k)
    return M2 * np.cross(np.cross(s1, c), np.cross(s2, a2))


def mass_matrix(found: Results, k: int) -> Array:
    """M of manual/theory.md, "Trees of links", on (σ', σ''), (6, 6)."""
    a1, c, a2 = arms(found, k)
    R1, R2 = found.bodies["one"]["rotation"][k], found.bodies["two"]["rotation"][k]
    M = np.zeros((6, 6))
    M[:3, :3] = R1 @ I1 @ R1.T - M1 * hat(a1) @ hat(a1) - M2 * hat(c) @ hat(c)
    M[3:, 3:] = R2 @ I2 @ R2.T - M2 * hat(a2) @ hat(a2)
    M[:3, 3:] = -M2 * hat(c) @ hat(a2)
    M[3:, :3] = M[:3, 3:].T
    return M


def test_numbers() -> None:
    found = solved(GOLDEN_A)
    one, two = found.bodies["one"], found.bodies["two"]
    near(one["angular_acceleration"][0], [-7.872973507783647, 5.758454792674423, -3.649496691017909], 10.0, EXACT)
    near(two["angular_acceleration"][0], [-2.073300609302811, -2.314982049943921, 10.2532687586563], 10.0, EXACT)
    near(-found.joints["link"]["force"][0], [7.771627258333382, 3.538823485902244, -1.95601380076495], 10.0, EXACT)
    near(found.foundation["force"][0], [11.339814615811722, 10.324495892808134, -13.40547852636314], 10.0, EXACT)
    near(found.foundation["moment"][0], np.zeros(3), 10.0, EXACT)  # about the one fixed ball
    near(found.energy["kinetic"][0], 6.232248895944697, 1.0, EXACT)
    near(coupling(found, 0), N, 1.0, EXACT)
    near(sum(m * G @ b["center_velocity"][0] for m, b in ((M1, one), (M2, two))), POWER, 10.0, EXACT)


def rate_of_energy(found: Results, k: int, missing: float) -> float:
    """dE/dt = Σ m ẋ·ẍ + σ·Iσ̇ of the accelerations of (49), N counted `missing` times too little."""
    rhs = missing * np.concatenate([-coupling(found, k), coupling(found, k)])
    change = np.linalg.solve(mass_matrix(found, k), rhs)
    a1, c, a2 = arms(found, k)
    total = 0.0
    for b, m, inertia, ddx, dd in (
        ("one", M1, I1, np.cross(change[:3], a1), change[:3]),
        ("two", M2, I2, np.cross(change[:3], c) + np.cross(change[3:], a2), change[3:]),
    ):
        body = {key: value[k] for key, value in found.bodies[b].items()}
        I_world = body["rotation"] @ inertia @ body["rotation"].T
        total += m * body["center_velocity"] @ (body["center_acceleration"] + ddx)
        total += body["angular_velocity"] @ I_world @ (body["angular_acceleration"] + dd)
    return float(total)


def test_49_keeps_the_energy_and_as_printed_does_not() -> None:
    """The rate of the kinetic energy is the weight's power; without N it would be 2.6468565 W more."""
    found = solved(GOLDEN_A)
    near(rate_of_energy(found, 0, missing=0.0), POWER, 10.0, EXACT)
    near(rate_of_energy(found, 0, missing=1.0) - POWER, EXCESS, 1.0, 5e-8)
    turned = np.linalg.solve(mass_matrix(found, 0), np.concatenate([-N, N]))
    near(found.bodies["one"]["angular_acceleration"][0] + turned[:3], [0.886, 13.679, -6.610], 1.0, 5e-4)


@pytest.mark.parametrize("row", [0, 1], ids=["first link", "second link"])
def test_49_row_by_row(row: int) -> None:
    """dR'/dt − N = M'_k + c'×k'',  dR''/dt + N = M''_k, dR/dt by differences of the momenta along the run."""
    h = 2e-4
    found = solved(GOLDEN_A + f"analysis: {{times: [0, {h}, {2 * h}, {3 * h}, {4 * h}], tolerance: 1e-13}}")
    R = np.array([(mass_matrix(found, k) @ np.concatenate(spins(found, k))).reshape(2, 3)[row] for k in range(5)])
    rate = (R[0] - 8 * R[1] + 8 * R[3] - R[4]) / (12 * h)
    a1, c, a2 = arms(found, 2)
    load = (np.cross(a1, M1 * G) + np.cross(c, M2 * G), np.cross(a2, M2 * G))[row]
    sign = 1.0 - 2.0 * row
    near(rate - sign * coupling(found, 2), load, 10.0, 1e-9)
    assert np.abs(rate - load).max() > 0.1  # the check can fail: without N


@pytest.mark.heavy
def test_energy_along_the_motion() -> None:
    """E + U stays over two seconds, while the printed (49) would have put in the work of N·(σ'' − σ')."""
    found = solved(GOLDEN_A + "analysis: {duration: 2, samples: 2001, tolerance: 1e-12}")
    total = found.energy["kinetic"] + found.energy["potential"]
    near(total, total[0], float(found.energy["kinetic"].max()), 1e-11)
    excess = [coupling(found, k) @ (s2 - s1) for k in range(len(found.time)) for s1, s2 in [spins(found, k)]]
    near(excess[0], EXCESS, 1.0, 5e-8)
    assert abs(np.trapezoid(excess, found.time)) > 1.0
