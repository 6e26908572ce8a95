"""Determine the dimension of a part of an expression, as far as it is certain.

Only parameters with a unit have a certain dimension. A number without a unit may carry any unit, so what it enters is
free: `m*9.81` may well be a force. Whole numbers up to 9, pi, and the results of sines and ratios are factors that
change no dimension: `L/2`, `pi*r**2`, `F*sin(w*t)`. The time and the coordinates of joints have dimensions only
together with such parameters: `v*t` is a length, `3*t` and `v*t/2` may be anything.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.units import LENGTH, NUMBER, RATE, TIME, VELOCITY, Dimension, describe

MAX_PLAIN_FACTOR = 9  # whole numbers up to this are plain factors; 10 may well be the acceleration of gravity
MAX_POWER = 64  # for higher powers the dimension is unknown


class MeasuredDimension(NamedTuple):
    """A dimension as far as it is certain.

    kind: free: it may be any; factor: it changes none; loose: that of the time or a coordinate alone; known: it is
    certain
    literal, moving: whether a whole number, or the time or a coordinate, is a factor in it. Both together may be a rate
    of any unit.
    """

    kind: Literal["free", "factor", "loose", "known"]
    dimension: Dimension = NUMBER
    literal: bool = False
    moving: bool = False


FREE = MeasuredDimension("free")
FACTOR = MeasuredDimension("factor")
WHOLE = MeasuredDimension("factor", literal=True)
COORDINATES = {  # the coordinates that joints, points and loads have
    "angle": NUMBER, "rate": RATE, "travel": LENGTH, "speed": VELOCITY,
    "length": LENGTH, "deflection": LENGTH, "turn": NUMBER,  # coordinates of loads
    **dict.fromkeys("xyz", LENGTH), **dict.fromkeys(("vx", "vy", "vz"), VELOCITY),
}  # fmt: skip
TIME_DIMENSION = MeasuredDimension("loose", TIME, moving=True)
NUMBER_FUNCTIONS = frozenset({"sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp"})
SUMS = {  # operations whose operands need the same dimension, in words for messages
    "add": "adds", "sub": "subtracts", "min": "takes the smallest of", "max": "takes the largest of",
    "hypot": "takes hypot of", "atan2": "takes atan2 of", "choose": "chooses between",
    **dict.fromkeys(("lt", "le", "gt", "ge", "eq", "ne"), "compares"),
}  # fmt: skip
# operations whose result has that dimension, too
DIMENSION_PRESERVING = frozenset({"add", "sub", "min", "max", "hypot", "choose"})


def known_dimension(dimension: Dimension) -> MeasuredDimension:
    """Return the dimension of a parameter with a unit."""
    return MeasuredDimension("known", dimension)


def coordinate_dimension(dimension: Dimension) -> MeasuredDimension:
    """Return the dimension of a coordinate."""
    return MeasuredDimension("loose", dimension, moving=True)


def literal_dimension(text: str) -> MeasuredDimension:
    """Return the dimension of a number as it is written: of a small whole number a factor, else free."""
    return WHOLE if text.isdecimal() and int(text) <= MAX_PLAIN_FACTOR else FREE


def operation_dimension(
    name: str, parts: Sequence[MeasuredDimension], argument: int = 0, strict: bool = False
) -> MeasuredDimension:
    """Return the dimension of an operation on parts. Raises Finding [wrong-dimension] without the expression's text."""
    if name in SUMS:
        common = common_dimension(name, parts[0], parts[1], strict)
        return common if name in DIMENSION_PRESERVING else FACTOR
    if name in ("mul", "div"):
        return product_dimension(parts[0], parts[1], 1 if name == "mul" else -1)
    if name in ("neg", "abs"):
        return parts[0]
    if name == "power":
        return power_dimension(parts[0], float(argument))
    if name == "sqrt":
        return power_dimension(parts[0], 0.5)
    if name == "pow":
        return power_dimension(parts[0], None, parts[1])
    if name in NUMBER_FUNCTIONS:
        return function_dimension(name, parts[0])
    return FACTOR  # sign, step, log, and conditions


