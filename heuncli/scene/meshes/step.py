"""Read solids from STEP files by OpenCASCADE, an optional extra: exact mass properties, and a surface of triangles.

The mass properties are integrals over the solids' own faces; sections cut a surface of triangles within a chord error
that this module chooses. Lengths are in the unit that the file states; they are returned in metres. Impure: the first
use imports OpenCASCADE (1 to 4 s) and takes away its printers, which would write to standard output.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from importlib import import_module
from itertools import combinations
from typing import Any

import numpy as np

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array
from heuncli.scene.meshes.formats import mesh_file_finding
from heuncli.scene.meshes.model import IndexArray, SolidMoments, TriangleSoup

CHORD_ERROR = 1e-3  # of the size of a solid: largest distance of its triangles
ANGLE_ERROR = 0.1  # [rad] between the normals of adjacent triangles on a curved face
INTEGRATION_ERROR = 1e-13  # relative, of the volume; moments are then right to 1e-11
SHARED_VOLUME = 1e-9  # of the smaller of two solids: an overlap above it counts twice
MAX_SOLIDS = 1000
MILLIMETRE = 1e-3
UNIT_WORD = b"LENGTH_UNIT"
USED_MODULES = (
    "Bnd", "BRep", "BRepAlgoAPI", "BRepBndLib", "BRepGProp", "BRepMesh", "GProp", "IFSelect", "Message", "STEPControl",
    "TopAbs", "TopExp", "TopLoc", "TopoDS",
)  # fmt: skip
SAVE_HINT = "export it again as STEP AP214 or AP242, as solids"
EXTRA_HINT = 'pip install "heuncli[step]"; or export the surface as STL, OBJ or PLY'


class StepSolid(NamedTuple):
    """One solid: its exact moments, and its triangles; in metres."""

    moments: SolidMoments
    soup: TriangleSoup


def read_step_solids(content: bytes) -> list[StepSolid]:
    """Read the solids of a STEP file. Raises Finding [missing-extra, mesh-file, mesh-crosses-itself, too-large]."""
    if UNIT_WORD not in content:
        raise mesh_file_finding("the file states no unit of length", SAVE_HINT)
    occ = _import_opencascade()
    reader = occ.STEPControl.STEPControl_Reader()
    if reader.ReadStream("file", io.BytesIO(content)) != occ.IFSelect.IFSelect_ReturnStatus.IFSelect_RetDone:
        raise mesh_file_finding("OpenCASCADE cannot read it as STEP", SAVE_HINT)
    reader.TransferRoots()
    unit = float(reader.SystemLengthUnit()) * MILLIMETRE
    kind = occ.TopAbs.TopAbs_ShapeEnum.TopAbs_SOLID
    shapes = [*_iter_parts(occ, reader.OneShape(), kind)] if reader.NbShapes() else []
    if not shapes:
        raise mesh_file_finding("the file has no solid, only surfaces or curves", SAVE_HINT)
    if len(shapes) > MAX_SOLIDS:
        raise Finding("too-large", f"{len(shapes):,} solids; at most {MAX_SOLIDS:,} are allowed", "split the file")
    _require_no_overlap(occ, shapes)
    return [_make_solid(occ, shape, unit, number) for number, shape in enumerate(shapes, 1)]


def _import_opencascade() -> Any:
    """Import the modules of OpenCASCADE that are used. Raises Finding [missing-extra]."""
    try:
        occ = import_module("OCP")
        for name in USED_MODULES:
            import_module(f"OCP.{name}")  # makes an attribute of OCP
    except ImportError:
        message = "STEP files need the package cadquery-ocp-novtk, which is not installed"
        raise Finding("missing-extra", message, EXTRA_HINT) from None
    messenger = occ.Message.Message.DefaultMessenger_s()
    messenger.RemovePrinters(occ.Message.Message_Printer.get_type_descriptor_s())
    return occ


def _iter_parts(occ: Any, shape: Any, kind: Any) -> Iterator[Any]:
    explorer = occ.TopExp.TopExp_Explorer(shape, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def _find_box(occ: Any, shape: Any) -> Array:
    """Return the extent of a shape, low and high (2, 3), somewhat too large."""
    box = occ.Bnd.Bnd_Box()
    occ.BRepBndLib.BRepBndLib.Add_s(shape, box)
    low, high = box.CornerMin(), box.CornerMax()
    return np.array([[low.X(), low.Y(), low.Z()], [high.X(), high.Y(), high.Z()]])


def _integrate(occ: Any, shape: Any) -> Any:
    properties = occ.GProp.GProp_GProps()
    occ.BRepGProp.BRepGProp.VolumeProperties_s(shape, properties, INTEGRATION_ERROR, False, False)
    return properties


def _require_no_overlap(occ: Any, shapes: list[Any]) -> None:
    """Raise Finding [mesh-crosses-itself] if two solids share a volume, which would count twice."""
    boxes = [_find_box(occ, shape) for shape in shapes]
    for (i, one), (k, other) in combinations(enumerate(shapes), 2):
        if (boxes[i][0] > boxes[k][1]).any() or (boxes[k][0] > boxes[i][1]).any():
            continue
        shared = abs(_integrate(occ, occ.BRepAlgoAPI.BRepAlgoAPI_Common(one, other).Shape()).Mass())
        smaller = min(abs(_integrate(occ, shape).Mass()) for shape in (one, other))
        if shared > SHARED_VOLUME * smaller:
            message = f"solids {i + 1} and {k + 1} share {shared / smaller:.2g} of the volume of the smaller one"
            raise Finding("mesh-crosses-itself", message, "it would count twice: cut one of them out of the other")


def _make_solid(occ: Any, shape: Any, unit: float, number: int) -> StepSolid:
    """Make a solid from its shape. unit: of lengths [m]"""
    properties = _integrate(occ, shape)
    sign = -1.0 if properties.Mass() < 0.0 else 1.0  # a shape inside out
    volume, middle = sign * properties.Mass(), properties.CentreOfMass()
    if not volume > 0.0:
        raise mesh_file_finding(f"solid {number} has no volume", SAVE_HINT)
    matrix = properties.MatrixOfInertia()
    inertia = sign * np.array([[matrix.Value(i, k) for k in (1, 2, 3)] for i in (1, 2, 3)])
    second = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    center = np.array([middle.X(), middle.Y(), middle.Z()])
    moments = SolidMoments(volume * unit**3, center * unit, second * unit**5)
    return StepSolid(moments, _tessellate(occ, shape, unit, number))


def _tessellate(occ: Any, shape: Any, unit: float, number: int) -> TriangleSoup:
    """Divide the faces of a shape into triangles."""
    box = _find_box(occ, shape)
    deflection = CHORD_ERROR * float(np.linalg.norm(box[1] - box[0]))
    occ.BRepMesh.BRepMesh_IncrementalMesh(shape, deflection, False, ANGLE_ERROR, False)
    corners: list[Array] = []
    triangles: list[IndexArray] = []
    count = 0
    for part in _iter_parts(occ, shape, occ.TopAbs.TopAbs_ShapeEnum.TopAbs_FACE):
        face = occ.TopoDS.TopoDS.Face(part)
        location = occ.TopLoc.TopLoc_Location()
        mesh = occ.BRep.BRep_Tool.Triangulation_s(face, location)
        if mesh is None:
            raise mesh_file_finding(f"a face of solid {number} cannot be divided into triangles", SAVE_HINT)
        move = location.Transformation()
        nodes = [mesh.Node(i).Transformed(move) for i in range(1, mesh.NbNodes() + 1)]
        corners.append(np.array([(node.X(), node.Y(), node.Z()) for node in nodes]))
        numbers = np.array([mesh.Triangle(i).Get() for i in range(1, mesh.NbTriangles() + 1)], dtype=np.intp) - 1
        is_reversed = face.Orientation() == occ.TopAbs.TopAbs_Orientation.TopAbs_REVERSED
        triangles.append(count + (numbers[:, ::-1] if is_reversed else numbers))
        count += len(nodes)
    return TriangleSoup(unit * np.concatenate(corners), np.concatenate(triangles))
