"""Cut a box by any plane, exactly.

With the box's axis nearest to the normal as x3, the piece is x3 > g(x1, x2), g linear and clipped to the box. Its
moments are integrals over x1 and x2 of polynomials between the lines where g meets an edge of the box, so
Gauss-Legendre from line to line gives them to rounding, for many planes at once and at any angle, also 1e-9 off.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.records import record
from heuncli.results.results import Array
from heuncli.scene.shapes.inertia import assemble_pseudo_inertia
from heuncli.scene.shapes.outlines import Outline, Planes, sort_polygon_corners
from heuncli.scene.shapes.solids import ThickSolid, piecewise_rule

CORNERS = np.array([[i, j, k] for i in (-1.0, 1.0) for j in (-1.0, 1.0) for k in (-1.0, 1.0)])
EDGES = np.array([(a, b) for a in range(8) for b in range(a + 1, 8) if np.abs(CORNERS[a] - CORNERS[b]).sum() == 2.0])


@record
class BoxColumns:
    """The box divided into columns along x3, (k, m).

    order: the box's axes that are x1, x2, x3
    sign: of the normal's component along x3
    x1, x2: places of the columns
    g: height of the plane there
    base: area of their bases
    """

    order: tuple[int, int, int]
    sign: float
    x1: Array
    x2: Array
    g: Array
    base: Array


@record
class Box(ThickSolid):
    """A box.

    center: centre [m]
    half_size: half sizes along its own axes [m]
    axes: its axes, in columns
    density: [kg/m3]
    """

    center: Array
    half_size: Array
    axes: Array
    density: float

    def divide_into_columns(self, n: Array, d: Array) -> BoxColumns:
        local = self.axes.T @ n
        i3 = int(np.argmax(np.abs(local)))
        order = ((i3 + 1) % 3, (i3 + 2) % 3, i3)
        n1, n2 = float(local[order[0]]), float(local[order[1]])
        sign, n3 = float(np.sign(local[i3])), abs(float(local[i3]))
        a, b, c = (float(self.half_size[i]) for i in order)
        h = d - n @ self.center
        with np.errstate(divide="ignore", invalid="ignore"):
            corners = np.array([-n2 * b - n3 * c, n2 * b - n3 * c, -n2 * b + n3 * c, n2 * b + n3 * c])
            x1, w1 = piecewise_rule(np.full(len(d), -a), np.full(len(d), a), (h[:, None] + corners) / n1, 3)
            remainder = h[:, None] - n1 * x1
            edges = (remainder[..., None] + np.array([-n3 * c, n3 * c])) / n2
            x2, w2 = piecewise_rule(np.full(x1.shape, -b), np.full(x1.shape, b), edges, 2)
        g = (remainder[..., None] - n2 * x2) / n3
        grid = np.broadcast_to(x1[..., None], x2.shape), x2, g, w1[..., None] * w2
        return BoxColumns(order, sign, *(part.reshape(len(d), -1) for part in grid))

    def pseudo_inertia_from_moments(self, mass: Array, first: Array, second: Array) -> Array:
        """Compute the pseudo-inertia about the body's origin from moments about the box's centre, in the box's axes."""
        Q, c = self.axes, self.center
        first = first @ Q.T
        shift = first[:, :, None] * c
        second = Q @ second @ Q.T + shift + shift.transpose(0, 2, 1) + mass[:, None, None] * np.outer(c, c)
        return assemble_pseudo_inertia(
            self.density * mass, self.density * (first + mass[:, None] * c), self.density * second
        )

    def whole_inertia(self) -> Array:
        mass = np.array([8.0 * np.prod(self.half_size)])
        P = self.pseudo_inertia_from_moments(
            mass, np.zeros((1, 3)), mass[:, None, None] * np.diag(self.half_size**2 / 3.0)
        )
        return np.asarray(P[0])

    def aligned_piece_inertia(self, n: Array, d: Array) -> Array | None:
        """Compute the pseudo-inertia of pieces cut across one of the box's axes, (k, 4, 4); None for other planes."""
        local = self.axes.T @ n
        k = int(np.argmax(np.abs(local)))
        i, j = (k + 1) % 3, (k + 2) % 3
        if local[i] != 0.0 or local[j] != 0.0:
            return None
        a, b, c = (float(self.half_size[axis]) for axis in (i, j, k))
        g = np.clip((d - n @ self.center) / abs(float(local[k])), -c, c)
        volume = 4.0 * a * b * (c - g)
        first, second = np.zeros((len(d), 3)), np.zeros((len(d), 3, 3))
        first[:, k] = np.sign(local[k]) * volume * 0.5 * (c + g)
        second[:, i, i], second[:, j, j] = volume * (a * a / 3.0), volume * (b * b / 3.0)
        second[:, k, k] = volume * ((c * c + c * g + g * g) / 3.0)
        return self.pseudo_inertia_from_moments(volume, first, second)

    def piece_inertia(self, n: Array, d: Array, side: Array, tolerance: float) -> Array:
        aligned = self.aligned_piece_inertia(n, d)
        if aligned is not None:
            return aligned
        columns = self.divide_into_columns(n, d)
        c = float(self.half_size[columns.order[2]])
        g = np.clip(columns.g, -c, c)
        volume = columns.base * (c - g)
        z1 = columns.sign * volume * 0.5 * (c + g)
        z2 = volume * (c * c + c * g + g * g) / 3.0
        first, second = np.empty((len(d), 3)), np.empty((len(d), 3, 3))
        i, j, k = columns.order
        for axis, moment in ((i, volume * columns.x1), (j, volume * columns.x2), (k, z1)):
            first[:, axis] = moment.sum(axis=-1)
        for p, q, moment in (
            (i, i, volume * columns.x1 * columns.x1), (j, j, volume * columns.x2 * columns.x2), (k, k, z2),
            (i, j, volume * columns.x1 * columns.x2), (j, k, z1 * columns.x2), (k, i, z1 * columns.x1),
        ):  # fmt: skip
            second[:, p, q] = second[:, q, p] = moment.sum(axis=-1)
        return self.pseudo_inertia_from_moments(volume.sum(axis=-1), first, second)

    def extent(self, n: Array) -> tuple[float, float]:
        middle, reach = float(n @ self.center), float(np.abs(self.axes.T @ n) @ self.half_size)
        return middle - reach, middle + reach

    def corners(self, n: Array) -> Array:
        return np.asarray(n @ self.center + CORNERS @ (self.half_size * (self.axes.T @ n)))

    def section_area(self, n: Array, d: Array) -> tuple[Array, Array]:
        columns = self.divide_into_columns(n, d)
        i, j, k = columns.order
        cut = columns.base * (np.abs(columns.g) < self.half_size[k]) / np.abs(self.axes[:, k] @ n)
        moment = np.empty((len(d), 3))
        for axis, x in ((i, columns.x1), (j, columns.x2), (k, columns.sign * columns.g)):
            moment[:, axis] = (cut * x).sum(axis=-1)
        areas = cut.sum(axis=-1)
        return areas, moment @ self.axes.T + areas[:, None] * self.center

    def section_outlines(self, n: Array, d: Array) -> tuple[Outline, ...]:
        corners = self.center + (CORNERS * self.half_size) @ self.axes.T
        heights = corners @ n

        def edge_crossings(planes: Planes) -> Array:
            a, b = (corners[EDGES[:, i]] for i in (0, 1))
            above, below = (heights[EDGES[:, i]] - d[planes, None] for i in (0, 1))
            crossed = (above > 0.0) != (below > 0.0)
            part = np.where(crossed, above, 0.0) / np.where(crossed, above - below, 1.0)
            return sort_polygon_corners(n, a + part[..., None] * (b - a), crossed)

        return (Outline((heights.min() <= d) & (d < heights.max()), edge_crossings),)
