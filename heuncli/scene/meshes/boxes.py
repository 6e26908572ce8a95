"""Find pairs of overlapping boxes among many, down a tree of boxes, all pairs of a level at once.

The boxes are sorted along a space-filling curve (Morton, 1966), and groups of them are put into larger ones. A pair of
nodes whose boxes overlap is followed to the pairs of their members. The members of nodes are stored in columns (the
first of each node, the second of each and so on), so that all pairs are tested in one coordinate at a time.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array
from heuncli.scene.meshes.model import IndexArray, stable_order

BITS_PER_AXIS = 10  # bits of the curve for each axis
SPREAD_MASKS = ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249))  # put two zero bits between bits
MAX_PAIRS = 40_000_000
MEMBERS_PER_NODE = 4  # boxes in a node
MAX_PAIRS_AT_ONCE = 1 << 13  # pairs of nodes handled together: their data fits in the cache


class BoxLevel(NamedTuple):
    """The members of the nodes of a level: the corners of their boxes (3, MEMBERS_PER_NODE, nodes)."""

    low: Array
    high: Array


def iter_overlapping(low: Array, high: Array) -> Iterator[tuple[IndexArray, IndexArray]]:
    """Yield the pairs of boxes (3, n) that touch or overlap, each once, some at a time. Raises Finding if they are too
    many.

    It is faster if boxes that are adjacent in order are close in space, as after `sort_along_curve`.
    """
    levels = build_levels(low, high)
    total = 0
    pending = [(len(levels) - 1, np.zeros(1, np.intp), np.zeros(1, np.intp))]
    while pending:
        level, a, b = pending.pop()
        if level < 0:
            total += len(a)
            if total > MAX_PAIRS:
                message = "its triangles overlap too much to check whether they intersect each other"
                raise Finding("too-large", message, "use a mesh with shorter triangles")
            yield a, b
            continue
        for i in range(0, len(a), MAX_PAIRS_AT_ONCE):
            pending.append(
                (
                    level - 1,
                    *find_member_pairs(
                        levels[level], a[i : i + MAX_PAIRS_AT_ONCE], b[i : i + MAX_PAIRS_AT_ONCE], level == 0
                    ),
                )
            )


def build_levels(low: Array, high: Array) -> list[BoxLevel]:
    """Build the levels from that of the boxes (3, n) up to a single node."""
    levels: list[BoxLevel] = []
    while not levels or low.shape[1] > 1:
        missing = -low.shape[1] % MEMBERS_PER_NODE
        ends = [np.pad(x, ((0, 0), (0, missing)), constant_values=e) for x, e in ((low, np.inf), (high, -np.inf))]
        level = BoxLevel(*(np.ascontiguousarray(x.reshape(3, -1, MEMBERS_PER_NODE).transpose(0, 2, 1)) for x in ends))
        levels.append(level)
        low, high = level.low.min(axis=1), level.high.max(axis=1)
    return levels


def find_member_pairs(level: BoxLevel, a: IndexArray, b: IndexArray, is_last: bool) -> tuple[IndexArray, IndexArray]:
    """Find the overlapping pairs of members of pairs of nodes, each once; at the last level no pair of a box with
    itself.
    """
    overlaps = np.ones((MEMBERS_PER_NODE, MEMBERS_PER_NODE, len(a)), dtype=bool)
    for low, high in zip(level.low, level.high, strict=True):
        bounds_a, bounds_b = (low.take(a, axis=1), high.take(a, axis=1)), (low.take(b, axis=1), high.take(b, axis=1))
        overlaps &= bounds_a[0][:, None] <= bounds_b[1]
        overlaps &= bounds_b[0] <= bounds_a[1][:, None]
    other_nodes = a != b
    one, other = [], []
    for i in range(MEMBERS_PER_NODE):
        for j in range(MEMBERS_PER_NODE):
            if j < i or (is_last and i == j):
                overlaps[i, j] &= other_nodes
            selected = np.flatnonzero(overlaps[i, j])
            one.append(MEMBERS_PER_NODE * a[selected] + i)
            other.append(MEMBERS_PER_NODE * b[selected] + j)
    return np.concatenate(one), np.concatenate(other)


def sort_along_curve(points: Array) -> IndexArray:
    """Return the order of points (3, n) along a space-filling curve, on which close points follow each other."""
    low, size = points.min(axis=1, keepdims=True), float(np.ptp(points, axis=1).max()) or 1.0
    cell = ((points - low) * ((2**BITS_PER_AXIS - 1) / size)).astype(np.int64)
    for shift, mask in SPREAD_MASKS:
        cell = (cell | (cell << shift)) & mask
    return stable_order(cell[0] | (cell[1] << 1) | (cell[2] << 2))
