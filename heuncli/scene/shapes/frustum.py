"""Cut a cylinder, tube or cone by any plane.

Local axes at the start: z along the axis, x towards the part of the normal perpendicular to it, n = (s, 0, c). At
height z the plane cuts the ring between the radii q(z) < r(z) along x = u(z) = (d - c z)/s; the part behind it is a
difference of two circular segments, whose moments have closed forms. Their integral over z is smooth between the
heights where u = +-r or +-q; there it starts like a power 3/2, which the quadrature removes. Outer and inner circle are
never subtracted as such: all terms carry the factor r - q, so that thin walls lose no digits. For a cut perpendicular
to the axis all is exact.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.results.results import Array
from heuncli.scene.shapes.inertia import assemble_pseudo_inertia
from heuncli.scene.shapes.outlines import SIDES, Corners, Flags, Outline, Planes, circle_corners
from heuncli.scene.shapes.rotations import perpendicular_pair
from heuncli.scene.shapes.solids import Owners, ThickSolid, gauss_rule, integrate_adaptively


def ring_segments(u: Array, r: Array, q: Array) -> tuple[Array, Array, Array, Array]:
    """Compute area, sum x, sum x^2, sum y^2 of the part x > u of a ring between the radii q < r."""
    a, b = np.clip(u, -r, r), np.clip(u, -q, q)
    h, g = np.sqrt((r - a) * (r + a)), np.sqrt((q - b) * (q + b))  # half chords
    ring = (r - q) * (r + q)
    is_ring = g > 0.0
    chord = np.where(is_ring, ring / np.where(is_ring, h + g, 1.0), h)  # h - g
    angle = np.arctan2(h, a)
    turn = np.arctan2(np.where(is_ring, a * chord, h * b), a * b + h * g)  # angle - arctan2(g, b)
    cubes = chord * (h * h + h * g + g * g)  # h^3 - g^3
    squares = a * (ring * h + q * q * chord)  # r^2 h a - q^2 g b
    quads = a * (a * a * chord - cubes)  # h a (a^2 - h^2) - g b (b^2 - g^2)
    turns = ring * (r * r + q * q) * angle + q**4 * turn  # r^4 angle - q^4 (its inner one)
    area = ring * angle + q * q * turn - a * chord
    return area, cubes * (2.0 / 3.0), 0.25 * (turns - quads), 0.25 * turns - squares / 3.0 + quads / 12.0


def positive_interval(constants: Array, slopes: Array) -> tuple[Array, Array]:
    """Return from where to where all lines constants + slopes x (k, j) are positive, (k,) each; if nowhere, to <
    from.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        roots = -constants / slopes
    empty = ((slopes == 0.0) & (constants < 0.0)).any(axis=-1)
    low = np.where(slopes > 0.0, roots, -np.inf).max(axis=-1)
    high = np.where(slopes < 0.0, roots, np.inf).min(axis=-1)
    return np.where(empty, 0.0, low), np.where(empty, -1.0, high)


@record
class LocalPlanes:
    """The planes in local axes: n = (s, 0, c), x along e, y along f, offsets d from the start (k,)."""

    s: float
    c: float
    e: Array
    f: Array
    d: Array


@record
class CutMidlines:
    """The middle lines of cuts through a round shape, from end to end.

    is_met: (k,) whether there is a cut
    leaves_both_ends: (k,) whether it leaves the shape through both end faces
    length: (k,) [m]
    x, z: (k, 2) at the two ends
    room: (2, k, 2) r - x and r + x at the two ends. All of them are linear in between, so that r - x has no rounding
    error where a cut is small.
    """

    is_met: Flags
    leaves_both_ends: Flags
    length: Array
    x: Array
    z: Array
    room: Array

    def evaluate(self, fractions: Array, line_numbers: Owners) -> tuple[Array, Array, Array]:
        """Return x, z and the half width of the cut at fractions (i, m), 0 to 1, of the lines of these numbers (i,)."""
        x, z, left, right = (
            a[line_numbers, :1] + fractions * np.diff(a[line_numbers], axis=-1) for a in (self.x, self.z, *self.room)
        )
        return x, z, np.sqrt(left * right)