def common_dimension(name: str, a: MeasuredDimension, b: MeasuredDimension, strict: bool = False) -> MeasuredDimension:
    """Return the dimension of parts that need the same one: a sum, a comparison, two branches.

    strict: also check the dimension of a coordinate. Raises Finding [wrong-dimension].
    """
    literal, moving = a.literal or b.literal, a.moving or b.moving
    kinds = {a.kind, b.kind}
    if (kinds == {"known"} or (strict and kinds == {"known", "loose"})) and a.dimension != b.dimension:
        message = f"{SUMS[name]} {describe(a.dimension)} and {describe(b.dimension)}"
        raise Finding("wrong-dimension", message, "both must have the same dimension")
    for part in (a, b):
        if part.kind == "known":
            return MeasuredDimension("known", part.dimension, literal, moving)
    if a.kind == b.kind and a.dimension == b.dimension:
        return MeasuredDimension(a.kind, a.dimension, literal, moving)
    return FREE


def product_dimension(a: MeasuredDimension, b: MeasuredDimension, sign: int) -> MeasuredDimension:
    """Return the dimension of a product, or of a quotient (sign -1)."""
    if "free" in (a.kind, b.kind):
        return FREE
    literal, moving = a.literal or b.literal, a.moving or b.moving
    if literal and moving:
        return FREE
    kind: Literal["factor", "loose", "known"] = "factor"
    if "known" in (a.kind, b.kind):
        kind = "known"
    elif "loose" in (a.kind, b.kind):
        kind = "loose"
    x, y = a.dimension, b.dimension
    dimension = (x[0] + sign * y[0], x[1] + sign * y[1], x[2] + sign * y[2])
    if dimension == NUMBER and "factor" not in (a.kind, b.kind):  # a ratio has no unit
        kind = "factor"
    return MeasuredDimension(kind, dimension, literal, moving)


def power_dimension(
    base: MeasuredDimension, exponent: float | None, exponent_measure: MeasuredDimension = FREE
) -> MeasuredDimension:
    """Return the dimension of a power. exponent: None if it is not constant; then its own dimension counts."""
    if exponent_measure.kind == "known" and exponent_measure.dimension != NUMBER:
        message = f"has an exponent that is {describe(exponent_measure.dimension)}"
        raise Finding("wrong-dimension", message, "an exponent must be a plain number: divide it by a reference value")
    if base.kind in ("free", "factor"):
        return base._replace(literal=True) if base.kind == "factor" else FREE
    if exponent is None or abs(exponent) > MAX_POWER:
        return FREE
    powers = [exponent * power for power in base.dimension]
    if any(power != int(power) for power in powers):
        return FREE
    x, y, z = map(int, powers)
    return base._replace(dimension=(x, y, z))


def function_dimension(name: str, argument: MeasuredDimension) -> MeasuredDimension:
    """Return the dimension of a function of numbers and angles. Raises Finding [wrong-dimension]."""
    if argument.kind == "known" and argument.dimension != NUMBER:
        message = f"takes {name} of {describe(argument.dimension)}"
        raise Finding("wrong-dimension", message, "divide it by a reference value: sin(t/T), exp(x/L)")
    return FACTOR


def table_dimension(
    name: str, dimensions: tuple[Dimension | None, Dimension | None], argument: MeasuredDimension
) -> MeasuredDimension:
    """Return the dimension of a table's value; dimensions: of its columns, if they have units."""
    x, y = dimensions
    if x is not None and argument.kind == "known" and argument.dimension != x:
        message = f"looks up {describe(argument.dimension)} in the table {name}, whose x is {describe(x)}"
        raise Finding("wrong-dimension", message, f"look up {describe(x)}, or give the table another x_unit")
    return FREE if y is None or y == NUMBER else MeasuredDimension("known", y, moving=True)
