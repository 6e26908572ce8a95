"""Solids of STEP files: mass properties by closed forms, rotated, shifted, in inches; cuts of their triangles."""

from __future__ import annotations

import io
import math
from pathlib import Path

import numpy as np
import pytest

from heuncli.base.errors import Finding, SpecError
from heuncli.multibody.mechanism.build import make_forms
from heuncli.scene.file_format.load import load
from heuncli.scene.meshes.reading import read_closed_mesh
from heuncli.scene.shapes.inertia import split_pseudo_inertia
from tests.shared.scenes import near

MM = 1e-3
TURN = 0.7  # [rad] about (1, 2, 3)
SHIFT = np.array([10.0, -20.0, 30.0])


def make_solids():
    """Shapes [mm], with volume, centre and second moments about it, by their closed forms."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import (
        BRepPrimAPI_MakeBox,
        BRepPrimAPI_MakeCylinder,
        BRepPrimAPI_MakeSphere,
        BRepPrimAPI_MakeTorus,
    )

    tube = BRepAlgoAPI_Cut(BRepPrimAPI_MakeCylinder(5.0, 20.0).Shape(), BRepPrimAPI_MakeCylinder(3.0, 20.0).Shape())
    ring = math.pi * 5.0**2 * 2.0 * math.pi * 20.0
    ball = 4.0 / 3.0 * math.pi * 7.0**3
    return {
        "box": (BRepPrimAPI_MakeBox(10.0, 20.0, 30.0).Shape(), 6000.0, (5, 10, 15), (100 / 12, 400 / 12, 900 / 12)),
        "cylinder": (
            BRepPrimAPI_MakeCylinder(5.0, 20.0).Shape(), 500 * math.pi, (0, 0, 10), (25 / 4, 25 / 4, 400 / 12),
        ),
        "tube": (tube.Shape(), 320 * math.pi, (0, 0, 10), (34 / 4, 34 / 4, 400 / 12)),
        "sphere": (BRepPrimAPI_MakeSphere(7.0).Shape(), ball, (0, 0, 0), (49 / 5, 49 / 5, 49 / 5)),
        "torus": (
            BRepPrimAPI_MakeTorus(20.0, 5.0).Shape(), ring, (0, 0, 0),
            (200 + 3 / 8 * 25, 200 + 3 / 8 * 25, 25 / 4),
        ),
    }  # fmt: skip


def save(*shapes, unit: str = "MM") -> bytes:
    from OCP.Interface import Interface_Static
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

    from heuncli.scene.meshes.step import _import_opencascade

    _import_opencascade()  # takes its printers away
    writer, stream = STEPControl_Writer(), io.BytesIO()
    Interface_Static.SetCVal_s("write.step.unit", unit)
    for shape in shapes:
        writer.Transfer(shape, STEPControl_StepModelType.STEPControl_AsIs)
    writer.WriteStream(stream)
    Interface_Static.SetCVal_s("write.step.unit", "MM")
    return stream.getvalue()


def move(shape, shift=SHIFT):
    """Return a shape turned and shifted, and the rotation (3, 3)."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec

    turn, place = gp_Trsf(), gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 2, 3)), TURN)
    place.SetTranslation(gp_Vec(*map(float, shift)))
    n = np.array([1.0, 2.0, 3.0]) / math.sqrt(14.0)
    K = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
    R = np.eye(3) + math.sin(TURN) * K + (1 - math.cos(TURN)) * K @ K
    turned = BRepBuilderAPI_Transform(shape, turn, True).Shape()
    return BRepBuilderAPI_Transform(turned, place, True).Shape(), R


@pytest.fixture(scope="module")
def solids():
    pytest.importorskip("OCP", reason="needs the package cadquery-ocp-novtk: pip install -e '.[step]'")
    return make_solids()


