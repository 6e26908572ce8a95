"""Interval arithmetic: bounds of an expression of time alone over many spans of time at once (Moore 1966).

    [a, b] + [c, d] = [a + c, b + d],    f([a, b]) = [f(a), f(b)] where f rises,    ...
    f([a, b]) in f(m) + f'([a, b]) [a - m, b - m]

Bounds hold for every instant of a span, seen or not; they are wider than the values where a variable occurs twice. The
second form, on the rate carried along, comes down with the square of the span. Tables are looked up at three instants:
their knots are discontinuities, and between knots there is nothing to miss.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from heuncli.expressions.programs import OPS, Expression, Pack

Array = NDArray[np.float64]
Truth = NDArray[np.bool_]
Bounds = tuple[Array, Array]  # lowest and highest value over each of n spans, (n,)
Comparison = Callable[[Bounds, Bounds], Truth]
ONE, NONE, ANY = ((np.asarray(a), np.asarray(b)) for a, b in ((1.0, 1.0), (0.0, 0.0), (-np.inf, np.inf)))

NAMES = {number: name for name, number in OPS.items()}


class Range(NamedTuple):
    """What a part of an expression may be over each span, and what its rate may be."""

    value: Bounds
    rate: Bounds


def bounds(expression: Expression, low: Array, high: Array) -> Bounds:
    """What the expression may be between `low` and `high`, each (n,)."""
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    with np.errstate(all="ignore"):
        stack: list[Range] = []
        _run(expression, 0, expression.count, Range((low, high), ONE), stack)
        value, rate = stack.pop()
        # what leaves the middle goes no farther than the rate takes it, and that bound shrinks with the square
        reach = half * np.fmax(np.abs(rate[0]), np.abs(rate[1]))
        there = np.array(expression.sample(middle.tolist()))
        least, most = np.fmax(value[0], there - reach), np.fmin(value[1], there + reach)
        return np.where(np.isnan(least), -np.inf, least), np.where(np.isnan(most), np.inf, most)


def _run(expression: Expression, at: int, end: int, time: Range, stack: list[Range]) -> None:
    """The instructions from `at` to `end` on the stack."""
    code = expression.code
    while at < end:
        name, argument = NAMES[code[2 * at]], code[2 * at + 1]
        at += 1
        if name == "const":
            stack.append(Range((np.asarray(expression.constants[argument]),) * 2, NONE))
        elif name == "var":
            stack.append(time)
        elif name == "table":
            found = _looked_up(expression, code[2 * at - 2 : 2 * at + 2], stack.pop().value)
            stack.append(Range(found, ANY))
            at += 1
        elif name == "unless":
            otherwise = at + argument  # behind the jump over it
            after = otherwise + code[2 * (otherwise - 1) + 1]
            low, high = stack.pop().value
            _run(expression, at, otherwise - 1, time, stack)
            _run(expression, otherwise, after, time, stack)
            second, first = stack.pop(), stack.pop()
            surely, never = (low > 0.0) | (high < 0.0), (low == 0.0) & (high == 0.0)
            value = _chosen(surely, never, first.value, second.value)
            rate = _chosen(surely, never, first.rate, second.rate)
            stack.append(Range(value, _chosen(surely | never, ~(surely | never), rate, ANY)))  # between: a jump
            at = after
        elif name == "power":
            x = stack.pop()
            slope = _times((np.asarray(float(argument)),) * 2, _power(x.value, argument - 1))
            stack.append(Range(_rounded(_power(x.value, argument)), _times(slope, x.rate)))
        elif name in UNARY:
            x = stack.pop()
            stack.append(Range(_rounded(UNARY[name](x.value)), _times(SLOPE[name](x.value), x.rate)))
        else:
            y, x = stack.pop(), stack.pop()
            if name in COMPARED:
                stack.append(Range(COMPARED[name](x.value, y.value), ANY))
                stack += [y] * argument  # 1: the right operand is needed again
            else:
                stack.append(Range(_rounded(BINARY[name](x.value, y.value)), RATE.get(name, _unknown)(x, y)))


def _rounded(x: Bounds) -> Bounds:
    """Moved outward by a rounding."""
    return np.nextafter(x[0], -np.inf), np.nextafter(x[1], np.inf)


def _chosen(surely: Truth, never: Truth, a: Bounds, b: Bounds) -> Bounds:
    """One branch where the condition tells, else both."""
    low = np.where(surely, a[0], np.where(never, b[0], np.fmin(a[0], b[0])))
    high = np.where(surely, a[1], np.where(never, b[1], np.fmax(a[1], b[1])))
    return low, high


def _looked_up(expression: Expression, code: tuple[int, ...], x: Bounds) -> Bounds:
    pack = Pack()
    start, count = pack.add_code(expression, (OPS["var"], 0, *code))
    places = np.stack(np.broadcast_arrays(x[0], 0.5 * (x[0] + x[1]), x[1]))
    found = np.array(pack.sample(start, count, places.ravel().tolist())).reshape(places.shape)
    return found.min(axis=0), found.max(axis=0)


# ---- operations
def _corners(f: Callable[[Array, Array], Array]) -> Callable[[Bounds, Bounds], Bounds]:
    """Of an operation that is monotone in each operand: its least and largest at the corners."""

    def both(x: Bounds, y: Bounds) -> Bounds:
        a, b, c, d = f(x[0], y[0]), f(x[0], y[1]), f(x[1], y[0]), f(x[1], y[1])
        return np.minimum(np.minimum(a, b), np.minimum(c, d)), np.maximum(np.maximum(a, b), np.maximum(c, d))

    return both


def _rising(f: Callable[[Array], Array]) -> Callable[[Bounds], Bounds]:
    return lambda x: (f(x[0]), f(x[1]))


def _even(f: Callable[[Array], Array]) -> Callable[[Bounds], Bounds]:
    """Of a function of |x| that rises."""
    return lambda x: _rising(f)(_abs(x))


def _abs(x: Bounds) -> Bounds:
    a, b = np.abs(x[0]), np.abs(x[1])
    return np.where((x[0] <= 0.0) & (x[1] >= 0.0), 0.0, np.fmin(a, b)), np.fmax(a, b)


def _product(a: Array, b: Array) -> Array:
    found = np.asarray(a * b)
    return np.where(np.isnan(found), 0.0, found) if np.isnan(found).any() else found  # 0 times infinity


_times = _corners(_product)


def _over(x: Bounds, y: Bounds) -> Bounds:
    through = (y[0] <= 0.0) & (y[1] >= 0.0)
    low, high = _corners(np.divide)(x, y)
    return np.where(through, -np.inf, low), np.where(through, np.inf, high)


def _power(x: Bounds, n: int) -> Bounds:
    if n < 0:
        return _over(ONE, _power(x, -n))
    return _even(lambda a: a**n)(x) if n % 2 == 0 else _rising(lambda a: a**n)(x)


def _raised(x: Bounds, y: Bounds) -> Bounds:
    """x to the power y, of a positive x; of others nothing is known."""
    low, high = _corners(np.power)(x, y)
    known = x[0] > 0.0
    return np.where(known, low, -np.inf), np.where(known, high, np.inf)


def _sine(x: Bounds) -> Bounds:
    """Between its values at the ends, but for the crests and troughs within."""
    a, b = np.sin(x[0]), np.sin(x[1])

    def within(at: float) -> Truth:
        return np.asarray(np.floor((x[1] - at) / (2 * np.pi)) > np.floor((x[0] - at) / (2 * np.pi)))

    return np.where(within(-np.pi / 2), -1.0, np.fmin(a, b)), np.where(within(np.pi / 2), 1.0, np.fmax(a, b))


def _cosine(x: Bounds) -> Bounds:
    return _sine((x[0] + np.pi / 2, x[1] + np.pi / 2))


def _tangent(x: Bounds) -> Bounds:
    through = np.floor(x[1] / np.pi + 0.5) > np.floor(x[0] / np.pi + 0.5)
    return np.where(through, -np.inf, np.tan(x[0])), np.where(through, np.inf, np.tan(x[1]))


def _angle(y: Bounds, x: Bounds) -> Bounds:
    """atan2(y, x): on the right half plane at the corners, else all round."""
    low, high = _corners(np.arctan2)(y, x)
    right = x[0] > 0.0
    return np.where(right, low, -np.pi), np.where(right, high, np.pi)


def _compared(surely: Comparison, never: Comparison) -> Callable[[Bounds, Bounds], Bounds]:
    return lambda x, y: (np.where(surely(x, y), 1.0, 0.0), np.where(never(x, y), 0.0, 1.0))


def _apart(x: Bounds, y: Bounds) -> Truth:
    return np.asarray((x[1] < y[0]) | (y[1] < x[0]))


def _same(x: Bounds, y: Bounds) -> Truth:
    return np.asarray((x[0] == x[1]) & (y[0] == y[1]) & (x[0] == y[0]))


COMPARED = {
    "lt": _compared(lambda x, y: x[1] < y[0], lambda x, y: x[0] >= y[1]),
    "le": _compared(lambda x, y: x[1] <= y[0], lambda x, y: x[0] > y[1]),
    "gt": _compared(lambda x, y: x[0] > y[1], lambda x, y: x[1] <= y[0]),
    "ge": _compared(lambda x, y: x[0] >= y[1], lambda x, y: x[1] < y[0]),
    "eq": _compared(_same, _apart),
    "ne": _compared(_apart, _same),
}
BINARY: dict[str, Callable[[Bounds, Bounds], Bounds]] = {
    "add": lambda x, y: (x[0] + y[0], x[1] + y[1]),
    "sub": lambda x, y: (x[0] - y[1], x[1] - y[0]),
    "mul": _times,
    "div": _over,
    "pow": _raised,
    "atan2": _angle,
    "hypot": lambda x, y: _corners(np.hypot)(_abs(x), _abs(y)),
    "min": _corners(np.minimum),
    "max": _corners(np.maximum),
}
UNARY: dict[str, Callable[[Bounds], Bounds]] = {
    "neg": lambda x: (-x[1], -x[0]),
    "abs": _abs,
    "sign": _rising(np.sign),
    "step": _rising(lambda a: np.where(a < 0.0, 0.0, 1.0)),
    "sin": _sine,
    "cos": _cosine,
    "tan": _tangent,
    "asin": _rising(lambda a: np.arcsin(np.clip(a, -1.0, 1.0))),  # what is beyond has no value
    "acos": lambda x: (np.arccos(np.clip(x[1], -1.0, 1.0)), np.arccos(np.clip(x[0], -1.0, 1.0))),
    "atan": _rising(np.arctan),
    "sinh": _rising(np.sinh),
    "cosh": _even(np.cosh),
    "tanh": _rising(np.tanh),
    "exp": _rising(np.exp),
    "log": _rising(lambda a: np.log(np.fmax(a, 0.0))),
    "sqrt": _rising(lambda a: np.sqrt(np.fmax(a, 0.0))),
}


# ---- rates
def _minus(x: Bounds) -> Bounds:
    return -x[1], -x[0]


def _plus(x: Bounds, y: Bounds) -> Bounds:
    return x[0] + y[0], x[1] + y[1]


def _unknown(x: Range, y: Range) -> Bounds:
    """Of what is left to the bounds of the value."""
    return ANY


def _rate_of_product(x: Range, y: Range) -> Bounds:
    return _plus(_times(x.rate, y.value), _times(x.value, y.rate))


def _rate_of_quotient(x: Range, y: Range) -> Bounds:
    left, right = _over(x.rate, y.value), _over(_times(x.value, y.rate), _power(y.value, 2))
    return left[0] - right[1], left[1] - right[0]


def _rate_of_power(x: Range, y: Range) -> Bounds:
    """Of a positive x: y x**(y - 1) x' + x**y log(x) y'."""
    below = y.value[0] - 1.0, y.value[1] - 1.0
    base = _times(_times(y.value, _raised(x.value, below)), x.rate)
    exponent = _times(_times(_raised(x.value, y.value), UNARY["log"](x.value)), y.rate)
    return base if y.rate is NONE else _plus(base, exponent)


def _rate_of_the_chosen(first: Comparison, second: Comparison) -> Callable[[Range, Range], Bounds]:
    return lambda x, y: _chosen(first(x.value, y.value), second(x.value, y.value), x.rate, y.rate)


RATE: dict[str, Callable[[Range, Range], Bounds]] = {
    "add": lambda x, y: _plus(x.rate, y.rate),
    "sub": lambda x, y: _plus(x.rate, _minus(y.rate)),
    "mul": _rate_of_product,
    "div": _rate_of_quotient,
    "pow": _rate_of_power,
    "min": _rate_of_the_chosen(lambda x, y: x[1] < y[0], lambda x, y: x[0] > y[1]),
    "max": _rate_of_the_chosen(lambda x, y: x[0] > y[1], lambda x, y: x[1] < y[0]),
}
SLOPE: dict[str, Callable[[Bounds], Bounds]] = {
    "neg": lambda x: _minus(ONE),
    "abs": UNARY["sign"],
    "sign": lambda x: _chosen(x[0] * x[1] > 0.0, x[0] * x[1] <= 0.0, NONE, ANY),
    "step": lambda x: _chosen((x[0] >= 0.0) | (x[1] < 0.0), (x[0] < 0.0) & (x[1] >= 0.0), NONE, ANY),
    "sin": _cosine,
    "cos": lambda x: _minus(_sine(x)),
    "tan": lambda x: _plus(ONE, _power(_tangent(x), 2)),
    "asin": lambda x: _over(ONE, UNARY["sqrt"](_plus(ONE, _minus(_power(x, 2))))),
    "acos": lambda x: _minus(SLOPE["asin"](x)),
    "atan": lambda x: _over(ONE, _plus(ONE, _power(x, 2))),
    "sinh": lambda x: UNARY["cosh"](x),
    "cosh": lambda x: UNARY["sinh"](x),
    "tanh": lambda x: _over(ONE, _power(UNARY["cosh"](x), 2)),
    "exp": lambda x: UNARY["exp"](x),
    "log": lambda x: _over(ONE, x),
    "sqrt": lambda x: _over((np.asarray(0.5),) * 2, UNARY["sqrt"](x)),
}
