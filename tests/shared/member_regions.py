"""What is in the cross-section of a member, told place by place, without the corners and arcs of its outline."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from heuncli.results.results import Array
from heuncli.scene.file_format.profiles import Family, Measures


def is_inside(family: Family, m: Measures) -> Callable[[Array, Array], Array]:
    """Whether places are in a cross-section, by what it is and not by its outline; origin as the outline's."""
    b, h, t, f, r, toe, slope = m
    phi = math.atan(slope)

    def rounded_box(x: Array, y: Array, width: float, height: float, radius: float) -> Array:
        dx, dy = np.abs(x) - 0.5 * width + radius, np.abs(y) - 0.5 * height + radius
        return np.where((dx > 0) & (dy > 0), dx * dx + dy * dy < radius**2, (dx < radius) & (dy < radius))

    def with_flange(x: Array, y: Array) -> Array:
        """A web along y to a flange on y = 0, x from the web's face, y upwards; half of it."""
        face = f + slope * (0.5 * b - x_of(x))
        cx, cy = r, f + slope * (0.5 * b - x_of(r)) + r / math.cos(phi)
        fillet = (x < cx - r * math.sin(phi)) & (y < cy) & ((x - cx) ** 2 + (y - cy) ** 2 > r * r)
        inside = (x < 0.0) | (y < face) | fillet
        end = overhang
        qx, qy = end - toe, f + slope * (0.5 * b - x_of(end - toe)) - toe / math.cos(phi)
        cut = (x > qx + toe * math.sin(phi)) & (y > qy) & ((x - qx) ** 2 + (y - qy) ** 2 > toe * toe)
        return np.asarray(inside & (x < end) & (y > 0.0) & ~(cut & (toe > 0.0)))

    overhang = b - t if family in ("C", "L") else 0.5 * (b - t)

    def x_of(x: Array | float) -> Array | float:
        return x + t if family in ("C", "L") else x + 0.5 * t

    if family == "box":
        return lambda x, y: rounded_box(x, y, b, h, r) & ~rounded_box(x, y, b - 2 * t, h - 2 * f, toe)
    if family == "I":
        return lambda x, y: with_flange(np.abs(x) - 0.5 * t, np.minimum(y, h - y))
    if family == "T":
        return lambda x, y: with_flange(np.abs(x) - 0.5 * t, h - y) & (y > 0.0)
    if family == "C":
        return lambda x, y: with_flange(x - t, np.minimum(y, h - y)) & (x > 0.0)

    def angle(x: Array, y: Array) -> Array:
        cut = (y > h - toe) & (x > t - toe) & ((x - t + toe) ** 2 + (y - h + toe) ** 2 > toe * toe)
        return with_flange(x - t, y) & (x > 0.0) & (y < h) & ~cut

    return angle
