"""Bodies of triangles cut by planes: two pieces make the whole, and each is what tetrahedra clipped one by one say."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.results.results import Array
from heuncli.scene.file_format.loads import Matrix
from heuncli.scene.file_format.models import Shape, Vec
from heuncli.scene.meshes.reading import read_closed_mesh
from heuncli.scene.shapes.composite_solid import CompositeSolid, make_composite_solid
from tests.shared import polyhedra
from tests.shared import triangles as t
from tests.shared.solids import beyond, carried, difference, rotation, unit, vec

IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
BODIES = {
    "box": t.box([-0.2, 0.1, 0.3], [0.4, 0.9, 0.7]),
    "beam": t.profile_I(0.3, 0.2, 0.05, 0.04, 1.0),
    "ring": t.torus(9, 7),
    "tube": t.cylinder(11, 0.5, 1.2, 0.3),
    "hollow": np.concatenate([t.box([-1, -1, -1], [2, 2, 2]), t.box()[:, ::-1]]),
    "two": np.concatenate([t.box(), t.torus(7, 5) + 2.0]),
    "wedge": t.tetrahedron(np.random.default_rng(2).normal(size=(4, 3))),
}


def body(
    triangles: Array, *, scale: float = 1.0, at: Vec = (0.0, 0.0, 0.0), axes: Matrix = IDENTITY, density: float = 2.0
) -> CompositeSolid:
    """The form of a mesh, whose coordinates are those of the file to all digits."""
    mesh = read_closed_mesh(t.obj(triangles).encode(), "body.obj")
    return make_composite_solid([Shape("mesh", density=density, mesh=mesh, scale=scale, at=at, rotation=axes)])


def planes(f: CompositeSolid, corners: Array, rng: np.random.Generator) -> list[tuple[Array, Array]]:
    """Normals, any, along axes and across edges; offsets at random, and through corners, so through edges and faces."""
    found = []
    corners = np.unique(corners.reshape(-1, 3), axis=0)
    for k in range(12):
        one, other = rng.choice(len(corners), 2, replace=False)
        edge = corners[one] - corners[other]
        n = (unit(rng.normal(size=3)), np.eye(3)[k % 3], unit(np.cross(edge, rng.normal(size=3))))[k % 3]
        low, high = f.extent(n)
        heights = corners[rng.integers(len(corners), size=4)] @ n
        found.append((n, np.concatenate([rng.uniform(low, high, 4), heights, [low, high, low - 1.0, high + 1.0]])))
    return found


@pytest.mark.parametrize("name", BODIES)
def test_two_pieces_make_the_whole_wherever_the_plane_lies(name: str) -> None:
    f = body(BODIES[name])
    for n, d in planes(f, BODIES[name], np.random.default_rng(1)):
        for one, other in zip(beyond(f, n, d), beyond(f, -n, -d), strict=True):
            assert difference(one + other, f.whole_inertia(), f.whole_inertia()) < 1e-14


@pytest.mark.parametrize("name", BODIES)
def test_a_piece_goes_over_smoothly_where_the_plane_meets_corners_edges_and_faces(name: str) -> None:
    """Moved by a hair it loses what lies between: its cross-section, as it is on that side, times the hair."""
    corners, (a, b, c) = BODIES[name].reshape(-1, 3), BODIES[name].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    k = int(np.argmax((normals**2).sum(axis=1)))
    across = unit(np.cross(b[k] - a[k], [0.3, -0.5, 0.8]))
    f, hair = body(BODIES[name], density=1.0), 1e-7
    for n, at in ((unit(normals[k]), a[k]), (across, a[k]), (unit(np.array([0.3, -0.5, 0.8])), corners[-1])):
        d = float(at @ n) + hair * np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
        lower, _, there, _, upper = beyond(f, n, d)
        area = f.parts[0].section_area(n, d)[0]
        for one, other, middle in ((lower, there, area[1]), (there, upper, area[3])):
            assert one[3, 3] - other[3, 3] == pytest.approx(
                middle * hair, abs=1e-14 * f.whole_inertia()[3, 3] + 10.0 * hair**2
            )
        reach = 1.0 + float((corners**2).sum(axis=1).max())  # of 1, x and x x
        assert np.abs(lower - upper).max() <= 2.0 * hair * reach * max(area) + 1e-14 * np.abs(f.whole_inertia()).max()


def clipped(triangles: Array, n: Array, d: float, density: float) -> Array:
    """The piece beyond a plane: of each tetrahedron between a triangle and the origin, with its sign."""
    P = np.zeros((4, 4))
    for triangle in triangles:
        a, b, c = triangle
        size = float(np.linalg.det(triangle))
        if size == 0.0:
            continue
        b, c = (b, c) if size > 0.0 else (c, b)
        O = np.zeros(3)
        faces = [np.array(face) for face in ((a, b, c), (O, b, a), (O, c, b), (O, a, c))]
        P += np.sign(size) * polyhedra.pseudo_inertia(polyhedra.clipped(faces, n, d))
    return density * P


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.third
def test_a_piece_is_that_of_tetrahedra_clipped_one_by_one(name: str) -> None:
    triangles, rng = BODIES[name], np.random.default_rng(3)
    f = body(triangles)
    for _ in range(2):
        n = unit(rng.normal(size=3))
        low, high = f.extent(n)
        d = rng.uniform(low, high, 2)
        for piece, height in zip(beyond(f, n, d), d.tolist(), strict=True):
            assert difference(piece, clipped(triangles, n, height, 2.0), f.whole_inertia()) < 1e-12


@pytest.mark.parametrize("name", BODIES)
def test_a_piece_loses_what_the_plane_passes_over(name: str) -> None:
    """Between corners the area is a polynomial of degree 2 in height, its moment of degree 3: Simpson's rule."""
    f = body(BODIES[name], density=1.0)
    for n in (np.eye(3)[0], np.eye(3)[2], unit(np.array([0.3, -0.5, 0.8]))):
        levels = np.unique(np.round(BODIES[name].reshape(-1, 3) @ n, 12))
        a, b = levels[:-1] + 1e-11, levels[1:] - 1e-11
        at = np.concatenate([a, 0.5 * (a + b), b])
        area, first = (part.reshape(3, len(a), -1) for part in f.parts[0].section_area(n, at))
        P = f.piece_inertias(n, np.concatenate([a, b]), np.zeros(2 * len(a))).reshape(2, -1, 4, 4)
        lost, weight = P[0] - P[1], (b - a)[:, None] / 6.0
        assert np.allclose(weight * (area[0] + 4.0 * area[1] + area[2]), lost[:, 3:, 3], rtol=1e-9, atol=1e-13)
        assert np.allclose(weight * (first[0] + 4.0 * first[1] + first[2]), lost[:, :3, 3], rtol=1e-9, atol=1e-13)


