"""Expressions as flat programs of numbers, and the packs in which the kernel runs them.

An Expression is what a user wrote, read once: a program for kernel/expressions.py with its own constants and tables.
A Pack joins the programs of many expressions in the arrays the kernel takes.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Sequence
from functools import cached_property

from heuncli.errors import LimitError, Problem, SourceLocation
from heuncli.kernel.choose import enclosure, expressions
from heuncli.records import record, replace

OPS = expressions.OPERATIONS
CONST, VAR, TABLE, KNOT, HOLD = OPS["const"], OPS["var"], OPS["table"], OPS["knot"], OPS["hold"]

TIME = "t"
Variable = str | tuple[str, str]  # the time, or (joint, quantity)
COARSEST, FINEST = 1 << 12, 1 << 20  # cells of the grids on which branches are looked for
CELLS_PER_CHANGE = 16  # a grid with fewer is not fine enough to trust
Code = tuple[int, ...]  # pairs (operation, argument), one after another


@record
class Table:
    """A function given by points, as the kernel reads it: a piecewise cubic.

    numbers: period, knots (pieces + 1), four coefficients a piece; kind: outside is 0 refused, 1 held, 2 periodic.
    x and y are the points as given, in SI.
    """

    name: str
    pieces: int
    kind: int
    numbers: tuple[float, ...]
    x: tuple[float, ...] = ()
    y: tuple[float, ...] = ()
    interpolation: str = "linear"


def outside(table: Table) -> tuple[str, str]:
    """What to say where a table's range is left, and a hint."""
    message = f"the table {table.name} covers x from {table.x[0]:.9g} to {table.x[-1]:.9g} (SI)"
    return message, "extend the table, or give it a period, or outside: hold"


@record
class Switch:
    """A place in an expression where a branch may change with time alone.

    decision: program whose value tells the branch; margin: program that passes through zero where the branch changes,
    or None (tables).
    """

    decision: Code
    margin: Code | None


@record
class Expression:
    """A number that may depend on time and on coordinates of joints; SI.

    constant is its value when it depends on neither. uses lists the coordinates, as (joint, quantity) with quantity one
    of angle, rate, travel, speed. code refers to constants, tables, and to variables: 0 is t, 1 + i is uses[i].
    held says for each branch in coordinates, by the number of its HOLD instruction, what it is a branch of.
    """

    source: str
    constant: float | None
    uses: tuple[tuple[str, str], ...] = ()
    time_dependent: bool = False
    location: SourceLocation | None = None
    code: Code = ()
    constants: tuple[float, ...] = ()
    tables: tuple[Table, ...] = ()
    switches: tuple[Switch, ...] = ()
    held: tuple[str, ...] = ()
    dimension: tuple[int, int, int] | None = None  # where it was written with a unit

    @classmethod
    def of(cls, value: float, location: SourceLocation | None = None) -> Expression:
        """The expression that is one number."""
        return cls(source=repr(value), constant=value, location=location, code=(CONST, 0), constants=(value,))

    def at(self, location: SourceLocation) -> Expression:
        """The same expression, with its place in a file."""
        return replace(self, location=location)

    @cached_property
    def pack(self) -> Pack:
        """A pack of this expression alone, its program from 0."""
        pack = Pack()
        pack.add(self)
        return pack

    def value(self, t: float = 0.0, coordinates: Sequence[float] = ()) -> float:
        """Value at an instant, with coordinates in the order of `uses`; NaN when not computable."""
        if self.constant is not None:
            return self.constant
        return self.pack.value(0, self.count, [t, *coordinates])

    def derivatives(self, t: float) -> tuple[float, float, float]:
        """Value, first and second time derivative; NaN for an expression of coordinates."""
        return self.pack.derivatives(0, self.count, t)

    def sample(self, times: Sequence[float]) -> array[float]:
        """Values at instants, for an expression of time alone."""
        return self.pack.sample(0, self.count, times)

    def bounds(self, begins: Sequence[float], ends: Sequence[float]) -> tuple[array[float], array[float]]:
        """Least and largest values over stretches of time, seen or not, for an expression of time alone."""
        return self.pack.bounds(0, self.count, begins, ends)

    @property
    def count(self) -> int:
        """Length of the program in pairs."""
        return len(self.code) // 2


