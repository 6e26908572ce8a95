"""Properties of the outlines in which meshes are cut: rectangles, an I section, tubes; torsion from below; why none."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from heuncli.base.errors import HeunError
from heuncli.loads.kinetostatics.auto_properties import CutForm, find_cut_properties
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Shape, Vec
from heuncli.scene.meshes.reading import read_closed_mesh
from heuncli.scene.shapes.composite_solid import make_composite_solid
from heuncli.study.workflow import solve
from tests.shared import triangles as t

X, Y, Z = np.eye(3)


def cut(triangles: Array, n: Array, e1: Array, d: float, *others: Shape) -> dict[str, float] | str:
    """The properties of one cut through a mesh, or why there are none."""
    mesh = read_closed_mesh(t.obj(triangles).encode(), "a.obj")
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    shape = Shape("mesh", density=1.0, mesh=mesh, scale=1.0, at=(0.0, 0.0, 0.0), rotation=axes)
    found = find_cut_properties(CutForm(make_composite_solid([shape, *others]), n, e1, np.array([d]), np.zeros(1)))
    if found.missing:
        return found.missing[0]
    (group,) = found.groups
    return {name: float(np.broadcast_to(value, 1)[0]) for name, value in group.values.items()}


def known(found: dict[str, float] | str) -> dict[str, float]:
    assert not isinstance(found, str), found
    return found


def test_a_rectangle() -> None:
    found = known(cut(t.box([0, 0, 0], [2, 0.3, 0.5]), X, Y, 0.7))
    b, h = 0.3, 0.5
    assert found["area"] == pytest.approx(b * h)
    assert (found["I1"], found["I2"]) == pytest.approx((b * h**3 / 12, h * b**3 / 12))
    assert (found["c1"], found["c2"]) == pytest.approx((b / 2, h / 2))
    assert found["J"] == pytest.approx(4 * (b * h) ** 3 / 3 / (2 * b + 2 * h) ** 2)


def test_an_I_section_through_its_own_axes() -> None:
    H, W, f, w = 0.3, 0.2, 0.05, 0.04
    beam = t.profile_I(H, W, f, w, 1.0)
    found = known(cut(beam, X, Z, 0.3))
    assert found["area"] == pytest.approx(2 * W * f + (H - 2 * f) * w)
    assert found["I1"] == pytest.approx((W * H**3 - (W - w) * (H - 2 * f) ** 3) / 12)
    assert found["I2"] == pytest.approx((2 * f * W**3 + (H - 2 * f) * w**3) / 12)
    assert (found["c1"], found["c2"]) == pytest.approx((W / 2, H / 2))
    message = cut(beam, X, np.array([0.0, math.cos(0.1), math.sin(0.1)]), 0.3)
    assert message == "e1 is not a principal axis of the outline (use first_axis: [0, 1, 0])"


@pytest.mark.parametrize(("wall", "low", "high"), [(0.01, 0.93, 1.0), (0.05, 0.7, 1.0)])
def test_torsion_of_thin_open_walls_is_that_of_their_strips(wall: float, low: float, high: float) -> None:
    """J = sum b t^3/3 for thin walls: the bound comes near from below."""
    found = known(cut(t.profile_I(1.0, 0.8, wall, wall, 1.0), X, Z, 0.3))
    strips = (2 * 0.8 + (1.0 - 2 * wall)) * wall**3 / 3
    assert low < found["J"] / strips < high


@pytest.mark.parametrize("inner", [0.0, 0.3, 0.45])
def test_a_cylinder_and_tubes(inner: float) -> None:
    """Torsion is bounded from below: 2/3 of a circle's J; a closed wall counts as slit. A of n chords errs by 4e-5."""
    R, n = 0.5, 400
    found = known(cut(t.cylinder(n, R, 1.2, inner), Z, X, 0.5))
    area, I, J = math.pi * (R**2 - inner**2), math.pi / 4 * (R**4 - inner**4), math.pi / 2 * (R**4 - inner**4)
    assert (found["area"], found["I1"], found["I2"]) == pytest.approx((area, I, I), rel=1e-4)
    assert (found["c1"], found["c2"]) == pytest.approx((R, R), rel=1e-4)
    assert found["J"] == pytest.approx(4 * area**3 / 3 / (2 * math.pi * (R + inner)) ** 2, rel=2e-4)
    assert found["J"] < J and (inner or found["J"] == pytest.approx(2 / 3 * J, rel=2e-4))


