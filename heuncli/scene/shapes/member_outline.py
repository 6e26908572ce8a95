"""The outline of a member's cross-section: its corners with their radii, exact moments of area, and polygons.

An outline is a closed polygon, counter-clockwise about its inside, of which a radius may round each corner. Its moments
are those of the polygon through the ends of the arcs, by Green's theorem, and of the segment between each arc and its
chord; about the arc's centre, x along the middle line of the arc, a half its angle,

    A = r^2 (a - sin a cos a),   int x = 2/3 r^3 sin^3 a,   int x^2 = r^4 ((a + sin a cos a)/4 - sin a cos^3 a/2)
    int y^2 = r^4 ((a - sin a cos a)/4 - sin^3 a cos a/6)
added where the corner turns left, else taken away. u is to the right (width), v up (height).
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.base.records import record
from heuncli.results.results import Array
from heuncli.scene.file_format.profiles import Family, Measures

# Chords in place of an arc of a polygon: its area is exact, its second moments are so to some 1e-6 of the section's.
CHORDS = 8


@record
class RoundedPolygon:
    """Corners (n, 2) [m] and the radii (n,) that round them."""

    corners: Array
    radii: Array

    @property
    def arcs(self) -> tuple[Array, Array, Array, Array]:
        """The arcs' starts and ends (n, 2), centres (n, 2), and the corners' turns (n,) [rad], > 0 to the left."""
        before = self.corners - np.roll(self.corners, 1, axis=0)
        before = before / np.hypot(*before.T)[:, None]
        after = np.roll(before, -1, axis=0)
        turn = np.arctan2(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], np.sum(before * after, axis=1))
        tangent = (self.radii * np.abs(np.tan(0.5 * turn)))[:, None]
        start, end = self.corners - tangent * before, self.corners + tangent * after
        left = np.stack([-before[:, 1], before[:, 0]], axis=1)
        return start, end, start + (np.sign(turn) * self.radii)[:, None] * left, turn

    def compute_moments(self) -> Array:
        """Compute A, int u, int v, int u^2, int u v, int v^2, (6,)."""
        start, end, center, turn = self.arcs
        p = np.stack([start, end], axis=1).reshape(-1, 2)
        q = np.roll(p, -1, axis=0)
        c = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
        (x, y), (u, v) = p.T, q.T
        moments = np.array([
            0.5 * c.sum(), (c * (x + u)).sum() / 6.0, (c * (y + v)).sum() / 6.0,
            (c * (x * x + x * u + u * u)).sum() / 12.0, (c * (2.0 * (x * y + u * v) + x * v + u * y)).sum() / 24.0,
            (c * (y * y + y * v + v * v)).sum() / 12.0,
        ])  # fmt: skip
        for r, angle, middle, o in zip(self.radii.tolist(), turn.tolist(), 0.5 * (start + end), center, strict=True):
            if r > 0.0:
                moments += math.copysign(1.0, angle) * _segment_moments(r, 0.5 * abs(angle), middle, o)
        return moments

    def make_polygon(self, rounded: Array) -> Array:
        """Make the polygon (m, 2) in which chords replace the arcs at the corners that `rounded` (n,) marks.

        Its corners between an arc's ends lie a little outside the arc, so that its area is exact.
        """
        start, _, center, turn = self.arcs
        points: list[Array] = []
        for k, is_rounded in enumerate(rounded.tolist()):
            if not is_rounded:
                points.append(self.corners[k : k + 1])
                continue
            step = turn[k] / CHORDS
            # (CHORDS - 2)/2 x^2 sin + r x sin = r^2 turn/2, x the distance of the corners from the centre
            part, sine = float(turn[k]), math.sin(step)
            x = (-1.0 + math.sqrt(1.0 + (CHORDS - 2) * part / sine)) / (CHORDS - 2)
            scale = np.array([1.0, *[x] * (CHORDS - 1), 1.0])
            angles = step * np.arange(CHORDS + 1)
            arm = start[k] - center[k]
            across = np.array([-arm[1], arm[0]])
            points.append(
                center[k] + scale[:, None] * (np.cos(angles)[:, None] * arm + np.sin(angles)[:, None] * across)
            )
        return np.concatenate(points)


def _segment_moments(r: float, half: float, middle: Array, center: Array) -> Array:
    """Compute the moments (6,) of the segment between an arc about a centre and its chord with this middle."""
    s, k = math.sin(half), math.cos(half)
    area, first = r * r * (half - s * k), 2.0 / 3.0 * r**3 * s**3
    along, across = 0.25 * (half + s * k) - 0.5 * s * k**3, 0.25 * (half - s * k) - s**3 * k / 6.0
    d = (middle - center) / math.hypot(*(middle - center))
    second = r**4 * ((along - across) * np.outer(d, d) + across * np.eye(2))
    shift = np.outer(first * d, center)
    second = second + shift + shift.T + area * np.outer(center, center)
    return np.array([area, *(first * d + area * center), second[0, 0], second[0, 1], second[1, 1]])


def make_outline(family: Family, m: Measures) -> tuple[RoundedPolygon, ...]:
    """Make the outline of a member, and of a box the hole too, which is clockwise; the origin is a corner or middle."""
    b, h, t, f, r, toe = m.width, m.height, m.web, m.flange, m.radius, m.toe_radius
    if family == "box":
        outer = _make_rectangle(b, h, r)
        hole = _make_rectangle(b - 2.0 * t, h - 2.0 * f, toe)
        return outer, RoundedPolygon(hole.corners[::-1], hole.radii)
    rows: list[tuple[float, float, float]]
    if family == "L":
        rows = [(0, 0, 0), (b, 0, 0), (b, f, toe), (t, f, r), (t, h, toe), (0, h, 0)]
    elif family == "C":
        root, tip = f + m.slope * (0.5 * b - t), f - 0.5 * m.slope * b
        lower = [(0.0, 0.0, 0.0), (b, 0.0, 0.0), (b, tip, toe), (t, root, r)]
        rows = [*lower, *((u, h - v, radius) for u, v, radius in reversed(lower))]
    else:
        top = [
            (0.5 * t, h - f, r), (0.5 * b, h - f, toe), (0.5 * b, h, 0), (-0.5 * b, h, 0), (-0.5 * b, h - f, toe),
            (-0.5 * t, h - f, r),
        ]  # fmt: skip
        foot: list[tuple[float, float, float]] = [(-0.5 * t, 0, 0), (0.5 * t, 0, 0)]
        if family == "I":
            foot = [(-0.5 * t, f, r), (-0.5 * b, f, toe), (-0.5 * b, 0, 0), (0.5 * b, 0, 0), (0.5 * b, f, toe),
                    (0.5 * t, f, r)]  # fmt: skip
        rows = [*foot, *top]
    array = np.array(rows, dtype=float)
    return (RoundedPolygon(array[:, :2], array[:, 2]),)


def _make_rectangle(b: float, h: float, r: float) -> RoundedPolygon:
    corners = 0.5 * np.array([[-b, -h], [b, -h], [b, h], [-b, h]])
    return RoundedPolygon(corners, np.full(4, r))
