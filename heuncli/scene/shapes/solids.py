"""The protocol of solids cut by parallel planes, and the simplest of them: point, rod, ball.

    n (3,)   unit normal, body axes        d (k,)   offsets: the planes n.x = d        piece: the part with n.x > d

A point or a rod can lie in a plane; `side` (k,) then decides: +1 the plane is just before it (it belongs to the piece),
-1 just beyond it (it does not), 0: half of it does.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from heuncli.base.records import record
from heuncli.results.results import Array
from heuncli.scene.shapes.inertia import assembled
from heuncli.scene.shapes.outlines import Outline, circle


class Solid(Protocol):
    """A homogeneous shape in body axes."""

    @property
    def near(self) -> float:
        """How far off a plane its corners may be that are meant to lie in it [m]."""

    def whole(self) -> Array:
        """Pseudo-inertia about the body's origin, (4, 4)."""

    def beyond(self, n: Array, d: Array, side: Array, near: float) -> Array:
        """Pseudo-inertia of the pieces, (k, 4, 4); what is thin lies in a plane within `near` [m] of it."""

    def extent(self, n: Array) -> tuple[float, float]:
        """Least and largest n.x."""

    def corners(self, n: Array) -> Array:
        """Where along n the cross-sections change their form: between these all is smooth in n.x."""

    def area(self, n: Array, d: Array) -> tuple[Array, Array]:
        """Area of the cross-sections (k,) [m2] and area times centroid (k, 3) [m3]."""

    def outlines(self, n: Array, d: Array) -> tuple[Outline, ...]:
        """Where the planes meet the shape."""

    def lies_in(self, n: Array, d: Array, near: float) -> NDArray[np.bool_]:
        """Whether something without thickness lies in the plane, (k,)."""


class Exact:
    """What all shapes have in common that are given by their measures."""

    near = 0.0


class Thick(Exact):
    """What all shapes with a volume have in common."""

    def lies_in(self, n: Array, d: Array, near: float) -> NDArray[np.bool_]:
        return np.zeros(len(d), dtype=bool)


def ends(solid: Solid, n: Array) -> Array:
    """The corners of what is smooth from one end to the other."""
    return np.array(solid.extent(n))


@record
class PointMass(Exact):
    """A point mass [kg]."""

    at: Array
    mass: float

    def whole(self) -> Array:
        x = np.append(self.at, 1.0)
        return self.mass * np.outer(x, x)

    def beyond(self, n: Array, d: Array, side: Array, near: float) -> Array:
        share = np.where(self.lies_in(n, d, near), 0.5 * (1.0 + side), (n @ self.at > d).astype(float))
        return share[:, None, None] * self.whole()

    def extent(self, n: Array) -> tuple[float, float]:
        h = float(n @ self.at)
        return h, h

    def corners(self, n: Array) -> Array:
        return ends(self, n)

    def area(self, n: Array, d: Array) -> tuple[Array, Array]:
        return np.zeros(len(d)), np.zeros((len(d), 3))

    def outlines(self, n: Array, d: Array) -> tuple[Outline, ...]:
        return ()

    def lies_in(self, n: Array, d: Array, near: float) -> NDArray[np.bool_]:
        return np.abs(n @ self.at - d) <= near


