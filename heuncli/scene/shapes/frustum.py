"""A cylinder, tube or cone cut by any plane.

Local axes at the start: z along the axis, x towards the part of the normal across it, n = (s, 0, c). At height z the
plane cuts the ring between the radii q(z) < r(z) along x = u(z) = (d - c z)/s; what is beyond is a difference of two
circular segments, whose moments have closed forms. Their integral over z is smooth between the heights where u = +-r or
+-q; there it starts like a power 3/2, which the quadrature removes. Differences of outer and inner circle are never
taken as such: all terms carry the factor r - q, so that thin walls lose nothing. Across the axis all is exact.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.results.results import Array
from heuncli.scene.shapes.inertia import assembled
from heuncli.scene.shapes.outlines import SIDES, Corners, Flags, Outline, Planes, circle
from heuncli.scene.shapes.quadrature import Owners, adaptive, gauss
from heuncli.scene.shapes.rotations import perpendicular
from heuncli.scene.shapes.solids import Thick


def segments(u: Array, r: Array, q: Array) -> tuple[Array, Array, Array, Array]:
    """Area, sum x, sum x^2, sum y^2 of the part x > u of a ring between the radii q < r."""
    a, b = np.clip(u, -r, r), np.clip(u, -q, q)
    h, g = np.sqrt((r - a) * (r + a)), np.sqrt((q - b) * (q + b))  # half chords
    ring = (r - q) * (r + q)
    both = g > 0.0
    chord = np.where(both, ring / np.where(both, h + g, 1.0), h)  # h - g
    angle = np.arctan2(h, a)
    turn = np.arctan2(np.where(both, a * chord, h * b), a * b + h * g)  # angle - arctan2(g, b)
    cubes = chord * (h * h + h * g + g * g)  # h^3 - g^3
    squares = a * (ring * h + q * q * chord)  # r^2 h a - q^2 g b
    quads = a * (a * a * chord - cubes)  # h a (a^2 - h^2) - g b (b^2 - g^2)
    turns = ring * (r * r + q * q) * angle + q**4 * turn  # r^4 angle - q^4 (its inner one)
    area = ring * angle + q * q * turn - a * chord
    return area, cubes * (2.0 / 3.0), 0.25 * (turns - quads), 0.25 * turns - squares / 3.0 + quads / 12.0


def bounds(constants: Array, slopes: Array) -> tuple[Array, Array]:
    """From where to where all lines constants + slopes x (k, j) are positive, (k,) each; where nowhere, to < from."""
    with np.errstate(divide="ignore", invalid="ignore"):
        roots = -constants / slopes
    empty = ((slopes == 0.0) & (constants < 0.0)).any(axis=-1)
    low = np.where(slopes > 0.0, roots, -np.inf).max(axis=-1)
    high = np.where(slopes < 0.0, roots, np.inf).min(axis=-1)
    return np.where(empty, 0.0, low), np.where(empty, -1.0, high)


@record
class Lines:
    """The planes in local axes: n = (s, 0, c), x along e, y along f, offsets from the start (k,)."""

    s: float
    c: float
    e: Array
    f: Array
    d: Array


@record
class Chord:
    """The middle lines of cuts through a round shape, end to end: x, z (k, 2) and the room r - x, r + x (2, k, 2).

    All of them are linear in between, and so free of the rounding of r - x where a cut is small. met: whether there is
    a cut, through: whether it leaves the shape through both ends, length [m], (k,) each.
    """

    met: Flags
    through: Flags
    length: Array
    x: Array
    z: Array
    room: Array

    def at(self, t: Array, owner: Owners) -> tuple[Array, Array, Array]:
        """x, z and the half width of the cut at parts t (i, m), 0 to 1, of the lines of these owners (i,)."""
        x, z, left, right = (a[owner, :1] + t * np.diff(a[owner], axis=-1) for a in (self.x, self.z, *self.room))
        return x, z, np.sqrt(left * right)


@record
class Frustum(Thick):
    """A ring-shaped body about an axis: radii at its start and end, outer and inner (0: full), density [kg/m3]."""

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

    def lines(self, n: Array, d: Array) -> Lines:
        c = float(n @ self.axis)
        across = np.cross(self.axis, n)
        s = float(np.sqrt(across @ across))
        f = across / s if s > tolerances.OFF_AXIS else perpendicular(self.axis)[1]
        f = f - (f @ self.axis) * self.axis  # a small s has left little of the product's right angle
        f = f / np.sqrt(f @ f)
        return Lines(s, c, np.cross(f, self.axis), f, d - n @ self.start)

    def placed(self, line: Lines, moments: Array) -> Array:
        """Pseudo-inertia about the body's origin of local moments 1, z, z^2, x, z x, x^2, y^2, (k, 7)."""
        one, z, zz, x, zx, xx, yy = (self.density * moments).T
        none = np.zeros_like(one)
        P = assembled(
            one,
            np.stack([x, none, z], axis=-1),
            np.stack([xx, none, zx, none, yy, none, zx, none, zz], axis=-1).reshape(-1, 3, 3),
        )
        G = np.eye(4)
        G[:3] = np.stack([line.e, line.f, self.axis, self.start], axis=-1)
        return np.asarray(G @ P @ G.T)

    def slices(self, low: Array, high: Array) -> Array:
        """Local moments (k, 7) of the full rings between two heights (k,); exact."""
        t, w = gauss(3)
        z = low[:, None] + (high - low)[:, None] * t
        w = np.pi * (high - low)[:, None] * w
        r, q = self.radii(z)
        ring = w * (r - q) * (r + q)
        round_ = 0.25 * ring * (r * r + q * q)
        none = np.zeros_like(z)
        terms = [ring, ring * z, ring * z * z, none, none, round_, round_]
        return np.asarray(np.stack(terms, axis=-1).sum(axis=1))

    def whole(self) -> Array:
        line = self.lines(self.axis, np.zeros(1))
        return np.asarray(self.placed(line, self.slices(np.zeros(1), np.full(1, self.length)))[0])

    def beyond(self, n: Array, d: Array, side: Array, near: float) -> Array:
        line = self.lines(n, d)
        s, c, k = line.s, line.c, len(d)
        none, full = np.zeros(k), np.full(k, self.length)
        if s <= tolerances.OFF_AXIS:
            at = np.clip(line.d / c, 0.0, self.length)
            return self.placed(line, self.slices(at, full) if c > 0.0 else self.slices(none, at))

        def moments(z: Array, owner: Owners) -> Array:
            r, q = self.radii(z)
            area, x, xx, yy = segments((line.d[owner, None] - c * z) / s, r, q)
            return np.stack([area, area * z, area * z * z, x, x * z, xx, yy], axis=-1)

        signs = np.array([1.0, -1.0])
        radii = np.array([self.outer, self.inner])
        slopes = c + s * np.outer(signs, (radii[:, 1] - radii[:, 0]) / self.length)
        with np.errstate(divide="ignore", invalid="ignore"):
            breaks = (line.d[:, None, None] - s * np.outer(signs, radii[:, 0])) / slopes
        V, _, zz, _, _, xx, yy = self.slices(none[:1], full[:1])[0]
        R = max(self.outer)
        scale = np.array([V, V * self.length, zz, V * R, V * R * self.length, xx, yy])
        return self.placed(line, adaptive(moments, none, full, breaks.reshape(k, 4), scale))

    def extent(self, n: Array) -> tuple[float, float]:
        line = self.lines(n, np.zeros(1))
        middle = n @ self.start + line.c * np.array([0.0, self.length])
        reach = line.s * np.array(self.outer)
        return float((middle - reach).min()), float((middle + reach).max())

    def corners(self, n: Array) -> Array:
        line = self.lines(n, np.zeros(1))
        middle = n @ self.start + line.c * np.array([0.0, self.length])
        rims = line.s * np.array([self.outer, self.inner])
        return np.concatenate([(middle - rims).ravel(), (middle + rims).ravel()])

    def along(self, line: Lines, radii: tuple[float, float]) -> tuple[Array, Array, Flags]:
        """From where to where (k,) the cut's middle line, x = d s + c p, z = d c - s p, is within these radii and ends.

        Also whether it leaves through both ends, (k,).
        """
        s, c, d = line.s, line.c, line.d
        slope = (radii[1] - radii[0]) / self.length
        x, z = d * s, d * c
        wide = radii[0] + slope * z
        constants = np.stack([z, self.length - z, wide - x, wide + x], axis=-1)
        slopes = np.broadcast_to(np.array([-s, s, -slope * s - c, -slope * s + c]), constants.shape)
        low, high = bounds(constants, slopes)
        ends_low, ends_high = bounds(constants[:, :2], slopes[:, :2])
        return low, high, (low == ends_low) & (high == ends_high) & (high > low)

    def chord(self, line: Lines, radii: tuple[float, float]) -> Chord:
        """The middle line of the cuts through the full shape with these radii."""
        low, high, through = self.along(line, radii)
        met = high > low
        ends = np.where(met, [low, high], 0.0).T
        x, z = line.d[:, None] * line.s + line.c * ends, line.d[:, None] * line.c - line.s * ends
        r = radii[0] + (radii[1] - radii[0]) / self.length * z
        room = np.maximum(np.stack([r - x, r + x]), 0.0)
        return Chord(met, through & met, ends[:, 1] - ends[:, 0], x, z, room)

    def conic(self, line: Lines, radii: tuple[float, float]) -> Array:
        """Area of the cuts through the full shape with these radii, and the area's moments in x and z, (k, 3)."""
        chord = self.chord(line, radii)

        def moments(t: Array, owner: Owners) -> Array:
            x, z, half = chord.at(t, owner)
            return np.stack([half, half * x, half * z], axis=-1)

        k = len(line.d)
        widest = np.sqrt(chord.room.max(axis=-1).prod(axis=0))
        scale = widest[:, None] * np.array([1.0, max(radii), self.length])
        integrals = adaptive(moments, np.zeros(k), np.ones(k), np.empty((k, 0)), scale)
        return 2.0 * chord.length[:, None] * integrals

    def area(self, n: Array, d: Array) -> tuple[Array, Array]:
        line = self.lines(n, d)
        if line.s <= tolerances.OFF_AXIS:
            z = line.d / line.c
            r, q = self.radii(z)
            areas = np.where((z > 0.0) & (z < self.length), np.pi * (r - q) * (r + q), 0.0)
            return areas, areas[:, None] * (self.start + z[:, None] * self.axis)
        section = self.conic(line, self.outer)
        if max(self.inner) > 0.0:
            section = section - self.conic(line, self.inner)
        areas, x, z = section.T
        return areas, np.outer(x, line.e) + np.outer(z, self.axis) + np.outer(areas, self.start)

    def outlines(self, n: Array, d: Array) -> tuple[Outline, ...]:
        line = self.lines(n, d)
        if line.s <= tolerances.OFF_AXIS:
            z = line.d / line.c
            r, q = self.radii(z)

            def rim(radii: Array) -> Corners:
                return lambda planes: circle(n, self.start + z[planes, None] * self.axis, radii[planes])

            met = (z > 0.0) & (z < self.length)
            return (Outline(met, rim(r), rim(q), met & (q > 0.0)) if max(self.inner) > 0.0 else Outline(met, rim(r)),)
        outer, inner = self.chord(line, self.outer), self.chord(line, self.inner)

        def around(chord: Chord) -> Corners:
            return lambda planes: np.concatenate(self.rims(line, chord, planes), axis=1)

        def strip(side: int) -> Corners:
            def corners(planes: Planes) -> Array:
                far, near = (self.rims(line, chord, planes)[side] for chord in (outer, inner))
                return np.concatenate([far, near[:, [-1, 0]]], axis=1)

            return corners

        if max(self.inner) == 0.0:
            return (Outline(outer.met, around(outer)),)
        hole, through = around(inner), inner.through
        ring = Outline(outer.met & ~through, around(outer), hole, inner.met)
        return (ring, *(Outline(through, strip(side), hole, through) for side in (0, 1)))

    def rims(self, line: Lines, chord: Chord, planes: Planes) -> tuple[Array, Array]:
        """The cuts' outlines at some planes: one side of the middle line up, the other down, (c, SIDES/2, 3) each."""
        t = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, SIDES // 2))
        x, z, half = chord.at(np.broadcast_to(t, (len(planes), len(t))), planes)
        middle = self.start + x[..., None] * line.e + z[..., None] * self.axis
        side = half[..., None] * line.f
        return middle + side, (middle - side)[:, ::-1]
