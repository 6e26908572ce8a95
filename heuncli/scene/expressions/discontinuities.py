"""Where the branches of an expression change with time alone: its jumps and kinks.

A change is decided, not sampled: an enclosure (kernel/enclosure.py) of what tells the branch shows that nothing changes
within a stretch of time, or that its margin only rises or falls there, so that the branches at the ends tell all; else
the stretch is halved, down to neighbouring doubles.
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

COARSEST, FINEST = 1 << 12, 1 << 20  # cells of the grids on which branches are looked for
CELLS_PER_CHANGE = 16  # a grid with fewer is not fine enough to trust
FIRST_CELLS = 256  # of a stretch looked at first
MOST_EQUAL = 4096  # doubles before a change of branch at which rounding may make the operands equal, one discontinuity
LOOKED_AT = 1000  # equal parts of a run, at whose ends the sign of a value is looked at
MOST_OPEN = 1 << 13  # stretches open at once; margins that are zero but for rounding have as many as there are doubles
OF_TIME = (VAR, 0)  # the program that is the time itself
RISING = frozenset(OPS[name] for name in ("sign", "step", "lt", "le", "gt", "ge"))  # rise or fall with their margin
Decide = Callable[[list[float]], list[float]]
Enclose = Callable[[list[float], list[float]], Sequence[Sequence[float]]]


def discontinuities(expression: Expression, t0: float, t1: float) -> list[float]:
    """The instants in (t0, t1) at which a branch of the expression changes with time alone: its jumps and kinks.

    Each is the first double at which the new branch holds; neighbours (sign at its zero, min(t, 1) at t = 1) leave a
    single instant between them, to be stepped over. Branches that depend on coordinates are left out. Raises LimitError
    where there are too many to tell apart.
    """
    return sorted({t for switch in expression.switches for t in _changes(expression, switch, t0, t1)})


def one_sided_limits(instants: Sequence[float]) -> list[tuple[float, float]]:
    """For each of ascending discontinuities the last instant before it and the first after it.

    Neighbouring doubles are one discontinuity: sign(t - 1) is zero at t = 1 alone, and its limits are those of the
    branches before and after that instant.
    """
    limits: list[tuple[float, float]] = []
    for t in instants:
        before = math.nextafter(t, -math.inf)
        if limits and limits[-1][1] >= before:
            limits[-1] = (limits[-1][0], t)
        else:
            limits.append((before, t))
    return limits


def beyond(last: float) -> float:
    """An instant behind the end of a run, up to which its last discontinuity may reach by rounding."""
    return last * (1.0 + 2.0 * MOST_EQUAL * tolerances.EPS)


def breaks_within(value: Expression, last: float) -> list[float]:
    """The discontinuities within (0, last], ascending, as `discontinuities` tells them.

    One that stands at the end of the run is told whole, also where by rounding its new branch begins just behind: a run
    that ends at a jump tells what is after it, whichever way the jump is written. It is left out where there is no
    value behind, as behind the end of a table.
    """
    if not last > 0.0:
        return []
    instants = discontinuities(value, 0.0, beyond(last))
    if not instants or instants[-1] <= last:
        return instants
    before, after = one_sided_limits(instants)[-1]
    inside = [t for t in instants if t <= before]
    return inside if before >= last or _ends_between(value, before, after) else instants


def _ends_between(value: Expression, before: float, after: float) -> bool:
    """Whether a value has a number at the one instant and none at the other; what else it depends on is taken as 1."""
    there = [math.isfinite(value.value(t, [1.0] * len(value.uses))) for t in (before, after)]
    return there[0] and not there[1]


def changes(value: Expression, last: float) -> list[tuple[float, float]]:
    """The last instant before and the first after each change of branch within the run, not what is at 0 alone."""
    return [(before, after) for before, after in one_sided_limits(breaks_within(value, last)) if before > 0.0]


def jumps(value: Expression, last: float, order: int = 0) -> list[tuple[float, float, float, float]]:
    """Where a value, or its derivative of an order, jumps within (0, last]: instants before and behind, and limits."""
    found = []
    for before, after in changes(value, last):
        first, then = value.derivatives(before)[order], value.derivatives(after)[order]
        if abs(then - first) > tolerances.SAME_VALUE * max(abs(first), abs(then), 1.0):
            found.append((before, after, first, then))
    return found


def first_not_positive(value: Expression, last: float) -> float | None:
    """The first of many instants of a run, those beside jumps and kinks among them, at which a value is not above 0."""
    return next((t for t in looked_at(value, last) if value.value(t) <= 0.0), None)


def first_negative(value: Expression, last: float) -> float | None:
    """The first of the same instants at which a value is below 0 by more than rounding."""
    seen = [(t, value.value(t)) for t in looked_at(value, last)]
    rounding = tolerances.SAME_VALUE * max((abs(x) for _, x in seen), default=0.0)
    return next((t for t, x in seen if x < -rounding), None)


def looked_at(value: Expression, last: float) -> list[float]:
    """Many instants of a run, those beside jumps and kinks among them."""
    grid = {last * k / LOOKED_AT for k in range(LOOKED_AT + 1)}
    grid.update(t for pair in changes(value, last) for t in pair)
    return sorted(grid)


def _changes(expression: Expression, switch: Switch, t0: float, t1: float) -> list[float]:
    """Where one switch changes, decided; where that has no end, as seen on a grid, too."""
    if switch.decision[:2] == OF_TIME and switch.decision[2] == KNOT and switch.decision[5] != PERIODIC:
        return _knots(expression.tables[switch.decision[3]], t0, t1)
    found = SwitchSearch(expression, switch, Grid(t0, t1, COARSEST)).changes()
    found = _seen(expression, switch, t0, t1) if found is None else found
    return [t for t in (*found, *_edges(expression, switch, found)) if t0 < t < t1]


def _knots(table: TableFunction, t0: float, t1: float) -> list[float]:
    """Where a table of the time itself goes from piece to piece: at its points.

    The last one is computed on the last piece. Where the table is held beyond, what is held begins there.
    These are the doubles that a search finds, to the last bit; of a million of them it takes minutes.
    """
    inner = table.x[bisect_right(table.x, t0) : bisect_left(table.x, t1)]
    last = table.x[-1]
    ends = {last, math.nextafter(last, math.inf)} if table.kind == HELD else {math.nextafter(last, math.inf)}
    return [t for t in (*(t for t in inner if t < last), *sorted(ends)) if t0 < t < t1]


def _edges(expression: Expression, switch: Switch, changes: Sequence[float]) -> list[float]:
    """The instants just before changes of branch at which rounding cannot tell the old branch from the new one."""
    if not changes:
        return []
    from heuncli.scene.expressions.tied_branches import tied_instants  # NumPy, which a check of a spec does without

    margin = switch.decision[:-4] if switch.margin is None else switch.margin
    table = None if switch.margin is not None else expression.tables[switch.decision[-3]]
    enclose, compute = _over_stretches(expression, margin), _at_instants(expression, margin)
    return tied_instants(changes, enclose, compute, table, MOST_EQUAL)


@record
class Grid:
    """The instants t0 + (t1 - t0) i / cells; the last one lies before t1."""

    t0: float
    t1: float
    cells: int

    def __getitem__(self, i: int) -> float:
        if i == self.cells:
            return math.nextafter(self.t1, -math.inf)
        return self.t0 + (self.t1 - self.t0) * (i / self.cells)


class SwitchSearch:
    """The search for the changes of one switch over a run."""

    def __init__(self, expression: Expression, switch: Switch, grid: Grid) -> None:
        self.expression, self.switch, self.grid = expression, switch, grid
        self.decide = _at_instants(expression, switch.decision)
        self.decisions = _over_stretches(expression, switch.decision)
        margin = switch.margin or switch.decision[:-4]  # of a table, the argument
        rises = switch.margin is None or switch.decision[-2] in RISING
        self.margins = _over_stretches(expression, margin) if rises else None
        self.branch: dict[float, float] = {}
        self.found: list[float] = []
        self.cells: list[tuple[float, float]] = []  # with changes, at whose ends the branches tell of all

    def changes(self) -> list[float] | None:
        """The first double of each new branch; None where too many stretches stay open."""
        cells = self.grid.cells
        stretches = [
            (i, i + FIRST_CELLS, self.grid[i], self.grid[i + FIRST_CELLS]) for i in range(0, cells, FIRST_CELLS)
        ]
        while stretches:
            if len(stretches) > MOST_OPEN:
                return None
            self.look_at({t for stretch in stretches for t in stretch[2:]})
            stretches = [half for stretch in self.undecided(stretches) for half in self.halves(*stretch)]
        self.require_few()
        return self.found + _between(self.decide, self.cells)

    def require_few(self) -> None:
        """Raise LimitError where the points of a table are too many, which its pieces tell before any is looked for."""
        if self.switch.margin is not None:
            return
        passed = [abs(self.branch[end] - self.branch[begin]) for begin, end in self.cells]
        count = sum(number for number in passed if number < math.inf)  # beyond a table that ends there are none
        if count > tolerances.MOST_STEPS:
            where = f"between {self.grid.t0:g} and {self.grid.t1:g} s"
            message = f"'{self.expression.source}' passes {count:,.0f} points of its table {where}, each a step's end"
            hint = f"at most {tolerances.MOST_STEPS:,} steps are taken: a shorter duration, or a table of fewer points"
            raise LimitError(Problem("too-many-jumps", message, self.expression.location, hint))

    def look_at(self, instants: set[float]) -> None:
        """The branches at instants."""
        new = sorted(instants - self.branch.keys())
        self.branch.update(zip(new, self.decide(new), strict=True))

    def undecided(self, stretches: list[tuple[int, int, float, float]]) -> list[tuple[int, int, float, float]]:
        """The stretches in which there may be changes that are not found yet."""
        begins, ends = [s[2] for s in stretches], [s[3] for s in stretches]
        least, largest, *_ = self.decisions(begins, ends)
        *_, slowest, fastest = self.margins(begins, ends) if self.margins else (least, [math.nan] * len(least))
        open_still = []
        for stretch, low, high, slow, fast in zip(stretches, least, largest, slowest, fastest, strict=True):
            before, after = self.branch[stretch[2]], self.branch[stretch[3]]
            if before == after and (low == high == before or (low != low and before == math.inf)):
                continue
            if (slow > 0.0 or fast < 0.0) and (before != after or before < math.inf):
                self.cells += self.between(*stretch)
            else:
                open_still.append(stretch)
        return open_still

    def halves(self, i: int, j: int, begin: float, end: float) -> list[tuple[int, int, float, float]]:
        """Both halves of a stretch, first by cells of the grid; none of neighbouring doubles: there it changes."""
        if j - i > 1:
            k = (i + j) // 2
            return [(i, k, begin, self.grid[k]), (k, j, self.grid[k], end)]
        middle = begin + 0.5 * (end - begin)
        if begin < middle < end:
            return [(i, i, begin, middle), (i, i, middle, end)]
        if self.branch[begin] != self.branch[end]:
            self.found.append(end)
        return []

    def between(self, i: int, j: int, begin: float, end: float) -> list[tuple[float, float]]:
        """The cells of the grid with changes in a stretch through which the margin rises or falls."""
        if j - i <= 1:
            return [(begin, end)]
        k = (i + j) // 2
        middle = self.grid[k]
        self.look_at({middle})
        return [
            cell
            for half in ((i, k, begin, middle), (k, j, middle, end))
            if self.branch[half[2]] != self.branch[half[3]]
            for cell in self.between(*half)
        ]


def _over_stretches(expression: Expression, code: Code) -> Enclose:
    """A program in time alone as a function of stretches: least and largest value, least and largest rate."""
    pack = Pack()
    start, count = pack.add_code(expression, code)
    return lambda begins, ends: pack.spans(start, count, begins, ends)


def _seen(expression: Expression, switch: Switch, t0: float, t1: float) -> list[float]:
    """Where one switch changes as seen on a grid, refined until it has many cells for each change it shows."""
    decide = _at_instants(expression, switch.decision)
    cells, last = COARSEST, math.nextafter(t1, -math.inf)
    while True:
        grid = [t0 + (t1 - t0) * (i / cells) for i in range(cells)]
        grid.append(last)
        branches = decide(grid)
        changed = [i for i in range(cells) if branches[i] != branches[i + 1]]
        if len(changed) * CELLS_PER_CHANGE <= cells:
            break
        if cells >= FINEST:
            message = f"'{expression.source}' jumps or bends too often between {t0:g} and {t1:g} s"
            hint = f"at most about {FINEST // CELLS_PER_CHANGE} jumps and kinks can be met exactly"
            raise LimitError(Problem("too-many-jumps", message, expression.location, hint))
        cells *= 4
    spans = [(grid[i], grid[i + 1]) for i in changed]
    if switch.margin is not None:
        spans += _near_zeros(_at_instants(expression, switch.margin), grid, branches, decide)
    return _between(decide, spans)


def _at_instants(expression: Expression, code: Code) -> Decide:
    """A program in time alone as a function of instants; inf stands for what is no number, which is a branch, too."""
    pack = Pack()
    start, count = pack.add_code(expression, code)

    def values(times: list[float]) -> list[float]:
        return [v if v == v else math.inf for v in pack.sample(start, count, times)]

    return values


def _between(decide: Decide, spans: Sequence[tuple[float, float]]) -> list[float]:
    """Changes of branch in each (low, high], from left to right, each found to the last bit; all spans together."""
    instants: list[float] = []
    rows = list(zip(spans, decide([low for low, _ in spans]), decide([high for _, high in spans]), strict=True))
    while rows := [row for row in rows if row[1] != row[2]]:
        firsts = _first_changes(decide, [span for span, _, _ in rows], [branch for _, branch, _ in rows])
        instants += firsts
        rows = [((t, span[1]), b, end) for (span, _, end), t, b in zip(rows, firsts, decide(firsts), strict=True)]
    return instants


def _first_changes(decide: Decide, spans: Sequence[tuple[float, float]], branches: Sequence[float]) -> list[float]:
    """Of spans that begin on a branch and end on another the first double of that, by halving."""
    lows, highs = [low for low, _ in spans], [high for _, high in spans]
    wide = list(range(len(spans)))
    while wide:
        middles = [lows[i] + 0.5 * (highs[i] - lows[i]) for i in wide]
        halved = [(i, t) for i, t in zip(wide, middles, strict=True) if lows[i] < t < highs[i]]
        for (i, t), branch in zip(halved, decide([t for _, t in halved]), strict=True):
            if branch == branches[i]:
                lows[i] = t
            else:
                highs[i] = t
        wide = [i for i, _ in halved]
    return highs


def _near_zeros(
    margin: Decide,
    grid: list[float],
    branches: list[float],
    decide: Decide,
) -> list[tuple[float, float]]:
    """Spans in which the margin passes through zero and back between neighbouring points of the grid."""
    margins = list(map(abs, margin(grid)))
    spans: list[tuple[float, float]] = []
    for i in range(1, len(grid) - 1):
        left, middle, right = margins[i - 1 : i + 2]
        bend = left - 2.0 * middle + right
        is_low = middle <= left and middle <= right and 0.0 < bend < math.inf
        if not is_low or not branches[i - 1] == branches[i] == branches[i + 1]:
            continue
        if middle > (right - left) ** 2 / (8.0 * bend) + bend:  # the parabola through the three stays well away
            continue
        a, b = grid[i - 1], grid[i + 1]
        for _ in range(60):  # the least margin by thirds; 60 of them leave nothing of the span
            c, d = a + (b - a) / 3.0, b - (b - a) / 3.0
            other = [t for t, branch in zip((c, d), decide([c, d]), strict=True) if branch != branches[i]]
            if other:
                spans += [(grid[i - 1], other[0]), (other[0], grid[i + 1])]
                break
            left, right = margin([c, d])
            a, b = (a, d) if abs(left) <= abs(right) else (c, b)
    return spans
