"""Represent expressions as flat programs of numbers, and join them in the packs that the kernel runs.

An Expression is what a user wrote, parsed once: a program for kernel/expressions.py with its own constants and tables.
A Pack joins the programs of many expressions in the arrays that the kernel takes.
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
OWN = "own"  # placeholder for a load in `uses`, until its name is known
LOADS = "forces"  # prefix of a load's name in `uses`, as in forces.buffer
POINTS = "points"  # prefix of a point's name, as in points.drill.bit
Code = tuple[int, ...]  # pairs (operation, argument), one after another


def is_point_name(name: str) -> bool:
    """Return whether a name in `uses` is a point's, and not a joint's."""
    return name.startswith(f"{POINTS}.")


def is_load_name(name: str) -> bool:
    """Return whether a name in `uses` is a load's."""
    return name.startswith(f"{LOADS}.")


HELD, PERIODIC = 1, 2  # kinds of tables: constant beyond their ends, or periodic


@record
class TableFunction:
    """A function given by points, in the kernel's form: a piecewise cubic.

    numbers: period, knots (pieces + 1), four coefficients a piece
    kind: outside its range it is 0 undefined, 1 constant, 2 periodic
    x, y: the given points [SI]
    dimensions: of the columns that have a unit
    notes: on what was done to the given points
    """

    name: str
    pieces: int
    kind: int
    numbers: array[float]
    x: array[float]
    y: array[float]
    interpolation: str = "linear"
    dimensions: tuple[tuple[int, int, int] | None, tuple[int, int, int] | None] = (None, None)
    notes: tuple[str, ...] = ()


def out_of_range_texts(table: TableFunction) -> tuple[str, str]:
    """Return the message and the hint for an argument outside a table's range."""
    message = f"table {table.name} covers x from {table.x[0]:.9g} to {table.x[-1]:.9g} (SI)"
    return message, "extend the table, or set period or outside: hold"


@record
class Switch:
    """A place in an expression where a branch may change with time alone.

    decision: program whose value identifies the branch
    margin: program that passes through zero where the branch changes, or None (tables)
    """

    decision: Code
    margin: Code | None


