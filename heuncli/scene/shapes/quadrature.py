"""Integrate functions that are smooth between known breaks: Gauss-Legendre on each interval, halved if needed.

All functions handle many integrals at once, one for each of k cuts.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray

from heuncli.base import tolerances
from heuncli.base.errors import Finding
from heuncli.results.results import Array

Owners = NDArray[np.intp]

# Nodes and weights on [-1, 1]; numpy.polynomial takes 4 ms to import, and whole bodies never need more than these.
SMALL_RULES = {
    2: ([-(3.0**-0.5), 3.0**-0.5], [1.0, 1.0]),
    3: ([-(0.6**0.5), 0.0, 0.6**0.5], [5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0]),
}
NODE_COUNT = 16
MAX_DEPTH = 48
MAX_OPEN_HALVES = (
    1000  # undecided halves of an integral at once: square roots need dozens, rounding errors endless ones
)


@cache
def gauss_rule(n: int) -> tuple[Array, Array]:
    """Return nodes and weights on [0, 1], (n,) each; exact up to degree 2n - 1."""
    x, w = (np.array(part) for part in SMALL_RULES[n]) if n in SMALL_RULES else np.polynomial.legendre.leggauss(n)
    return 0.5 * (1.0 + x), 0.5 * w


def split_at_breaks(low: Array, high: Array, breaks: Array) -> tuple[Array, Array]:
    """Return starts and lengths (..., m + 1) of the intervals into which breaks (..., m) divide [low, high]; 0
    outside.
    """
    inside = np.clip(np.nan_to_num(breaks, nan=0.0), low[..., None], high[..., None])
    edges = np.sort(np.concatenate([low[..., None], inside, high[..., None]], axis=-1), axis=-1)
    return edges[..., :-1], np.diff(edges, axis=-1)


def piecewise_rule(low: Array, high: Array, breaks: Array, n: int) -> tuple[Array, Array]:
    """Return nodes and weights (..., (m + 1) n) for integrands that are of degree 2n - 1 between the breaks."""
    starts, lengths = split_at_breaks(low, high, breaks)
    x, w = gauss_rule(n)
    nodes = starts[..., None] + lengths[..., None] * x
    weights = lengths[..., None] * w
    return nodes.reshape(*low.shape, -1), weights.reshape(*low.shape, -1)


def integrate_adaptively(
    f: Callable[[Array, Owners], Array], low: Array, high: Array, breaks: Array, scale: Array
) -> Array:
    """Integrate m functions from low to high, (k,), to about QUADRATURE times scale, (k, m) or (m,). Returns (k, m).

    f(z, owner) takes z (i, n) and the numbers of their integrals (i,), and returns (i, n, m). At the breaks (k, j) f
    may have square roots: z = start + length sin^2(psi/2) makes them smooth in psi, in which intervals are halved until
    two halves agree with their whole. Raises Finding [thin-shape] if rounding prevents that.
    """
    x, w = gauss_rule(NODE_COUNT)

    def integral_over(interval: Array, owner: Owners) -> Array:
        start, length, p, q = (interval[:, i, None] for i in range(4))
        psi = p + (q - p) * x
        s = np.sin(0.5 * psi)
        weight = (q - p) * w * 0.5 * length * np.sin(psi)
        values: Array = np.einsum("in,inm->im", weight, f(start + length * s * s, owner))
        return values

    starts, lengths = split_at_breaks(low, high, breaks)
    owner, slot = np.nonzero(lengths > 0.0)
    interval = np.stack(
        [starts[owner, slot], lengths[owner, slot], np.zeros(len(owner)), np.full(len(owner), np.pi)], axis=-1
    )
    whole = integral_over(interval, owner)
    total = np.zeros((len(low), whole.shape[-1]))
    limit = tolerances.QUADRATURE * np.broadcast_to(scale, total.shape)
    for depth in range(MAX_DEPTH):
        if not len(owner):
            break
        halves, owners = np.repeat(interval, 2, axis=0), np.repeat(owner, 2)
        halves[0::2, 3] = halves[1::2, 2] = 0.5 * (interval[:, 2] + interval[:, 3])
        parts = integral_over(halves, owners)
        sum_of_halves = parts[0::2] + parts[1::2]
        done = np.all(np.abs(sum_of_halves - whole) <= limit[owner], axis=-1) | (depth == MAX_DEPTH - 1)
        np.add.at(total, owner[done], sum_of_halves[done])
        is_open = np.repeat(~done, 2)
        if is_open.sum() > MAX_OPEN_HALVES * len(low):
            message = "a shape is so thin relative to its size that rounding errors determine the cut"
            raise Finding("thin-shape", message, "give its real thickness, or remove it from the body that is cut")
        interval, owner, whole = halves[is_open], owners[is_open], parts[is_open]
    return total
