"""Rainflow counting of a history of loads: ASTM E1049-85, 5.4.4, and 5.4.5 for one that is repeated.

Of four turning points a b c d one after another the range b c is a cycle if it is no larger than those on either side;
b and c are taken out, and a d takes the place of the three ranges. What is left when none is (the residue) grows up to
its largest range and falls behind it; each of its ranges is half a cycle.

The rule of 5.4.4, of three points, counts what contains the first point as halves at once, and drops that point. Both
count the same: a range that it drops is smaller than the next one, and so is left to the residue. Where the two are
equal, to the bit, four points count one cycle where three count two halves of the same range and mean.
Numbers only: knows nothing of joints, units or text.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Mask

WHOLE, HALF = 1.0, 0.5


class Cycles(NamedTuple):
    """Cycles (n,): from which turning point to which, so that halves tell whether they rise; counts: how often each."""

    begin: Array
    end: Array
    counts: Array

    @property
    def ranges(self) -> Array:
        """From the lowest to the highest of each, (n,)."""
        return np.abs(self.end - self.begin)

    @property
    def means(self) -> Array:
        """Halfway between the two, (n,)."""
        return 0.5 * (self.begin + self.end)

    def some(self, which: Mask) -> Cycles:
        """Those that are marked."""
        return Cycles(*(x[which] for x in self))


def turning_points(values: Array) -> Array:
    """The first of some values (n,), each at which they turn, and the last; what stands still is one point."""
    change = np.diff(values)
    moved = np.flatnonzero(change)
    if not len(moved):
        return values[:1]
    rises = change[moved] > 0.0
    turns = moved[1:][rises[1:] != rises[:-1]]
    return np.concatenate([values[:1], values[turns], values[-1:]])


def rainflow(values: Array) -> Cycles:
    """The cycles of a history (n,) told once: whole ones, behind them the halves of the residue."""
    closed, residue = paired(turning_points(values).tolist())
    return joined([whole(closed), halves(residue)])


def repeated(values: Array, times: int) -> Cycles:
    """The cycles of a history (n,), ending where it began, that is run through so many times in a row.

    The residue stays the same from the second time on, so that each further time closes the same cycles.
    """
    period = turning_points(np.append(values[:-1], values[:1]))
    closed, residue = paired(period.tolist())
    found, done = [whole(closed, float(times))], 1
    while done < times:
        before = residue
        closed, residue = paired(turning_points(np.array(before + paired(period.tolist())[1])).tolist())
        again = 1 if residue != before else times - done
        found.append(whole(closed, float(again)))
        done += again
    return joined([*found, halves(residue)])


def endless(values: Array) -> Cycles:
    """The cycles that each repetition adds of a history (n,), ending where it began, repeated for ever: no halves.

    It is begun at its highest point (5.4.5): then the residue is its largest range, up and down.
    """
    period = values[:-1] if len(values) > 1 else values
    top = int(np.argmax(period))
    points = turning_points(np.concatenate([period[top:], period[: top + 1]]))
    closed, residue = paired(points.tolist())
    return whole([*closed, *zip(residue[:-1:2], residue[1::2], strict=True)])


def paired(points: list[float]) -> tuple[list[tuple[float, float]], list[float]]:
    """The cycles that close among turning points, and the residue; plain floats, 0.2 µs a point."""
    closed: list[tuple[float, float]] = []
    left: list[float] = []
    for d in points:
        while len(left) > 2:
            b, c = left[-2], left[-1]
            inner = abs(c - b)
            if inner > abs(d - c) or inner > abs(b - left[-3]):
                break
            closed.append((b, c))
            del left[-2:]
        left.append(d)
    return closed, left


def whole(pairs: list[tuple[float, float]], times: float = 1.0) -> Cycles:
    """Closed cycles, each so many times."""
    both = np.array(pairs, dtype=np.float64).reshape(-1, 2)
    return Cycles(both[:, 0], both[:, 1], np.full(len(both), times * WHOLE))


def halves(residue: list[float]) -> Cycles:
    """The half cycles between the points of a residue."""
    points = np.array(residue)
    return Cycles(points[:-1], points[1:], np.full(max(len(points) - 1, 0), HALF))


def joined(parts: list[Cycles]) -> Cycles:
    """Several lists of cycles in one."""
    return Cycles(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))
