"""The structs of expressions.pxd as plain classes, for the kernel that is not compiled."""

from __future__ import annotations


class Instruction:
    """An operation and its argument."""

    __slots__ = ("argument", "op")

    def __init__(self, op: int, argument: int) -> None:
        self.op = op
        self.argument = argument


class Program:
    """`count` instructions from number `start`; none where a number stands in the program's stead."""

    __slots__ = ("count", "start")

    def __init__(self, start: int, count: int) -> None:
        self.start = start
        self.count = count


class Jet:
    """A value with its first and second derivative in time; never changed in place."""

    __slots__ = ("rate", "second", "value")

    def __init__(self, value: float, rate: float, second: float) -> None:
        self.value = value
        self.rate = rate
        self.second = second


class Table:
    """A table among the constants: its knots and coefficients begin at these places."""

    __slots__ = ("coefficients", "knots", "outside", "period", "pieces")

    def __init__(self, pieces: int, outside: int, period: float, knots: int, coefficients: int) -> None:
        self.pieces = pieces
        self.outside = outside
        self.period = period
        self.knots = knots
        self.coefficients = coefficients


class Programs:
    """Programs side by side, what they point into, and the stacks they run on."""

    __slots__ = ("code", "constants", "jets", "stack", "variables")

    code: list[Instruction]
    constants: list[float]
    variables: list[float]
    stack: list[float]
    jets: list[Jet]
