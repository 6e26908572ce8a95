"""Vectors of bodies at many instants, each component in a row of its own: long sums in place of many short ones.

Vectors (n, 3, n_t) and matrices (n, 3, 3, n_t) of n bodies, where elsewhere instants come first: a sum over three
components is then three loops over all instants. Products are added up in a fixed order, that in which NumPy's einsum
adds those of (n_t, n, 3).
"""

from __future__ import annotations

import numpy as np

from heuncli.results import Array


def rows(values: Array) -> Array:
    """Values (n_t, ...) with the instants last and next to each other, (..., n_t)."""
    return np.ascontiguousarray(values.transpose(*range(1, values.ndim), 0))


def instants_first(values: Array) -> Array:
    """Values (..., n_t) as they are elsewhere, (n_t, ...)."""
    last = values.ndim - 1
    return np.ascontiguousarray(values.transpose(last, *range(last)))


def body_by_body(values: Array) -> Array:
    """Values (n, ..., n_t) as (n_t, n, ...), in memory one body behind the other."""
    last = values.ndim - 1
    return np.ascontiguousarray(values.transpose(0, last, *range(1, last))).swapaxes(0, 1)


def cross(a: Array, b: Array) -> Array:
    """a x b, (n, 3, n_t)."""
    out = np.empty(a.shape)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        np.subtract(a[:, j] * b[:, k], a[:, k] * b[:, j], out=out[:, i])
    return out


def turned(R: Array, vectors: Array) -> Array:
    """R v, (n, 3, n_t)."""
    x, y, z = (R[:, :, i] * vectors[:, None, i] for i in range(3))
    return np.asarray(x + z + y)


def turned_back(R: Array, vectors: Array) -> Array:
    """R^T v, (n, 3, n_t)."""
    x, y, z = (R[:, i] * vectors[:, i, None] for i in range(3))
    return np.asarray(x + y + z)


def form(x: Array, J: Array) -> Array:
    """x . J x of vectors and matrices (n, 3, 3), (n, n_t)."""
    found = np.zeros((x.shape[0], x.shape[2]))
    for i in range(3):
        for j in range(3):
            found += x[:, i] * J[:, i, j, None] * x[:, j]
    return found


def squares(vectors: Array) -> Array:
    """v . v, (n, n_t)."""
    x, y, z = (vectors[:, i] * vectors[:, i] for i in range(3))
    return np.asarray(x + y + z)


def largest(values: Array) -> Array:
    """The largest magnitude of values (..., n_t) at each instant, (n_t,)."""
    return np.asarray(np.abs(values).reshape(-1, values.shape[-1]).max(axis=0, initial=0.0))
