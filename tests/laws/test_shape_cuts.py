"""Pieces of shapes cut by planes: two halves make the whole, and each is what independent calculations say."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.base import tolerances
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Shape
from heuncli.scene.shapes import composite_solid, solids
from heuncli.scene.shapes.composite_solid import make_composite_solid
from tests.oracle.masses import Plane, cloud
from tests.shared import polyhedra
from tests.shared.solids import (
    ROUND,
    SOLIDS,
    axis_of,
    beyond,
    blur,
    carried,
    difference,
    moved,
    planes,
    rotation,
    stretched,
    unit,
)

ROUNDING = 2e-15


@pytest.mark.parametrize("name", SOLIDS)
@pytest.mark.third
def test_two_halves_make_the_whole(name: str) -> None:
    shape = SOLIDS[name]
    f = make_composite_solid([shape])
    for n, d in planes(shape, np.random.default_rng(1), 60):
        for one, other in zip(beyond(f, n, d), beyond(f, -n, -d), strict=True):
            assert difference(one + other, f.whole_inertia(), f.whole_inertia()) < ROUNDING


@pytest.mark.parametrize("name", SOLIDS)
def test_the_piece_grows_to_the_whole_body_as_the_plane_goes_back(name: str) -> None:
    f = make_composite_solid([SOLIDS[name]])
    for n, _ in planes(SOLIDS[name], np.random.default_rng(2), 12):
        low, high = f.extent(n)
        none, all_ = beyond(f, n, np.array([high + 1e-9, low - 1e-9]))
        assert difference(none, np.zeros((4, 4)), f.whole_inertia()) == 0.0
        assert difference(all_, f.whole_inertia(), f.whole_inertia()) < ROUNDING
        mass = beyond(f, n, np.linspace(low, high, 60))[:, 3, 3]
        assert np.all(np.diff(mass) <= 1e-15 * mass[0])


@pytest.mark.parametrize("name", SOLIDS)
def test_a_piece_turns_and_moves_with_its_shape(name: str) -> None:
    rng = np.random.default_rng(3)
    f = make_composite_solid([SOLIDS[name]])
    for n, d in planes(SOLIDS[name], rng, 12):
        R, p = rotation(rng), rng.normal(size=3)
        there = make_composite_solid([moved(SOLIDS[name], R, p)])
        offsets = d + (R @ n) @ p
        for one, other, rounding in zip(
            beyond(f, n, d), beyond(there, R @ n, offsets), blur(there, R @ n, offsets), strict=True
        ):
            assert difference(carried(one, R, p), other, there.whole_inertia()) < 1e-14 + rounding


@pytest.mark.parametrize("factor", [2.0**-10, 2.0**10])  # exact, so that no wall changes its thickness by rounding
@pytest.mark.parametrize("name", SOLIDS)
def test_units_of_length_do_not_matter(name: str, factor: float) -> None:
    shape = SOLIDS[name]
    f, large = make_composite_solid([shape]), make_composite_solid([stretched(shape, factor)])
    S = np.diag([factor] * 3 + [1.0])
    volume = factor if name == "rod" else factor**3
    for n, d in planes(shape, np.random.default_rng(4), 12):
        for one, other in zip(beyond(f, n, d), beyond(large, n, factor * d), strict=True):
            assert difference(volume * S @ one @ S, other, large.whole_inertia()) < 1e-15


@pytest.mark.parametrize("name", ["box", "turned box"])
def test_box_against_a_clipped_polyhedron(name: str) -> None:
    shape = SOLIDS[name]
    axes = np.eye(3) if shape.rotation is None else np.array(shape.rotation)
    faces = polyhedra.box(np.array(shape.center), np.array(shape.size), axes)
    f = make_composite_solid([shape])
    for n, d in planes(shape, np.random.default_rng(5), 30):
        for piece, offset in zip(beyond(f, n, d), d, strict=True):
            expected = 1.5 * polyhedra.pseudo_inertia(polyhedra.clipped(faces, n, float(offset)))
            assert difference(piece, expected, f.whole_inertia()) < 5e-15


@pytest.mark.parametrize("axis", [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)])
def test_box_cut_across_an_axis_and_a_hair_askew(axis: tuple[int, float]) -> None:
    """Across an axis the piece is a box, by a formula of its own; a hair askew by the integrals for any plane."""
    shape, (k, sign) = SOLIDS["box"], axis
    n = sign * np.eye(3)[k]
    f = make_composite_solid([shape])
    low, high = f.extent(n)
    d = np.linspace(low - 0.1, high + 0.1, 9)
    faces = polyhedra.box(np.array(shape.center), np.array(shape.size), np.eye(3))
    askew = beyond(f, unit(n + 1e-17 + 1e-16 * np.roll(n, 1)), d)
    for piece, other, offset in zip(beyond(f, n, d), askew, d, strict=True):
        expected = 1.5 * polyhedra.pseudo_inertia(polyhedra.clipped(faces, n, float(offset)))
        assert difference(piece, expected, f.whole_inertia()) < 5e-15
        assert difference(piece, other, f.whole_inertia()) < 5e-15


def richardson(shape: Shape, n: Array, d: float) -> Array:
    """Prisms with more and more sides: the error of each falls with the square of their number."""
    ends = np.array(shape.from_), np.array(shape.to)
    r0, r1 = shape.radius or 0.0, shape.radius or 0.0 if shape.to_radius is None else shape.to_radius
    bore = shape.inner_radius or 0.0

    def solid(sides: int) -> Array:
        outer = polyhedra.pseudo_inertia(polyhedra.clipped(polyhedra.prism(*ends, r0, r1, sides), n, d))
        inner = polyhedra.pseudo_inertia(polyhedra.clipped(polyhedra.prism(*ends, bore, bore, sides), n, d))
        return 1.5 * (outer - inner)

    return (4.0 * solid(1024) - solid(512)) / 3.0


@pytest.mark.heavy
@pytest.mark.parametrize("name", ["cylinder", "tube", "cone", "frustum"])
@pytest.mark.third
def test_round_shapes_against_prisms_of_many_sides(name: str) -> None:
    shape = SOLIDS[name]
    f = make_composite_solid([shape])
    for n, d in planes(shape, np.random.default_rng(6), 3):
        for piece, offset in zip(beyond(f, n, d[:2]), d[:2], strict=True):
            assert difference(piece, richardson(shape, n, float(offset)), f.whole_inertia()) < 1e-8


@pytest.mark.parametrize("name", [name for name in SOLIDS if name != "thin tube"])
def test_against_clouds_of_mass_points(name: str) -> None:
    """The cloud of a thin tube is a difference of two bars, which leaves it five digits fewer."""
    shape = SOLIDS[name]
    data = {key.rstrip("_"): value for key, value in shape._asdict().items() if value is not None}
    if shape.rotation is not None:
        data["orientation"] = {"matrix": data.pop("rotation")}
    f = make_composite_solid([shape])
    for n, d in planes(shape, np.random.default_rng(7), 18)[::3]:
        for piece, offset in zip(beyond(f, n, d), d, strict=True):
            x, w = cloud(data, Plane(offset * n, n))
            y = np.append(x, np.ones((len(x), 1)), axis=1)
            assert difference(piece, (y * w[:, None]).T @ y, f.whole_inertia()) < 1e-12


def grazing(shape: Shape, rng: np.random.Generator, count: int) -> list[tuple[Array, Array]]:
    """Planes at any angle that all but touch the rims of a round shape, from inside or outside."""
    axis, ends = axis_of(shape), np.array([shape.from_, shape.to])
    far = shape.radius if shape.to_radius is None else shape.to_radius
    rims = [(ends[0], shape.radius), (ends[1], far), (ends[0], shape.inner_radius), (ends[1], shape.inner_radius)]
    found = []
    for n, _ in planes(shape, rng, count):
        steep = float(np.sqrt(np.cross(axis, n) @ np.cross(axis, n)))
        touch = np.array([n @ at + s * steep * (r or 0.0) for at, r in rims for s in (-1.0, 1.0)])
        found.append((n, touch + 10.0 ** rng.uniform(-9.0, -1.0, len(touch)) * rng.choice([-1.0, 1.0], len(touch))))
    return found


@pytest.mark.parametrize("name", ROUND)
def test_planes_that_graze_a_rim_lose_no_accuracy(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the quadrature has its worst cases it agrees with a much finer one, thin walls included."""
    f = make_composite_solid([SOLIDS[name]])
    cases = grazing(SOLIDS[name], np.random.default_rng(8), 20)
    pieces = [beyond(f, n, d) for n, d in cases]
    monkeypatch.setattr(solids, "NODE_COUNT", 40)
    monkeypatch.setattr(tolerances, "QUADRATURE", 1e-16)
    monkeypatch.setattr(solids, "MAX_DEPTH", 10)
    for (n, d), rough in zip(cases, pieces, strict=True):
        for one, other in zip(rough, beyond(f, n, d), strict=True):
            assert difference(one, other, f.whole_inertia()) < 1e-13


