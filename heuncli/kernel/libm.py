"""C's functions and numbers in plain Python: they return a value where those of `math` raise."""

from __future__ import annotations

import math
from collections.abc import Callable

INFINITY, NAN = math.inf, math.nan


def exp(x: float) -> float:
    return math.exp(x) if x < 709.8 else _or_infinite(math.exp, x)


def _or_infinite(f: Callable[[float], float], x: float) -> float:
    try:
        return f(x)
    except OverflowError:
        return math.inf


def sinh(x: float) -> float:
    return math.sinh(x) if -710.0 < x < 710.0 else math.copysign(_or_infinite(math.sinh, abs(x)), x)


def cosh(x: float) -> float:
    return math.cosh(x) if -710.0 < x < 710.0 else _or_infinite(math.cosh, x)


def sin(x: float) -> float:
    return math.sin(x) if x - x == 0.0 else math.nan


def cos(x: float) -> float:
    return math.cos(x) if x - x == 0.0 else math.nan


def tan(x: float) -> float:
    return math.tan(x) if x - x == 0.0 else math.nan


def floor(x: float) -> float:
    return x if x == 0.0 or x - x != 0.0 else float(math.floor(x))


def pow(x: float, y: float) -> float:
    try:
        return math.pow(x, y)
    except ValueError:  # 0 to a negative power is shut out before
        return math.nan
    except OverflowError:
        return -math.inf if x < 0.0 and math.fmod(y, 2.0) != 0.0 else math.inf
