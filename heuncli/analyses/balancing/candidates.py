"""Places for counterweights, and what a weight there does over a cycle.

A point mass m at place + ρ û of a body adds what is linear in its moments (m, m p, m p p^T), p from the body's origin:
    m p = m place + U,   m p p^T = m place place^T + place U^T + U place^T + ρ U U^T/|U|,   U = m ρ û,  m = |U|/ρ
Of a body that turns evenly about an axis fixed in the ground the terms in m and ρ do nothing.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.base.records import record
from heuncli.results.results import Array

NO_EFFECT = 1e-10  # of what a product does at most: rounding of a cycle's accelerations


@record
class WeightPlace:
    """Where a counterweight may stand: a body's point, and how far from it (None: the body's farthest joint)."""

    body: int
    name: str
    place: Array
    radius: float | None


@record
class Candidate:
    """A place with the two directions across its body's axis, and the answers to the moments of a weight there.

    by_mass (n,), by_product (n, 2), by_square (n, 2, 2), n numbers for all forces and moments of the cycle, as they are
    weighed: what a mass at the place, a product along each direction, and moments of second order make ON the
    foundation at unit rate.
    """

    at: WeightPlace
    radius: float
    across: Array
    by_mass: Array
    by_product: Array
    by_square: Array

    def effect(self, U: Array) -> Array:
        """What a weight of product U (2,) adds, (n,)."""
        size = math.sqrt(float(U @ U))
        if size == 0.0:
            return np.zeros_like(self.by_mass)
        return np.asarray(self.by_product @ U + size * self.of_size(U / size))

    def of_size(self, u: Array) -> Array:
        """What grows with the size of U whichever its direction u (2,), (n,)."""
        return np.asarray(self.by_mass / self.radius + self.radius * (self.by_square @ u @ u))

    def slope(self, U: Array) -> Array:
        """The effect's derivative by U, (n, 2)."""
        size = math.sqrt(float(U @ U))
        if size == 0.0:
            return self.by_product
        u = U / size
        square = self.by_square @ u
        curved = 2.0 * square - (square @ u)[:, None] * u
        return np.asarray(self.by_product + self.by_mass[:, None] / self.radius * u + self.radius * curved)

    def is_linear(self, unit: float) -> bool:
        """Whether mass and second moments do nothing that counts beside the product; unit: what that does at most."""
        other = np.abs(self.by_mass).max() / self.radius, self.radius * np.abs(self.by_square).max()
        return bool(max(other) <= NO_EFFECT * unit)

    @property
    def columns(self) -> Array:
        """All answers side by side, (n, 7)."""
        return np.concatenate([self.by_mass[:, None], self.by_product, self.by_square.reshape(-1, 4)], axis=1)

    def with_columns(self, columns: Array) -> Candidate:
        """The same place with answers (k, 7) of another kind."""
        square = columns[:, 3:].reshape(-1, 2, 2)
        return Candidate(self.at, self.radius, self.across, columns[:, 0], columns[:, 1:3], square)
