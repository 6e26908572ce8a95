"""The protocol of solids cut by parallel planes, and the simplest of them: point, rod, ball.

    n (3,)   unit normal, body axes        d (k,)   offsets: the planes n.x = d        piece: the part with n.x > d

A point or a rod can lie in a plane; `side` (k,) then decides: +1 the plane is just before it (it belongs to the piece),
-1 just behind it (it does not), 0: half of it does.

Functions that are smooth between known breaks are integrated by Gauss-Legendre on each interval, halved if needed; they
handle many integrals at once, one for each of k cuts.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from heuncli.base import tolerances
from heuncli.base.errors import Finding
from heuncli.base.records import record
from heuncli.results.results import Array
from heuncli.scene.shapes.inertia import assemble_pseudo_inertia
from heuncli.scene.shapes.outlines import Outline, circle_corners

# Solids


class Solid(Protocol):
    """A homogeneous shape in body axes."""

    @property
    def tolerance(self) -> float:
        """The distance from a plane at which corners still count as lying in it [m]."""

    def whole_inertia(self) -> Array:
        """Return the pseudo-inertia about the body's origin, (4, 4)."""

    def piece_inertia(self, n: Array, d: Array, side: Array, tolerance: float) -> Array:
        """Return the pseudo-inertia of the pieces, (k, 4, 4). A thin shape lies in a plane within `tolerance` [m] of
        it.
        """

    def extent(self, n: Array) -> tuple[float, float]:
        """Return the least and largest n.x."""

    def corners(self, n: Array) -> Array:
        """Return where along n the cross-sections change their form; between these, all is smooth in n.x."""

    def section_area(self, n: Array, d: Array) -> tuple[Array, Array]:
        """Return the area of the cross-sections (k,) [m2] and area times centroid (k, 3) [m3]."""

    def section_outlines(self, n: Array, d: Array) -> tuple[Outline, ...]:
        """Return the outlines in which the planes meet the shape."""

    def lies_in(self, n: Array, d: Array, tolerance: float) -> NDArray[np.bool_]:
        """Return whether a shape without thickness lies in the plane, (k,)."""


class ExactSolid:
    """Base of the shapes given by their dimensions, whose corners need no tolerance."""

    tolerance = 0.0


class ThickSolid(ExactSolid):
    """Base of the shapes with a volume, which never lie in a plane."""

    def lies_in(self, n: Array, d: Array, tolerance: float) -> NDArray[np.bool_]:
        return np.zeros(len(d), dtype=bool)


def end_corners(solid: Solid, n: Array) -> Array:
    """Return the two ends of a shape whose cross-sections are smooth between them."""
    return np.array(solid.extent(n))


@record
class PointMass(ExactSolid):
    """A point mass [kg] at a place [m]."""

    place: Array
    mass: float

    def whole_inertia(self) -> Array:
        x = np.append(self.place, 1.0)
        return self.mass * np.outer(x, x)

    def piece_inertia(self, n: Array, d: Array, side: Array, tolerance: float) -> Array:
        share = np.where(self.lies_in(n, d, tolerance), 0.5 * (1.0 + side), (n @ self.place > d).astype(float))
        return share[:, None, None] * self.whole_inertia()

    def extent(self, n: Array) -> tuple[float, float]:
        h = float(n @ self.place)
        return h, h

    def corners(self, n: Array) -> Array:
        return end_corners(self, n)

    def section_area(self, n: Array, d: Array) -> tuple[Array, Array]:
        return np.zeros(len(d)), np.zeros((len(d), 3))

    def section_outlines(self, n: Array, d: Array) -> tuple[Outline, ...]:
        return ()

    def lies_in(self, n: Array, d: Array, tolerance: float) -> NDArray[np.bool_]:
        return np.abs(n @ self.place - d) <= tolerance