@record
class Expression:
    """A number that may depend on time and on coordinates; SI.

    constant: its value if it depends on neither
    uses: the coordinates, as (joint, quantity) with quantity one of angle, rate, travel, speed, or (points.BODY.POINT,
    quantity) with one of x, y, z, vx, vy, vz, or (forces.LOAD, quantity) with one of length, speed, shift_x, ... turn_z
    code: refers to constants, tables, and to variables: 0 is t, 1 + i is uses[i]
    held_branches: for each branch that depends on coordinates, by the number of its HOLD instruction, the text of its
    condition
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
    held_branches: tuple[str, ...] = ()
    dimension: tuple[int, int, int] | None = None  # if it was written with a unit
    is_truth: bool = False  # it is 1 or 0, and changes only where one of its branches does
    is_condition: bool = False  # it is written as a condition, such as t > 1: no value for a key that takes a number

    @classmethod
    def from_number(cls, value: float, location: SourceLocation | None = None) -> Expression:
        """Make the expression that is one number."""
        return cls(source=repr(value), constant=value, location=location, code=(CONST, 0), constants=(value,))

    def with_location(self, location: SourceLocation) -> Expression:
        """Return the same expression with its location in a file."""
        return replace(self, location=location)

    def with_source(self, source: str) -> Expression:
        """Return the same expression with another name for messages."""
        return replace(self, source=source)

    @cached_property
    def pack(self) -> Pack:
        """A pack of this expression alone, whose program starts at 0."""
        pack = Pack()
        pack.add(self)
        return pack

    def value(self, t: float = 0.0, coordinates: Sequence[float] = ()) -> float:
        """Return the value at an instant, with coordinates in the order of `uses`; NaN if it cannot be computed."""
        if self.constant is not None:
            return self.constant
        return self.pack.value(0, self.count, [t, *coordinates])

    def derivatives(self, t: float) -> tuple[float, float, float]:
        """Return value, first and second time derivative; NaN for an expression of coordinates."""
        return self.pack.derivatives(0, self.count, t)

    def sample(self, times: Sequence[float]) -> array[float]:
        """Return the values at instants, for an expression of time alone."""
        return self.pack.sample(0, self.count, times)

    def sample_derivatives(self, times: Sequence[float]) -> list[array[float]]:
        """Return values, first and second time derivatives at instants, for an expression of time alone; NaN where
        undefined.
        """
        return self.pack.sample_derivatives(0, self.count, times)

    def bounds(self, begins: Sequence[float], ends: Sequence[float]) -> tuple[array[float], array[float]]:
        """Return enclosures of the values over intervals of time, for an expression of time alone."""
        return self.pack.bounds(0, self.count, begins, ends)

    @property
    def count(self) -> int:
        """The length of the program in pairs."""
        return len(self.code) // 2


class Pack:
    """Programs one after another, with common arrays of code (int pairs), constants, variables and tables, and their
    starts.

    variables: [0] is "t", the others are (joint, quantity) in the order in which the kernel takes them
    branches: the branches that depend on coordinates, in the order in which the kernel holds them, as (expression,
    index in it)
    """

    def __init__(self) -> None:
        self.code = array("i")
        self.constants = array("d", [0.0])  # never empty, so that the kernel may take its address
        self.starts: list[int] = []
        self.variables: list[Variable] = [TIME]
        self.branches: list[tuple[Expression, int]] = []
        self._variable_index: dict[Variable, int] = {TIME: 0}
        self.tables: list[array[float]] = []  # the arrays of the tables themselves, shared by all packs
        self._table_index: dict[int, int] = {}
        self._expressions: expressions.Expressions | None = None

    @property
    def expressions(self) -> expressions.Expressions:
        """The programs in the kernel's form; built again only after programs were added."""
        if self._expressions is None:
            self._expressions = expressions.Expressions(
                self.code, self.constants, len(self.variables), self.branch_count, self.starts, self.tables
            )
        return self._expressions

    @property
    def branch_count(self) -> int:
        """The number of branches that depend on coordinates."""
        return len(self.branches)

    def with_constants(self, constants: array[float]) -> Pack:
        """Return the same programs with other constants; nothing may be added to them."""
        other = copy(self)
        other.constants, other._expressions = constants, None
        return other

    def add(self, expression: Expression) -> tuple[int, int]:
        """Append a program; returns its first pair and its number of pairs."""
        return self.add_code(expression, expression.code)

    def add_code(self, expression: Expression, code: Code) -> tuple[int, int]:
        """Append a program that refers to the expression's constants, tables and variables."""
        first = len(self.constants)
        self.constants.extend(expression.constants)
        tables = [self._add_table(table) for table in expression.tables]
        variables = [0, *(self._add_variable(use) for use in expression.uses)]
        branch_count = self.branch_count
        self.branches.extend((expression, k) for k in range(len(expression.held_branches)))
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
                argument += branch_count
            self.code.extend((op, argument))
        self.starts.append(start)
        return start, len(code) // 2

    def _add_table(self, table: TableFunction) -> int:
        if id(table.numbers) not in self._table_index:
            self._table_index[id(table.numbers)] = len(self.tables)
            self.tables.append(table.numbers)
        return self._table_index[id(table.numbers)]

    def _add_variable(self, use: Variable) -> int:
        if use not in self._variable_index:
            self._variable_index[use] = len(self.variables)
            self.variables.append(use)
        return self._variable_index[use]

    def value(self, start: int, count: int, x: Sequence[float]) -> float:
        """Return the value of one program at x, in the order of `variables`; NaN if it cannot be computed."""
        return float(self.expressions.evaluate(start, count, x))

    def derivatives(self, start: int, count: int, t: float) -> tuple[float, float, float]:
        """Return value, first and second time derivative of one program in time alone."""
        value, rate, second = jets.find_derivatives(self.expressions, start, count, t)
        return value, rate, second

    def sample(self, start: int, count: int, times: Sequence[float]) -> array[float]:
        """Return the values of one program in time alone at instants."""
        out = array("d", bytes(8 * len(times)))
        self.expressions.sample(start, count, array("d", times), out)
        return out

    def sample_derivatives(self, start: int, count: int, times: Sequence[float]) -> list[array[float]]:
        """Return values, first and second time derivatives of one program in time alone at instants."""
        columns = [array("d", bytes(8 * len(times))) for _ in range(3)]
        jets.sample_derivatives(self.expressions, start, count, array("d", times), *columns)
        return columns

    def bound_with_rates(
        self, start: int, count: int, begins: Sequence[float], ends: Sequence[float]
    ) -> list[array[float]]:
        """Return least and largest value, and least and largest rate, of one program in time alone over intervals of
        time.
        """
        bounds = array("d", bytes(8 * 4 * len(begins)))
        enclosure.find_natural_bounds(self.expressions, start, count, array("d", begins), array("d", ends), bounds)
        return [bounds[k::4] for k in range(4)]

    def bounds(
        self, start: int, count: int, begins: Sequence[float], ends: Sequence[float]
    ) -> tuple[array[float], array[float]]:
        """Return least and largest values of one program in time alone over intervals of time; NaN where undefined."""
        least, largest = (array("d", bytes(8 * len(begins))) for _ in range(2))
        enclosure.find_bounds(self.expressions, start, count, array("d", begins), array("d", ends), least, largest)
        return least, largest


def make_pack(values: Iterable[Expression]) -> Pack:
    """Make the pack of some programs, in their order."""
    pack = Pack()
    for value in values:
        pack.add(value)
    return pack