def test_cylinder_cut_askew_between_its_ends() -> None:
    """A cylinder of mean height h under a plane of slope k: centroid x = R^2 k/(4 h), z = h/2 + R^2 k^2/(8 h)."""
    R, h, k = 0.4, 1.0, 0.7
    f = make_composite_solid([Shape("cylinder", from_=(0, 0, 0), to=(0, 0, 2), radius=R, density=3.0)])
    below = beyond(f, -unit(np.array([-k, 0, 1])), np.array([-h / np.sqrt(1 + k * k)]))[0]
    mass = 3.0 * np.pi * R * R * h
    assert np.allclose(below[3, 3], mass, rtol=1e-14)
    assert np.allclose(below[:3, 3] / mass, [R * R * k / (4 * h), 0, h / 2 + R * R * k * k / (8 * h)], atol=1e-15)


def test_hoof_of_a_cylinder() -> None:
    """A plane through a diameter of the base, height h at the rim: V = 2 R^2 h/3, centroid (3 pi R/16, 3 pi h/32)."""
    R, h = 0.4, 0.9
    f = make_composite_solid([Shape("cylinder", from_=(0, 0, 0), to=(0, 0, 2), radius=R, density=1.0)])
    hoof = beyond(f, unit(np.array([h / R, 0, -1])), np.zeros(1))[0]
    assert np.allclose(hoof[3, 3], 2 * R * R * h / 3, rtol=1e-14)
    assert np.allclose(hoof[:3, 3] / hoof[3, 3], [3 * np.pi * R / 16, 0, 3 * np.pi * h / 32], atol=1e-15)


