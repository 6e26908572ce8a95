"""Pairs of boxes that overlap, out of many: down a tree of boxes, all pairs of a level at once.

The boxes are put in the order of a space-filling curve (Morton, 1966) and two by two into larger ones. A pair of nodes
whose boxes overlap is followed to the pairs of what is in them.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import reduce

import numpy as np

from heuncli.errors import Finding
from heuncli.meshes.model import Numbers
from heuncli.results import Array

BITS = 10  # an axis, of the curve
MOST_PAIRS = 40_000_000
AT_ONCE = 1 << 19  # pairs of a level followed together
LEAF = 4  # boxes


def overlapping(low: Array, high: Array) -> Iterator[tuple[Numbers, Numbers]]:
    """Pairs of boxes (n, 3) that touch or overlap, each once, some at a time. Raises Finding if they are too many."""
    if not len(low):
        return
    order = along_curve(0.5 * (low + high))
    count = 1 << max(0, int(np.ceil(np.log2(max(len(order) / LEAF, 1.0)))))
    padded = np.full(count * LEAF, -1, dtype=np.intp)
    padded[: len(order)] = order
    lows, highs = [_filled(low, padded, np.inf)], [_filled(high, padded, -np.inf)]
    members = LEAF
    while len(lows[-1]) > 1 or members == LEAF:
        lows.append(_of_members(np.minimum, lows[-1], members))
        highs.append(_of_members(np.maximum, highs[-1], members))
        members = 2
    total = 0
    waiting = [(len(lows) - 1, np.zeros(1, np.intp), np.zeros(1, np.intp))]
    while waiting:
        level, a, b = waiting.pop()
        if level == 0:
            total += len(a)
            if total > MOST_PAIRS:
                message = "its triangles overlap so much that it is not seen whether they cross each other"
                raise Finding("too-large", message, "a mesh of shorter triangles")
            yield padded[a], padded[b]
            continue
        for i in range(0, len(a), AT_ONCE):
            waiting.append((level - 1, *_below(level, a[i : i + AT_ONCE], b[i : i + AT_ONCE], lows, highs)))


def _below(level: int, a: Numbers, b: Numbers, lows: list[Array], highs: list[Array]) -> tuple[Numbers, Numbers]:
    """The pairs of what is in nodes that overlap, a <= b, a < b at the end."""
    n = LEAF if level == 1 else 2
    one = (n * a[:, None, None] + np.arange(n)[:, None] + np.zeros(n, np.intp)).ravel()
    other = (n * b[:, None, None] + np.arange(n) + np.zeros((n, 1), np.intp)).ravel()
    keep = one <= other if level > 1 else one < other
    one, other = one[keep], other[keep]
    low, high = lows[level - 1], highs[level - 1]
    for axis in range(3):
        below, above = low[:, axis].copy(), high[:, axis].copy()
        meet = (below[one] <= above[other]) & (below[other] <= above[one])
        one, other = one[meet], other[meet]
    return one, other


def _of_members(extreme: np.ufunc, values: Array, members: int) -> Array:
    """The extremes of so many rows each; half the time of a reduction along a short axis, or less."""
    return np.asarray(reduce(extreme, (values[k::members] for k in range(members))))


def _filled(values: Array, order: Numbers, empty: float) -> Array:
    found = values[order]
    found[order < 0] = empty
    return found


def along_curve(points: Array) -> Numbers:
    """The order of points (n, 3) along a curve on which near ones follow each other."""
    low, size = points.min(axis=0), float(np.ptp(points, axis=0).max()) or 1.0
    cell = ((points - low) * ((2**BITS - 1) / size)).astype(np.int64)
    key = np.zeros(len(points), dtype=np.int64)
    for bit in range(BITS):
        for axis in range(3):
            key |= ((cell[:, axis] >> bit) & 1) << (3 * bit + axis)
    return np.argsort(key, kind="stable")
