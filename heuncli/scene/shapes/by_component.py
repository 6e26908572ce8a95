"""Compute with vectors of bodies at many instants component by component: few long sums in place of many short ones.

Vectors are (n, 3, n_t) and matrices (n, 3, 3, n_t) for n bodies, while elsewhere instants come first. A sum over three
components is then three loops over all instants. Products are summed in a fixed order, that of NumPy's einsum for (n_t,
n, 3).
"""

from __future__ import annotations

import numpy as np

from heuncli.results.results import Array


def instants_last(values: Array) -> Array:
    """Return values (n_t, ...) with the instants last and contiguous, (..., n_t)."""
    return np.ascontiguousarray(values.transpose(*range(1, values.ndim), 0))


def instants_first(values: Array) -> Array:
    """Return values (..., n_t) with the instants first, (n_t, ...)."""
    last = values.ndim - 1
    return np.ascontiguousarray(values.transpose(last, *range(last)))


def bodies_contiguous(values: Array) -> Array:
    """Return values (n, ..., n_t) as (n_t, n, ...), stored in memory one body after another."""
    last = values.ndim - 1
    return np.ascontiguousarray(values.transpose(0, last, *range(1, last))).swapaxes(0, 1)


# the next and the second next component, cyclic
NEXT_COMPONENT, AFTER_NEXT_COMPONENT = (np.array([1, 2, 0]), np.array([2, 0, 1]))


def cross_components(a: Array, b: Array) -> Array:
    """Compute a x b, (n, 3, n_t)."""
    return np.asarray(
        a.take(NEXT_COMPONENT, 1) * b.take(AFTER_NEXT_COMPONENT, 1)
        - a.take(AFTER_NEXT_COMPONENT, 1) * b.take(NEXT_COMPONENT, 1)
    )


def rotate_components(R: Array, vectors: Array) -> Array:
    """Compute R v, (n, 3, n_t)."""
    products = R * vectors[:, None]
    return np.asarray(products[:, :, 0] + products[:, :, 2] + products[:, :, 1])


def rotate_components_back(R: Array, vectors: Array) -> Array:
    """Compute R^T v, (n, 3, n_t)."""
    products = R * vectors[:, :, None]
    return np.asarray(products[:, 0] + products[:, 1] + products[:, 2])


def quadratic_form(x: Array, J: Array) -> Array:
    """Compute x . J x of vectors (n, 3, n_t) and matrices (n, 3, 3), (n, n_t)."""
    products = (x[:, :, None] * J[..., None] * x[:, None]).reshape(len(x), 9, x.shape[2])
    total = products[:, 0] + products[:, 1]
    for k in range(2, 9):
        total += products[:, k]
    return np.asarray(total)


def squared_lengths(vectors: Array) -> Array:
    """Compute v . v, (n, n_t)."""
    products = vectors * vectors
    return np.asarray(products[:, 0] + products[:, 1] + products[:, 2])


def largest_magnitude(values: Array) -> Array:
    """Return the largest magnitude of values (..., n_t) at each instant, (n_t,)."""
    return np.asarray(np.abs(values).reshape(-1, values.shape[-1]).max(axis=0, initial=0.0))