@pytest.mark.parametrize("name", BODIES)
def test_a_mesh_turns_moves_and_grows_with_its_keys(name: str) -> None:
    rng = np.random.default_rng(4)
    f = body(BODIES[name])
    R, p = rotation(rng), rng.normal(size=3)
    axes = tuple(vec(row) for row in R)
    there = body(BODIES[name], scale=0.25, at=vec(p), axes=axes)  # type: ignore[arg-type]
    S = np.diag([0.25] * 3 + [1.0])
    assert (
        difference(0.25**3 * carried(S @ f.whole_inertia() @ S, R, p), there.whole_inertia(), there.whole_inertia())
        < 1e-14
    )
    for n, d in planes(f, BODIES[name], rng)[:4]:
        offsets = 0.25 * d + (R @ n) @ p
        for one, other in zip(beyond(f, n, d), beyond(there, R @ n, offsets), strict=True):
            assert difference(0.25**3 * carried(S @ one @ S, R, p), other, there.whole_inertia()) < 2e-14


def test_a_box_of_triangles_is_a_box() -> None:
    low, high = np.array([-0.2, 0.1, 0.3]), np.array([0.4, 0.9, 0.7])
    f, box = (
        body(t.box(low, high)),
        make_composite_solid([Shape("box", center=vec(0.5 * (low + high)), size=vec(high - low), density=2.0)]),
    )
    rng = np.random.default_rng(5)
    for _ in range(20):
        n = unit(rng.normal(size=3))
        d = rng.uniform(*box.extent(n), 6)
        side = np.ones(6)
        assert difference(f.whole_inertia(), box.whole_inertia(), box.whole_inertia()) < 1e-15
        assert np.allclose(f.piece_inertias(n, d, side), box.piece_inertias(n, d, side), rtol=0.0, atol=1e-15)
        one, other = f.cross_sections(n, d, side), box.cross_sections(n, d, side)
        assert np.allclose(one.area, other.area, atol=1e-5)
        assert np.allclose(one.centroid, other.centroid, atol=1e-5)
        assert (one.regions == 1).all()


