"""Meshes as they are drawn: their silhouette encloses what is seen, not their holes; fine ones are thinned."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.output.machine_geometry.solids import MAX_TRIANGLES, Surface, find_nearest_place, make_surfaces
from heuncli.output.machine_geometry.views import find_silhouette, find_solid_edges, parse_view, select_visible_edges
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Shape
from heuncli.scene.meshes.reading import read_closed_mesh
from tests.shared import triangles as t

DOWN = np.array([0.0, 0.0, -9.81])
IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def shape(triangles: Array) -> Shape:
    mesh = read_closed_mesh(t.binary_stl(triangles), "a.stl")
    return Shape("mesh", density=1.0, mesh=mesh, scale=0.5, at=(0.0, 0.0, 0.0), rotation=IDENTITY)


def drawn(triangles: Array) -> Surface:
    (surface,) = make_surfaces(shape(triangles))
    return surface


def areas(surface: Surface, toward: str) -> list[float]:
    """The areas that the lines of the silhouette enclose, with the sign of their sense, the largest first."""
    view = parse_view(toward, DOWN)
    found = []
    for line in find_silhouette(find_solid_edges(surface), np.eye(3), view):
        x, y = view.project(surface.corners[line]).T
        found.append(0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))
    return sorted(found, reverse=True)


@pytest.mark.parametrize(("n", "m"), [(40, 24), (400, 100)])
def test_one_sees_through_a_ring(n: int, m: int) -> None:
    surface = drawn(t.torus(n, m))
    assert len(surface.faces) <= MAX_TRIANGLES
    rough = 0.01 if n < 100 else 0.05
    assert areas(surface, "z") == pytest.approx([0.25 * math.pi * 1.3**2, -0.25 * math.pi * 0.7**2], rel=rough)
    side = areas(surface, "x")
    assert sum(side) >= 0.25 * (2.6 * 0.6 - (4 - math.pi) * 0.09) * (1 - rough)


def test_a_box_has_its_twelve_edges() -> None:
    surface = drawn(t.box())
    assert len(surface.edges) == 12 and len(surface.faces) == 12
    assert len(select_visible_edges(find_solid_edges(surface), np.eye(3), parse_view("30,20", DOWN))) == 9
    assert areas(surface, "x") == pytest.approx([0.25])


def test_arms_lead_to_what_lies_outside_its_extent() -> None:
    tube = shape(t.cylinder(20, 1.0, 2.0, 0.5))
    assert find_nearest_place(tube, np.array([0.0, 0.0, 0.5]))[1] == 0.0  # on its axis
    place, gap = find_nearest_place(tube, np.array([0.0, 0.0, 3.0]))
    assert gap == pytest.approx(2.0) and place[2] == pytest.approx(1.0)
