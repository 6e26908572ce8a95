"""Find where the branches of an expression change with time alone: its jumps and kinks.

A change is proved, not sampled. An enclosure (kernel/enclosure.py) of the branch decision shows that nothing changes
within an interval of time, or that its margin only rises or only falls there, so that the branches at the ends suffice.
Otherwise the interval is halved, down to adjacent doubles.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Sequence

from heuncli.base import tolerances
from heuncli.base.errors import LimitError, Problem
from heuncli.base.records import record
from heuncli.scene.expressions.programs import (
    HELD,
    KNOT,
    OPS,
    PERIODIC,
    VAR,
    Code,
    Expression,
    Pack,
    Switch,
    TableFunction,
)

MIN_CELLS, MAX_CELLS = 1 << 12, 1 << 20  # cells of the coarsest and the finest grid
CELLS_PER_CHANGE = 16  # a grid with fewer is not fine enough to trust
FIRST_CELLS = 256  # cells in each of the first intervals
MAX_TIED_DOUBLES = (
    4096  # doubles before a change of branch at which rounding may make the operands equal, one discontinuity
)
SAMPLE_COUNT = 1000  # equal parts of a run, at whose ends values are sampled
# undecided intervals at once; a margin that is zero up to rounding has one for each double
MAX_OPEN_INTERVALS = 1 << 13
TIME_PROGRAM = (VAR, 0)  # the program of the time itself
# monotonic in the margin
MONOTONIC_OPERATIONS = frozenset(OPS[name] for name in ("sign", "step", "lt", "le", "gt", "ge"))
Decide = Callable[[list[float]], list[float]]
Enclose = Callable[[list[float], list[float]], Sequence[Sequence[float]]]


def find_discontinuities(expression: Expression, t0: float, t1: float) -> list[float]:
    """Find the instants in (t0, t1) at which a branch of the expression changes with time alone: its jumps and kinks.

    Each is the first double at which the new branch holds; adjacent ones (sign at its zero, min(t, 1) at t = 1) leave a
    single instant between them, to be stepped over. Branches that depend on coordinates are left out. Raises LimitError
    if there are too many to separate.
    """
    return sorted({t for switch in expression.switches for t in _find_switch_changes(expression, switch, t0, t1)})


def pair_adjacent_instants(instants: Sequence[float]) -> list[tuple[float, float]]:
    """For each of ascending discontinuities, return the last instant before it and the first after it.

    Adjacent doubles are one discontinuity: sign(t - 1) is zero at t = 1 alone, and its limits are those of the branches
    before and after that instant.
    """
    limits: list[tuple[float, float]] = []
    for t in instants:
        before = math.nextafter(t, -math.inf)
        if limits and limits[-1][1] >= before:
            limits[-1] = (limits[-1][0], t)
        else:
            limits.append((before, t))
    return limits


def instant_after_end(last: float) -> float:
    """Return an instant after the end of a run, up to which rounding may shift its last discontinuity."""
    return last * (1.0 + 2.0 * MAX_TIED_DOUBLES * tolerances.EPS)


def find_run_discontinuities(value: Expression, last: float) -> list[float]:
    """Find the discontinuities within (0, last], ascending, as `find_discontinuities` does.

    A discontinuity at the end of the run is included, even if rounding puts its new branch just after the end: a run
    that ends at a jump shows the value after it, however the jump is written. It is left out if there is no value after
    it, as behind the end of a table.
    """
    if not last > 0.0:
        return []
    instants = find_discontinuities(value, 0.0, instant_after_end(last))
    if not instants or instants[-1] <= last:
        return instants
    before, after = pair_adjacent_instants(instants)[-1]
    inside = [t for t in instants if t <= before]
    return inside if before >= last or _becomes_undefined(value, before, after) else instants


def _becomes_undefined(value: Expression, first: float, second: float) -> bool:
    """Return whether a value is finite at the first instant and not at the second; coordinates are taken as 1."""
    is_defined = [math.isfinite(value.value(t, [1.0] * len(value.uses))) for t in (first, second)]
    return is_defined[0] and not is_defined[1]


def find_branch_changes(value: Expression, last: float) -> list[tuple[float, float]]:
    """Return the last instant before and the first after each change of branch within the run, except one only at 0."""
    return [
        (before, after)
        for before, after in pair_adjacent_instants(find_run_discontinuities(value, last))
        if before > 0.0
    ]


def find_jumps(value: Expression, last: float, order: int = 0) -> list[tuple[float, float, float, float]]:
    """Find where a value, or its derivative of an order, jumps within (0, last]: instants before and after, and
    limits.
    """
    found = []
    for before, after in find_branch_changes(value, last):
        limit_before, limit_after = value.derivatives(before)[order], value.derivatives(after)[order]
        if abs(limit_after - limit_before) > tolerances.SAME_VALUE * max(abs(limit_before), abs(limit_after), 1.0):
            found.append((before, after, limit_before, limit_after))
    return found


def find_first_not_positive(value: Expression, last: float) -> float | None:
    """Find the first sampled instant of a run at which a value is not above 0; the samples include all jumps and
    kinks.
    """
    return next((t for t in sample_instants(value, last) if value.value(t) <= 0.0), None)


def find_first_negative(value: Expression, last: float) -> float | None:
    """Find the first of these instants at which the value is negative by more than rounding."""
    samples = [(t, value.value(t)) for t in sample_instants(value, last)]
    rounding = tolerances.SAME_VALUE * max((abs(x) for _, x in samples), default=0.0)
    return next((t for t, x in samples if x < -rounding), None)


def sample_instants(value: Expression, last: float) -> list[float]:
    """Return many instants of a run, including those next to its jumps and kinks."""
    grid = {last * k / SAMPLE_COUNT for k in range(SAMPLE_COUNT + 1)}
    grid.update(t for pair in find_branch_changes(value, last) for t in pair)
    return sorted(grid)


def _find_switch_changes(expression: Expression, switch: Switch, t0: float, t1: float) -> list[float]:
    """Find where one switch changes, by proof; if that does not end, by a grid."""
    if switch.decision[:2] == TIME_PROGRAM and switch.decision[2] == KNOT and switch.decision[5] != PERIODIC:
        return _find_table_changes(expression.tables[switch.decision[3]], t0, t1)
    change_instants = SwitchSearch(expression, switch, TimeGrid(t0, t1, MIN_CELLS)).find_changes()
    change_instants = _find_sampled_changes(expression, switch, t0, t1) if change_instants is None else change_instants
    return [t for t in (*change_instants, *_find_tied_instants(expression, switch, change_instants)) if t0 < t < t1]


def _find_table_changes(table: TableFunction, t0: float, t1: float) -> list[float]:
    """Find where a table of the time itself changes from piece to piece: at its points.

    The last point is computed on the last piece. If the table holds its end values, that constant begins there. These
    are the doubles that a search would find, to the last bit; for a million of them it would take minutes.
    """
    points = table.x[bisect_right(table.x, t0) : bisect_left(table.x, t1)]
    last = table.x[-1]
    ends = {last, math.nextafter(last, math.inf)} if table.kind == HELD else {math.nextafter(last, math.inf)}
    return [t for t in (*(t for t in points if t < last), *sorted(ends)) if t0 < t < t1]


def _find_tied_instants(expression: Expression, switch: Switch, changes: Sequence[float]) -> list[float]:
    """Find the instants just before changes of branch at which rounding cannot tell the old branch from the new one."""
    if not changes:
        return []
    from heuncli.scene.expressions.tied_branches import find_tied_instants  # NumPy, which validation avoids

    margin = switch.decision[:-4] if switch.margin is None else switch.margin
    table = None if switch.margin is not None else expression.tables[switch.decision[-3]]
    enclose, compute = _enclose_program(expression, margin), _evaluate_program(expression, margin)
    return find_tied_instants(changes, enclose, compute, table, MAX_TIED_DOUBLES)


@record
class TimeGrid:
    """The instants t0 + (t1 - t0) i / cells; the last one lies just before t1."""

    t0: float
    t1: float
    cells: int

    def __getitem__(self, i: int) -> float:
        if i == self.cells:
            return math.nextafter(self.t1, -math.inf)
        return self.t0 + (self.t1 - self.t0) * (i / self.cells)


class SwitchSearch:
    """Searches the changes of one switch over a run."""

    def __init__(self, expression: Expression, switch: Switch, grid: TimeGrid) -> None:
        self.expression, self.switch, self.grid = expression, switch, grid
        self.decide = _evaluate_program(expression, switch.decision)
        self.bound_decision = _enclose_program(expression, switch.decision)
        margin = switch.margin or switch.decision[:-4]  # a table's margin is its argument
        rises = switch.margin is None or switch.decision[-2] in MONOTONIC_OPERATIONS
        self.bound_margin = _enclose_program(expression, margin) if rises else None
        self.branch: dict[float, float] = {}
        self.found: list[float] = []
        self.cells: list[tuple[float, float]] = []  # monotonic cells with different branches at their ends

    def find_changes(self) -> list[float] | None:
        """Return the first double of each new branch; None if too many intervals stay undecided."""
        cells = self.grid.cells
        intervals = [
            (i, i + FIRST_CELLS, self.grid[i], self.grid[i + FIRST_CELLS]) for i in range(0, cells, FIRST_CELLS)
        ]
        while intervals:
            if len(intervals) > MAX_OPEN_INTERVALS:
                return None
            self.evaluate_branches({t for stretch in intervals for t in stretch[2:]})
            intervals = [half for stretch in self.select_undecided(intervals) for half in self.halve(*stretch)]
        self.require_few_changes()
        return self.found + _locate_changes(self.decide, self.cells)

    def require_few_changes(self) -> None:
        """Raise LimitError if a table has too many points, which its piece numbers show before any point is
        searched.
        """
        if self.switch.margin is not None:
            return
        points_passed = [abs(self.branch[end] - self.branch[begin]) for begin, end in self.cells]
        # behind a table that ends there are no points
        count = sum(number for number in points_passed if number < math.inf)
        if count > tolerances.MOST_STEPS:
            where = f"between {self.grid.t0:g} and {self.grid.t1:g} s"
            message = (
                f"'{self.expression.source}' passes {count:,.0f} points of its table {where}, and each ends a step"
            )
            hint = f"at most {tolerances.MOST_STEPS:,} steps are taken: shorten the duration, or use fewer table points"
            raise LimitError(Problem("too-many-jumps", message, self.expression.location, hint))

    def evaluate_branches(self, instants: set[float]) -> None:
        """Compute the branches at instants."""
        new = sorted(instants - self.branch.keys())
        self.branch.update(zip(new, self.decide(new), strict=True))

    def select_undecided(self, intervals: list[tuple[int, int, float, float]]) -> list[tuple[int, int, float, float]]:
        """Return the intervals that may contain changes not found yet."""
        begins, ends = [s[2] for s in intervals], [s[3] for s in intervals]
        least, largest, *_ = self.bound_decision(begins, ends)
        *_, slowest, fastest = (
            self.bound_margin(begins, ends) if self.bound_margin else (least, [math.nan] * len(least))
        )
        undecided = []
        for interval, low, high, slope_low, slope_high in zip(intervals, least, largest, slowest, fastest, strict=True):
            before, after = self.branch[interval[2]], self.branch[interval[3]]
            if before == after and (low == high == before or (low != low and before == math.inf)):
                continue
            if (slope_low > 0.0 or slope_high < 0.0) and (before != after or before < math.inf):
                self.cells += self.find_changed_cells(*interval)
            else:
                undecided.append(interval)
        return undecided

    def halve(self, i: int, j: int, begin: float, end: float) -> list[tuple[int, int, float, float]]:
        """Return both halves of an interval, first by cells of the grid. Adjacent doubles are not halved: a change
        there is found.
        """
        if j - i > 1:
            k = (i + j) // 2
            return [(i, k, begin, self.grid[k]), (k, j, self.grid[k], end)]
        middle = begin + 0.5 * (end - begin)
        if begin < middle < end:
            return [(i, i, begin, middle), (i, i, middle, end)]
        if self.branch[begin] != self.branch[end]:
            self.found.append(end)
        return []

    def find_changed_cells(self, i: int, j: int, begin: float, end: float) -> list[tuple[float, float]]:
        """Return the cells of the grid with changes in an interval on which the margin is monotonic."""
        if j - i <= 1:
            return [(begin, end)]
        k = (i + j) // 2
        middle = self.grid[k]
        self.evaluate_branches({middle})
        return [
            cell
            for half in ((i, k, begin, middle), (k, j, middle, end))
            if self.branch[half[2]] != self.branch[half[3]]
            for cell in self.find_changed_cells(*half)
        ]


def _enclose_program(expression: Expression, code: Code) -> Enclose:
    """Return a function that bounds a program in time alone over intervals: least and largest value, least and largest
    rate.
    """
    pack = Pack()
    start, count = pack.add_code(expression, code)
    return lambda begins, ends: pack.bound_with_rates(start, count, begins, ends)


def _find_sampled_changes(expression: Expression, switch: Switch, t0: float, t1: float) -> list[float]:
    """Find where one switch changes on a grid, which is refined until it has many cells for each change. Raises
    LimitError.
    """
    decide = _evaluate_program(expression, switch.decision)
    cells, last = MIN_CELLS, math.nextafter(t1, -math.inf)
    while True:
        instants = [t0 + (t1 - t0) * (i / cells) for i in range(cells)]
        instants.append(last)
        branches = decide(instants)
        changed = [i for i in range(cells) if branches[i] != branches[i + 1]]
        if len(changed) * CELLS_PER_CHANGE <= cells:
            break
        if cells >= MAX_CELLS:
            message = f"'{expression.source}' has too many jumps or kinks between {t0:g} and {t1:g} s"
            hint = f"at most about {MAX_CELLS // CELLS_PER_CHANGE} jumps and kinks can be located exactly"
            raise LimitError(Problem("too-many-jumps", message, expression.location, hint))
        cells *= 4
    spans = [(instants[i], instants[i + 1]) for i in changed]
    if switch.margin is not None:
        spans += _find_near_zeros(_evaluate_program(expression, switch.margin), instants, branches, decide)
    return _locate_changes(decide, spans)


def _evaluate_program(expression: Expression, code: Code) -> Decide:
    """Return a function that evaluates a program in time alone at instants; NaN, which is a branch of its own, becomes
    inf.
    """
    pack = Pack()
    start, count = pack.add_code(expression, code)

    def values(times: list[float]) -> list[float]:
        return [v if v == v else math.inf for v in pack.sample(start, count, times)]

    return values


def _locate_changes(decide: Decide, spans: Sequence[tuple[float, float]]) -> list[float]:
    """Locate the changes of branch in each (low, high], from left to right, to the last bit; all spans together."""
    instants: list[float] = []
    rows = list(zip(spans, decide([low for low, _ in spans]), decide([high for _, high in spans]), strict=True))
    while rows := [row for row in rows if row[1] != row[2]]:
        firsts = _bisect_first_changes(decide, [span for span, _, _ in rows], [branch for _, branch, _ in rows])
        instants += firsts
        rows = [((t, span[1]), b, end) for (span, _, end), t, b in zip(rows, firsts, decide(firsts), strict=True)]
    return instants


def _bisect_first_changes(
    decide: Decide, spans: Sequence[tuple[float, float]], branches: Sequence[float]
) -> list[float]:
    """For spans that begin on one branch and end on another, return the first double of the other, by bisection."""
    lows, highs = [low for low, _ in spans], [high for _, high in spans]
    open_spans = list(range(len(spans)))
    while open_spans:
        middles = [lows[i] + 0.5 * (highs[i] - lows[i]) for i in open_spans]
        halved = [(i, t) for i, t in zip(open_spans, middles, strict=True) if lows[i] < t < highs[i]]
        for (i, t), branch in zip(halved, decide([t for _, t in halved]), strict=True):
            if branch == branches[i]:
                lows[i] = t
            else:
                highs[i] = t
        open_spans = [i for i, _ in halved]
    return highs


def _find_near_zeros(
    margin: Decide,
    grid: list[float],
    branches: list[float],
    decide: Decide,
) -> list[tuple[float, float]]:
    """Find spans in which the margin passes through zero and back between adjacent points of the grid."""
    margins = list(map(abs, margin(grid)))
    spans: list[tuple[float, float]] = []
    for i in range(1, len(grid) - 1):
        left, middle, right = margins[i - 1 : i + 2]
        second_difference = left - 2.0 * middle + right
        is_low = middle <= left and middle <= right and 0.0 < second_difference < math.inf
        if not is_low or not branches[i - 1] == branches[i] == branches[i + 1]:
            continue
        if (
            middle > (right - left) ** 2 / (8.0 * second_difference) + second_difference
        ):  # the parabola through the three stays well away
            continue
        a, b = grid[i - 1], grid[i + 1]
        for _ in range(60):  # ternary search of the least margin; 60 steps reach the resolution of doubles
            c, d = a + (b - a) / 3.0, b - (b - a) / 3.0
            changed = [t for t, branch in zip((c, d), decide([c, d]), strict=True) if branch != branches[i]]
            if changed:
                spans += [(grid[i - 1], changed[0]), (changed[0], grid[i + 1])]
                break
            left, right = margin([c, d])
            a, b = (a, d) if abs(left) <= abs(right) else (c, b)
    return spans
