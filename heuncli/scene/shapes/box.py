"""A box cut by any plane, exactly.

With the box's axis nearest to the normal as x3, the piece is x3 > g(x1, x2), g linear and clipped to the box. Its
moments are integrals over x1 and x2 of polynomials between the lines where g meets an edge of the box, so
Gauss-Legendre from line to line gives them to rounding, for many planes at once and at any angle, also 1e-9 off.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.records import record
from heuncli.results.results import Array
from heuncli.scene.shapes.inertia import assembled
from heuncli.scene.shapes.outlines import Outline, Planes, polygon
from heuncli.scene.shapes.quadrature import piecewise
from heuncli.scene.shapes.solids import Thick

CORNERS = np.array([[i, j, k] for i in (-1.0, 1.0) for j in (-1.0, 1.0) for k in (-1.0, 1.0)])
EDGES = np.array([(a, b) for a in range(8) for b in range(a + 1, 8) if np.abs(CORNERS[a] - CORNERS[b]).sum() == 2.0])


@record
class BoxColumns:
    """The box in columns along x3: where in x1 and x2, how much of the base, and the height g of the plane, (k, m)."""

    order: tuple[int, int, int]
    sign: float
    x1: Array
    x2: Array
    g: Array
    base: Array


@record
class Box(Thick):
    """A box: centre, half sizes along its own axes (the columns of `axes`), density [kg/m3]."""

    center: Array
    half: Array
    axes: Array
    density: float

    def columns(self, n: Array, d: Array) -> BoxColumns:
        local = self.axes.T @ n
        i3 = int(np.argmax(np.abs(local)))
        order = ((i3 + 1) % 3, (i3 + 2) % 3, i3)
        n1, n2 = float(local[order[0]]), float(local[order[1]])
        sign, n3 = float(np.sign(local[i3])), abs(float(local[i3]))
        a, b, c = (float(self.half[i]) for i in order)
        h = d - n @ self.center
        with np.errstate(divide="ignore", invalid="ignore"):
            corners = np.array([-n2 * b - n3 * c, n2 * b - n3 * c, -n2 * b + n3 * c, n2 * b + n3 * c])
            x1, w1 = piecewise(np.full(len(d), -a), np.full(len(d), a), (h[:, None] + corners) / n1, 3)
            rest = h[:, None] - n1 * x1
            edges = (rest[..., None] + np.array([-n3 * c, n3 * c])) / n2
            x2, w2 = piecewise(np.full(x1.shape, -b), np.full(x1.shape, b), edges, 2)
        g = (rest[..., None] - n2 * x2) / n3
        grid = np.broadcast_to(x1[..., None], x2.shape), x2, g, w1[..., None] * w2
        return BoxColumns(order, sign, *(part.reshape(len(d), -1) for part in grid))

    def placed(self, mass: Array, first: Array, second: Array) -> Array:
        """Pseudo-inertia about the body's origin from moments about the box's centre, in the box's axes."""
        Q, c = self.axes, self.center
        first = first @ Q.T
        shift = first[:, :, None] * c
        second = Q @ second @ Q.T + shift + shift.transpose(0, 2, 1) + mass[:, None, None] * np.outer(c, c)
        return assembled(self.density * mass, self.density * (first + mass[:, None] * c), self.density * second)

    def whole(self) -> Array:
        mass = np.array([8.0 * np.prod(self.half)])
        P = self.placed(mass, np.zeros((1, 3)), mass[:, None, None] * np.diag(self.half**2 / 3.0))
        return np.asarray(P[0])

    def beyond(self, n: Array, d: Array, side: Array, near: float) -> Array:
        at = self.columns(n, d)
        c = float(self.half[at.order[2]])
        g = np.clip(at.g, -c, c)
        up = at.base * (c - g)
        z1 = at.sign * up * 0.5 * (c + g)
        z2 = up * (c * c + c * g + g * g) / 3.0
        first, second = np.empty((len(d), 3)), np.empty((len(d), 3, 3))
        i, j, k = at.order
        for axis, moment in ((i, up * at.x1), (j, up * at.x2), (k, z1)):
            first[:, axis] = moment.sum(axis=-1)
        for p, q, moment in (
            (i, i, up * at.x1 * at.x1), (j, j, up * at.x2 * at.x2), (k, k, z2),
            (i, j, up * at.x1 * at.x2), (j, k, z1 * at.x2), (k, i, z1 * at.x1),
        ):  # fmt: skip
            second[:, p, q] = second[:, q, p] = moment.sum(axis=-1)
        return self.placed(up.sum(axis=-1), first, second)

    def extent(self, n: Array) -> tuple[float, float]:
        middle, reach = float(n @ self.center), float(np.abs(self.axes.T @ n) @ self.half)
        return middle - reach, middle + reach

    def corners(self, n: Array) -> Array:
        return np.asarray(n @ self.center + CORNERS @ (self.half * (self.axes.T @ n)))

    def area(self, n: Array, d: Array) -> tuple[Array, Array]:
        at = self.columns(n, d)
        i, j, k = at.order
        cut = at.base * (np.abs(at.g) < self.half[k]) / np.abs(self.axes[:, k] @ n)
        moment = np.empty((len(d), 3))
        for axis, x in ((i, at.x1), (j, at.x2), (k, at.sign * at.g)):
            moment[:, axis] = (cut * x).sum(axis=-1)
        areas = cut.sum(axis=-1)
        return areas, moment @ self.axes.T + areas[:, None] * self.center

    def outlines(self, n: Array, d: Array) -> tuple[Outline, ...]:
        corners = self.center + (CORNERS * self.half) @ self.axes.T
        heights = corners @ n

        def crossings(planes: Planes) -> Array:
            a, b = (corners[EDGES[:, i]] for i in (0, 1))
            above, below = (heights[EDGES[:, i]] - d[planes, None] for i in (0, 1))
            crossed = (above > 0.0) != (below > 0.0)
            part = np.where(crossed, above, 0.0) / np.where(crossed, above - below, 1.0)
            return polygon(n, a + part[..., None] * (b - a), crossed)

        return (Outline((heights.min() <= d) & (d < heights.max()), crossings),)
