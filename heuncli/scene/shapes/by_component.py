"""Vectors of bodies at many instants, each component in a row of its own: long sums in place of many short ones.

Vectors (n, 3, n_t) and matrices (n, 3, 3, n_t) of n bodies, where elsewhere instants come first: a sum over three
components is then three loops over all instants. Products are added up in a fixed order, that in which NumPy's einsum
adds those of (n_t, n, 3).
"""

from __future__ import annotations

import numpy as np

from heuncli.results.results import Array


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


NEXT, LAST = np.array([1, 2, 0]), np.array([2, 0, 1])  # of each component those behind it, in turn


def cross(a: Array, b: Array) -> Array:
    """a x b, (n, 3, n_t)."""
    return np.asarray(a.take(NEXT, 1) * b.take(LAST, 1) - a.take(LAST, 1) * b.take(NEXT, 1))


def turned(R: Array, vectors: Array) -> Array:
    """R v, (n, 3, n_t)."""
    each = R * vectors[:, None]
    return np.asarray(each[:, :, 0] + each[:, :, 2] + each[:, :, 1])


def turned_back(R: Array, vectors: Array) -> Array:
    """R^T v, (n, 3, n_t)."""
    each = R * vectors[:, :, None]
    return np.asarray(each[:, 0] + each[:, 1] + each[:, 2])


def form(x: Array, J: Array) -> Array:
    """x . J x of vectors and matrices (n, 3, 3), (n, n_t)."""
    each = (x[:, :, None] * J[..., None] * x[:, None]).reshape(len(x), 9, x.shape[2])
    found = each[:, 0] + each[:, 1]
    for k in range(2, 9):
        found += each[:, k]
    return np.asarray(found)


def squares(vectors: Array) -> Array:
    """v . v, (n, n_t)."""
    each = vectors * vectors
    return np.asarray(each[:, 0] + each[:, 1] + each[:, 2])


def largest(values: Array) -> Array:
    """The largest magnitude of values (..., n_t) at each instant, (n_t,)."""
    return np.asarray(np.abs(values).reshape(-1, values.shape[-1]).max(axis=0, initial=0.0))
