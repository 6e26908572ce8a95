"""Stresses in sections by hand: circle, tube, rectangle (Saint-Venant's torsion by Timoshenko's table), given moments.

A bar welded to the ground, loaded by a force and a couple at its tip without weight: all six resultants are known.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.results.results import Array, Block
from tests.shared.scenes import near, solved

F = np.array([700.0, -40.0, 25.0])  # N, Q1, Q2 = F
C = np.array([12.0, 3.0, -5.0])  # about x, y, z: T; and M at the cut with the lever of F
LEVER = 0.4  # from the cut to the tip [m]
M = C + np.cross([LEVER, 0.0, 0.0], F)
AREA = {"circle": math.pi * 0.02**2, "tube": math.pi * (0.02**2 - 0.015**2), "rectangle": 0.03 * 0.06}


def stress(properties: str, force: Array = F, couple: Array = C, more: str = "", beside: float = 0.0) -> Block:
    """The stress block of a cut with normal x, e1 = y, its point somewhat beside the bar's axis."""
    found = solved(f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bar:
    shapes: [{{type: box, center: [0.5, 0, 0], size: [1, 0.03, 0.06], density: 1000}}]
    points: {{root: [0, 0, 0], tip: [1, 0, 0]}}
joints: {{wall: {{type: weld, from: ground.O, to: bar.root}}}}
forces:
  push: {{type: force, on: bar.tip, vector: {force.tolist()}}}
  twist: {{type: couple, on: bar.tip, vector: {couple.tolist()}}}
sections:
  cut: {{body: bar, at: [{1 - LEVER}, {beside}, 0], normal: [1, 0, 0], first_axis: [0, 1, 0],
         properties: {properties}{more}}}
""")
    cut = found.sections["cut"]
    about = [cut["N"][0], cut["Q1"][0], cut["Q2"][0]]
    near(about, force, 700.0, 1e-13)
    if "reduce_to" not in more and not beside:
        near([cut[name][0] for name in ("T", "M1", "M2")], couple + np.cross([LEVER, 0.0, 0.0], force), 700.0, 1e-13)
    return {name: float(value[0]) for name, value in cut["stress"].items()}


def expected(block: Block, axial: float, bending: float, torsion: float, area: float, factor: float) -> None:
    """The parts of the block, by W's and areas; the shear force's largest stress is `factor` times the mean.

    von Mises is no less than any point's that is plain: the extreme fibre's, and where shear and torsion meet.
    """
    shear = math.hypot(F[1], F[2]) / area
    near(block["normal_max"], axial + bending, abs(axial) + bending, 1e-13)
    near(block["normal_min"], axial - bending, abs(axial) + bending, 1e-13)
    near(block["shear_torsion"], torsion, torsion, 1e-13)
    near(block["shear_mean"], shear, shear, 1e-13)
    assert torsion < block["shear_max"] <= torsion + factor * shear * (1 + 1e-13)
    most = math.sqrt((abs(axial) + bending) ** 2 + 3 * block["shear_max"] ** 2)
    least = max(abs(axial) + bending, math.sqrt(3) * block["shear_max"])
    assert least * 0.999 < block["mises"] <= most * (1 + 1e-13)


def test_circle() -> None:
    """W = π R³/4 in bending, π R³/2 in torsion, whatever the direction of bending."""
    R = 0.02
    bending, torsion = math.hypot(M[1], M[2]) / (math.pi * R**3 / 4), abs(M[0]) / (math.pi * R**3 / 2)
    found = stress("{circle: {radius: 0.02}}")
    expected(found, F[0] / AREA["circle"], bending, torsion, AREA["circle"], 4 / 3)
    near(found["shear_max"], torsion + 4 / 3 * found["shear_mean"], torsion, 1e-13)


def test_tube() -> None:
    """W = π (R⁴ − r⁴)/(4 R)."""
    R, r = 0.02, 0.015
    W = math.pi * (R**4 - r**4) / (4 * R)
    found = stress("{tube: {radius: 0.02, inner_radius: 0.015}}")
    expected(found, F[0] / AREA["tube"], math.hypot(M[1], M[2]) / W, abs(M[0]) / (2 * W), AREA["tube"], 2.0)
    thick = 4 / 3 * (R * R + R * r + r * r) / (R * R + r * r)  # Q S/(I b) across the middle
    near(found["shear_max"], abs(M[0]) / (2 * W) + thick * found["shear_mean"], found["shear_max"], 1e-13)


# Largest shear stress T/(k a² b) of a rectangle b ≥ a (Timoshenko & Goodier, Theory of Elasticity, table of § 109)
TORSION = {1.0: 0.208, 1.2: 0.219, 1.5: 0.231, 2.0: 0.246, 2.5: 0.258, 3.0: 0.267, 4.0: 0.282, 5.0: 0.291, 10.0: 0.312}


@pytest.mark.parametrize("ratio", TORSION)
@pytest.mark.parametrize("upright", [True, False])
def test_torsion_of_rectangles(ratio: float, upright: bool) -> None:
    """To the three digits of the table, the long side along either axis."""
    a = 0.02
    b = ratio * a
    width, height = (a, b) if upright else (b, a)
    found = stress(f"{{rectangle: {{width: {width}, height: {height}}}}}")
    assert abs(M[0]) / (found["shear_torsion"] * a * a * b) == pytest.approx(TORSION[ratio], abs=6e-4)


def test_square_in_torsion_exactly() -> None:
    """Saint-Venant's series with hundreds of terms, to more digits than the table has."""
    n = np.arange(1, 4000, 2)
    J = 1 / 3 * (1 - 192 / math.pi**5 * np.sum(np.tanh(n * math.pi / 2) / n**5))
    slope = 1 - 8 / math.pi**2 * np.sum(1 / (n[:20] ** 2 * np.cosh(np.minimum(n[:20] * math.pi / 2, 700.0))))
    found = stress("{rectangle: {width: 0.02, height: 0.02}}")
    near(found["shear_torsion"], abs(M[0]) / (J / slope * 0.02**3), found["shear_torsion"], 1e-13)
    assert J == pytest.approx(0.1406, abs=5e-5)


def test_rectangle() -> None:
    """Width along e1, height along e2: the corner has |M1|/(b h²/6) + |M2|/(h b²/6)."""
    b, h = 0.03, 0.06
    found = stress("{rectangle: {width: 30 mm, height: 60 mm}}")
    bending = abs(M[1]) / (b * h**2 / 6) + abs(M[2]) / (h * b**2 / 6)
    expected(found, F[0] / (b * h), bending, found["shear_torsion"], b * h, 1.5)
    assert found["shear_torsion"] == pytest.approx(abs(M[0]) / (0.246 * b**2 * h), rel=3e-3)


def test_given_moments() -> None:
    """Any section by its area, moments, torsion constant and extents: as if all met in one place."""
    text = "{area: 2e-3, I1: 4e-7, I2: 3e-7, J: 1e-7, c1: 0.02, c2: 0.05}"
    bending = abs(M[1]) * 0.05 / 4e-7 + abs(M[2]) * 0.02 / 3e-7
    torsion = abs(M[0]) * 0.05 / 1e-7
    for properties, factor in ((text, 5.5), (text.replace("}", ", shear_factor: 1.6}"), 1.6)):
        found = stress(properties)
        expected(found, F[0] / 2e-3, bending, torsion, 2e-3, factor)
        shear = torsion + factor * found["shear_mean"]
        near(found["shear_max"], shear, shear, 1e-13)
        mises = math.hypot(F[0] / 2e-3 + bending, math.sqrt(3) * shear)
        near(found["mises"], mises, mises, 1e-13)


def as_numbers(area: float, I1: float, I2: float, J: float, c1: float, c2: float) -> str:
    return f"{{area: {area}, I1: {I1}, I2: {I2}, J: {J}, c1: {c1}, c2: {c2}}}"


def test_given_moments_are_no_less_than_the_shape_that_has_them() -> None:
    """A square's torsion is 1.35 T c/J, a thin rectangle's T b/J; a circle's, a tube's shear 4/3 and 2."""
    b, a, R, r = 0.02, 0.2, 0.02, 0.0199
    ring, thin = math.pi * (R**4 - r**4) / 4, b**3 * a / 3 * (1 - 0.63 * b / a)
    shapes = {
        "{rectangle: {width: 0.02, height: 0.02}}": as_numbers(
            b * b, b**4 / 12, b**4 / 12, 0.1406 * b**4, b / 2, b / 2
        ),
        "{rectangle: {width: 0.2, height: 0.02}}": as_numbers(a * b, a * b**3 / 12, b * a**3 / 12, thin, a / 2, b / 2),
        "{tube: {radius: 0.02, inner_radius: 0.0199}}": as_numbers(
            math.pi * (R * R - r * r), ring, ring, 2 * ring, R, R
        ),
    }
    for shape, numbers in shapes.items():
        known, given = stress(shape), stress(numbers)
        for name in ("normal_max", "shear_torsion", "shear_max", "mises"):
            assert given[name] > known[name] * (1 - 1e-3), (shape, name)


# shear force alone, across a bar's middle; tension and torsion away: textbooks' tau_max, and sqrt(3) of it
SHEAR_ALONE = {
    "{circle: {radius: 0.02}}": 4 / 3 / (math.pi * 0.02**2),
    "{tube: {radius: 0.02, inner_radius: 0.01999}}": 2 / (math.pi * (0.02**2 - 0.01999**2)),
    "{rectangle: {width: 0.03, height: 0.06}}": 1.5 / (0.03 * 0.06),
}


@pytest.mark.parametrize("shape", SHEAR_ALONE)
def test_shear_alone(shape: str) -> None:
    """The couple at the tip takes the bending away in the cut."""
    force = np.array([0.0, 3000.0, 4000.0])
    found = stress(shape, force, -np.cross([LEVER, 0.0, 0.0], force))
    tau = 5000.0 * SHEAR_ALONE[shape]
    near(found["shear_max"], tau, tau, 1e-6)
    near(found["mises"], math.sqrt(3) * tau, tau, 1e-6)
    near(found["normal_max"], 0.0, tau, 1e-9)


def test_bending_by_a_shear_force() -> None:
    """Of a circle under Q and M = Q l: the extreme fibre's, or the middle's where the lever is short."""
    for lever in (0.001, 0.01, 0.0115, 0.012, 0.1):  # 4/3 sqrt(3) Q/A = 4 Q l/(A R): l = R/sqrt(3) = 11.547 mm
        force = np.array([0.0, 0.0, 1000.0])
        found = stress("{circle: {radius: 0.02}}", force, np.cross([lever - LEVER, 0.0, 0.0], force))
        mean = 1000.0 / AREA["circle"]
        exact = mean * max(4 / 3 * math.sqrt(3), 4 * lever / 0.02)
        near(found["mises"], exact, exact, 1e-12)


def test_push_and_pull() -> None:
    """normal_max and normal_min change places with the sign of everything; von Mises stays."""
    one, other = stress("{circle: {radius: 0.02}}"), stress("{circle: {radius: 0.02}}", -F, -C)
    near([other["normal_max"], other["normal_min"]], [-one["normal_min"], -one["normal_max"]], one["mises"], 1e-13)
    near(other["mises"], one["mises"], one["mises"], 1e-13)


def test_utilisation() -> None:
    found = stress("{circle: {radius: 0.02}}", more=", strength: 235e6")
    near(found["utilisation"], found["mises"] / 235e6, 1.0, 1e-13)
    assert "utilisation" not in stress("{circle: {radius: 0.02}}")


def test_always_about_the_centroid() -> None:
    """Wherever the moments themselves are taken."""
    plain = stress("{circle: {radius: 0.02}}")
    for where in ("bar.tip", "ground.O", "centroid"):
        other = stress("{circle: {radius: 0.02}}", more=f", reduce_to: {where}")
        for name, value in plain.items():
            near(other[name], value, plain["mises"], 1e-12)


def test_a_cut_point_beside_the_centroid() -> None:
    """Stresses go by the centroid of the shapes' cut, not by the point that names the plane."""
    plain = stress("{circle: {radius: 0.02}}")
    other = stress("{circle: {radius: 0.02}}", beside=0.01)
    for name, value in plain.items():
        near(other[name], value, plain["mises"], 1e-12)
