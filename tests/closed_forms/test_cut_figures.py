"""How planes meet bodies: area, centroid, separate places, and what lies in the plane."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.results.results import Array
from heuncli.scene.file_format.models import Shape
from heuncli.scene.shapes.composite_solid import CompositeSolid, make_composite_solid
from tests.shared.solids import SOLIDS, axis_of, beyond, difference, planes, unit

X, Y, Z = np.eye(3)
BEFORE, BEYOND, OPEN = 1.0, -1.0, 0.0


def one(f: CompositeSolid, n: Array, d: float, side: float = OPEN) -> tuple[float, Array, int]:
    found = f.cross_sections(n, np.array([d]), np.array([side]))
    return float(found.area[0]), found.centroid[0], int(found.regions[0])


@pytest.mark.parametrize("name", [name for name in SOLIDS if name != "rod"])
def test_area_is_how_fast_the_piece_shrinks(name: str) -> None:
    """dm/dd = -density area, d(m x)/dd = -density area centroid; differences over 1e-4 of the body's extent."""
    f = make_composite_solid([SOLIDS[name]])
    for n, d in planes(SOLIDS[name], np.random.default_rng(21), 15)[::3]:
        low, high = f.extent(n)
        d = d[(d > low + 0.02 * (high - low)) & (d < high - 0.02 * (high - low))]
        h = 1e-4 * (high - low)
        area = f.cross_sections(n, d, np.zeros(len(d)))
        slope = (beyond(f, n, d - h) - beyond(f, n, d + h))[:, :, 3] / (2 * h * 1.5)
        assert np.allclose(slope[:, 3], area.area, rtol=2e-4)
        assert np.allclose(slope[:, :3] / slope[:, 3, None], area.centroid, atol=2e-4 * (high - low))
        assert np.allclose(area.centroid @ n, d, atol=1e-11)


def test_ellipse() -> None:
    f = make_composite_solid(
        [Shape("cylinder", from_=(0, 0, -1), to=(0, 0, 1), radius=0.3, inner_radius=0.1, density=1.0)]
    )
    n = unit(np.array([0.6, 0.2, 1.0]))
    area, centroid, places = one(f, n, 0.1)
    assert np.isclose(area, np.pi * 0.08 / n[2], rtol=1e-13)
    assert np.allclose(centroid, [0, 0, 0.1 / n[2]], atol=1e-13)
    assert places == 1


def test_rectangle_along_a_cylinder() -> None:
    f = make_composite_solid([Shape("cylinder", from_=(0, 0, -1), to=(0, 0, 3), radius=0.5, density=1.0)])
    area, centroid, places = one(f, X, 0.3)
    assert np.isclose(area, 4 * 0.8, rtol=1e-13)
    assert np.allclose(centroid, [0.3, 0, 1], atol=1e-12)
    assert places == 1


@pytest.mark.parametrize(
    ("normal", "offset", "places"),
    [
        (Z, 0.0, 1),  # a ring
        (X, 0.0, 2),  # two strips
        (X, 0.25, 1),  # within the wall
        (unit(np.array([1.0, 0, 0.05])), 0.0, 2),  # through both ends, a little askew
        (unit(np.array([1.0, 0, 0.3])), 0.2, 1),  # through one end: joined round the other side of the bore
        (unit(np.array([1.0, 0, 3.0])), 0.0, 1),  # an ellipse with a hole
        (X, 0.31, 0),
    ],
)
def test_places_of_a_tube(normal: Array, offset: float, places: int) -> None:
    f = make_composite_solid(
        [Shape("cylinder", from_=(0, 0, -1), to=(0, 0, 1), radius=0.3, inner_radius=0.2, density=1.0)]
    )
    assert one(f, normal, offset)[2] == places


def ring(center: tuple[float, float], radius: float, bore: float | None = None) -> Shape:
    x, y = center
    return Shape("cylinder", from_=(x, y, 0), to=(x, y, 1), radius=radius, inner_radius=bore, density=1.0)


