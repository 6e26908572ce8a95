"""Rainflow counting of a load history: ASTM E1049-85, 5.4.4, and 5.4.5 for a repeated one.

Of four consecutive turning points a b c d the range b c is a cycle if it is no larger than the ranges on either side; b
and c are removed, and a d replaces the three ranges. When no more can be removed, the remaining points (the residue)
grow up to the largest range and fall after it; each of its ranges is half a cycle.

The rule of 5.4.4, of three points, counts a range that contains the first point as half a cycle at once, and drops that
point. Both count the same: a range that it drops is smaller than the next one, and so is left to the residue. Where the
two are equal, to the bit, four points count one cycle where three count two halves of the same range and mean. Numbers
only: knows nothing of joints, units or text.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Mask

WHOLE, HALF = 1.0, 0.5


class Cycles(NamedTuple):
    """Cycles (n,): the two turning points of each, in order, so that halves rise or fall; counts: how often each
    occurs.
    """

    begin: Array
    end: Array
    counts: Array

    @property
    def ranges(self) -> Array:
        """The difference between highest and lowest value of each cycle, (n,)."""
        return np.abs(self.end - self.begin)

    @property
    def means(self) -> Array:
        """The mean of highest and lowest value of each cycle, (n,)."""
        return 0.5 * (self.begin + self.end)

    def select(self, mask: Mask) -> Cycles:
        """Return the cycles that the mask marks."""
        return Cycles(*(x[mask] for x in self))


def find_turning_points(values: Array) -> Array:
    """Return the first of some values (n,), each at which they turn, and the last; equal neighbours count as one
    point.
    """
    change = np.diff(values)
    changing = np.flatnonzero(change)
    if not len(changing):
        return values[:1]
    rises = change[changing] > 0.0
    turns = changing[1:][rises[1:] != rises[:-1]]
    return np.concatenate([values[:1], values[turns], values[-1:]])


def count_once(values: Array) -> Cycles:
    """Count the cycles of a history (n,) that is run through once: whole cycles, then the halves of the residue."""
    closed, residue = pair_points(find_turning_points(values).tolist())
    return concatenate_cycles([make_whole_cycles(closed), make_half_cycles(residue)])


def count_repeated(values: Array, times: int) -> Cycles:
    """Count the cycles of a history (n,), closed to its beginning, that is run through `times` times.

    The residue is the same from the second pass on, so each further pass closes the same cycles.
    """
    period = find_turning_points(np.append(values[:-1], values[:1]))
    closed, residue = pair_points(period.tolist())
    parts, passes = [make_whole_cycles(closed, float(times))], 1
    while passes < times:
        before = residue
        closed, residue = pair_points(find_turning_points(np.array(before + pair_points(period.tolist())[1])).tolist())
        again = 1 if residue != before else times - passes
        parts.append(make_whole_cycles(closed, float(again)))
        passes += again
    return concatenate_cycles([*parts, make_half_cycles(residue)])


def count_endless(values: Array) -> Cycles:
    """Count the cycles that each pass adds if a history (n,), closed to its beginning, is repeated for ever: no halves.

    It starts at its highest point (5.4.5); then the residue is the largest range, up and down.
    """
    period = values[:-1] if len(values) > 1 else values
    top = int(np.argmax(period))
    points = find_turning_points(np.concatenate([period[top:], period[: top + 1]]))
    closed, residue = pair_points(points.tolist())
    return make_whole_cycles([*closed, *zip(residue[:-1:2], residue[1::2], strict=True)])


def pair_points(points: list[float]) -> tuple[list[tuple[float, float]], list[float]]:
    """Return the cycles that close among turning points, and the residue; plain floats, 0.2 µs a point."""
    closed: list[tuple[float, float]] = []
    residue: list[float] = []
    for d in points:
        while len(residue) > 2:
            b, c = residue[-2], residue[-1]
            inner = abs(c - b)
            if inner > abs(d - c) or inner > abs(b - residue[-3]):
                break
            closed.append((b, c))
            del residue[-2:]
        residue.append(d)
    return closed, residue


def make_whole_cycles(pairs: list[tuple[float, float]], times: float = 1.0) -> Cycles:
    """Make closed cycles, each counted `times` times."""
    ends = np.array(pairs, dtype=np.float64).reshape(-1, 2)
    return Cycles(ends[:, 0], ends[:, 1], np.full(len(ends), times * WHOLE))


def make_half_cycles(residue: list[float]) -> Cycles:
    """Make the half cycles between the points of a residue."""
    points = np.array(residue)
    return Cycles(points[:-1], points[1:], np.full(max(len(points) - 1, 0), HALF))


def concatenate_cycles(parts: list[Cycles]) -> Cycles:
    """Concatenate several lists of cycles."""
    return Cycles(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))