@pytest.mark.parametrize("inner", [0.0, 0.3])
def test_a_cylinder_of_triangles_errs_as_the_square_of_its_facets(inner: float) -> None:
    exact = make_composite_solid(
        [
            Shape(
                "cylinder",
                from_=(0.0, 0.0, 0.0),
                to=(0.0, 0.0, 1.2),
                radius=0.5,
                inner_radius=inner or None,
                density=2.0,
            )
        ]
    )
    n, d = unit(np.array([0.7, 0.2, 0.5])), np.array([0.1, 0.3, 0.6])
    errors = []
    for count in (40, 80, 160):
        f = body(t.cylinder(count, 0.5, 1.2, inner))
        pieces = zip(beyond(f, n, d), beyond(exact, n, d), strict=True)
        errors.append(max(difference(one, other, exact.whole_inertia()) for one, other in pieces))
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx([2.0, 2.0], abs=0.1)


def test_regions_are_counted_through_holes_and_parts() -> None:
    z, x = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    for name, n, d, count in (
        ("ring", z, 0.01, 1), ("ring", x, 0.03, 2), ("tube", z, 0.5, 1), ("tube", x, 0.01, 2), ("hollow", z, 0.5, 1),
        ("beam", z, 0.05, 2), ("beam", z, 0.01, 1), ("two", z, 0.5, 1), ("two", x, 2.03, 2), ("box", z, 5.0, 0),
    ):  # fmt: skip
        found = body(BODIES[name]).cross_sections(n, np.array([d]), np.zeros(1))
        assert found.regions.tolist() == [count], (name, d)
    ring, rod = body(BODIES["ring"]), Shape("rod", from_=(0.0, 0.0, -1.0), to=(0.0, 0.0, 1.0), mass=1.0)
    # what stands within the hull of a mesh's outline counts as one with it
    far = Shape("cylinder", from_=(9.0, 0.0, -1.0), to=(9.0, 0.0, 1.0), radius=0.5, density=1.0)
    both = CompositeSolid((*ring.parts, *make_composite_solid([rod, far]).parts), ring.tolerance)
    assert both.cross_sections(z, np.array([0.01, 0.5]), np.zeros(2)).regions.tolist() == [2, 2]


def test_corners_of_a_fine_mesh_are_few_and_hold_its_flat_faces() -> None:
    fine = body(t.cylinder(400, 0.5, 1.2, 0.3))
    assert len(fine.corners(np.array([0.0, 0.0, 1.0]))) == 2
    across = fine.corners(np.array([1.0, 0.0, 0.0]))
    assert len(across) <= 104 and across[0] == pytest.approx(-0.5) and across[-1] == pytest.approx(0.5)
