"""Closed surfaces of triangles, and what of them follows from the divergence theorem.

    V = sum a.(b x c)/6     sum m x = V/4 (a + b + c)     sum m x x^T = V/20 (s s^T + sum a a^T),   s = a + b + c
of the tetrahedra between a point and the triangles a, b, c, counter-clockwise from outside; here the point is the
middle of the surface, so that what is far from the origin loses no digits.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heuncli.base.records import record
from heuncli.results.results import Array

Numbers = NDArray[np.intp]


@record
class TriangleMesh:
    """A closed surface: corners (n, 3), triangles (m, 3) of their numbers, counter-clockwise from outside.

    In the units of its file. shells: of how many separate surfaces it consists; volume: what it encloses; low, high
    (3,): its extent; notes: what was put right, in sentences.
    """

    corners: Array
    triangles: Numbers
    shells: int
    volume: float
    low: Array
    high: Array
    notes: tuple[str, ...] = ()


@record
class Soup:
    """Triangles as a file has them, each with corners of its own or sharing those of a list: (n, 3) and (m, 3)."""

    corners: Array
    triangles: Numbers


def along(a: Array, b: Array) -> Array:
    """a . b of columns (3, ...)."""
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def across(a: Array, b: Array) -> Array:
    """a x b of columns (3, ...)."""
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def at_corners(places: Array, triangles: Numbers) -> Array:
    """Places (n, 3) of the corners of triangles, in columns: (3 corners, 3 axes, m)."""
    columns = np.ascontiguousarray(places.T)
    return np.stack([columns.take(numbers, axis=1) for numbers in triangles.T])


def tetrahedra(corners: Array, triangles: Numbers, middle: Array) -> tuple[Array, Array]:
    """Corners (3, 3, m) from the middle on, in columns, and volumes (m,) of the tetrahedra between it and triangles."""
    places = at_corners(corners - middle, triangles)
    a, b, c = places
    return places, along(a, across(b, c)) / 6.0


def middle_of(corners: Array) -> Array:
    """The middle of the extent, (3,)."""
    return np.asarray(0.5 * (corners.min(axis=0) + corners.max(axis=0)))


def moments(corners: Array, triangles: Numbers) -> tuple[float, Array, Array]:
    """Volume, and its first (3,) and second moments (3, 3) about the middle of the corners."""
    (a, b, c), V = tetrahedra(corners, triangles, middle_of(corners))
    s = a + b + c
    first = 0.25 * (s @ V)
    second = sum((V * x) @ x.T for x in (s, a, b, c)) / 20.0
    return float(V.sum()), first, np.asarray(second)


def least(triangles: Array) -> Array:
    """The least of three along the second axis, (m, ...); a reduction along so short an axis takes twice as long."""
    return np.asarray(np.minimum(np.minimum(triangles[:, 0], triangles[:, 1]), triangles[:, 2]))


def most(triangles: Array) -> Array:
    """The largest of three along the second axis, (m, ...)."""
    return np.asarray(np.maximum(np.maximum(triangles[:, 0], triangles[:, 1]), triangles[:, 2]))


def crossed(a: Array, b: Array) -> Array:
    """a x b of rows (..., 3)."""
    out = np.empty(np.broadcast(a, b).shape)
    out[..., 0] = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    out[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    out[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return out


def components(count: int, a: Numbers, b: Numbers) -> Numbers:
    """For each of `count` things the least number of those that pairs (a, b) join it to (Shiloach, Vishkin, 1982)."""
    first = np.arange(count)
    while True:
        one, other = first[a], first[b]
        apart = one != other
        if not apart.any():
            return first
        a, b = a[apart], b[apart]
        low, high = np.minimum(one[apart], other[apart]), np.maximum(one[apart], other[apart])
        first[high] = low  # of several joined to one the last; the others are met again
        while True:
            further = first[first]
            if (further == first).all():
                break
            first = further


def in_order(keys: Numbers) -> Numbers:
    """The stable order of whole numbers from 0 on: with their places behind them, where both have room in 63 bits."""
    bits = len(keys).bit_length()
    if int(keys.max(initial=0)) >> (63 - bits):
        return np.argsort(keys, kind="stable")
    return np.asarray(np.sort((keys << bits) | np.arange(len(keys))) & ((1 << bits) - 1))


def numbered(first: Numbers) -> tuple[Numbers, Numbers]:
    """Of things joined as `components` has them the first of each component (k,), and of each thing its component."""
    begins = first == np.arange(len(first))
    return np.flatnonzero(begins), (np.cumsum(begins) - 1)[first]
