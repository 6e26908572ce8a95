"""Where two branches of an expression are equal by rounding, just before one takes the other's place."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.results.results import Array, Mask
from heuncli.scene.expressions.programs import HELD, PERIODIC, TableFunction

FEW_EQUAL = 8  # doubles that are looked at one by one: most often there are fewer
Decide = Callable[[list[float]], list[float]]
Enclose = Callable[[list[float], list[float]], Sequence[Sequence[float]]]


def tied_instants(
    changes: Sequence[float], enclose: Enclose, compute: Decide, table: TableFunction | None, most: int
) -> list[float]:
    """The instants just before changes of branch at which rounding cannot tell the old branch from the new one.

    changes: the first instants of the new branches. enclose, compute: of the margin that tells the branch, bounds over
    stretches of time and values at instants; table: whose piece the margin tells, if one's. most: how many instants
    before a change are one discontinuity with it.

    min(t, 1) is computed as t at t = 1 itself, a table that falls to one of its points is computed on the piece above,
    and min(3*t, 0.9) is 3*t at t = 0.3, for 3*0.3 is rounded down. There the old branch ends, not at the next double.
    Together with the change they are one discontinuity, at which the limits from either side are those before and
    after, whichever branch is computed between. Where there are too many of them the first one is told at which both
    branches are equal as they are computed: derivatives are those of the new branch from there on (kernel/jets.py).
    """
    may_be, equal = _nearness(enclose, compute, table)
    ends, which, edges = np.array(changes), np.arange(len(changes)), list[float]()
    for _ in range(FEW_EQUAL):
        if not len(ends):
            return edges
        ends = np.nextafter(ends, -np.inf)
        near = may_be(ends)
        ends, which = ends[near], which[near]
        edges += ends.tolist()
    for k, t in zip(which.tolist(), ends.tolist(), strict=True):
        first = _first_of_all(may_be, t)
        last = math.nextafter(changes[k], -math.inf)
        if _place(last) - _place(first) < most:
            edges += np.arange(_place(first), _place(t)).view(np.float64).tolist()
        elif equal(np.array([last]))[0]:
            edges.append(_first_of_all(equal, last))
    return edges


def _place(t: float) -> int:
    """The number of a double among all that are not negative."""
    return int(np.array(t).view(np.int64))


def _first_of_all(holds: Callable[[Array], Mask], t: float) -> float:
    """The first double of those up to t, where it holds, at all of which something holds, one next to the other."""
    end, step = _place(t), 1
    while step <= end and holds(np.array([end - step]).view(np.float64))[0]:
        step *= 2
    low, high = max(end - step, -1), end - step // 2
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if holds(np.array([middle]).view(np.float64))[0] else (middle, high)
    return float(np.array(high).view(np.float64))


def _nearness(
    enclose: Enclose, compute: Decide, table: TableFunction | None
) -> tuple[Callable[[Array], Mask], Callable[[Array], Mask]]:
    """Whether at instants (n,) a branch may change, as far as rounding can tell, and whether it does as computed."""

    def meets(low: Array, high: Array) -> Mask:
        return np.asarray((low <= 0.0) & (high >= 0.0)) if table is None else _meets_points(table, low, high)

    def may_be(times: Array) -> Mask:
        low, high = (np.asarray(bound) for bound in enclose(times.tolist(), times.tolist())[:2])
        width = high - low  # of what is computed with, decimals are rounded, too: as much again either way
        return meets(low - width, high + width)

    def is_equal(times: Array) -> Mask:
        values = np.array(compute(times.tolist()))
        return meets(values, values)

    return may_be, is_equal


def _meets_points(table: TableFunction, low: Array, high: Array) -> Mask:
    """Whether stretches (n,) from low to high of a table's argument hold a point at which its piece changes.

    At the ends of a table that ends there is nothing beyond that could be told there.
    """
    x = np.frombuffer(table.x)
    if table.kind == PERIODIC:
        turned = table.numbers[0] * np.floor((low - x[0]) / table.numbers[0])
        rounding = 2.0 * tolerances.EPS * (np.abs(low) + np.abs(turned))
        low, high = low - turned - rounding, high - turned + rounding
        x = np.append(x, x[1] + table.numbers[0])  # behind the last point, which is the first one
    elif table.kind != HELD:
        x = x[1:-1]
    return np.asarray(np.searchsorted(x, low, side="left") < np.searchsorted(x, high, side="right"))
