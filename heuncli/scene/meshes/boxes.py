"""Pairs of boxes that overlap, out of many: down a tree of boxes, all pairs of a level at once.

In the order of a space-filling curve (Morton, 1966) some and some boxes are put into larger ones. A pair of nodes whose
boxes overlap is followed to the pairs of what is in them. What is in a node stands in columns: the first of each node,
the second of each and so on, so that all pairs are asked about one coordinate of theirs at a time.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array
from heuncli.scene.meshes.model import Numbers, in_order

BITS = 10  # an axis, of the curve
SPREAD = ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249))  # so that two others come between bits
MOST_PAIRS = 40_000_000
MEMBERS = 4  # of a node
AT_ONCE = 1 << 13  # pairs of nodes followed together: what they need stays near the processor


class Level(NamedTuple):
    """What is in the nodes of a level: the ends of their boxes (3, MEMBERS, nodes)."""

    low: Array
    high: Array


def overlapping(low: Array, high: Array) -> Iterator[tuple[Numbers, Numbers]]:
    """Pairs of boxes (3, n) that touch or overlap, each once, some at a time. Raises Finding if they are too many.

    It takes the less time, the nearer those are to each other that stand together: as they are `along_curve`.
    """
    levels = levels_of(low, high)
    total = 0
    waiting = [(len(levels) - 1, np.zeros(1, np.intp), np.zeros(1, np.intp))]
    while waiting:
        level, a, b = waiting.pop()
        if level < 0:
            total += len(a)
            if total > MOST_PAIRS:
                message = "its triangles overlap so much that it is not seen whether they cross each other"
                raise Finding("too-large", message, "a mesh of shorter triangles")
            yield a, b
            continue
        for i in range(0, len(a), AT_ONCE):
            waiting.append((level - 1, *within(levels[level], a[i : i + AT_ONCE], b[i : i + AT_ONCE], level == 0)))


def levels_of(low: Array, high: Array) -> list[Level]:
    """The levels from that of the boxes (3, n) up to a single node."""
    found: list[Level] = []
    while not found or low.shape[1] > 1:
        missing = -low.shape[1] % MEMBERS
        ends = [np.pad(x, ((0, 0), (0, missing)), constant_values=e) for x, e in ((low, np.inf), (high, -np.inf))]
        level = Level(*(np.ascontiguousarray(x.reshape(3, -1, MEMBERS).transpose(0, 2, 1)) for x in ends))
        found.append(level)
        low, high = level.low.min(axis=1), level.high.max(axis=1)
    return found


def within(level: Level, a: Numbers, b: Numbers, last: bool) -> tuple[Numbers, Numbers]:
    """The pairs that overlap of what is in pairs of nodes, each once; at the last level none of a box with itself."""
    meet = np.ones((MEMBERS, MEMBERS, len(a)), dtype=bool)
    for low, high in zip(level.low, level.high, strict=True):
        of_a, of_b = (low.take(a, axis=1), high.take(a, axis=1)), (low.take(b, axis=1), high.take(b, axis=1))
        meet &= of_a[0][:, None] <= of_b[1]
        meet &= of_b[0] <= of_a[1][:, None]
    other_nodes = a != b
    one, other = [], []
    for i in range(MEMBERS):
        for j in range(MEMBERS):
            if j < i or (last and i == j):
                meet[i, j] &= other_nodes
            on = np.flatnonzero(meet[i, j])
            one.append(MEMBERS * a[on] + i)
            other.append(MEMBERS * b[on] + j)
    return np.concatenate(one), np.concatenate(other)


def along_curve(points: Array) -> Numbers:
    """The order of points (3, n) along a curve on which near ones follow each other."""
    low, size = points.min(axis=1, keepdims=True), float(np.ptp(points, axis=1).max()) or 1.0
    cell = ((points - low) * ((2**BITS - 1) / size)).astype(np.int64)
    for apart, kept in SPREAD:
        cell = (cell | (cell << apart)) & kept
    return in_order(cell[0] | (cell[1] << 1) | (cell[2] << 2))
