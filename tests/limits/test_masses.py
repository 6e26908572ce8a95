"""Bodies without inertia about an axis: where mass matrices and explicit formulas divide by zero."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.results.results import Array
from tests.oracle.turns import about
from tests.shared.scenes import near, solved

Z = np.array([0.0, 0.0, 1.0])
ARMS = (np.array([0.0, 0.0, -1.0]), np.array([0.0, 0.0, -1.0]))  # of two rods of 1 m, body axes
TURNS = (about(np.array([1.0, 0, 0]), 1.0), about(np.array([0, 1.0, 0]), 0.7))


def mass_matrix(axial: float) -> Array:
    """M_ab = δ_ab I_a + Σ m_i [(d_ai·d_bi) 1 − d_bi d_ai^T] of two rods of 1 kg on balls, (6, 6).

    manual/theory.md, "Trees of links".
    """
    inertias = [R @ np.diag([1 / 12, 1 / 12, axial]) @ R.T for R in TURNS]
    whole = [R @ c for R, c in zip(TURNS, ARMS, strict=True)]
    d = [{0: whole[0] / 2}, {0: whole[0], 1: whole[1] / 2}]  # of each body: the arms in the bodies on its path
    M = np.zeros((6, 6))
    for i in (0, 1):
        M[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] += inertias[i]
        for a, u in d[i].items():
            for b, w in d[i].items():
                M[3 * a : 3 * a + 3, 3 * b : 3 * b + 3] += (u @ w) * np.eye(3) - np.outer(w, u)
    return M


def rods(axial: float) -> str:
    """The same as a scene, released at rest."""
    body = "mass: 1, center: [0, 0, -0.5], points: {{a: [0, 0, 0], b: [0, 0, -1]}}, inertia: [{0}, {0}, {1!r}]"
    one, other = (body.format(1 / 12, axial) + f", orientation: {{matrix: {R.tolist()}}}" for R in TURNS)
    return f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{one: {{{one}}}, other: {{{other}}}}}
joints: {{A: {{type: ball, from: ground.O, to: one.a}}, B: {{type: ball, from: one.b, to: other.a}}}}
"""


def test_the_mass_matrix_of_thin_rods_is_singular() -> None:
    """Rank 4 of 6, the null vectors along the rods; Cholesky's factor of it is none, or nothing but rounding."""
    M = mass_matrix(0.0)
    values, vectors = np.linalg.eigh(M)
    assert np.sum(values > 1e-12) == 4
    axes = np.array([[*(TURNS[0] @ Z), 0, 0, 0], [0, 0, 0, *(TURNS[1] @ Z)]])
    near(np.abs(vectors[:, :2].T @ axes.T @ axes @ vectors[:, :2]), np.eye(2), 1.0, 1e-14)
    assert np.linalg.cond(M) > 1e15
    assert np.linalg.cond(mass_matrix(1e-9)) == pytest.approx(1.5e9, rel=0.3)


def test_heun_does_not_know_the_axial_inertia() -> None:
    """The same accelerations and forces from none to 1e-3 of it; more of this in tests/laws/test_thin_rods.py."""
    thin = solved(rods(0.0))
    for axial in (1e-9, 1e-6, 1e-3):
        thick = solved(rods(axial))
        for name in ("one", "other"):
            near(thin.bodies[name]["center_acceleration"], thick.bodies[name]["center_acceleration"], 9.81, 2e-15 * 30)
        near(thin.joints["A"]["force"], thick.joints["A"]["force"], 9.81, 1e-13)


# ---- the printed rows of (58) and (61): σ̇_i = (M_i + (A_j − A_k) σ_j σ_k)/A_i
SPIN, MOMENT = np.array([0.0, 2.0, -0.5]), np.array([0.0, 0.7, 1.3])


def spin_up(A: Array, M: Array, s: Array) -> Array:
    """σ̇ by Euler's rows, each divided by its own A."""
    gyroscopic = np.array([(A[1] - A[2]) * s[1] * s[2], (A[2] - A[0]) * s[2] * s[0], (A[0] - A[1]) * s[0] * s[1]])
    with np.errstate(invalid="ignore"):
        return (M + gyroscopic) / A


def test_the_printed_rows_divide_by_nothing() -> None:
    """A rod of 1 m and 3 kg along body x about its end: A = (0, 1, 1). 0/0 about its axis, and so in the section."""
    A = np.array([0.0, 1.0, 1.0])
    explicit = spin_up(A, MOMENT, SPIN)
    assert np.isnan(explicit[0]) and np.isfinite(explicit[1:]).all()
    center = np.array([0.85, 0.0, 0.0])  # of the piece beyond 0.7 m, 0.9 kg
    with np.errstate(invalid="ignore"):
        assert np.isnan(np.cross(explicit, center)).any()  # 0 times nothing known is nothing known


def test_heun_cuts_a_thin_rod() -> None:
    """s' = −m' a* (no load on the piece), a* with the spin that the rod's own moment makes, about its axis none."""
    found = solved(f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  rod:
    shapes: [{{type: rod, from: [0, 0, 0], to: [1, 0, 0], mass: 3}}]
    points: {{a: [0, 0, 0]}}
    angular_velocity: {{vector: {SPIN.tolist()}, frame: body}}
joints: {{A: {{type: ball, from: ground.O, to: rod.a}}}}
forces: {{m: {{type: couple, on: rod.a, vector: {MOMENT.tolist()}, frame: body}}}}
sections: {{cut: {{body: rod, at: [0.7, 0, 0], normal: [1, 0, 0]}}}}
""")
    turning = np.array([0.0, *MOMENT[1:]])  # A2 = A3 = 1, and no spin about the axis
    center = np.array([0.85, 0.0, 0.0])
    a = np.cross(turning, center) + np.cross(SPIN, np.cross(SPIN, center))
    near(found.sections["cut"]["force"][0], -0.9 * a, 3.0, 1e-14)
    assert np.isfinite(found.sections["cut"]["moment"]).all()
    near(found.sections["cut"]["T"][0], 0.0, 1.0, 1e-15)
