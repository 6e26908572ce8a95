"""Find where two branches of an expression are equal by rounding, just before one takes over from the other."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.results.results import Array, Mask
from heuncli.scene.expressions.programs import HELD, PERIODIC, TableFunction

SINGLE_STEPS = 8  # doubles that are tested one by one; usually there are fewer
Decide = Callable[[list[float]], list[float]]
Enclose = Callable[[list[float], list[float]], Sequence[Sequence[float]]]


def find_tied_instants(
    changes: Sequence[float], enclose: Enclose, compute: Decide, table: TableFunction | None, max_tied: int
) -> list[float]:
    """Find the instants just before changes of branch at which rounding cannot tell the old branch from the new one.

    changes: the first instants of the new branches
    enclose, compute: bounds over intervals of time, and values at instants, of the margin of the branch
    table: the table whose piece the margin identifies, if any
    max_tied: how many instants before a change form one discontinuity with it

    min(t, 1) is computed as t at t = 1 itself, a table that falls to one of its points is computed on the piece above,
    and min(3*t, 0.9) is 3*t at t = 0.3, for 3*0.3 is rounded down. The old branch ends there, not at the next double.
    Together with the change these instants are one discontinuity, whose one-sided limits are those before and after,
    whichever branch is computed between. If there are too many, the first one is returned at which both branches are
    equal as computed: from there on, derivatives are those of the new branch (kernel/jets.py).
    """
    may_be_tied, is_tied = _make_tie_tests(enclose, compute, table)
    instants, change_numbers, tied = np.array(changes), np.arange(len(changes)), list[float]()
    for _ in range(SINGLE_STEPS):
        if not len(instants):
            return tied
        instants = np.nextafter(instants, -np.inf)
        near = may_be_tied(instants)
        instants, change_numbers = instants[near], change_numbers[near]
        tied += instants.tolist()
    for k, t in zip(change_numbers.tolist(), instants.tolist(), strict=True):
        first = _find_first(may_be_tied, t)
        last = math.nextafter(changes[k], -math.inf)
        if _ordinal(last) - _ordinal(first) < max_tied:
            tied += np.arange(_ordinal(first), _ordinal(t)).view(np.float64).tolist()
        elif is_tied(np.array([last]))[0]:
            tied.append(_find_first(is_tied, last))
    return tied


def _ordinal(t: float) -> int:
    """Return the ordinal of a double among all that are not negative."""
    return int(np.array(t).view(np.int64))


def _find_first(holds: Callable[[Array], Mask], t: float) -> float:
    """Find the first of the adjacent doubles up to t at all of which `holds` is true; it is true at t."""
    end, step = _ordinal(t), 1
    while step <= end and holds(np.array([end - step]).view(np.float64))[0]:
        step *= 2
    low, high = max(end - step, -1), end - step // 2
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if holds(np.array([middle]).view(np.float64))[0] else (middle, high)
    return float(np.array(high).view(np.float64))


def _make_tie_tests(
    enclose: Enclose, compute: Decide, table: TableFunction | None
) -> tuple[Callable[[Array], Mask], Callable[[Array], Mask]]:
    """Return two tests at instants (n,): whether a branch may change there, given rounding, and whether it does as
    computed.
    """

    def contains_change(low: Array, high: Array) -> Mask:
        return np.asarray((low <= 0.0) & (high >= 0.0)) if table is None else _contains_point(table, low, high)

    def may_be_tied(times: Array) -> Mask:
        low, high = (np.asarray(bound) for bound in enclose(times.tolist(), times.tolist())[:2])
        width = high - low  # decimal inputs are rounded, too, so the width is added on either side
        return contains_change(low - width, high + width)

    def is_tied(times: Array) -> Mask:
        values = np.array(compute(times.tolist()))
        return contains_change(values, values)

    return may_be_tied, is_tied


def _contains_point(table: TableFunction, low: Array, high: Array) -> Mask:
    """Return whether intervals (n,) from low to high of a table's argument contain a point at which its piece changes.

    The ends of a table that ends do not count, as it has no value behind them.
    """
    x = np.frombuffer(table.x)
    if table.kind == PERIODIC:
        offset = table.numbers[0] * np.floor((low - x[0]) / table.numbers[0])
        rounding = 2.0 * tolerances.EPS * (np.abs(low) + np.abs(offset))
        low, high = low - offset - rounding, high - offset + rounding
        x = np.append(x, x[1] + table.numbers[0])  # the point after the last one, which equals the first one
    elif table.kind != HELD:
        x = x[1:-1]
    return np.asarray(np.searchsorted(x, low, side="left") < np.searchsorted(x, high, side="right"))
