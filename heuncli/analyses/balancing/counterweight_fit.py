"""Fit counterweights: candidate places, their effect over a cycle, and the products with the least sum of squares.

If all weights act linearly, this is one linear system; of several solutions the one of least |U| is taken. A weight
whose own mass matters acts linearly in its size along a fixed direction, so Newton's iteration begins with the best of
many directions and the best sizes there; a size is never negative, and is 0 if no weight helps. Everything is computed
with the few numbers that a QR decomposition of the cycle leaves.

A point mass m at place + ρ û of a body adds forces that are linear in its moments (m, m p, m p p^T), with p measured
from the body's origin:
    m p = m place + U,   m p p^T = m place place^T + place U^T + U place^T + ρ U U^T/|U|,   U = m ρ û,  m = |U|/ρ
For a body that turns uniformly about an axis fixed in the ground, the terms in m and ρ have no effect.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import product

import numpy as np

from heuncli.base import tolerances
from heuncli.base.linear_algebra import solve_least_squares
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

    def compute_response(self, U: Array) -> Array:
        """Return the response (n,) to a weight of product U (2,)."""
        size = math.sqrt(float(U @ U))
        if size == 0.0:
            return np.zeros_like(self.by_mass)
        return np.asarray(self.by_product @ U + size * self.compute_size_response(U / size))

    def compute_size_response(self, u: Array) -> Array:
        """Return the part of the response (n,) per unit of |U| that the mass and the second moments cause, for
        direction u (2,).
        """
        return np.asarray(self.by_mass / self.radius + self.radius * (self.by_square @ u @ u))

    def compute_slope(self, U: Array) -> Array:
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


MAX_STARTS = 1000  # combinations of directions of all weights
MIN_DIRECTIONS = 6
MAX_STEPS, MAX_HALVINGS = 200, 40
RELATIVE_DIFFERENCE = 1e-5  # of |U|: step for second derivatives; first ones are exact


def solve_products(
    unbalanced: Array, candidates: Sequence[Candidate], linear: Sequence[bool], largest_effect: float
) -> tuple[Array, bool]:
    """Return the products U (k, 2) of the candidates, and whether others would serve as well.

    unbalanced (n, 6): weighted force and moment without counterweights
    """
    columns = [unbalanced.reshape(-1, 1), *(one.columns for one in candidates)]
    R: Array = np.linalg.qr(np.concatenate(columns, axis=1))[1]
    reduced = [one.replace_columns(R[:, 1 + 7 * k : 8 + 7 * k]) for k, one in enumerate(candidates)]
    size = largest_effect * math.sqrt(unbalanced.shape[0])
    if all(linear):
        U, several = solve_linear(np.concatenate([one.by_product for one in reduced], axis=1), R[:, 0], size)
        return U.reshape(-1, 2), several
    best = min(
        iter_starts(R[:, 0], reduced, linear, size),
        key=lambda U: float(np.sum(compute_residual(R[:, 0], reduced, U) ** 2)),
    )
    return refine_products(R[:, 0], reduced, best), False


def solve_linear(A: Array, constant: Array, size: float) -> tuple[Array, bool]:
    """Return the x that minimises |A x + constant|, of several the smallest, and whether there are several.

    size: reference size of columns that have an effect
    """
    is_active = np.sqrt(np.sum(A * A, axis=0)) > tolerances.NO_EFFECT * size
    x = np.zeros(A.shape[1])
    if not is_active.any():
        return x, True
    solution, _, rank, _ = np.linalg.lstsq(A[:, is_active] / size, -constant / size, rcond=tolerances.SAME_WEIGHT)
    x[is_active] = solution
    return x, int(rank) < A.shape[1]


def compute_residual(constant: Array, candidates: Sequence[Candidate], U: Array) -> Array:
    """Return the force and moment (n,) that remain with the weights."""
    return np.asarray(
        constant
        + sum(
            (one.compute_response(product) for one, product in zip(candidates, U, strict=True)), np.zeros_like(constant)
        )
    )


def iter_starts(
    constant: Array, candidates: Sequence[Candidate], linear: Sequence[bool], size: float
) -> Iterator[Array]:
    """Yield starting weights: many directions of the nonlinear weights, each with its best sizes and the best linear
    weights.
    """
    nonlinear = [k for k, is_linear in enumerate(linear) if not is_linear]
    direction_count = max(MIN_DIRECTIONS, int(MAX_STARTS ** (1.0 / len(nonlinear))))
    angles = 2.0 * math.pi * np.arange(min(direction_count, 72)) / min(direction_count, 72)
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    for chosen_directions in product(directions, repeat=len(nonlinear)):
        yield solve_sizes(constant, candidates, dict(zip(nonlinear, chosen_directions, strict=True)), size)


def solve_sizes(constant: Array, candidates: Sequence[Candidate], directions: dict[int, Array], size: float) -> Array:
    """Return the best weights if some lie along given directions; the sizes of these are not negative."""
    U = np.zeros((len(candidates), 2))
    free = list(directions)
    while True:
        free_directions = {k: directions[k] for k in free}
        columns = [one.by_product for k, one in enumerate(candidates) if k not in directions]
        columns += [
            (candidates[k].by_product @ u + candidates[k].compute_size_response(u))[:, None]
            for k, u in free_directions.items()
        ]
        if not columns:
            return U
        x, _ = solve_linear(np.concatenate(columns, axis=1), constant, size)
        sizes = x[len(x) - len(free) :] if free else x[:0]
        if (sizes >= 0.0).all():
            break
        free = [k for k, value in zip(free, sizes, strict=True) if value >= 0.0]
    linear = [k for k in range(len(candidates)) if k not in directions]
    for i, k in enumerate(linear):
        U[k] = x[2 * i : 2 * i + 2]
    for k, value in zip(free, sizes, strict=True):
        U[k] = value * directions[k]
    return U


def refine_products(constant: Array, candidates: Sequence[Candidate], U: Array) -> Array:
    """Refine the weights that are not 0 by Newton's iteration; each step is halved until the residual falls."""
    active = [k for k in range(len(U)) if np.any(U[k])]
    if not active:
        return U
    active_candidates = [candidates[k] for k in active]

    def compute_gradient(x: Array) -> tuple[Array, Array]:
        """Return the gradient of half the squared residual, and the Jacobian."""
        products = x.reshape(-1, 2)
        J = np.concatenate(
            [one.compute_slope(each) for one, each in zip(active_candidates, products, strict=True)], axis=1
        )
        return J.T @ compute_residual(constant, active_candidates, products), J

    x = U[active].ravel()
    for _ in range(MAX_STEPS):
        g, J = compute_gradient(x)
        step = find_descent_step(compute_hessian(lambda at: compute_gradient(at)[0], x), J.T @ J, g)
        current = np.sum(compute_residual(constant, active_candidates, x.reshape(-1, 2)) ** 2)
        for _ in range(MAX_HALVINGS):
            if np.sum(compute_residual(constant, active_candidates, (x + step).reshape(-1, 2)) ** 2) < current:
                break
            step = 0.5 * step
        else:
            break
        x = x + step
    refined = U.copy()
    refined[active] = x.reshape(-1, 2)
    sizes = np.sqrt(np.sum(refined**2, axis=1))
    refined[sizes <= tolerances.NO_WEIGHT * sizes.max()] = 0.0
    return refined


def compute_hessian(gradient: Callable[[Array], Array], x: Array) -> Array:
    """Compute second derivatives by central differences of the first."""
    h = RELATIVE_DIFFERENCE * float(np.abs(x).max())
    rows = [(gradient(x + h * e) - gradient(x - h * e)) / (2.0 * h) for e in np.eye(len(x))]
    H = np.array(rows)
    return np.asarray(0.5 * (H + H.T))


def find_descent_step(H: Array, gauss: Array, g: Array) -> Array:
    """Return Newton's step; if it leads uphill the Gauss-Newton step, else the negative gradient."""
    for matrix in (H, gauss):
        step = -solve_least_squares(matrix, g)
        if step @ g < 0.0:
            return np.asarray(step)
    return -g