@record
class Rod(ExactSolid):
    """A uniform straight rod without thickness between two points, line density [kg/m]."""

    start: Array
    end: Array
    line_density: float

    def part_inertia(self, p: Array, q: Array) -> Array:
        """Compute the pseudo-inertia of the rod between fractions p and q of its length, (k,) each; (k, 4, 4)."""
        vector = self.end - self.start
        mass = self.line_density * float(np.sqrt(vector @ vector)) * (q - p)
        middle = self.start + 0.5 * (p + q)[:, None] * vector
        second = middle[:, :, None] * middle[:, None, :] + ((q - p) ** 2 / 12.0)[:, None, None] * np.outer(
            vector, vector
        )
        return assemble_pseudo_inertia(mass, mass[:, None] * middle, mass[:, None, None] * second)

    def whole_inertia(self) -> Array:
        return np.asarray(self.part_inertia(np.zeros(1), np.ones(1))[0])

    def interval_above(self, n: Array, d: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
        """Return from where to where the rod is above the planes, 0 to 1 along it, and whether they cut it, (k,)."""
        start, end = n @ self.start - d, n @ self.end - d
        is_cut = (start > 0.0) != (end > 0.0)
        fraction = np.where(is_cut, start, 0.0) / np.where(is_cut, start - end, 1.0)
        first = np.where(start > 0.0, 0.0, fraction)
        last = np.where(start > 0.0, np.where(is_cut, fraction, 1.0), is_cut.astype(float))
        return first, last, is_cut

    def piece_inertia(self, n: Array, d: Array, side: Array, tolerance: float) -> Array:
        first, last, _ = self.interval_above(n, d)
        shared = (0.5 * (1.0 + side))[:, None, None] * self.whole_inertia()
        return np.where(self.lies_in(n, d, tolerance)[:, None, None], shared, self.part_inertia(first, last))

    def extent(self, n: Array) -> tuple[float, float]:
        a, b = float(n @ self.start), float(n @ self.end)
        return min(a, b), max(a, b)

    def corners(self, n: Array) -> Array:
        return end_corners(self, n)

    def section_area(self, n: Array, d: Array) -> tuple[Array, Array]:
        return np.zeros(len(d)), np.zeros((len(d), 3))

    def section_outlines(self, n: Array, d: Array) -> tuple[Outline, ...]:
        first, last, cut = self.interval_above(n, d)
        fraction = np.where(first > 0.0, first, last)[:, None, None]
        return (Outline(cut, lambda planes: self.start + fraction[planes] * (self.end - self.start)),)

    def lies_in(self, n: Array, d: Array, tolerance: float) -> NDArray[np.bool_]:
        return (np.abs(n @ self.start - d) <= tolerance) & (np.abs(n @ self.end - d) <= tolerance)


@record
class Ball(ThickSolid):
    """A full sphere, density [kg/m3]. Its pieces are caps of height t = R - (d - n.c), polynomials in t."""

    center: Array
    radius: float
    density: float

    def cap_inertia(self, n: Array, t: Array) -> Array:
        """Compute the pseudo-inertia of the caps of height t, 0 to 2R, about the body's origin, (k, 4, 4)."""
        R, c = self.radius, self.center
        scale = np.pi * self.density
        mass = scale * t * t * (R - t / 3.0)
        axial_first = scale * 0.25 * (t * (2.0 * R - t)) ** 2  # sum m z, z along n from the centre
        axial_second = scale * t * t * (R**3 - t * (5.0 * R * R / 3.0 - t * (R - t / 5.0)))  # sum m z^2
        transverse_second = scale * 0.25 * t**3 * (4.0 * R * R / 3.0 - t * (R - t / 5.0))  # sum m x^2
        normal = np.outer(n, n)
        first = axial_first[:, None] * n
        second = transverse_second[:, None, None] * (np.eye(3) - normal) + axial_second[:, None, None] * normal
        shift = first[:, :, None] * c
        second = second + shift + shift.transpose(0, 2, 1) + mass[:, None, None] * np.outer(c, c)
        return assemble_pseudo_inertia(mass, first + mass[:, None] * c, second)

    def whole_inertia(self) -> Array:
        return np.asarray(self.cap_inertia(np.array([0.0, 0.0, 1.0]), np.array([2.0 * self.radius]))[0])

    def piece_inertia(self, n: Array, d: Array, side: Array, tolerance: float) -> Array:
        return self.cap_inertia(n, np.clip(self.radius - (d - n @ self.center), 0.0, 2.0 * self.radius))

    def extent(self, n: Array) -> tuple[float, float]:
        h = float(n @ self.center)
        return h - self.radius, h + self.radius

    def section_circle(self, n: Array, d: Array) -> tuple[Array, Array]:
        """Return the centres (k, 3) and squared radii (k,), 0 where the plane misses the ball."""
        h = d - n @ self.center
        return self.center + h[:, None] * n, np.maximum((self.radius - h) * (self.radius + h), 0.0)

    def corners(self, n: Array) -> Array:
        return end_corners(self, n)

    def section_area(self, n: Array, d: Array) -> tuple[Array, Array]:
        centers, squares = self.section_circle(n, d)
        areas = np.pi * squares
        return areas, areas[:, None] * centers

    def section_outlines(self, n: Array, d: Array) -> tuple[Outline, ...]:
        centers, squares = self.section_circle(n, d)
        return (Outline(squares > 0.0, lambda planes: circle_corners(n, centers[planes], np.sqrt(squares[planes]))),)


# Quadrature

Owners = NDArray[np.intp]

# Nodes and weights on [-1, 1]; numpy.polynomial takes 4 ms to import, and whole bodies never need more than these.
SMALL_RULES = {
    2: ([-(3.0**-0.5), 3.0**-0.5], [1.0, 1.0]),
    3: ([-(0.6**0.5), 0.0, 0.6**0.5], [5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0]),
}
NODE_COUNT = 16
MAX_DEPTH = 48
MAX_OPEN_HALVES = (
    1000  # undecided halves of an integral at once: square roots need dozens, rounding errors endless ones
)


@cache
def gauss_rule(n: int) -> tuple[Array, Array]:
    """Return nodes and weights on [0, 1], (n,) each; exact up to degree 2n - 1."""
    x, w = (np.array(part) for part in SMALL_RULES[n]) if n in SMALL_RULES else np.polynomial.legendre.leggauss(n)
    return 0.5 * (1.0 + x), 0.5 * w


def split_at_breaks(low: Array, high: Array, breaks: Array) -> tuple[Array, Array]:
    """Return starts and lengths (..., m + 1) of the intervals into which breaks (..., m) divide [low, high]; 0
    outside.
    """
    inside = np.clip(np.nan_to_num(breaks, nan=0.0), low[..., None], high[..., None])
    edges = np.sort(np.concatenate([low[..., None], inside, high[..., None]], axis=-1), axis=-1)
    return edges[..., :-1], np.diff(edges, axis=-1)


def piecewise_rule(low: Array, high: Array, breaks: Array, n: int) -> tuple[Array, Array]:
    """Return nodes and weights (..., (m + 1) n) for integrands that are of degree 2n - 1 between the breaks."""
    starts, lengths = split_at_breaks(low, high, breaks)
    x, w = gauss_rule(n)
    nodes = starts[..., None] + lengths[..., None] * x
    weights = lengths[..., None] * w
    return nodes.reshape(*low.shape, -1), weights.reshape(*low.shape, -1)


def integrate_adaptively(
    f: Callable[[Array, Owners], Array], low: Array, high: Array, breaks: Array, scale: Array
) -> Array:
    """Integrate m functions from low to high, (k,), to about QUADRATURE times scale, (k, m) or (m,). Returns (k, m).

    f(z, owner) takes z (i, n) and the numbers of their integrals (i,), and returns (i, n, m). At the breaks (k, j) f
    may have square roots: z = start + length sin^2(psi/2) makes them smooth in psi, in which intervals are halved until
    two halves agree with their whole. Raises Finding [thin-shape] if rounding prevents that.
    """
    x, w = gauss_rule(NODE_COUNT)

    def integral_over(interval: Array, owner: Owners) -> Array:
        start, length, p, q = (interval[:, i, None] for i in range(4))
        psi = p + (q - p) * x
        s = np.sin(0.5 * psi)
        weight = (q - p) * w * 0.5 * length * np.sin(psi)
        values: Array = np.einsum("in,inm->im", weight, f(start + length * s * s, owner))
        return values

    starts, lengths = split_at_breaks(low, high, breaks)
    owner, slot = np.nonzero(lengths > 0.0)
    interval = np.stack(
        [starts[owner, slot], lengths[owner, slot], np.zeros(len(owner)), np.full(len(owner), np.pi)], axis=-1
    )
    whole = integral_over(interval, owner)
    total = np.zeros((len(low), whole.shape[-1]))
    limit = tolerances.QUADRATURE * np.broadcast_to(scale, total.shape)
    for depth in range(MAX_DEPTH):
        if not len(owner):
            break
        halves, owners = np.repeat(interval, 2, axis=0), np.repeat(owner, 2)
        halves[0::2, 3] = halves[1::2, 2] = 0.5 * (interval[:, 2] + interval[:, 3])
        parts = integral_over(halves, owners)
        sum_of_halves = parts[0::2] + parts[1::2]
        done = np.all(np.abs(sum_of_halves - whole) <= limit[owner], axis=-1) | (depth == MAX_DEPTH - 1)
        np.add.at(total, owner[done], sum_of_halves[done])
        is_open = np.repeat(~done, 2)
        if is_open.sum() > MAX_OPEN_HALVES * len(low):
            message = "a shape is so thin relative to its size that rounding errors determine the cut"
            raise Finding("thin-shape", message, "give its real thickness, or remove it from the body that is cut")
        interval, owner, whole = halves[is_open], owners[is_open], parts[is_open]
    return total
