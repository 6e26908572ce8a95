"""Dual numbers: a value with its gradient, and the functions of the kernel on them (forward differentiation).

    f(x + dx) = f(x) + f'(x) dx,   carried through every operation by the chain rule: exact to rounding, no step
The gradient is taken in all directions at once. Where a formula branches it is compared by values, for the branch taken
is the function differentiated; but what is zero and moves is not "equal to zero": a kernel that leaves out what is
nothing must not leave out what is about to be something.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from heuncli.kernel import libm
from heuncli.results.results import Array


class Dual:
    """A number that moves: value and gradient, never changed in place; plain numbers beside it stand still."""

    __slots__ = ("gradient", "value")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, value: float, gradient: Array) -> None:
        self.value = value
        self.gradient = gradient

    def __add__(self, other: Any) -> Dual:
        if isinstance(other, Dual):
            return Dual(self.value + other.value, self.gradient + other.gradient)
        return Dual(self.value + other, self.gradient)

    __radd__ = __add__

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.gradient)

    def __sub__(self, other: Any) -> Dual:
        if isinstance(other, Dual):
            return Dual(self.value - other.value, self.gradient - other.gradient)
        return Dual(self.value - other, self.gradient)

    def __rsub__(self, other: float) -> Dual:
        return Dual(other - self.value, -self.gradient)

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, Dual):
            return Dual(self.value * other.value, self.value * other.gradient + other.value * self.gradient)
        if other == 0.0 and self.value - self.value == 0.0:
            return self.value * other  # nothing moves: what stays a plain number is cheap from here on
        return Dual(self.value * other, self.gradient * other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Dual:
        if isinstance(other, Dual):
            value = self.value / other.value
            return Dual(value, (self.gradient - value * other.gradient) / other.value)
        return Dual(self.value / other, self.gradient / other)

    def __rtruediv__(self, other: float) -> Dual:
        value = other / self.value
        return Dual(value, self.gradient * (-value / self.value))

    def __abs__(self) -> Dual:
        return -self if self.value < 0.0 else self

    def __lt__(self, other: Any) -> bool:
        return self.value < value_of(other)

    def __le__(self, other: Any) -> bool:
        return self.value <= value_of(other)

    def __gt__(self, other: Any) -> bool:
        return self.value > value_of(other)

    def __ge__(self, other: Any) -> bool:
        return self.value >= value_of(other)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Dual):
            return self.value == other.value and bool(np.array_equal(self.gradient, other.gradient))
        return self.value == other and not self.gradient.any()

    def __ne__(self, other: object) -> bool:
        return not self == other


def value_of(x: Any) -> float:
    """The value of a number, moving or not."""
    value: float = x.value if isinstance(x, Dual) else x
    return value


def gradient_of(x: Any, directions: int) -> Array:
    """The gradient of a number, moving or not."""
    return x.gradient if isinstance(x, Dual) else np.zeros(directions)


def _chain(x: Dual, value: float, slope: float) -> Dual:
    """f(x) by its value and its slope there."""
    return Dual(value, x.gradient * slope)


def sqrt(x: Any) -> Any:
    """Where x vanishes with its gradient, as a sum of squares does, so does the root; else it has no slope there."""
    if not isinstance(x, Dual):
        return math.sqrt(x)
    root = math.sqrt(x.value)
    if root == 0.0:
        return Dual(0.0, np.where(x.gradient == 0.0, 0.0, math.nan)) if x.gradient.any() else 0.0
    return _chain(x, root, 0.5 / root)


def fabs(x: Any) -> Any:
    return abs(x) if isinstance(x, Dual) else math.fabs(x)


def sin(x: Any) -> Any:
    return _chain(x, libm.sin(x.value), libm.cos(x.value)) if isinstance(x, Dual) else libm.sin(x)


def cos(x: Any) -> Any:
    return _chain(x, libm.cos(x.value), -libm.sin(x.value)) if isinstance(x, Dual) else libm.cos(x)


def tan(x: Any) -> Any:
    if not isinstance(x, Dual):
        return libm.tan(x)
    value = libm.tan(x.value)
    return _chain(x, value, 1.0 + value * value)


def asin(x: Any) -> Any:
    return _chain(x, math.asin(x.value), _of_arc(x.value)) if isinstance(x, Dual) else math.asin(x)


def acos(x: Any) -> Any:
    return _chain(x, math.acos(x.value), -_of_arc(x.value)) if isinstance(x, Dual) else math.acos(x)


def _of_arc(x: float) -> float:
    """The slope of asin; none at its ends."""
    square = (1.0 - x) * (1.0 + x)
    return 1.0 / math.sqrt(square) if square > 0.0 else math.nan


def atan(x: Any) -> Any:
    return _chain(x, math.atan(x.value), 1.0 / (1.0 + x.value * x.value)) if isinstance(x, Dual) else math.atan(x)


def atan2(y: Any, x: Any) -> Any:
    if not (isinstance(x, Dual) or isinstance(y, Dual)):
        return math.atan2(y, x)
    a, b = value_of(y), value_of(x)
    square = a * a + b * b
    n = len((y if isinstance(y, Dual) else x).gradient)
    if square == 0.0:
        return Dual(math.atan2(a, b), np.full(n, math.nan))
    return Dual(math.atan2(a, b), (b * gradient_of(y, n) - a * gradient_of(x, n)) / square)


def sinh(x: Any) -> Any:
    return _chain(x, libm.sinh(x.value), libm.cosh(x.value)) if isinstance(x, Dual) else libm.sinh(x)


def cosh(x: Any) -> Any:
    return _chain(x, libm.cosh(x.value), libm.sinh(x.value)) if isinstance(x, Dual) else libm.cosh(x)


def tanh(x: Any) -> Any:
    if not isinstance(x, Dual):
        return math.tanh(x)
    value = math.tanh(x.value)
    return _chain(x, value, 1.0 - value * value)


def exp(x: Any) -> Any:
    if not isinstance(x, Dual):
        return libm.exp(x)
    value = libm.exp(x.value)
    return _chain(x, value, value)


def log(x: Any) -> Any:
    return _chain(x, math.log(x.value), 1.0 / x.value) if isinstance(x, Dual) else math.log(x)


def floor(x: Any) -> float:
    return libm.floor(value_of(x))


def pow(x: Any, y: Any) -> Any:
    """x**y; x must be positive where y moves, and where it is zero it has the slope that the power has there."""
    a, b = value_of(x), value_of(y)
    value = libm.pow(a, b)
    gradient: Any = 0.0
    if isinstance(x, Dual):
        slope = 0.0 if b == 0.0 else math.nan if a == 0.0 and b < 1.0 else b * libm.pow(a, b - 1.0)
        gradient = slope * x.gradient
    if isinstance(y, Dual):
        gradient = gradient + value * (math.log(a) if a > 0.0 else math.nan) * y.gradient
    return value if isinstance(gradient, float) else Dual(value, gradient)


INFINITY, NAN = math.inf, math.nan
