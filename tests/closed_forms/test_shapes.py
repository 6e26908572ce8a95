"""Mass properties of whole shapes and of pieces across the axis: manual/theory.md, "Mass properties"."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.results.results import Array
from heuncli.scene.file_format.models import Shape
from heuncli.scene.shapes.composite_solid import make_composite_solid
from heuncli.scene.shapes.inertia import split_pseudo_inertia
from tests.shared.solids import SOLIDS, beyond, difference, moved, rotation

RHO = 2.5
CLOSE = {"rtol": 1e-14, "atol": 1e-16}


def upright(shape: Shape, cut: float) -> tuple[float, Array, Array]:
    """Mass, centre and inertia about it of the piece z > cut."""
    return split_pseudo_inertia(beyond(make_composite_solid([shape]), np.array([0.0, 0.0, 1.0]), np.array([cut]))[0])


def test_rod() -> None:
    mass, center, inertia = upright(Shape("rod", from_=(0, 0, 0), to=(0, 0, 2), line_density=3.0), 0.5)
    assert np.allclose(mass, 4.5, **CLOSE)
    assert np.allclose(center, [0, 0, 1.25], **CLOSE)
    assert np.allclose(inertia, np.diag([1, 1, 0]) * 4.5 * 1.5**2 / 12, **CLOSE)


@pytest.mark.parametrize("bore", [None, 0.2, 0.2999999])
def test_cylinder_and_tube(bore: float | None) -> None:
    R, q, length = 0.3, bore or 0.0, 1.4
    shape = Shape("cylinder", from_=(0, 0, 0), to=(0, 0, 2), radius=R, inner_radius=bore, density=RHO)
    mass, center, inertia = upright(shape, 0.6)
    expected = RHO * np.pi * (R - q) * (R + q) * length
    assert np.allclose(mass, expected, **CLOSE)
    assert np.allclose(center, [0, 0, 1.3], **CLOSE)
    across = expected * ((R * R + q * q) / 4 + length**2 / 12)
    assert np.allclose(inertia, np.diag([across, across, expected * (R * R + q * q) / 2]), **CLOSE)


@pytest.mark.parametrize(("r1", "r2"), [(0.5, 0.2), (0.2, 0.5), (0.5, 0.0), (0.0, 0.5)])
def test_cone_and_frustum(r1: float, r2: float) -> None:
    cut, height = 0.7, 2.0
    shape = Shape("cone", from_=(0, 0, 0), to=(0, 0, height), radius=r1, to_radius=r2, density=RHO)
    mass, center, inertia = upright(shape, cut)
    r1, length = r1 + (r2 - r1) * cut / height, height - cut
    expected = RHO * np.pi * length * (r1 * r1 + r1 * r2 + r2 * r2) / 3
    first = RHO * np.pi * length**2 * (r1 * r1 + 2 * r1 * r2 + 3 * r2 * r2) / 12
    second = RHO * np.pi * length**3 * (r1 * r1 + 3 * r1 * r2 + 6 * r2 * r2) / 30
    axial = RHO * np.pi * length / 10 * (r1**4 + r1**3 * r2 + r1 * r1 * r2 * r2 + r1 * r2**3 + r2**4)
    assert np.allclose(mass, expected, **CLOSE)
    assert np.allclose(center, [0, 0, cut + first / expected], **CLOSE)
    across = axial / 2 + second - first * first / expected
    assert np.allclose(inertia, np.diag([across, across, axial]), rtol=1e-13, atol=1e-16)


@pytest.mark.parametrize("h", [-0.6, -0.5, 0.0, 0.3, 0.55])
def test_sphere(h: float) -> None:
    R = 0.6
    mass, center, inertia = upright(Shape("sphere", center=(0, 0, 0), radius=R, density=RHO), h)
    expected = RHO * np.pi * (R - h) ** 2 * (2 * R + h) / 3
    z = 3 * (R + h) ** 2 / (4 * (2 * R + h))
    axial = RHO * np.pi / 2 * (8 * R**5 / 15 - R**4 * h + 2 * R * R * h**3 / 3 - h**5 / 5)
    second = RHO * np.pi * (2 * R**5 / 15 - R * R * h**3 / 3 + h**5 / 5)
    across = axial / 2 + second - expected * z * z
    whole = RHO * np.pi * 4 / 3 * R**3
    assert np.allclose(mass, expected, **CLOSE)
    assert np.allclose(center, [0, 0, z], **CLOSE)
    assert np.allclose(inertia, np.diag([across, across, axial]), rtol=0, atol=1e-15 * whole)


def test_box() -> None:
    b, c, length = 0.5, 0.8, 0.9
    mass, center, inertia = upright(Shape("box", center=(0, 0, 0), size=(b, c, 2.0), density=RHO), 0.1)
    expected = RHO * length * b * c
    assert np.allclose(mass, expected, **CLOSE)
    assert np.allclose(center, [0, 0, 0.55], **CLOSE)
    assert np.allclose(inertia, np.diag([length**2 + c * c, length**2 + b * b, b * b + c * c]) * expected / 12, **CLOSE)


def test_golden_box() -> None:
    """manual/theory.md, "Closed cases" 16: a box about the centre of its face x = 0, and its piece x > 0.7."""
    f = make_composite_solid([Shape("box", center=(1, 0, 0), size=(2, 1, 0.6), density=1.0)])
    mass, center, _ = split_pseudo_inertia(f.whole_inertia())
    piece, at, _ = split_pseudo_inertia(beyond(f, np.array([1.0, 0, 0]), np.array([0.7]))[0])
    assert np.allclose([mass, piece], [1.2, 0.78], **CLOSE)
    assert np.allclose([center, at], [[1, 0, 0], [1.35, 0, 0]], **CLOSE)


@pytest.mark.parametrize("name", SOLIDS)
def test_mass_and_density_say_the_same(name: str) -> None:
    shape = SOLIDS[name]
    by_density = make_composite_solid([shape])
    mass = float(by_density.whole_inertia()[3, 3])
    by_mass = make_composite_solid([shape._replace(mass=mass, density=None, line_density=None)])
    assert difference(by_mass.whole_inertia(), by_density.whole_inertia(), by_density.whole_inertia()) < 1e-15


@pytest.mark.parametrize("name", SOLIDS)
def test_extent_is_where_pieces_begin_and_end(name: str) -> None:
    rng = np.random.default_rng(11)
    for _ in range(20):
        f = make_composite_solid([moved(SOLIDS[name], rotation(rng), rng.normal(size=3))])
        n = rotation(rng)[0]
        low, high = f.extent(n)
        edge = 1e-3 * (high - low)
        mass = beyond(f, n, np.array([low, low + edge, high - edge, high]))[:, 3, 3]
        assert abs(mass[0] - f.whole_inertia()[3, 3]) < 1e-14 * mass[0]
        assert mass[0] > mass[1] > mass[2] > 0.0
        assert mass[3] < 1e-14 * mass[0]


def test_shapes_add() -> None:
    shapes = list(SOLIDS.values())
    parts = sum(make_composite_solid([shape]).whole_inertia() for shape in shapes)
    assert difference(make_composite_solid(shapes).whole_inertia(), parts, parts) < 1e-15
