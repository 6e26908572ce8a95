"""Candidate places for counterweights, and the effect of a weight there over a cycle.

A point mass m at place + ρ û of a body adds forces that are linear in its moments (m, m p, m p p^T), with p measured
from the body's origin:
    m p = m place + U,   m p p^T = m place place^T + place U^T + U place^T + ρ U U^T/|U|,   U = m ρ û,  m = |U|/ρ
For a body that turns uniformly about an axis fixed in the ground, the terms in m and ρ have no effect.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record
from heuncli.results.results import Array


@record
class WeightPlace:
    """A place for a counterweight: a point of a body, and the weight's distance from it.

    point (3,): its position, body axes [m]
    radius [m]: None means the distance of the body's farthest joint
    """

    body: int
    name: str
    point: Array
    radius: float | None


@record
class Candidate:
    """A place with two directions across its body's axis, and the responses to the moments of a weight there.

    The responses are weighted forces and moments ON the foundation over the cycle at unit rate.

    plane_directions (3, 2): the two directions
    by_mass (n,): response to a mass at the place
    by_product (n, 2): response to a product m ρ along each direction
    by_square (n, 2, 2): response to moments of second order
    """

    weight_place: WeightPlace
    radius: float
    plane_directions: Array
    by_mass: Array
    by_product: Array
    by_square: Array

    def effect(self, U: Array) -> Array:
        """Return the response (n,) to a weight of product U (2,)."""
        size = math.sqrt(float(U @ U))
        if size == 0.0:
            return np.zeros_like(self.by_mass)
        return np.asarray(self.by_product @ U + size * self.size_effect(U / size))

    def size_effect(self, u: Array) -> Array:
        """Return the part of the response (n,) per unit of |U| that the mass and the second moments cause, for
        direction u (2,).
        """
        return np.asarray(self.by_mass / self.radius + self.radius * (self.by_square @ u @ u))

    def slope(self, U: Array) -> Array:
        """Return the derivative (n, 2) of the response with respect to U."""
        size = math.sqrt(float(U @ U))
        if size == 0.0:
            return self.by_product
        u = U / size
        square = self.by_square @ u
        curved = 2.0 * square - (square @ u)[:, None] * u
        return np.asarray(self.by_product + self.by_mass[:, None] / self.radius * u + self.radius * curved)

    def is_linear(self, largest_effect: float) -> bool:
        """Return whether mass and second moments are negligible compared with the product, whose largest effect is
        given.
        """
        nonlinear_effects = np.abs(self.by_mass).max() / self.radius, self.radius * np.abs(self.by_square).max()
        return bool(max(nonlinear_effects) <= tolerances.NO_EFFECT * largest_effect)

    @property
    def columns(self) -> Array:
        """All responses as one matrix (n, 7)."""
        return np.concatenate([self.by_mass[:, None], self.by_product, self.by_square.reshape(-1, 4)], axis=1)

    def replace_columns(self, columns: Array) -> Candidate:
        """Return the same place with transformed responses (k, 7)."""
        square = columns[:, 3:].reshape(-1, 2, 2)
        return Candidate(self.weight_place, self.radius, self.plane_directions, columns[:, 0], columns[:, 1:3], square)