@record
class Frustum(ThickSolid):
    """A ring-shaped body about an axis: outer and inner radii at its start and end (inner 0: solid), density
    [kg/m3].
    """

    start: Array
    axis: Array
    length: float
    outer: tuple[float, float]
    inner: tuple[float, float]
    density: float

    def radii(self, z: Array) -> tuple[Array, Array]:
        t = z / self.length
        (r0, r1), (q0, q1) = self.outer, self.inner
        return r0 + (r1 - r0) * t, q0 + (q1 - q0) * t

    def localize_planes(self, n: Array, d: Array) -> LocalPlanes:
        c = float(n @ self.axis)
        normal_part = np.cross(self.axis, n)
        s = float(np.sqrt(normal_part @ normal_part))
        f = normal_part / s if s > tolerances.OFF_AXIS else perpendicular_pair(self.axis)[1]
        f = f - (f @ self.axis) * self.axis  # with a small s the cross product is not quite perpendicular
        f = f / np.sqrt(f @ f)
        return LocalPlanes(s, c, np.cross(f, self.axis), f, d - n @ self.start)

    def pseudo_inertia_from_moments(self, planes: LocalPlanes, moments: Array) -> Array:
        """Compute the pseudo-inertia about the body's origin of local moments 1, z, z^2, x, z x, x^2, y^2, (k, 7)."""
        one, z, zz, x, zx, xx, yy = (self.density * moments).T
        zero = np.zeros_like(one)
        P = assemble_pseudo_inertia(
            one,
            np.stack([x, zero, z], axis=-1),
            np.stack([xx, zero, zx, zero, yy, zero, zx, zero, zz], axis=-1).reshape(-1, 3, 3),
        )
        G = np.eye(4)
        G[:3] = np.stack([planes.e, planes.f, self.axis, self.start], axis=-1)
        return np.asarray(G @ P @ G.T)

    def slice_moments(self, low: Array, high: Array) -> Array:
        """Compute the local moments (k, 7) of the full rings between two heights (k,), exactly."""
        t, w = gauss_rule(3)
        z = low[:, None] + (high - low)[:, None] * t
        w = np.pi * (high - low)[:, None] * w
        r, q = self.radii(z)
        ring = w * (r - q) * (r + q)
        diametral = 0.25 * ring * (r * r + q * q)
        zero = np.zeros_like(z)
        terms = [ring, ring * z, ring * z * z, zero, zero, diametral, diametral]
        return np.asarray(np.stack(terms, axis=-1).sum(axis=1))

    def whole_inertia(self) -> Array:
        planes = self.localize_planes(self.axis, np.zeros(1))
        return np.asarray(
            self.pseudo_inertia_from_moments(planes, self.slice_moments(np.zeros(1), np.full(1, self.length)))[0]
        )

    def piece_inertia(self, n: Array, d: Array, side: Array, tolerance: float) -> Array:
        planes = self.localize_planes(n, d)
        s, c, k = planes.s, planes.c, len(d)
        zero, full = np.zeros(k), np.full(k, self.length)
        if s <= tolerances.OFF_AXIS:
            height = np.clip(planes.d / c, 0.0, self.length)
            return self.pseudo_inertia_from_moments(
                planes, self.slice_moments(height, full) if c > 0.0 else self.slice_moments(zero, height)
            )

        def segment_moments(z: Array, owner: Owners) -> Array:
            r, q = self.radii(z)
            area, x, xx, yy = ring_segments((planes.d[owner, None] - c * z) / s, r, q)
            return np.stack([area, area * z, area * z * z, x, x * z, xx, yy], axis=-1)

        signs = np.array([1.0, -1.0])
        radii = np.array([self.outer, self.inner])
        slopes = c + s * np.outer(signs, (radii[:, 1] - radii[:, 0]) / self.length)
        with np.errstate(divide="ignore", invalid="ignore"):
            breaks = (planes.d[:, None, None] - s * np.outer(signs, radii[:, 0])) / slopes
        V, _, zz, _, _, xx, yy = self.slice_moments(zero[:1], full[:1])[0]
        R = max(self.outer)
        scale = np.array([V, V * self.length, zz, V * R, V * R * self.length, xx, yy])
        return self.pseudo_inertia_from_moments(
            planes, integrate_adaptively(segment_moments, zero, full, breaks.reshape(k, 4), scale)
        )

    def extent(self, n: Array) -> tuple[float, float]:
        planes = self.localize_planes(n, np.zeros(1))
        middle = n @ self.start + planes.c * np.array([0.0, self.length])
        reach = planes.s * np.array(self.outer)
        return float((middle - reach).min()), float((middle + reach).max())

    def corners(self, n: Array) -> Array:
        planes = self.localize_planes(n, np.zeros(1))
        middle = n @ self.start + planes.c * np.array([0.0, self.length])
        rims = planes.s * np.array([self.outer, self.inner])
        return np.concatenate([(middle - rims).ravel(), (middle + rims).ravel()])

    def midline_interval(self, planes: LocalPlanes, radii: tuple[float, float]) -> tuple[Array, Array, Flags]:
        """Return from where to where (k,) the cut's middle line, x = d s + c p, z = d c - s p, is within these radii
        and the ends.

        Also returns whether it leaves through both ends, (k,).
        """
        s, c, d = planes.s, planes.c, planes.d
        slope = (radii[1] - radii[0]) / self.length
        x, z = d * s, d * c
        radius = radii[0] + slope * z
        constants = np.stack([z, self.length - z, radius - x, radius + x], axis=-1)
        slopes = np.broadcast_to(np.array([-s, s, -slope * s - c, -slope * s + c]), constants.shape)
        low, high = positive_interval(constants, slopes)
        ends_low, ends_high = positive_interval(constants[:, :2], slopes[:, :2])
        return low, high, (low == ends_low) & (high == ends_high) & (high > low)

    def find_midlines(self, planes: LocalPlanes, radii: tuple[float, float]) -> CutMidlines:
        """Find the middle lines of the cuts through the full shape with these radii."""
        low, high, leaves_both_ends = self.midline_interval(planes, radii)
        is_met = high > low
        ends = np.where(is_met, [low, high], 0.0).T
        x, z = planes.d[:, None] * planes.s + planes.c * ends, planes.d[:, None] * planes.c - planes.s * ends
        r = radii[0] + (radii[1] - radii[0]) / self.length * z
        room = np.maximum(np.stack([r - x, r + x]), 0.0)
        return CutMidlines(is_met, leaves_both_ends & is_met, ends[:, 1] - ends[:, 0], x, z, room)

    def full_section_moments(self, planes: LocalPlanes, radii: tuple[float, float]) -> Array:
        """Compute the area of the cuts through the full shape with these radii, and its moments in x and z, (k, 3)."""
        midlines = self.find_midlines(planes, radii)

        def strip_moments(t: Array, owner: Owners) -> Array:
            x, z, half = midlines.evaluate(t, owner)
            return np.stack([half, half * x, half * z], axis=-1)

        k = len(planes.d)
        max_half_width = np.sqrt(midlines.room.max(axis=-1).prod(axis=0))
        scale = max_half_width[:, None] * np.array([1.0, max(radii), self.length])
        integrals = integrate_adaptively(strip_moments, np.zeros(k), np.ones(k), np.empty((k, 0)), scale)
        return 2.0 * midlines.length[:, None] * integrals

    def section_area(self, n: Array, d: Array) -> tuple[Array, Array]:
        planes = self.localize_planes(n, d)
        if planes.s <= tolerances.OFF_AXIS:
            z = planes.d / planes.c
            r, q = self.radii(z)
            areas = np.where((z > 0.0) & (z < self.length), np.pi * (r - q) * (r + q), 0.0)
            return areas, areas[:, None] * (self.start + z[:, None] * self.axis)
        section = self.full_section_moments(planes, self.outer)
        if max(self.inner) > 0.0:
            section = section - self.full_section_moments(planes, self.inner)
        areas, x, z = section.T
        return areas, np.outer(x, planes.e) + np.outer(z, self.axis) + np.outer(areas, self.start)

    def section_outlines(self, n: Array, d: Array) -> tuple[Outline, ...]:
        local_planes = self.localize_planes(n, d)
        if local_planes.s <= tolerances.OFF_AXIS:
            z = local_planes.d / local_planes.c
            r, q = self.radii(z)

            def rim(radii: Array) -> Corners:
                return lambda planes: circle_corners(n, self.start + z[planes, None] * self.axis, radii[planes])

            is_met = (z > 0.0) & (z < self.length)
            return (
                Outline(is_met, rim(r), rim(q), is_met & (q > 0.0))
                if max(self.inner) > 0.0
                else Outline(is_met, rim(r)),
            )
        outer, inner = self.find_midlines(local_planes, self.outer), self.find_midlines(local_planes, self.inner)

        def whole_outline(chord: CutMidlines) -> Corners:
            return lambda planes: np.concatenate(self.section_rims(local_planes, chord, planes), axis=1)

        def strip(side: int) -> Corners:
            def corners(planes: Planes) -> Array:
                far, near = (self.section_rims(local_planes, chord, planes)[side] for chord in (outer, inner))
                return np.concatenate([far, near[:, [-1, 0]]], axis=1)

            return corners

        if max(self.inner) == 0.0:
            return (Outline(outer.is_met, whole_outline(outer)),)
        hole, leaves_both_ends = whole_outline(inner), inner.leaves_both_ends
        ring = Outline(outer.is_met & ~leaves_both_ends, whole_outline(outer), hole, inner.is_met)
        return (ring, *(Outline(leaves_both_ends, strip(side), hole, leaves_both_ends) for side in (0, 1)))

    def section_rims(self, local_planes: LocalPlanes, midlines: CutMidlines, planes: Planes) -> tuple[Array, Array]:
        """Compute the outlines of cuts at some planes: one side of the middle line up, the other down, (c, SIDES/2, 3)
        each.
        """
        t = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, SIDES // 2))
        x, z, half = midlines.evaluate(np.broadcast_to(t, (len(planes), len(t))), planes)
        middle = self.start + x[..., None] * local_planes.e + z[..., None] * self.axis
        side = half[..., None] * local_planes.f
        return middle + side, (middle - side)[:, ::-1]