class Pack:
    """Programs side by side: code (int pairs), constants and tables, variables, and the depth of the deepest.

    `variables[0]` is "t", the others are (joint, quantity) in the order in which the kernel takes them. `branches` are
    the branches in coordinates, in the order in which the kernel holds them: of which expression, and which of its own.
    """

    def __init__(self) -> None:
        self.code = array("i")
        self.constants = array("d", [0.0])  # never empty, so that the kernel may take its address
        self.depth = 1
        self.variables: list[Variable] = [TIME]
        self.branches: list[tuple[Expression, int]] = []
        self._places: dict[Variable, int] = {TIME: 0}
        self._tables: dict[int, tuple[int, Table]] = {}
        self._expressions: expressions.Expressions | None = None

    @property
    def expressions(self) -> expressions.Expressions:
        """The programs as the kernel runs them; made anew only where programs were added since."""
        if self._expressions is None:
            self._expressions = expressions.Expressions(
                self.code, self.constants, len(self.variables), self.depth, self.held
            )
        return self._expressions

    @property
    def held(self) -> int:
        """How many branches in coordinates there are."""
        return len(self.branches)

    def add(self, expression: Expression) -> tuple[int, int]:
        """Append a program; gives its first pair and its number of pairs."""
        return self.add_code(expression, expression.code)

    def add_code(self, expression: Expression, code: Code) -> tuple[int, int]:
        """Append a program that refers to the expression's constants, tables and variables."""
        first = len(self.constants)
        self.constants.extend(expression.constants)
        tables = [self._table(table) for table in expression.tables]
        variables = [0, *(self._variable(use) for use in expression.uses)]
        held = self.held
        self.branches.extend((expression, k) for k in range(len(expression.held)))
        start = len(self.code) // 2
        self._expressions = None
        is_data = False
        for op, argument in zip(code[::2], code[1::2], strict=True):
            if is_data:
                is_data = False
            elif op == CONST:
                argument += first
            elif op == VAR:
                argument = variables[argument]
            elif op in (TABLE, KNOT):
                argument, is_data = tables[argument], True
            elif op == HOLD:
                argument += held
            self.code.extend((op, argument))
        self.depth = max(self.depth, expressions.stack_depth(code))
        return start, len(code) // 2

    def _table(self, table: Table) -> int:
        if id(table) not in self._tables:
            self._tables[id(table)] = len(self.constants), table
            self.constants.extend(table.numbers)
        return self._tables[id(table)][0]

    def _variable(self, use: Variable) -> int:
        if use not in self._places:
            self._places[use] = len(self.variables)
            self.variables.append(use)
        return self._places[use]

    def value(self, start: int, count: int, x: Sequence[float]) -> float:
        """Value of one program at x, in the order of `variables`; NaN when not computable."""
        return float(self.expressions.evaluate(start, count, x))

    def derivatives(self, start: int, count: int, t: float) -> tuple[float, float, float]:
        """Value, first and second time derivative of one program in time alone."""
        value, rate, second = self.expressions.derivatives(start, count, t)
        return value, rate, second

    def sample(self, start: int, count: int, times: Sequence[float]) -> array[float]:
        """Values of one program in time alone at instants."""
        out = array("d", bytes(8 * len(times)))
        self.expressions.sample(start, count, array("d", times), out)
        return out

    def bounds(
        self, start: int, count: int, begins: Sequence[float], ends: Sequence[float]
    ) -> tuple[array[float], array[float]]:
        """Least and largest values of one program in time alone over stretches of time; NaN where it has none."""
        least, largest = (array("d", bytes(8 * len(begins))) for _ in range(2))
        enclosure.bounds_over(self.expressions, start, count, array("d", begins), array("d", ends), least, largest)
        return least, largest


def discontinuities(expression: Expression, t0: float, t1: float) -> list[float]:
    """The instants in (t0, t1) at which a branch of the expression changes with time alone: its jumps and kinks.

    Each is the first double at which the new branch holds; two may be neighbours (sign at its zero): then the segment
    between them is a single instant, to be stepped over. Branches that depend on coordinates are left out. Raises
    LimitError where there are too many to tell apart.
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


def _changes(expression: Expression, switch: Switch, t0: float, t1: float) -> list[float]:
    """Where one switch changes: seen on a grid, refined until it has many cells for each change it shows."""
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
    return [t for low, high in spans for t in _between(decide, low, high) if t0 < t < t1]


def _at_instants(expression: Expression, code: Code) -> Callable[[list[float]], list[float]]:
    """A program in time alone as a function of instants; inf stands for what is no number, which is a branch, too."""
    pack = Pack()
    start, count = pack.add_code(expression, code)

    def values(times: list[float]) -> list[float]:
        return [v if v == v else math.inf for v in pack.sample(start, count, times)]

    return values


def _between(decide: Callable[[list[float]], list[float]], low: float, high: float) -> list[float]:
    """Changes of branch in (low, high], from left to right, each found to the last bit."""
    instants: list[float] = []
    branch, end = decide([low, high])
    while branch != end:
        a, b = low, high
        while a < (middle := a + 0.5 * (b - a)) < b:
            if decide([middle])[0] == branch:
                a = middle
            else:
                b = middle
        instants.append(b)
        low, branch = b, decide([b])[0]
    return instants


def _near_zeros(
    margin: Callable[[list[float]], list[float]],
    grid: list[float],
    branches: list[float],
    decide: Callable[[list[float]], list[float]],
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
