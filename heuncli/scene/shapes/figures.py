"""The figures in which planes cut the single shapes of a body, where they are round or rectangles along e1 and e2.

Beam theory speaks of cuts square to the bar: there a cylinder, tube or cone shows a circle or ring, a box a rectangle,
a sphere a circle everywhere. Of what is cut askew only that it is met is told, and why its figure is none of these.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.results.results import Array
from heuncli.scene.shapes.box import Box
from heuncli.scene.shapes.figure_kinds import CuttingPlanes, Figure, Rectangle, Round, Unknown
from heuncli.scene.shapes.frustum import Frustum
from heuncli.scene.shapes.rotations import cross_rows
from heuncli.scene.shapes.solids import Ball, PointMass, Rod, Solid


def figure_of(part: Solid, at: CuttingPlanes) -> Figure | None:
    """The figure of a shape; None of what has no thickness, and so none."""
    if isinstance(part, Frustum):
        return of_frustum(part, at)
    if isinstance(part, Box):
        return of_box(part, at)
    if isinstance(part, Ball):
        h = at.d - at.n @ part.center
        radius = np.sqrt(np.maximum((part.radius - h) * (part.radius + h), 0.0))
        met = np.abs(at.beside - at.n @ part.center) < part.radius
        return Round(met, part.center + h[:, None] * at.n, radius, np.zeros_like(radius))
    if isinstance(part, PointMass | Rod):
        return None
    from heuncli.scene.shapes.profiles import of_polyhedron  # few scenes have them

    return of_polyhedron(part, at)


def of_frustum(part: Frustum, at: CuttingPlanes) -> Figure:
    """Of a cylinder, tube or cone."""
    if not is_along(part.axis, at.n):
        low, high = part.extent(at.n)
        return Unknown((low < at.beside) & (at.beside < high), "a cylinder, tube or cone is cut askew")
    c = float(part.axis @ at.n)
    z, beside = ((d - at.n @ part.start) / c for d in (at.d, at.beside))
    r, q = part.radii(np.clip(z, 0.0, part.length))
    return Round((beside > 0.0) & (beside < part.length), part.start + z[:, None] * part.axis, r, q)


def of_box(part: Box, at: CuttingPlanes) -> Figure:
    """Of a box, sides along e1 and e2."""
    i = int(np.argmax(np.abs(part.axes.T @ at.n)))
    h = at.d - at.n @ part.center
    if not is_along(part.axes[:, i], at.n):
        low, high = part.extent(at.n)
        return Unknown((low < at.beside) & (at.beside < high), "a box is cut askew")
    met = np.abs(at.beside - at.n @ part.center) < part.half[i]
    along = [j for j in range(3) if j != i and is_along(part.axes[:, j], at.e1)]
    if not along:
        side = ", ".join(f"{x:.6g}" for x in (part.axes[:, (i + 1) % 3] + 0.0).tolist())
        return Unknown(met, f"e1 is not along a side of the box (as first_axis: [{side}] is)")
    width, height = (2.0 * float(part.half[j]) for j in (along[0], 3 - i - along[0]))
    return Rectangle(met, part.center + h[:, None] * at.n, width, height)


def is_along(a: Array, b: Array) -> bool:
    """Whether two unit vectors are of one line, or opposite."""
    across = cross_rows(a, b)
    return float(np.sqrt(across @ across)) <= tolerances.PARALLEL