def test_cone_cut_askew_is_a_cone_on_an_ellipse() -> None:
    """Apex up to the cut: a third of area times distance; centroid at three quarters of the way to the figure's."""
    f = make_composite_solid([SOLIDS["cone"]])
    axis, apex = axis_of(SOLIDS["cone"]), np.array(SOLIDS["cone"].to)
    n = unit(axis + 0.4 * unit(np.cross(axis, [1.0, 2.0, 3.0])))
    d = n @ apex - np.array([0.05, 0.2, 0.35])
    pieces, figures = beyond(f, n, d), f.cross_sections(n, d, np.zeros(3))
    assert np.allclose(pieces[:, 3, 3], 1.5 * figures.area * (n @ apex - d) / 3, rtol=1e-12)
    assert np.allclose(pieces[:, :3, 3] / pieces[:, 3, 3, None], apex + 0.75 * (figures.centroid - apex), atol=1e-12)


@pytest.mark.parametrize("name", ROUND)
def test_across_the_axis_a_hair_askew_changes_nothing(name: str) -> None:
    """The exact formulas across the axis and the quadrature off it meet."""
    shape = SOLIDS[name]
    f, axis = make_composite_solid([shape]), axis_of(shape)
    across = unit(np.cross(axis, [0.3, -0.5, 0.2]))
    at = np.array(shape.from_) + 0.4 * (np.array(shape.to) - np.array(shape.from_))
    straight = beyond(f, axis, np.array([axis @ at]))[0]
    askew = unit(axis + 1e-14 * across)
    wide = max(shape.radius or 0.0, shape.to_radius or 0.0) / np.linalg.norm(np.array(shape.to) - np.array(shape.from_))
    assert difference(beyond(f, askew, np.array([askew @ at]))[0], straight, f.whole_inertia()) < 1e-14 * max(
        1.0, 3.0 * wide
    )


def test_many_cuts_at_once_are_the_cuts_one_by_one() -> None:
    f = make_composite_solid(list(SOLIDS.values()))
    n = unit(np.array([0.3, -0.6, 0.5]))
    d = np.linspace(*f.extent(n), 40)
    together = beyond(f, n, d)
    for offset, piece in zip(d, together, strict=True):
        assert difference(beyond(f, n, np.array([offset]))[0], piece, f.whole_inertia()) < ROUNDING


@pytest.mark.parametrize("name", ["box", "cylinder"])
def test_many_planes_are_cut_a_share_at_a_time(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the same numbers: a run of 100,000 cuts through a box took a gigabyte."""
    f, n = make_composite_solid([SOLIDS[name]]), np.array([0.6, 0.0, 0.8])
    d, side = np.linspace(*f.extent(n), 40), np.repeat([-1.0, 0.0, 0.0, 1.0], 10)
    whole, sections = f.piece_inertias(n, d, side), f.cross_sections(n, d, side)
    monkeypatch.setattr(composite_solid, "MAX_PLANES_AT_ONCE", 7)
    asked: list[int] = []
    monkeypatch.setattr(
        composite_solid.CompositeSolid,
        "one_sided_sections",
        counted(composite_solid.CompositeSolid.one_sided_sections, asked),
    )
    assert np.allclose(f.piece_inertias(n, d, side), whole, rtol=1e-14, atol=1e-14)
    again = f.cross_sections(n, d, side)
    assert asked == [7, 7, 7, 7, 7, 5]
    for field in ("area", "centroid", "regions"):
        assert np.allclose(getattr(again, field), getattr(sections, field), rtol=1e-14, atol=1e-14, equal_nan=True)


def counted(limits: Any, asked: list[int]) -> Any:
    """The same, with how many planes it is asked for."""

    def of(self: composite_solid.CompositeSolid, n: Array, d: Array, side: Array) -> Any:
        asked.append(len(d))
        return limits(self, n, d, side)

    return of
