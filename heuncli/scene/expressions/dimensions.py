"""Of what dimension a part of an expression is, as far as that is certain.

Only parameters with a unit have a dimension for certain. A number without a unit may carry any unit of its own, so what
it enters is free: `m*9.81` may well be a force. Whole numbers up to 9, pi, and what sines and ratios give are factors
that change no dimension: `L/2`, `pi*r**2`, `F*sin(w*t)`. The time and the coordinates of joints have dimensions only
together with such parameters: `v*t` is a length, `3*t` and `v*t/2` may be anything.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.units import LENGTH, NUMBER, RATE, TIME, VELOCITY, Dimension, describe

LARGEST_FACTOR = 9  # whole numbers up to it are plain factors; a 10 may well be the acceleration of gravity
LARGEST_POWER = 64  # beyond it no dimension is told


class Measure(NamedTuple):
    """A dimension as far as it is certain.

    free: may be any; factor: changes none; loose: of the time or a coordinate alone; known: certain. literal, moving:
    whether a whole number, the time or a coordinate is a factor in it: both together may be a rate, whatever its unit.
    """

    kind: Literal["free", "factor", "loose", "known"]
    dimension: Dimension = NUMBER
    literal: bool = False
    moving: bool = False


FREE = Measure("free")
FACTOR = Measure("factor")
WHOLE = Measure("factor", literal=True)
COORDINATES = {  # of joints, of points, of loads
    "angle": NUMBER, "rate": RATE, "travel": LENGTH, "speed": VELOCITY,
    "length": LENGTH, "deflection": LENGTH, "turn": NUMBER,  # of what a load acts between
    **dict.fromkeys("xyz", LENGTH), **dict.fromkeys(("vx", "vy", "vz"), VELOCITY),
}  # fmt: skip
OF_TIME = Measure("loose", TIME, moving=True)
OF_NUMBERS = frozenset({"sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp"})
SUMS = {  # operations on what has one dimension, and what they do with it, in words
    "add": "adds", "sub": "subtracts", "min": "takes the least of", "max": "takes the largest of",
    "hypot": "takes hypot of", "atan2": "takes atan2 of", "choose": "chooses between",
    **dict.fromkeys(("lt", "le", "gt", "ge", "eq", "ne"), "compares"),
}  # fmt: skip
KEPT = frozenset({"add", "sub", "min", "max", "hypot", "choose"})  # whose result has that dimension, too


def known(dimension: Dimension) -> Measure:
    """Of a parameter with a unit."""
    return Measure("known", dimension)


def loose(dimension: Dimension) -> Measure:
    """Of a coordinate."""
    return Measure("loose", dimension, moving=True)


def of_literal(text: str) -> Measure:
    """Of a number as it is written."""
    return WHOLE if text.isdecimal() and int(text) <= LARGEST_FACTOR else FREE


def combined(name: str, parts: Sequence[Measure], argument: int = 0, strict: bool = False) -> Measure:
    """Of an operation on parts. Raises Finding [wrong-dimension] without the expression's text."""
    if name in SUMS:
        whole = alike(name, parts[0], parts[1], strict)
        return whole if name in KEPT else FACTOR
    if name in ("mul", "div"):
        return product(parts[0], parts[1], 1 if name == "mul" else -1)
    if name in ("neg", "abs"):
        return parts[0]
    if name == "power":
        return raised(parts[0], float(argument))
    if name == "sqrt":
        return raised(parts[0], 0.5)
    if name == "pow":
        return raised(parts[0], None, parts[1])
    if name in OF_NUMBERS:
        return of_function(name, parts[0])
    return FACTOR  # sign, step, log, and what is true or not


def alike(name: str, a: Measure, b: Measure, strict: bool = False) -> Measure:
    """Of what must be of one dimension: a sum, a comparison, either branch; strict: a coordinate's counts, too."""
    literal, moving = a.literal or b.literal, a.moving or b.moving
    kinds = {a.kind, b.kind}
    if (kinds == {"known"} or (strict and kinds == {"known", "loose"})) and a.dimension != b.dimension:
        message = f"{SUMS[name]} {describe(a.dimension)} and {describe(b.dimension)}"
        raise Finding("wrong-dimension", message, "multiply or divide one of them by what it lacks")
    for one in (a, b):
        if one.kind == "known":
            return Measure("known", one.dimension, literal, moving)
    if a.kind == b.kind and a.dimension == b.dimension:
        return Measure(a.kind, a.dimension, literal, moving)
    return FREE


def product(a: Measure, b: Measure, sign: int) -> Measure:
    """Of a product, or of a quotient (sign -1)."""
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
    return Measure(kind, dimension, literal, moving)


def raised(base: Measure, exponent: float | None, measure: Measure = FREE) -> Measure:
    """Of a power; exponent: None where it is no number written out, then its measure counts."""
    if measure.kind == "known" and measure.dimension != NUMBER:
        message = f"has an exponent that is {describe(measure.dimension)}"
        raise Finding("wrong-dimension", message, "an exponent is a plain number: divide it by a reference of its own")
    if base.kind in ("free", "factor"):
        return base._replace(literal=True) if base.kind == "factor" else FREE
    if exponent is None or abs(exponent) > LARGEST_POWER:
        return FREE
    powers = [exponent * power for power in base.dimension]
    if any(power != int(power) for power in powers):
        return FREE
    x, y, z = map(int, powers)
    return base._replace(dimension=(x, y, z))


def of_function(name: str, argument: Measure) -> Measure:
    """Of a function of numbers and angles."""
    if argument.kind == "known" and argument.dimension != NUMBER:
        message = f"takes {name} of {describe(argument.dimension)}"
        raise Finding("wrong-dimension", message, "divide it by a reference of its own: sin(t/T), exp(x/L)")
    return FACTOR


def looked_up(name: str, dimensions: tuple[Dimension | None, Dimension | None], argument: Measure) -> Measure:
    """Of a table's value; dimensions: of its columns, where they were given with units."""
    x, y = dimensions
    if x is not None and argument.kind == "known" and argument.dimension != x:
        message = f"looks up {describe(argument.dimension)} in the table {name}, whose x is {describe(x)}"
        raise Finding("wrong-dimension", message, f"look up {describe(x)}, or give the table another x_unit")
    return FREE if y is None or y == NUMBER else Measure("known", y, moving=True)