@pytest.mark.parametrize(
    ("shapes", "places"),
    [
        ([ring((0, 0), 1.0), ring((1.9, 0), 1.0)], 1),
        ([ring((0, 0), 1.0), ring((2.1, 0), 1.0)], 2),
        ([ring((0, 0), 1.0), ring((2.1, 0), 1.0), ring((1.0, 0.0), 0.2)], 1),
        ([ring((0, 0), 1.0, 0.5), ring((0, 0), 0.5)], 1),  # a shaft that fills the bore
        ([ring((0, 0), 1.0, 0.5), ring((0, 0), 0.4)], 2),  # one with room
        ([ring((0, 0), 1.0, 0.5), ring((0.3, 0), 0.4)], 1),  # that touches on one side
        ([ring((0, 0), 1.0, 0.8), ring((0, 0), 0.7, 0.5), ring((0, 0), 0.3)], 3),
        ([Shape("box", center=(0, 0, 0.5), size=(4, 0.1, 1), density=1.0)] * 2, 1),
        ([Shape("box", center=(0, 0, 0.5), size=(4, 0.01, 1), density=1.0),
          Shape("box", center=(0.3, 0, 0.5), size=(0.01, 4, 1), density=1.0)], 1),  # a thin cross
        ([Shape("box", center=(s, 0, 0.5), size=(0.5, 1, 1), density=1.0) for s in (-1, 1)], 2),  # a fork
        ([Shape("box", center=(0, s, 0.5), size=(4, 0.1, 1), density=1.0) for s in (-0.5, 0.5)], 2),  # long and near
        ([Shape("sphere", center=(0, 0, 0.5), radius=0.5, density=1.0), ring((0, 0.8), 0.31)], 1),
        ([Shape("sphere", center=(0, 0, 0.5), radius=0.5, density=1.0), ring((0, 0.8), 0.29)], 2),
        ([Shape("rod", from_=(0, 0, 0), to=(1, 0, 1), line_density=1.0),
          Shape("rod", from_=(0, 0, 0), to=(-1, 0, 1), line_density=1.0)], 2),
        ([Shape("rod", from_=(0, 0, 0), to=(0, 0, 1), line_density=1.0), ring((0.1, 0), 0.2)], 1),
        ([Shape("rod", from_=(0, 0, 0), to=(0, 0, 1), line_density=1.0), ring((0, 0), 0.4, 0.2)], 2),
        ([Shape("point", at=(0, 0, 0.2), mass=1.0)], 0),
    ],
)  # fmt: skip
def test_places_of_several_shapes(shapes: list[Shape], places: int) -> None:
    for order in (shapes, shapes[::-1]):
        assert one(make_composite_solid(order), Z, 0.5)[2] == places


def test_places_cut_by_cut() -> None:
    """A fork with its stem: one place below, two above."""
    tines = [Shape("box", center=(x, 0, 1.5), size=(0.2, 0.2, 1), density=1.0) for x in (-1, 1)]
    f = make_composite_solid([*tines, Shape("box", center=(0, 0, 0.5), size=(2.2, 0.2, 1), density=1.0)])
    found = f.cross_sections(Z, np.array([-0.5, 0.5, 1.5, 2.5]), np.zeros(4))
    assert found.regions.tolist() == [0, 1, 2, 0]
    assert np.allclose(found.area[1:3], [0.44, 0.08])
    assert np.isnan(found.area[[0, 3]]).all()
    assert np.isnan(found.centroid[[0, 3]]).all()


def test_end_faces_and_shoulders_are_limits() -> None:
    """A stepped shaft: radius 2 up to z = 1, then 1 up to z = 3."""
    f = make_composite_solid(
        [
            Shape("cylinder", from_=(0, 0, 0), to=(0, 0, 1), radius=2.0, density=1.0),
            Shape("cylinder", from_=(0, 0, 1), to=(0, 0, 3), radius=1.0, density=1.0),
        ]
    )
    thick, thin = 4 * np.pi, np.pi
    assert np.isclose(one(f, Z, 1.0, BEFORE)[0], thick)
    assert np.isclose(one(f, Z, 1.0, BEYOND)[0], thin)
    assert np.isclose(one(f, Z, 1.0, OPEN)[0], (thick + thin) / 2)
    assert np.isclose(one(f, -Z, -1.0, BEFORE)[0], thin)
    assert np.isclose(one(f, Z, 0.0, BEYOND)[0], thick)
    assert np.isclose(one(f, Z, 0.0, OPEN)[0], thick)
    assert one(f, Z, 0.0, BEFORE)[2] == 0
    assert np.isclose(one(f, Z, 3.0, BEFORE)[0], thin)
    assert one(f, Z, 3.0, BEYOND)[2] == 0
    assert np.allclose(one(f, Z, 3.0, BEFORE)[1], [0, 0, 3], atol=1e-11)


