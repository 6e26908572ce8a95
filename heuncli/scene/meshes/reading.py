"""Files of surfaces -> closed meshes: STL, OBJ, PLY, told apart by what stands in them. No file is opened here."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from heuncli.base.errors import Finding
from heuncli.base.number_range import are_in_range
from heuncli.scene.meshes.closure import edges_of, loose_corners, neighbours, shells_of
from heuncli.scene.meshes.crossings import require_no_crossing
from heuncli.scene.meshes.drawn_in import parted
from heuncli.scene.meshes.model import Soup, TriangleMesh, middle_of, tetrahedra
from heuncli.scene.meshes.numbers import refused
from heuncli.scene.meshes.obj import read_obj
from heuncli.scene.meshes.ply import read_ply
from heuncli.scene.meshes.stl import read_stl
from heuncli.scene.meshes.welding import resolution, welded, welded_near

MOST_TRIANGLES = 2_000_000
READERS: dict[str, Callable[[bytes], Soup]] = {"stl": read_stl, "obj": read_obj, "ply": read_ply}
OTHERS = {
    "step": "STEP", "stp": "STEP", "iges": "IGES", "igs": "IGES", "dae": "COLLADA", "3mf": "3MF", "glb": "glTF",
    "gltf": "glTF", "off": "OFF", "amf": "AMF",
}  # fmt: skip
KINDS = "STL, OBJ or PLY, named so: rod.stl"


def mesh_of(content: bytes | bytearray, name: str) -> TriangleMesh:
    """The closed mesh in a file of this name. Raises Finding: mesh-file, open-mesh and the like."""
    soup = welded(soup_of(bytes(content), name))
    notes: list[str] = []
    edges = edges_of(soup.triangles)
    loose = loose_corners(edges)
    if len(loose):
        before = len(soup.corners)
        soup = welded_near(soup, loose)
        edges = edges_of(soup.triangles)
        if len(soup.corners) < before and not len(loose_corners(edges)):
            notes.append(f"corners less than {resolution(soup.corners):.2g} of its units apart were taken as one")
    _require_triangles(soup)
    beside = neighbours(soup, edges)
    V = tetrahedra(soup.corners, soup.triangles, middle_of(soup.corners))[1]
    turned = soup.triangles[:, ::-1] if V.sum() < 0.0 else soup.triangles
    require_no_crossing(*parted(soup.corners, turned, beside), resolution(soup.corners))
    shells = shells_of(soup, beside, V)
    if shells.turned:
        notes.append("its triangles were turned inward; they are taken as outward")
    return TriangleMesh(
        soup.corners, shells.triangles, len(shells.volumes), float(shells.volumes.sum()),
        soup.corners.min(axis=0), soup.corners.max(axis=0), tuple(notes),
    )  # fmt: skip


def soup_of(content: bytes, name: str) -> Soup:
    """The triangles of a file, of coordinates that are computed with. Raises Finding."""
    soup = _reader(content, name)(content)
    _require_triangles(soup)
    if len(soup.triangles) > MOST_TRIANGLES:
        message = f"{len(soup.triangles):,} triangles; at most {MOST_TRIANGLES:,} are read"
        raise Finding("too-large", message, "a coarser mesh will do: mass and inertia err as the square of its size")
    own = soup.corners[soup.triangles.ravel()] if len(soup.corners) > 3 * len(soup.triangles) else soup.corners
    wrong = ~np.isfinite(own)
    if wrong.any() or not are_in_range(own).all():
        raise refused("a coordinate is no finite number, or beyond what is computed with", "save it again")
    return soup


def _require_triangles(soup: Soup) -> None:
    if not len(soup.triangles):
        raise refused("there are no triangles in it", "a solid's surface, in triangles")


def _reader(content: bytes, name: str) -> Callable[[bytes], Soup]:
    """By the name's ending; of others by how the file begins. Raises Finding."""
    end = name.rpartition(".")[2].lower()
    if content[:4] in (b"ply\n", b"ply\r"):
        return read_ply
    if end in READERS and end != "ply":
        return READERS[end]
    if end == "ply":
        raise refused("a PLY file begins with 'ply'", KINDS)
    if end in OTHERS:
        raise refused(f"{OTHERS[end]} is not read", f"export its surface as {KINDS}")
    if content.lstrip()[:5].lower() == b"solid":
        return read_stl
    raise refused("of which kind it is cannot be told", KINDS)
