"""Find the visible lines of solids: silhouettes, and the edges on the side towards the eye."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.machine_geometry.solids import Surface
from heuncli.output.machine_geometry.views import SceneView
from heuncli.results.results import Array

Indices = np.ndarray[tuple[int, ...], np.dtype[np.intp]]
MATCH_DECIMALS = 9  # decimals, relative to the surface's size, to which edge points are matched with corners
NO_FACE = -1


class SolidEdges(NamedTuple):
    """A surface with what is needed to find its visible lines, all in body axes.

    normals: of the faces, (f, 3)
    pieces: its edges in straight pieces, (m, 2, 3)
    adjacent_faces: numbers of the two faces at each piece, (m, 2); NO_FACE if there is none
    """

    surface: Surface
    normals: Array
    pieces: Array
    adjacent_faces: Indices


def find_solid_edges(surface: Surface) -> SolidEdges:
    """Find the face normals and the edges with their adjacent faces, which do not depend on the view."""
    c = surface.corners
    p, q, r = c[np.array([face[:3] for face in surface.faces])].swapaxes(0, 1)
    normals = np.cross(q - p, r - q)
    size = float(np.ptp(c, axis=0).max()) or 1.0
    numbers = {tuple(p): k for k, p in enumerate(np.round(c / size, MATCH_DECIMALS).tolist())}
    sides: dict[tuple[int, int], list[int]] = {}
    for number, face in enumerate(surface.faces):
        for a, b in zip(face, (*face[1:], face[0]), strict=True):
            sides.setdefault((min(a, b), max(a, b)), []).append(number)
    pieces: list[Array] = []
    adjacent: list[list[int]] = []
    for edge in surface.edges:
        ends = [numbers.get(tuple(p), NO_FACE) for p in np.round(edge / size, MATCH_DECIMALS).tolist()]
        for k, (a, b) in enumerate(pairwise(ends)):
            faces = sides.get((min(a, b), max(a, b)), [])
            pieces.append(edge[k : k + 2])
            adjacent.append([*faces, NO_FACE, NO_FACE][:2])
    return SolidEdges(
        surface, normals, np.array(pieces).reshape(-1, 2, 3), np.array(adjacent, dtype=np.intp).reshape(-1, 2)
    )


def find_silhouette(solid: SolidEdges, rotation: Array, view: SceneView) -> list[Indices]:
    """Find the closed lines of corner numbers that bound the visible part of a surface, which lies to their left.

    The winding number about each point is the number of layers of the surface there: 0 where one sees through a hole.
    In a simplified mesh a few triangles may be turned over; lines about single ones are left out.
    """
    visible = solid.normals @ (rotation.T @ view.eye_direction) > 0.0
    faces = np.array(
        [face for face, is_visible in zip(solid.surface.faces, visible.tolist(), strict=True) if is_visible], np.intp
    )
    ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2) if len(faces) else faces.reshape(0, 2)
    edge_counts = Counter(map(tuple, ends.tolist()))
    successors: dict[int, list[int]] = {}
    for (a, b), count in edge_counts.items():
        successors.setdefault(a, []).extend([b] * max(0, count - edge_counts[b, a]))
    lines = [np.array(line, dtype=np.intp) for line in _iter_closed_lines(successors)]
    return [line for line in lines if _compute_length(solid.surface.corners[line]) > solid.surface.blur]


def _compute_length(line: Array) -> float:
    """Compute the length of a closed line through corners (n, 3)."""
    steps = np.roll(line, -1, axis=0) - line
    return float(np.sqrt((steps * steps).sum(axis=1)).sum())


def _iter_closed_lines(successors: dict[int, list[int]]) -> Iterator[list[int]]:
    """Yield closed lines of corners, using every successor once; empties `successors`.

    Each corner must begin as many lines as it ends.
    """
    for start in successors:
        while successors[start]:
            line = [start]
            while (next_corner := successors[line[-1]].pop()) != start:
                line.append(next_corner)
            yield line


def select_visible_edges(solid: SolidEdges, rotation: Array, view: SceneView) -> Array:
    """Select the pieces of edges (k, 2, 3) on the side towards the eye, body axes.

    rotation: the body's rotation matrix, (3, 3)
    """
    d = rotation.T @ view.eye_direction  # to the eye, in body axes
    faces = np.append(solid.normals @ d > 0.0, False)  # the last entry is that of NO_FACE
    visible = faces[solid.adjacent_faces].any(axis=1)
    has_no_face = (solid.adjacent_faces == NO_FACE).all(axis=1)  # on round surfaces, such as great circles
    if has_no_face.any():
        middle = solid.surface.corners.mean(axis=0)
        visible |= has_no_face & ((solid.pieces.mean(axis=1) - middle) @ d > 0.0)
    return np.asarray(solid.pieces[visible])