@pytest.mark.parametrize("name", ["sphere", "cone", "turned box", "tube"])
def test_at_a_tip_the_centroid_is_the_tip(name: str) -> None:
    f = make_composite_solid([SOLIDS[name]])
    n = unit(np.array([0.3, 0.5, -0.7]))
    low, high = f.extent(n)
    for tip, side in ((low, BEYOND), (high, BEFORE)):
        area, centroid, places = one(f, n, tip, side)
        assert places == 1
        assert area < 1e-5
        assert abs(n @ centroid - tip) < 1e-11


def test_rods_only() -> None:
    f = make_composite_solid(
        [
            Shape("rod", from_=(0, 0, 0), to=(2, 0, 2), line_density=1.0),
            Shape("rod", from_=(0, 0, 0), to=(0, 0, 2), line_density=5.0),
        ]
    )
    area, centroid, places = one(f, Z, 1.0)
    assert (area, places) == (0.0, 2)
    assert np.allclose(centroid, [0.5, 0, 1], atol=1e-11)


def test_a_point_in_the_plane_needs_a_side() -> None:
    f = make_composite_solid(
        [Shape("point", at=(0, 0, 0.8), mass=2.0), Shape("rod", from_=(0, 0, 0), to=(0, 0, 2), line_density=1.0)]
    )
    d = np.array([0.8, 0.8 + 1e-13, 0.8 - 1e-13, 0.8001])
    assert f.has_mass_in_plane(Z, d).tolist() == [True, True, True, False]
    assert not f.has_rod_in_plane(Z, d).any()
    rod = f.parts[1].whole_inertia()[3, 3] - d / 1.0
    for n, offsets, beyond_mass in ((Z, d, rod), (-Z, -d, d)):
        for side, part in ((BEFORE, 2.0), (BEYOND, 0.0), (OPEN, 1.0)):
            mass = f.piece_inertias(n, offsets, np.full(4, side))[:, 3, 3]
            assert np.allclose(mass[:3], beyond_mass[:3] + part, atol=1e-12)
        assert np.allclose(mass[3], beyond_mass[3] + (0.0 if n is Z else 2.0), atol=1e-12)


def test_a_rod_in_the_plane() -> None:
    f = make_composite_solid(
        [
            Shape("rod", from_=(0, 0, 1), to=(1, 1, 1), mass=3.0),
            Shape("sphere", center=(0, 0, 0), radius=0.5, mass=1.0),
        ]
    )
    d = np.array([1.0, 0.5])
    assert f.has_rod_in_plane(Z, d).tolist() == [True, False]
    assert not f.has_mass_in_plane(Z, d).any()
    assert not f.has_rod_in_plane(X, d).any()
    for side, mass in ((BEFORE, 3.0), (BEYOND, 0.0), (OPEN, 1.5)):
        assert np.isclose(f.piece_inertias(Z, d, np.full(2, side))[0, 3, 3], mass)


@pytest.mark.parametrize("side", [BEFORE, BEYOND, OPEN])
def test_what_lies_in_the_plane_is_counted_once(side: float) -> None:
    f = make_composite_solid(
        [
            Shape("point", at=(0.1, 0.2, 0.3), mass=2.0),
            Shape("rod", from_=(1, 0, 0.3), to=(0, 1, 0.3), mass=3.0),
            Shape("sphere", center=(0, 0, 0), radius=0.5, mass=1.0),
        ]
    )
    d, sides = np.array([0.3]), np.array([side])
    both = f.piece_inertias(Z, d, sides)[0] + f.piece_inertias(-Z, -d, -sides)[0]
    assert difference(both, f.whole_inertia(), f.whole_inertia()) < 1e-15


def test_where_a_tolerance_reaches_grows_with_the_body() -> None:
    for size in (1e-3, 1.0, 1e3):
        f = make_composite_solid([Shape("point", at=(0, 0, size), mass=1.0)])
        d = size * np.array([1.0, 1.0 + 5e-13, 1.0 + 2e-12])
        assert f.has_mass_in_plane(Z, d).tolist() == [True, True, False]


def test_radius_is_at_the_start_and_to_radius_at_the_end() -> None:
    shape = SOLIDS["frustum"]
    f, axis = make_composite_solid([shape]), axis_of(shape)
    ends = (shape.from_, BEYOND, 0.2), (shape.to, BEFORE, 0.7)
    for end, side, radius in ends:
        assert np.isclose(one(f, axis, float(axis @ np.array(end)), side)[0], np.pi * radius**2, rtol=1e-10)
