"""Read surface files into closed meshes: STL, OBJ, PLY, distinguished by their contents. No file is opened here."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from heuncli.base.errors import Finding
from heuncli.base.units import are_in_range
from heuncli.scene.meshes.closure import (
    coordinate_resolution,
    find_edge_neighbours,
    find_edges,
    find_open_corners,
    find_shells,
    weld_equal_corners,
    weld_near_corners,
)
from heuncli.scene.meshes.crossings import require_no_crossing
from heuncli.scene.meshes.formats import mesh_file_finding, read_obj, read_stl
from heuncli.scene.meshes.model import TriangleMesh, TriangleSoup, make_tetrahedra, middle_of_extent, separate_fans
from heuncli.scene.meshes.ply import read_ply

MAX_TRIANGLES = 2_000_000
MESH_READERS: dict[str, Callable[[bytes], TriangleSoup]] = {"stl": read_stl, "obj": read_obj, "ply": read_ply}
UNREAD_FORMATS = {
    "step": "STEP", "stp": "STEP", "iges": "IGES", "igs": "IGES", "dae": "COLLADA", "3mf": "3MF", "glb": "glTF",
    "gltf": "glTF", "off": "OFF", "amf": "AMF",
}  # fmt: skip
FORMAT_HINT = "STL, OBJ or PLY, with that file name extension: rod.stl"


def read_closed_mesh(content: bytes | bytearray, name: str) -> TriangleMesh:
    """Read the closed mesh in a file of this name. Raises Finding: mesh-file, open-mesh and the like."""
    soup = weld_equal_corners(read_soup(bytes(content), name))
    notes: list[str] = []
    edges = find_edges(soup.triangles)
    open_corners = find_open_corners(edges)
    if len(open_corners):
        corner_count = len(soup.corners)
        soup = weld_near_corners(soup, open_corners)
        edges = find_edges(soup.triangles)
        if len(soup.corners) < corner_count and not len(find_open_corners(edges)):
            notes.append(f"vertices closer than {coordinate_resolution(soup.corners):.2g} of its units were merged")
    _require_triangles(soup)
    edge_neighbours = find_edge_neighbours(soup, edges)
    V = make_tetrahedra(soup.corners, soup.triangles, middle_of_extent(soup.corners))[1]
    outward = soup.triangles[:, ::-1] if V.sum() < 0.0 else soup.triangles
    require_no_crossing(*separate_fans(soup.corners, outward, edge_neighbours), coordinate_resolution(soup.corners))
    shells = find_shells(soup, edge_neighbours, V)
    if shells.is_reversed:
        notes.append("its normals pointed inward; the triangles were reversed")
    return TriangleMesh(
        soup.corners, shells.triangles, len(shells.volumes), float(shells.volumes.sum()),
        soup.corners.min(axis=0), soup.corners.max(axis=0), tuple(notes),
    )  # fmt: skip


def read_soup(content: bytes, name: str) -> TriangleSoup:
    """Read the triangles of a file, and check that their coordinates are in range. Raises Finding."""
    soup = _find_reader(content, name)(content)
    _require_triangles(soup)
    if len(soup.triangles) > MAX_TRIANGLES:
        message = f"{len(soup.triangles):,} triangles; at most {MAX_TRIANGLES:,} are allowed"
        raise Finding(
            "too-large", message, "use a coarser mesh: errors of mass and inertia go with the square of the edge length"
        )
    used_corners = soup.corners[soup.triangles.ravel()] if len(soup.corners) > 3 * len(soup.triangles) else soup.corners
    is_not_finite = ~np.isfinite(used_corners)
    if is_not_finite.any() or not are_in_range(used_corners).all():
        raise mesh_file_finding("a coordinate is not a finite number, or is outside the allowed range", "save it again")
    return soup


def _require_triangles(soup: TriangleSoup) -> None:
    if not len(soup.triangles):
        raise mesh_file_finding("the file has no triangles", "give the surface of a solid as triangles")


def _find_reader(content: bytes, name: str) -> Callable[[bytes], TriangleSoup]:
    """Find the reader by the name's ending, otherwise by the beginning of the file. Raises Finding."""
    end = name.rpartition(".")[2].lower()
    if content[:4] in (b"ply\n", b"ply\r"):
        return read_ply
    if end in MESH_READERS and end != "ply":
        return MESH_READERS[end]
    if end == "ply":
        raise mesh_file_finding("a PLY file begins with 'ply'", FORMAT_HINT)
    if end in UNREAD_FORMATS:
        raise mesh_file_finding(f"{UNREAD_FORMATS[end]} cannot be read", f"export its surface as {FORMAT_HINT}")
    if content.lstrip()[:5].lower() == b"solid":
        return read_stl
    raise mesh_file_finding("the file format cannot be identified", FORMAT_HINT)
