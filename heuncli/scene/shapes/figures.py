"""Find the figures in which planes cut the single shapes of a body, if they are round, or rectangles along e1 and e2.

Beam theory assumes cuts perpendicular to the bar: then a cylinder, tube or cone shows a circle or ring, a box a
rectangle, and a sphere always a circle. For an oblique cut the result only says whether the plane meets the shape, and
why the figure is unknown.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.results.results import Array
from heuncli.scene.shapes.box import Box
from heuncli.scene.shapes.figure_kinds import CuttingPlanes, Figure, RectangleFigure, RoundFigure, UnknownFigure
from heuncli.scene.shapes.frustum import Frustum
from heuncli.scene.shapes.rotations import cross_rows
from heuncli.scene.shapes.solids import Ball, PointMass, Rod, Solid


def find_figure(part: Solid, planes: CuttingPlanes) -> Figure | None:
    """Find the figure of a shape; None if the shape has no thickness."""
    if isinstance(part, Frustum):
        return find_frustum_figure(part, planes)
    if isinstance(part, Box):
        return find_box_figure(part, planes)
    if isinstance(part, Ball):
        h = planes.d - planes.n @ part.center
        radius = np.sqrt(np.maximum((part.radius - h) * (part.radius + h), 0.0))
        is_met = np.abs(planes.shifted_d - planes.n @ part.center) < part.radius
        return RoundFigure(is_met, part.center + h[:, None] * planes.n, radius, np.zeros_like(radius))
    if isinstance(part, PointMass | Rod):
        return None
    from heuncli.scene.shapes.profiles import find_profile_figure  # few scenes have meshes

    return find_profile_figure(part, planes)


def find_frustum_figure(part: Frustum, planes: CuttingPlanes) -> Figure:
    """Find the figure of a cylinder, tube or cone."""
    if not are_parallel(part.axis, planes.n):
        low, high = part.extent(planes.n)
        return UnknownFigure(
            (low < planes.shifted_d) & (planes.shifted_d < high), "a cylinder, tube or cone is cut obliquely"
        )
    c = float(part.axis @ planes.n)
    z, shifted_z = ((d - planes.n @ part.start) / c for d in (planes.d, planes.shifted_d))
    r, q = part.radii(np.clip(z, 0.0, part.length))
    return RoundFigure((shifted_z > 0.0) & (shifted_z < part.length), part.start + z[:, None] * part.axis, r, q)


def find_box_figure(part: Box, planes: CuttingPlanes) -> Figure:
    """Find the figure of a box, with sides along e1 and e2."""
    i = int(np.argmax(np.abs(part.axes.T @ planes.n)))
    h = planes.d - planes.n @ part.center
    if not are_parallel(part.axes[:, i], planes.n):
        low, high = part.extent(planes.n)
        return UnknownFigure((low < planes.shifted_d) & (planes.shifted_d < high), "a box is cut obliquely")
    is_met = np.abs(planes.shifted_d - planes.n @ part.center) < part.half_size[i]
    parallel_axes = [j for j in range(3) if j != i and are_parallel(part.axes[:, j], planes.e1)]
    if not parallel_axes:
        side = ", ".join(f"{x:.6g}" for x in (part.axes[:, (i + 1) % 3] + 0.0).tolist())
        return UnknownFigure(is_met, f"e1 is not parallel to a side of the box (use first_axis: [{side}])")
    width, height = (2.0 * float(part.half_size[j]) for j in (parallel_axes[0], 3 - i - parallel_axes[0]))
    return RectangleFigure(is_met, part.center + h[:, None] * planes.n, width, height)


def are_parallel(a: Array, b: Array) -> bool:
    """Return whether two unit vectors are parallel, or opposite."""
    cross_product = cross_rows(a, b)
    return float(np.sqrt(cross_product @ cross_product)) <= tolerances.PARALLEL