@pytest.mark.heavy
@pytest.mark.parametrize("name", ["box", "cylinder", "tube", "sphere", "torus"])
def test_moments_are_those_of_closed_forms(solids, name: str) -> None:
    """In place in millimetres; rotated and shifted in inches."""
    shape, volume, center, squares = solids[name]
    moved, R = move(shape)
    for content, S, shift in ((save(shape), np.eye(3), 0.0 * SHIFT), (save(moved, unit="INCH"), R, SHIFT)):
        mesh = read_closed_mesh(content, f"{name}.step")
        assert mesh.moments is not None and not mesh.notes
        found_volume, found_center, second = mesh.moments
        near(found_volume, volume * MM**3, volume * MM**3, 1e-11)
        near(found_center, (S @ np.array(center) + shift) * MM, 0.05, 1e-11)
        near(second, S @ np.diag(squares) @ S.T * volume * MM**5, max(squares) * volume * MM**5, 1e-10)
        assert f"volume differs by {abs(mesh_volume(mesh) / found_volume - 1.0):.1e}" in mesh.facts[1]
        assert abs(mesh_volume(mesh) / found_volume - 1.0) < 6e-3


def mesh_volume(mesh) -> float:
    a, b, c = (mesh.corners[mesh.triangles[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


BODY = """heun: 1
bodies: {{b: {{shapes: [{{type: mesh, file: {file}, density: 7800{more}}}]}}}}
analysis: {{type: state}}
"""


@pytest.mark.heavy
def test_a_body_has_the_mass_of_its_solids_and_cuts_of_their_triangles(solids, folder: Path) -> None:
    shape, _, _, squares = solids["cylinder"]
    second, R = move(shape, np.array([100.0, 0.0, 0.0]))
    (folder / "two.stp").write_bytes(save(shape, second))
    spec = load(
        str(folder / "m.yaml"),
        BODY.format(file="two.stp", more=", at: [1, 2, 3], mass: 0.1").replace("density: 7800, ", ""),
    )
    form = make_forms(spec, *())["b"]
    mass, center, inertia = split_pseudo_inertia(form.whole_inertia())
    centers = [np.array([0, 0, 10]) * MM, (R @ np.array([0, 0, 10]) + np.array([100, 0, 0])) * MM]
    middle = np.mean(centers, axis=0)
    near(mass, 0.1, 0.1, 1e-12)
    near(center, middle + np.array([1, 2, 3]), 1.0, 1e-11)
    T = np.diag(squares) * MM**2
    T = 0.05 * (T + R @ T @ R.T + sum(np.outer(c - middle, c - middle) for c in centers))
    near(inertia, np.trace(T) * np.eye(3) - T, 1e-3, 1e-10)
    n = np.array([0.0, 0.0, 1.0])
    piece = form.piece_inertias(n, np.array([3.0 - 1.0, 3.0 + 10.0 * MM, 4.0]), np.zeros(3))[:, 3, 3]
    near(piece[[0, 2]], [0.1, 0.0], 0.1, 1e-12)
    assert 0.03 < piece[1] < 0.07
    assert "2 solids" in spec.bodies["b"].shapes[0].mesh.facts[0]


@pytest.mark.heavy
def test_what_no_body_can_be_is_refused(solids, folder: Path) -> None:
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.gp import gp_Dir, gp_Pln, gp_Pnt

    box = solids["box"][0]
    overlapping, _ = move(box, np.array([1.0, 0.0, 0.0]))
    face = BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), 0.0, 1.0, 0.0, 1.0).Face()
    whole = save(box)
    for content, code, said in (
        (save(box, overlapping), "mesh-crosses-itself", "solids 1 and 2 share"),
        (save(face), "mesh-file", "no solid"),
        (whole.replace(b"LENGTH_UNIT", b"LENGTH_WORD"), "mesh-file", "no unit of length"),
        (b"ISO-10303-21; LENGTH_UNIT nonsense", "mesh-file", ""),
    ):
        with pytest.raises(Finding) as refused:
            read_closed_mesh(content, "x.step")
        assert refused.value.code == code and said in refused.value.message and refused.value.hint
    (folder / "box.step").write_bytes(whole)
    with pytest.raises(SpecError, match="a STEP file states its own unit"):
        load(str(folder / "m.yaml"), BODY.format(file="box.step", more=", scale: 1 mm"))
    load(str(folder / "m.yaml"), BODY.format(file="box.step", more=""))


def test_without_opencascade_the_message_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "OCP", None)
    with pytest.raises(Finding, match="cadquery-ocp-novtk") as refused:
        read_closed_mesh(b"ISO-10303-21; LENGTH_UNIT", "x.step")
    assert refused.value.code == "missing-extra" and "heuncli[step]" in refused.value.hint