@record
class Rod(Exact):
    """A uniform straight rod without thickness between two points, line density [kg/m]."""

    start: Array
    end: Array
    line_density: float

    def part(self, p: Array, q: Array) -> Array:
        """Pseudo-inertia of the rod from its parts p to q, 0 to 1, (k,) each, (k, 4, 4)."""
        run = self.end - self.start
        mass = self.line_density * float(np.sqrt(run @ run)) * (q - p)
        middle = self.start + 0.5 * (p + q)[:, None] * run
        second = middle[:, :, None] * middle[:, None, :] + ((q - p) ** 2 / 12.0)[:, None, None] * np.outer(run, run)
        return assembled(mass, mass[:, None] * middle, mass[:, None, None] * second)

    def whole(self) -> Array:
        return np.asarray(self.part(np.zeros(1), np.ones(1))[0])

    def above(self, n: Array, d: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
        """From where to where the rod is above the planes, 0 to 1 along it, and whether they cut it, (k,)."""
        start, end = n @ self.start - d, n @ self.end - d
        cut = (start > 0.0) != (end > 0.0)
        at = np.where(cut, start, 0.0) / np.where(cut, start - end, 1.0)
        first = np.where(start > 0.0, 0.0, at)
        last = np.where(start > 0.0, np.where(cut, at, 1.0), cut.astype(float))
        return first, last, cut

    def beyond(self, n: Array, d: Array, side: Array, near: float) -> Array:
        first, last, _ = self.above(n, d)
        shared = (0.5 * (1.0 + side))[:, None, None] * self.whole()
        return np.where(self.lies_in(n, d, near)[:, None, None], shared, self.part(first, last))

    def extent(self, n: Array) -> tuple[float, float]:
        a, b = float(n @ self.start), float(n @ self.end)
        return min(a, b), max(a, b)

    def corners(self, n: Array) -> Array:
        return ends(self, n)

    def area(self, n: Array, d: Array) -> tuple[Array, Array]:
        return np.zeros(len(d)), np.zeros((len(d), 3))

    def outlines(self, n: Array, d: Array) -> tuple[Outline, ...]:
        first, last, cut = self.above(n, d)
        at = np.where(first > 0.0, first, last)[:, None, None]
        return (Outline(cut, lambda planes: self.start + at[planes] * (self.end - self.start)),)

    def lies_in(self, n: Array, d: Array, near: float) -> NDArray[np.bool_]:
        return (np.abs(n @ self.start - d) <= near) & (np.abs(n @ self.end - d) <= near)


@record
class Ball(Thick):
    """A full sphere, density [kg/m3]. Its pieces are caps of height t = R - (d - n.c), polynomials in t."""

    center: Array
    radius: float
    density: float

    def caps(self, n: Array, t: Array) -> Array:
        """Pseudo-inertia of the caps of height t, 0 to 2R, about the body's origin, (k, 4, 4)."""
        R, c = self.radius, self.center
        scale = np.pi * self.density
        mass = scale * t * t * (R - t / 3.0)
        along = scale * 0.25 * (t * (2.0 * R - t)) ** 2  # sum m z, z along n from the centre
        square = scale * t * t * (R**3 - t * (5.0 * R * R / 3.0 - t * (R - t / 5.0)))  # sum m z^2
        across = scale * 0.25 * t**3 * (4.0 * R * R / 3.0 - t * (R - t / 5.0))  # sum m x^2
        normal = np.outer(n, n)
        first = along[:, None] * n
        second = across[:, None, None] * (np.eye(3) - normal) + square[:, None, None] * normal
        shift = first[:, :, None] * c
        second = second + shift + shift.transpose(0, 2, 1) + mass[:, None, None] * np.outer(c, c)
        return assembled(mass, first + mass[:, None] * c, second)

    def whole(self) -> Array:
        return np.asarray(self.caps(np.array([0.0, 0.0, 1.0]), np.array([2.0 * self.radius]))[0])

    def beyond(self, n: Array, d: Array, side: Array, near: float) -> Array:
        return self.caps(n, np.clip(self.radius - (d - n @ self.center), 0.0, 2.0 * self.radius))

    def extent(self, n: Array) -> tuple[float, float]:
        h = float(n @ self.center)
        return h - self.radius, h + self.radius

    def circle(self, n: Array, d: Array) -> tuple[Array, Array]:
        """Centres (k, 3) and squared radii (k,), 0 where the plane misses the ball."""
        h = d - n @ self.center
        return self.center + h[:, None] * n, np.maximum((self.radius - h) * (self.radius + h), 0.0)

    def corners(self, n: Array) -> Array:
        return ends(self, n)

    def area(self, n: Array, d: Array) -> tuple[Array, Array]:
        centers, squares = self.circle(n, d)
        areas = np.pi * squares
        return areas, areas[:, None] * centers

    def outlines(self, n: Array, d: Array) -> tuple[Outline, ...]:
        centers, squares = self.circle(n, d)
        return (Outline(squares > 0.0, lambda planes: circle(n, centers[planes], np.sqrt(squares[planes]))),)
