"""Solids as they are seen: their outlines, and the edges on the side that is turned to the eye."""

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
KNOWN = 9  # decimals, of a surface's size, to which its edges are found among its corners
NO_FACE = -1


class SeenSolid(NamedTuple):
    """A surface, its faces' normals (f, 3), its edges in straight pieces (m, 2, 3), and of each the faces beside it.

    beside (m, 2): NO_FACE where there is none. All in body axes.
    """

    surface: Surface
    normals: Array
    pieces: Array
    beside: Indices


def solid_of(surface: Surface) -> SeenSolid:
    """What of a surface is looked up for each view of it."""
    c = surface.corners
    p, q, r = c[np.array([face[:3] for face in surface.faces])].swapaxes(0, 1)
    normals = np.cross(q - p, r - q)
    size = float(np.ptp(c, axis=0).max()) or 1.0
    numbers = {tuple(p): k for k, p in enumerate(np.round(c / size, KNOWN).tolist())}
    sides: dict[tuple[int, int], list[int]] = {}
    for number, face in enumerate(surface.faces):
        for a, b in zip(face, (*face[1:], face[0]), strict=True):
            sides.setdefault((min(a, b), max(a, b)), []).append(number)
    pieces: list[Array] = []
    beside: list[list[int]] = []
    for edge in surface.edges:
        ends = [numbers.get(tuple(p), NO_FACE) for p in np.round(edge / size, KNOWN).tolist()]
        for k, (a, b) in enumerate(pairwise(ends)):
            faces = sides.get((min(a, b), max(a, b)), [])
            pieces.append(edge[k : k + 2])
            beside.append([*faces, NO_FACE, NO_FACE][:2])
    return SeenSolid(
        surface, normals, np.array(pieces).reshape(-1, 2, 3), np.array(beside, dtype=np.intp).reshape(-1, 2)
    )


def outline(points: Array) -> Array:
    """The corners of the convex hull of points (n, 2), counter-clockwise (Andrew, 1979)."""
    found = sorted(set(map(tuple, points.tolist())))
    if len(found) < 3:
        return np.array(found).reshape(-1, 2)
    halves: list[tuple[float, float]] = []
    for way in (found, found[::-1]):
        half: list[tuple[float, float]] = []
        for x, y in way:
            while len(half) > 1:
                (ax, ay), (bx, by) = half[-2:]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0:
                    break
                half.pop()
            half.append((x, y))
        halves += half[:-1]
    return np.array(halves)


def silhouette(solid: SeenSolid, rotation: Array, view: SceneView) -> list[Indices]:
    """The closed lines, by the numbers of their corners, at which what is seen of a surface ends, to its left what is.

    They wind about each place as often as the surface lies over it: about none where one sees through a hole. Of a
    thinned surface a triangle here and there is turned over; lines about such a one are left out.
    """
    seen = solid.normals @ (rotation.T @ view.toward) > 0.0
    faces = np.array([face for face, looks in zip(solid.surface.faces, seen.tolist(), strict=True) if looks], np.intp)
    ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2) if len(faces) else faces.reshape(0, 2)
    left = Counter(map(tuple, ends.tolist()))
    following: dict[int, list[int]] = {}
    for (a, b), count in left.items():
        following.setdefault(a, []).extend([b] * max(0, count - left[b, a]))
    lines = [np.array(line, dtype=np.intp) for line in _closed_lines(following)]
    return [line for line in lines if _length(solid.surface.corners[line]) > solid.surface.blur]


def _length(line: Array) -> float:
    """Of a closed line through corners (n, 3)."""
    way = np.roll(line, -1, axis=0) - line
    return float(np.sqrt((way * way).sum(axis=1)).sum())


def _closed_lines(following: dict[int, list[int]]) -> Iterator[list[int]]:
    """The closed lines of corners of which as many lines come as go; empties `following`."""
    for start in following:
        while following[start]:
            line = [start]
            while (onward := following[line[-1]].pop()) != start:
                line.append(onward)
            yield line


def edges_seen(solid: SeenSolid, rotation: Array, view: SceneView) -> Array:
    """The pieces of edges (k, 2, 3) on the side towards the eye, body axes; rotation: the body's attitude (3, 3)."""
    d = rotation.T @ view.toward  # to the eye, in body axes
    faces = np.append(solid.normals @ d > 0.0, False)  # the last one stands for no face
    seen = faces[solid.beside].any(axis=1)
    lone = (solid.beside == NO_FACE).all(axis=1)  # on round surfaces, such as great circles
    if lone.any():
        middle = solid.surface.corners.mean(axis=0)
        seen |= lone & ((solid.pieces.mean(axis=1) - middle) @ d > 0.0)
    return np.asarray(solid.pieces[seen])
