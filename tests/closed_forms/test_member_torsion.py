"""Torsion constants of members against Saint-Venant's equation, solved here by finite differences.

    phi_xx + phi_yy = -2 inside, phi = 0 on the edge, of a hole a constant with int phi_n ds = 2 A(hole); J = 2 int phi
A point next to the edge has the distance to it along the lines of the grid, found by bisection of what is inside
(Shortley and Weller); what is inside is told by tests/shared/member_regions.py. Two grids, extrapolated, have J to
0.5 %, as the circle and the rectangle show.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import spsolve

from heuncli.results.results import Array
from heuncli.scene.file_format.profiles import Family, Measures, find_profile
from heuncli.scene.shapes.member_section import make_member_section
from tests.shared.member_regions import is_inside

Inside = Callable[[Array, Array], Array]
GRID_ERROR = 0.006
STATED = 0.06  # in the manual, and in what heun model lists


def solve_grid(
    inside: Inside, left: float, right: float, low: float, high: float, h: float, hole: float = 0.0
) -> float:
    """J by a grid of spacing h, of a region with a hole of this area about the origin, or without one.

    phi = p + K q, p = 0 on both edges, q harmonic and 1 on the hole's; with D the flux of q into the hole, the K that
    makes the energy least gives J = 2 int p + 4 (int q + hole)^2/D.
    """
    X, Y = np.meshgrid(
        np.arange(left - 0.37 * h, right + 2 * h, h), np.arange(low - 0.41 * h, high + 2 * h, h), indexing="ij"
    )
    is_in = np.pad(inside(X, Y)[1:-1, 1:-1], 1)
    x, y, n = X[is_in], Y[is_in], int(is_in.sum())
    number = np.full(X.shape, -1)
    number[is_in] = np.arange(n)
    i, j = np.nonzero(is_in)
    neighbours, distances, holes = [], [], []
    for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        neighbour, distance = number[i + dx, j + dy], np.full(n, h)
        at_edge = neighbour < 0
        a, b = np.zeros(at_edge.sum()), np.full(at_edge.sum(), h)
        for _ in range(30):
            middle = 0.5 * (a + b)
            is_still_in = inside(x[at_edge] + dx * middle, y[at_edge] + dy * middle)
            a, b = np.where(is_still_in, middle, a), np.where(is_still_in, b, middle)
        distance[at_edge] = np.maximum(a, 1e-4 * h)
        neighbours.append(neighbour)
        distances.append(distance)
        holes.append(at_edge & (x * dx + y * dy < 0.0) & (hole > 0.0))  # inwards
    rows, columns, values, diagonal, source = [], [], [], np.zeros(n), np.zeros(n)
    for p, q in ((0, 1), (1, 0), (2, 3), (3, 2)):
        weight = 2.0 / (distances[p] * (distances[p] + distances[q]))
        diagonal -= weight
        source -= weight * holes[p]
        known = neighbours[p] >= 0
        rows.append(np.flatnonzero(known))
        columns.append(neighbours[p][known])
        values.append(weight[known])
    rows.append(np.arange(n))
    columns.append(np.arange(n))
    values.append(diagonal)
    matrix = csr_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(n, n))
    cells = 0.25 * (distances[0] + distances[1]) * (distances[2] + distances[3])
    J = 2.0 * float(spsolve(matrix, np.full(n, -2.0)) @ cells)
    if hole == 0.0:
        return J
    q = spsolve(matrix, source)
    flux = sum(float((h * (1.0 - q) / distance)[at].sum()) for distance, at in zip(distances, holes, strict=True))
    return J + 4.0 * (float(q @ cells) + hole) ** 2 / flux


def torsion(inside: Inside, left: float, right: float, low: float, high: float, h: float, hole: float = 0.0) -> float:
    """J of two grids, extrapolated: the cells at the edge err by the spacing squared."""
    coarse, fine = (solve_grid(inside, left, right, low, high, spacing, hole) for spacing in (h, h / 1.6))
    return fine + (fine - coarse) / (1.6**2 - 1.0)


def test_the_grids() -> None:
    assert torsion(lambda x, y: x * x + y * y < 1.0, -1, 1, -1, 1, 0.05) == pytest.approx(np.pi / 2, rel=2e-3)
    bar = torsion(lambda x, y: (np.abs(x) < 1.0) & (np.abs(y) < 0.1), -1, 1, -0.1, 0.1, 0.2 / 9)
    assert bar == pytest.approx(2.0 * 0.2**3 / 3.0 * (1.0 - 0.630 * 0.1), rel=GRID_ERROR)


MEASURED: tuple[tuple[Family, tuple[float, ...]], ...] = (
    ("I", (100, 200, 5, 8, 0)), ("I", (100, 200, 10, 10, 0)), ("I", (100, 100, 8, 16, 4)), ("I", (100, 60, 10, 5, 5)),
    ("T", (100, 100, 10, 10, 0)), ("T", (100, 100, 8, 12, 10)), ("T", (50, 100, 10, 6, 5)), ("T", (80, 60, 12, 6, 6)),
    ("L", (100, 100, 10, 10, 12, 6)), ("L", (80, 120, 12, 8, 10)), ("L", (50, 50, 5, 5)), ("L", (60, 120, 6, 12, 10)),
    ("C", (60, 100, 5, 8)), ("C", (80, 200, 8, 12, 13)), ("C", (100, 100, 10, 10, 10)),
)  # fmt: skip
NAMED = ("IPE 80", "IPE 200", "IPE 600", "HEA 100", "HEA 200", "HEB 300", "HEM 300", "UPN 80", "UPN 200", "UPN 400")


@pytest.mark.parametrize(("family", "sizes"), [*MEASURED, *((None, (name,)) for name in NAMED)])
@pytest.mark.third
def test_torsion_constant(family: Family | None, sizes: tuple[float, ...]) -> None:
    if family is None:
        profile = find_profile(str(sizes[0]))
        assert profile.measures is not None
        assert profile.family != "tube"
        family, m = profile.family, profile.measures
    else:
        m = Measures(*(1e-3 * size for size in sizes))
    scaled = Measures(*(1e3 * size for size in m[:6]), m.slope)
    left = 0.0 if family in ("C", "L") else -0.5 * scaled.width
    h = min(scaled.web, scaled.flange) / 8.0
    J = torsion(is_inside(family, scaled), left, left + scaled.width, 0.0, scaled.height, h)
    found = make_member_section(family, m).J * 1e12
    assert abs(found / J - 1.0) < STATED - GRID_ERROR, found / J - 1.0


@pytest.mark.parametrize("name", ["RHS 100x50x4", "SHS 100x10", "CFSHS 60x3"])
def test_box(name: str) -> None:
    m = find_profile(name).measures
    assert m is not None
    b, h, t = 1e3 * m.width, 1e3 * m.height, 1e3 * m.web
    hole = (b - 2 * t) * (h - 2 * t) - (4.0 - np.pi) * (1e3 * m.toe_radius) ** 2
    scaled = Measures(*(1e3 * size for size in m))
    J = torsion(is_inside("box", scaled), -0.5 * b, 0.5 * b, -0.5 * h, 0.5 * h, t / 7.0, hole)
    assert abs(make_member_section("box", m).J * 1e12 / J - 1.0) < STATED - GRID_ERROR


def test_the_grid_with_a_hole() -> None:
    """A ring, whose J is that of its area."""
    J = torsion(lambda x, y: np.abs(np.hypot(x, y) - 0.9) < 0.1, -1, 1, -1, 1, 0.2 / 9, np.pi * 0.64)
    assert J == pytest.approx(np.pi / 2 * (1.0 - 0.8**4), rel=2 * GRID_ERROR)
