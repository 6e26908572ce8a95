"""Expressions as flat programs of numbers, and the packs in which the kernel runs them.

An Expression is what a user wrote, read once: a program for kernel/expressions.py with its own constants and tables.
A Pack joins the programs of many expressions in the arrays the kernel takes.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Sequence
from copy import copy
from functools import cached_property

from heuncli.base.errors import SourceLocation
from heuncli.base.records import record, replace
from heuncli.kernel.choose import enclosure, expressions, jets

OPS = expressions.OPERATIONS
CONST, VAR, TABLE, KNOT, HOLD = OPS["const"], OPS["var"], OPS["table"], OPS["knot"], OPS["hold"]
INTEGRAL = OPS["integral"]

TIME = "t"
Variable = str | tuple[str, str]  # the time, or (joint, quantity)
OWN = "own"  # what a load acts between, until it is told which load that is
LOADS = "forces"  # begins the name of a load in `uses`, as in forces.buffer
POINTS = "points"  # begins the name of a point, as in points.drill.bit
Code = tuple[int, ...]  # pairs (operation, argument), one after another


def is_of_point(name: str) -> bool:
    """Whether it is a point's name in `uses`, and not a joint's."""
    return name.startswith(f"{POINTS}.")


def is_of_load(name: str) -> bool:
    """Whether it is a load's name in `uses`."""
    return name.startswith(f"{LOADS}.")


HELD, PERIODIC = 1, 2  # kinds of tables: held beyond their ends, or going on


@record
class TableFunction:
    """A function given by points, as the kernel reads it: a piecewise cubic.

    numbers: period, knots (pieces + 1), four coefficients a piece; kind: outside is 0 refused, 1 held, 2 periodic.
    x and y are the points as given, in SI; dimensions: of the columns that have a unit.
    """

    name: str
    pieces: int
    kind: int
    numbers: array[float]
    x: array[float]
    y: array[float]
    interpolation: str = "linear"
    dimensions: tuple[tuple[int, int, int] | None, tuple[int, int, int] | None] = (None, None)


def outside(table: TableFunction) -> tuple[str, str]:
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
    of angle, rate, travel, speed, or (points.BODY.POINT, quantity) with one of x, y, z, vx, vy, vz, or (forces.LOAD,
    quantity) with one of length, speed, shift_x, ... turn_z. code refers to
    constants, tables, and to variables: 0 is t, 1 + i is uses[i].
    held says for each branch in coordinates, by the number of its HOLD instruction, what it is a branch of.
    """

    source: str
    constant: float | None
    uses: tuple[tuple[str, str], ...] = ()
    time_dependent: bool = False
    location: SourceLocation | None = None
    code: Code = ()
    constants: tuple[float, ...] = ()
    tables: tuple[TableFunction, ...] = ()
    switches: tuple[Switch, ...] = ()
    held: tuple[str, ...] = ()
    dimension: tuple[int, int, int] | None = None  # where it was written with a unit
    is_truth: bool = False  # 1 or 0, and it changes where a branch of its own does

    @classmethod
    def of(cls, value: float, location: SourceLocation | None = None) -> Expression:
        """The expression that is one number."""
        return cls(source=repr(value), constant=value, location=location, code=(CONST, 0), constants=(value,))

    def at(self, location: SourceLocation) -> Expression:
        """The same expression, with its place in a file."""
        return replace(self, location=location)

    def named(self, source: str) -> Expression:
        """The same expression, with what it is called where it is told of."""
        return replace(self, source=source)

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

    def course(self, times: Sequence[float]) -> list[array[float]]:
        """Values, first and second time derivatives at instants, for an expression of time alone; NaN where none is."""
        return self.pack.course(0, self.count, times)

    def bounds(self, begins: Sequence[float], ends: Sequence[float]) -> tuple[array[float], array[float]]:
        """Least and largest values over stretches of time, seen or not, for an expression of time alone."""
        return self.pack.bounds(0, self.count, begins, ends)

    @property
    def count(self) -> int:
        """Length of the program in pairs."""
        return len(self.code) // 2


class Pack:
    """Programs side by side: code (int pairs), constants, variables, the numbers of tables, and where each begins.

    `variables[0]` is "t", the others are (joint, quantity) in the order in which the kernel takes them. `branches` are
    the branches in coordinates, in the order in which the kernel holds them: of which expression, and which of its own.
    """

    def __init__(self) -> None:
        self.code = array("i")
        self.constants = array("d", [0.0])  # never empty, so that the kernel may take its address
        self.starts: list[int] = []
        self.variables: list[Variable] = [TIME]
        self.branches: list[tuple[Expression, int]] = []
        self._places: dict[Variable, int] = {TIME: 0}
        self.tables: list[array[float]] = []  # those of the tables themselves, which all packs share
        self._tables: dict[int, int] = {}
        self._expressions: expressions.Expressions | None = None

    @property
    def expressions(self) -> expressions.Expressions:
        """The programs as the kernel runs them; made anew only where programs were added since."""
        if self._expressions is None:
            self._expressions = expressions.Expressions(
                self.code, self.constants, len(self.variables), self.held, self.starts, self.tables
            )
        return self._expressions

    @property
    def held(self) -> int:
        """How many branches in coordinates there are."""
        return len(self.branches)

    def with_constants(self, constants: array[float]) -> Pack:
        """The same programs with other constants; nothing is to be added to them."""
        other = copy(self)
        other.constants, other._expressions = constants, None
        return other

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
            elif op == INTEGRAL:
                argument, is_data = argument + first, True
            elif op == HOLD:
                argument += held
            self.code.extend((op, argument))
        self.starts.append(start)
        return start, len(code) // 2

    def _table(self, table: TableFunction) -> int:
        if id(table.numbers) not in self._tables:
            self._tables[id(table.numbers)] = len(self.tables)
            self.tables.append(table.numbers)
        return self._tables[id(table.numbers)]

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
        value, rate, second = jets.derivatives(self.expressions, start, count, t)
        return value, rate, second

    def sample(self, start: int, count: int, times: Sequence[float]) -> array[float]:
        """Values of one program in time alone at instants."""
        out = array("d", bytes(8 * len(times)))
        self.expressions.sample(start, count, array("d", times), out)
        return out

    def course(self, start: int, count: int, times: Sequence[float]) -> list[array[float]]:
        """Values, first and second time derivatives of one program in time alone at instants."""
        columns = [array("d", bytes(8 * len(times))) for _ in range(3)]
        jets.derivatives_over(self.expressions, start, count, array("d", times), *columns)
        return columns

    def spans(self, start: int, count: int, begins: Sequence[float], ends: Sequence[float]) -> list[array[float]]:
        """Least and largest value, and least and largest rate, of one program in time alone over stretches of time."""
        columns = [array("d", bytes(8 * len(begins))) for _ in range(4)]
        enclosure.spans_over(self.expressions, start, count, array("d", begins), array("d", ends), *columns)
        return columns

    def bounds(
        self, start: int, count: int, begins: Sequence[float], ends: Sequence[float]
    ) -> tuple[array[float], array[float]]:
        """Least and largest values of one program in time alone over stretches of time; NaN where it has none."""
        least, largest = (array("d", bytes(8 * len(begins))) for _ in range(2))
        enclosure.bounds_over(self.expressions, start, count, array("d", begins), array("d", ends), least, largest)
        return least, largest


def pack_of(values: Iterable[Expression]) -> Pack:
    """The pack of some programs, in their order."""
    pack = Pack()
    for value in values:
        pack.add(value)
    return pack