def of_cells(cells: set[tuple[int, int]]) -> Array:
    """A plate of square cells in y and z, 1 thick along x."""
    found = []
    for y, z in cells:
        corner = [np.array([0.0, *c]) for c in ((y, z), (y + 1, z), (y + 1, z + 1), (y, z + 1))]
        found += [[corner[0], corner[2], corner[1]], [corner[0], corner[3], corner[2]]]
        found += [[corner[0] + X, corner[1] + X, corner[2] + X], [corner[0] + X, corner[2] + X, corner[3] + X]]
        for k, beside in enumerate(((y, z - 1), (y + 1, z), (y, z + 1), (y - 1, z))):
            if beside not in cells:
                p, q = corner[k], corner[(k + 1) % 4]
                found += [[p, q, q + X], [p, q + X, p + X]]
    return np.array(found)


def test_torsion_of_a_plate_with_several_holes() -> None:
    """More holes than parts lengthen the inner lines: the bound gives way for that."""
    plate = of_cells({(y, z) for y in range(7) for z in range(3) if not (y % 2 == 1 and z == 1)})
    found = known(cut(plate, X, Y, 0.5))
    area, L = 21.0 - 3.0, 20.0 + 12.0
    assert found["area"] == pytest.approx(area)
    assert found["J"] == pytest.approx(4 * area**3 / 3 / (L + 4 * math.pi * math.sqrt(area / math.pi)) ** 2)
    assert found["J"] < 4 * area**3 / 3 / L**2


U = np.array([(0, 0), (4, 0), (4, 3), (3, 3), (3, 1), (1, 1), (1, 3), (0, 3)], dtype=float)
U_CAP = [(0, 1, 5), (1, 4, 5), (1, 2, 4), (2, 3, 4), (0, 5, 7), (5, 6, 7)]


def test_why_there_are_none() -> None:
    channel = t.prism(U, U_CAP, 1.0)
    assert "shear forces may twist it" in cut(channel, X, Y, 0.5)  # type: ignore[operator]
    assert "has 2 parts" in cut(channel, Z, Y, 2.0)  # type: ignore[operator]
    assert cut(t.box(), X, Y, 2.0) == "the cut meets no shape with a thickness"
    far: Vec = (0.5, 9.0, 0.0)
    other = Shape("box", center=far, size=(1.0, 1.0, 1.0), density=1.0)
    assert "a mesh and other shapes" in cut(t.box(), X, Y, 0.5, other)  # type: ignore[operator]


SCENE = """heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  bar: {shapes: [SHAPE], points: {a: [0, 0, 0], b: [0.4, 0, 0]}}
joints: {root: {type: weld, from: ground.O, to: bar.a}}
sections: {along: {body: bar, from: a, to: b, count: 5, properties: auto, strength: 235 MPa}}
"""
SOLID = "{type: box, center: [0.2, 0, 0], size: [0.4, 0.02, 0.03], density: 7850}"
MESH = "{type: mesh, file: bar.stl, scale: 1 mm, density: 7850}"


def test_a_cantilever_from_a_file_is_that_of_its_box(tmp_path: Path) -> None:
    (tmp_path / "bar.stl").write_bytes(t.binary_stl(t.box([0, -10, -15], [400, 10, 15])))
    found = []
    for name, shape in (("box", SOLID), ("mesh", MESH)):
        (tmp_path / f"{name}.yaml").write_text(SCENE.replace("SHAPE", shape))
        found.append(solve(load(tmp_path / f"{name}.yaml")).results.sections["along"])
    for key in ("N", "Q2", "M1", "s"):
        assert found[1][key] == pytest.approx(found[0][key], rel=1e-6, abs=1e-6)
    one, other = (block["stress"] for block in found)
    assert other["normal_max"] == pytest.approx(one["normal_max"], rel=1e-5, abs=1.0)
    assert (other["shear_max"] >= one["shear_max"] - 1e-6).all()  # of an outline it is not known so well


def test_a_turned_first_axis_is_refused_with_the_one_to_take(tmp_path: Path) -> None:
    (tmp_path / "bar.stl").write_bytes(t.binary_stl(t.box([0, -10, -15], [400, 10, 15])))
    text = SCENE.replace("SHAPE", MESH).replace("count: 5", "count: 5, first_axis: [0, 1, 0.3]")
    (tmp_path / "a.yaml").write_text(text)
    with pytest.raises(HeunError) as caught:
        solve(load(tmp_path / "a.yaml"))
    assert [p.code for p in caught.value.problems] == ["no-properties"]
    assert "use first_axis: [0, 1, 0]" in str(caught.value)
