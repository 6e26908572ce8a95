"""Read STL, OBJ, PLY and STEP into closed meshes, distinguished by their contents. No file is opened here."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

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
from heuncli.scene.meshes.model import (
    SolidMoments,
    TriangleMesh,
    TriangleSoup,
    make_tetrahedra,
    middle_of_extent,
    separate_fans,
)
from heuncli.scene.meshes.ply import read_ply

MAX_TRIANGLES = 2_000_000
MAX_VOLUME_DEFECT = 0.05  # of the triangles of a solid; beyond, they do not bound it
MESH_READERS: dict[str, Callable[[bytes], TriangleSoup]] = {"stl": read_stl, "obj": read_obj, "ply": read_ply}
STEP_START = b"ISO-10303-21"
STEP_ENDINGS = ("step", "stp", "p21")
UNREAD_FORMATS = {
    "iges": "IGES", "igs": "IGES", "dae": "COLLADA", "3mf": "3MF", "glb": "glTF",
    "gltf": "glTF", "off": "OFF", "amf": "AMF",
}  # fmt: skip
FORMAT_HINT = "STL, OBJ, PLY or STEP, with that file name extension: rod.stl"


def read_closed_mesh(content: bytes | bytearray, name: str) -> TriangleMesh:
    """Read the closed mesh in a file of this name. Raises Finding: mesh-file, open-mesh and the like."""
    if is_step(content, name):
        return read_step_mesh(bytes(content))
    return close_soup(read_soup(bytes(content), name))


def is_step(content: bytes | bytearray, name: str) -> bool:
    """Return whether a file of this name is STEP."""
    return content[:100].lstrip().startswith(STEP_START) or name.rpartition(".")[2].lower() in STEP_ENDINGS


def read_step_mesh(content: bytes) -> TriangleMesh:
    """Read the solids of a STEP file as one mesh, with their exact moments. Raises Finding."""
    from heuncli.scene.meshes.step import read_step_solids  # imports an optional package

    solids = read_step_solids(content)
    if sum(len(solid.soup.triangles) for solid in solids) > MAX_TRIANGLES:
        raise Finding("too-large", f"its solids take more than {MAX_TRIANGLES:,} triangles", "give fewer of them")
    meshes = [close_soup(solid.soup) for solid in solids]
    moments = add_moments([solid.moments for solid in solids])
    volumes = [mesh.volume for mesh in meshes]
    defects = [abs(volume / solid.moments.volume - 1.0) for volume, solid in zip(volumes, solids, strict=True)]
    if max(defects) > MAX_VOLUME_DEFECT:
        number = 1 + int(np.argmax(defects))
        message = f"the volume of solid {number} and of its surface differ by {100.0 * max(defects):.2g} %"
        raise mesh_file_finding(message, "repair the solid in the CAD program: it may be open or cross itself")
    starts = np.cumsum([0, *(len(mesh.corners) for mesh in meshes)])
    return TriangleMesh(
        np.concatenate([mesh.corners for mesh in meshes]),
        np.concatenate([start + mesh.triangles for start, mesh in zip(starts, meshes, strict=False)]),
        sum(mesh.shells for mesh in meshes),
        moments.volume,
        np.min([mesh.low for mesh in meshes], axis=0),
        np.max([mesh.high for mesh in meshes], axis=0),
        tuple(note for mesh in meshes for note in mesh.notes if "inward" not in note),
        describe_moments(moments, len(solids), math.fsum(volumes)),
        moments,
    )


def describe_moments(moments: SolidMoments, count: int, volume: float) -> tuple[str, ...]:
    """Say in sentences what solids are in a STEP file. volume: of their triangles [m^3]"""
    inertia = (np.trace(moments.second) * np.eye(3) - moments.second) / moments.volume
    squares, axes = np.linalg.eigh(inertia)
    axes = axes * np.where(axes[np.argmax(np.abs(axes), axis=0), range(3)] < 0.0, -1.0, 1.0)
    radii = ", ".join(
        f"{math.sqrt(max(square, 0.0)):.6g} about ({', '.join(f'{x + 0.0:.4g}' for x in np.round(axis, 12))})"
        for square, axis in zip(squares, axes.T, strict=True)
    )
    center = ", ".join(f"{x + 0.0:.6g}" for x in np.where(np.abs(moments.center) < 1e-12, 0.0, moments.center))
    solids = "1 solid" if count == 1 else f"{count} solids"
    return (
        f"{solids}, {moments.volume:.6g} m3, centre ({center}) m; principal radii of gyration [m] {radii}",
        f"cuts use triangles, whose volume differs by {abs(volume / moments.volume - 1.0):.1e}",
    )


def add_moments(parts: Sequence[SolidMoments]) -> SolidMoments:
    """Add the moments of solids."""
    volume = math.fsum(part.volume for part in parts)
    center = np.sum([part.volume * part.center for part in parts], axis=0) / volume
    arms = [part.center - center for part in parts]
    second = sum(part.second + part.volume * np.outer(arm, arm) for part, arm in zip(parts, arms, strict=True))
    return SolidMoments(volume, center, np.asarray(second))


def close_soup(soup: TriangleSoup) -> TriangleMesh:
    """Make the closed mesh of triangles. Raises Finding: open-mesh and the like."""
    soup = weld_equal_corners(soup)
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
