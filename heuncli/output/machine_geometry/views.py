"""Views of a machine: parallel projection onto a drawing plane with axes r to the right, u up, d to the eye.

    right = r . x,   up = u . x,   depth = d . x (larger is nearer);   r, u, d orthonormal, r x u = d
Up is against gravity if there is any, else z. At azimuth and elevation 0 x points to the right (y if x is up); from
there the eye moves to the right by the azimuth and up by the elevation, as in MATLAB's `view`. Of solids a view shows
silhouettes, and the edges on the side towards the eye.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from itertools import islice, pairwise

import numpy as np

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.reduction.plane.step import iter_departures
from heuncli.multibody.reduction.plane.view import find_neighbours, iter_normals
from heuncli.multibody.reduction.plane.view import make_view as seen_from_plane
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.output.machine_geometry.solids import Surface
from heuncli.results.results import Array

AZIMUTH, ELEVATION = 30.0, 20.0  # degrees, default view of a spatial scene
MIN_VISIBLE_GRAVITY = 0.1  # part of gravity perpendicular to the line of sight that is enough to define up
ROUNDING = 1e-12  # components of unit vectors below it are rounding errors
MAX_DEPTH_RATIO = 0.6  # of the extent in the plane of motion; a deeper machine is seen in the spatial view
VALID_VIEWS = "x, y, z, or azimuth and elevation in degrees"
VIEW_EXAMPLES = "for example --view z or --view 30,20"
Indices = np.ndarray[tuple[int, ...], np.dtype[np.intp]]
MATCH_DECIMALS = 9  # decimals, relative to the surface's size, to which edge points are matched with corners
NO_FACE = -1


class SceneView(NamedTuple):
    """Unit vectors (3,) to the right, up, and to the eye; and a description of the direction of view."""

    right_direction: Array
    up_direction: Array
    eye_direction: Array
    description: str

    def project(self, points: Array) -> Array:
        """Project points or vectors (..., 3) onto the drawing plane, (..., 2)."""
        return np.asarray(np.stack([points @ self.right_direction, points @ self.up_direction], axis=-1))

    def compute_depth(self, points: Array) -> Array:
        """Compute how near to the eye points (..., 3) are, (...,); larger is nearer."""
        return np.asarray(points @ self.eye_direction)

    def format_axes(self) -> tuple[str, str]:
        """Format the directions of the axes to the right and up."""
        return format_direction(self.right_direction), format_direction(self.up_direction)


def format_direction(direction: Array) -> str:
    """Format a direction by world axes: `x`, `-y`, `0.87 x - 0.5 y`."""
    text = ""
    for component, axis in zip(direction.tolist(), "xyz", strict=True):
        figure = f"{abs(component):.2g}"
        if float(figure) >= 0.01:
            sign = ("- " if component < 0.0 else "+ ") if text else "-" if component < 0.0 else ""
            text += f" {sign}" if text else sign
            text += axis if figure == "1" else f"{figure} {axis}"
    return text


def make_view_along(direction: Array, gravity: Array) -> SceneView:
    """Make the view along a line; its sign is chosen so that the world axes point right and up rather than left and
    down.
    """
    d = _normalise(direction)
    up_direction = _project_out(-gravity, d)
    if float(np.linalg.norm(up_direction)) < MIN_VISIBLE_GRAVITY * float(np.linalg.norm(gravity)) or not gravity.any():
        up_direction = next(
            e for e in (_project_out(axis, d) for axis in np.eye(3)[[2, 1]]) if e @ e > MIN_VISIBLE_GRAVITY
        )
    up_direction = _normalise(up_direction)
    right = _normalise(np.cross(up_direction, d))
    if right[int(np.argmax(np.abs(right)))] < 0.0:
        d, right = -d, -right
    description = format_direction(d)
    return SceneView(right, up_direction, d, description if description.startswith("-") else f"+{description}")


def make_view_at_angles(azimuth: float, elevation: float, gravity: Array) -> SceneView:
    """Make the view from an azimuth and an elevation [degrees]."""
    up_direction = _normalise(-gravity) if gravity.any() else np.array([0.0, 0.0, 1.0])
    right = np.eye(3)[1 if int(np.argmax(np.abs(up_direction))) == 0 else 0]
    right = _normalise(_project_out(right, up_direction))
    ahead = np.cross(up_direction, right)
    a, e = math.radians(azimuth), math.radians(elevation)
    level = math.sin(a) * right - math.cos(a) * ahead
    d = _normalise(math.cos(e) * level + math.sin(e) * up_direction)
    r = _normalise(math.cos(a) * right + math.sin(a) * ahead)
    return SceneView(r, _normalise(np.cross(d, r)), d, f"azimuth {azimuth:.6g}, elevation {elevation:.6g} degrees")


def parse_view(option: str, gravity: Array) -> SceneView:
    """Parse the value of `--view`. Raises Finding."""
    text = option.strip().lower()
    if text in ("x", "y", "z"):
        return make_view_along(np.eye(3)["xyz".index(text)], gravity)
    try:
        azimuth, elevation = map(float, text.split(","))
    except ValueError:
        raise Finding("bad-option", f"expected {VALID_VIEWS}", VIEW_EXAMPLES) from None
    if not (abs(azimuth) <= 360.0 and abs(elevation) <= 90.0):
        raise Finding("bad-option", "expected an azimuth up to 360 and an elevation up to 90 degrees", VIEW_EXAMPLES)
    return make_view_at_angles(azimuth, elevation, gravity)


def choose_view(scene: PreparedScene, points: Array) -> SceneView:
    """Choose the view: along the normal of a planar scene unless it extends far along that normal; else from 30, 20
    degrees.

    points: (n, 3), what the figure must hold
    """
    gravity = scene.mechanism.gravity
    n = find_motion_plane(scene)
    if n is not None:
        view = make_view_along(n, gravity)
        low, high = (
            f(np.column_stack([view.project(points), view.compute_depth(points)]), axis=0) for f in (np.min, np.max)
        )
        spans = high - low
        if spans[2] <= MAX_DEPTH_RATIO * max(spans[0], spans[1]):
            return view
    return make_view_at_angles(AZIMUTH, ELEVATION, gravity)


def find_motion_plane(scene: PreparedScene) -> Array | None:
    """Find the normal (3,) of the plane in which a scene moves, or None if its motion is spatial."""
    adjacent = find_neighbours(scene)
    for n in iter_normals(scene):
        if not list(islice(iter_departures(seen_from_plane(scene, n, adjacent)), 1)):
            return n
    return None


def _project_out(vector: Array, direction: Array) -> Array:
    """Return the part of a vector that is perpendicular to a unit direction."""
    return np.asarray(vector - (vector @ direction) * direction)


def _normalise(vector: Array) -> Array:
    """Scale a vector to unit length and set components that are rounding errors to zero."""
    unit = vector / np.linalg.norm(vector)
    unit = np.where(np.abs(unit) < ROUNDING, 0.0, unit)
    return np.asarray(unit / np.linalg.norm(unit))


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
