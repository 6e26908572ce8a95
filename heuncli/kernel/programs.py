"""The structs of expressions: programs, their operands and their results (evaluator.py, jets.py, enclosure.py)."""

from __future__ import annotations

from array import array

from heuncli.kernel.structs import Size, Struct, Value

# Operations, in the order in which they are distinguished: without operands, of two, of one, and the others.
CONST, VAR = range(2)
ADD, SUB, MUL, DIV, POW, ATAN2, HYPOT, MIN, MAX = range(2, 11)
NEG, POWER, ABS, SIGN, STEP = range(11, 16)
SIN, COS, TAN, ASIN, ACOS, ATAN = range(16, 22)
SINH, COSH, TANH, EXP, LOG, SQRT = range(22, 28)
TABLE, KNOT, JUMP, UNLESS = range(28, 32)
LT, LE, GT, GE, EQ, NE = range(32, 38)
HOLD, INTEGRAL = range(38, 40)
NODES = 8  # quadrature nodes: exact for polynomials of degree 15

FREE, HELD, TAKEN = range(3)  # what HOLD means
REFUSED, EXTENDED, PERIODIC = range(3)  # what a table says beyond its ends


class Instruction(Value):
    """An operation and its argument."""

    op: int
    argument: int


class Program(Value):
    """`count` instructions from number `start`; count is 0 if a number is used instead of a program."""

    start: int
    count: int


class Jet(Value):
    """A value with its first and second derivative in time."""

    value: float
    rate: float
    second: float


class Table(Value):
    """A table among the constants: the positions of its knots and coefficients."""

    pieces: int
    outside: int
    period: float
    knots: Size
    coefficients: Size


class Bounds(Value):
    """The smallest and the largest that a number may be."""

    low: float
    high: float


class Span(Value):
    """Bounds of a value, its rate and its second derivative over an interval of time."""

    value: Bounds
    rate: Bounds
    second: Bounds


class Programs(Struct):
    """Programs side by side, the data they refer to, the stacks they run on, and the branches they hold."""

    code: list[Instruction]
    constants: list[float]
    tables: list[array[float]]
    variables: list[float]
    stack: list[float]
    jets: list[Jet]
    branches: list[float]
    holding: int
    doubt: list[int]  # whether each held branch may change over the interval of time
    ranges: list[Span]  # ranges of the variables over a time interval
    middles: list[Span]  # and at an instant of it
    spans: list[Span]
