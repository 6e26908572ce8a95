"""Arithmetic of spans: bounds of a value, its rate and its second derivative, through each operation of a program.

Natural interval arithmetic (intervals.py) with the chain rules of the jets. Functions are taken over the part of a span
on which they have values. Where a value may jump its derivatives are unknown, and where it may have a kink the second
one is.
"""

from __future__ import annotations

from heuncli.kernel.declarations import *
from heuncli.kernel.evaluator import angle_on_branch
from heuncli.kernel.intervals import (
    all_numbers,
    arccosine,
    arcsine,
    arctangent,
    cosine,
    distance,
    empty_interval,
    exact_times,
    exponential_function,
    hull,
    hyperbolic_cosine,
    hyperbolic_sine,
    hyperbolic_tangent,
    intersect,
    is_empty,
    is_off_cut,
    is_zero,
    library_above,
    library_below,
    logarithm,
    magnitude,
    minus,
    negative,
    plus,
    point_interval,
    polar_angle,
    quotient,
    raise_to_interval,
    raise_to_number,
    raise_to_whole,
    scale_bounds,
    sine,
    square_of,
    square_root,
    tangent,
    times,
)


def intersect_or_first(a: Bounds, b: Bounds) -> Bounds:
    """Return the intersection; a if rounding makes the two disjoint."""
    both: Bounds = intersect(a, b)
    return a if is_empty(both) else both


def constant_span(a: Bounds) -> Span:
    """Return the span of a constant within a."""
    return Span(a, point_interval(0.0), point_interval(0.0))


def jumping_span(a: Bounds) -> Span:
    """Return the span of what may jump within a."""
    return Span(a, all_numbers(), all_numbers())


def empty_span() -> Span:
    """Return the span of what has no value at all."""
    return Span(empty_interval(), empty_interval(), empty_interval())


def is_constant(u: Span) -> cython.bint:
    """Return whether a span certainly does not change."""
    return is_zero(u.rate) and is_zero(u.second)


def replace_nothing(a: Bounds) -> Bounds:
    """Return a, or all numbers where a derivative has no value."""
    return all_numbers() if is_empty(a) else a


def chain_spans(u: Span, f: Bounds, df: Bounds, ddf: Bounds) -> Span:
    """Return f(u) from f and its derivatives over u; if u is constant so is f(u), whatever f' is."""
    if is_empty(f):
        return empty_span()
    if is_constant(u):
        return constant_span(f)
    first: Bounds = replace_nothing(df)
    rate: Bounds = times(first, u.rate)
    return Span(f, rate, plus(times(replace_nothing(ddf), square_of(u.rate)), times(first, u.second)))


def merge_branches(a: Span, b: Span) -> Span:
    """Return the span of one or the other, with jumps between them."""
    if is_empty(a.value):
        return b
    if is_empty(b.value):
        return a
    value: Bounds = hull(a.value, b.value)
    return (
        constant_span(value) if value.low == value.high and is_constant(a) and is_constant(b) else jumping_span(value)
    )


def compare_bounds(op: cython.int, a: Bounds, b: Bounds) -> cython.int:
    """Return 1 if a comparison holds everywhere, 0 if nowhere, 2 if undecided, -1 without operands."""
    if is_empty(a) or is_empty(b):
        return -1
    if op == LT:
        return 1 if a.high < b.low else 0 if a.low >= b.high else 2
    elif op == LE:
        return 1 if a.high <= b.low else 0 if a.low > b.high else 2
    elif op == GT:
        return compare_bounds(LT, b, a)
    elif op == GE:
        return compare_bounds(LE, b, a)
    is_disjoint: cython.bint = a.high < b.low or b.high < a.low
    is_equal: cython.bint = a.low == a.high and b.low == b.high and a.low == b.low
    if op == EQ:
        return 1 if is_equal else 0 if is_disjoint else 2
    return 1 if is_disjoint else 0 if is_equal else 2


def span_of_truth(holds: cython.int) -> Span:
    """Return the span of a comparison's result."""
    if holds < 0:
        return empty_span()
    return jumping_span(Bounds(0.0, 1.0)) if holds == 2 else constant_span(point_interval(1.0 if holds == 1 else 0.0))


# Operations


def span_of_two(op: cython.int, a: Span, b: Span) -> Span:
    """Apply an operation to two spans."""
    if is_empty(a.value) or is_empty(b.value):
        return empty_span()
    if op == ADD:
        return Span(plus(a.value, b.value), plus(a.rate, b.rate), plus(a.second, b.second))
    elif op == SUB:
        return Span(minus(a.value, b.value), minus(a.rate, b.rate), minus(a.second, b.second))
    elif op == MUL:
        return span_of_product(a, b)
    elif op == DIV:
        return span_of_quotient(a, b)
    elif op == POW:
        return span_of_power(a, b)
    elif op == ATAN2:
        value: Bounds = polar_angle(a.value, b.value)
        return span_of_angle(value, a, b) if is_off_cut(a.value, b.value) else jumping_span(value)
    elif op == HYPOT:
        return span_of_distance(a, b)
    return span_of_extreme(op, a, b)


def span_of_product(a: Span, b: Span) -> Span:
    """(a b)' = a' b + a b',  (a b)'' = a'' b + 2 a' b' + a b''."""
    crossed: Bounds = times(scale_bounds(2.0, a.rate), b.rate)
    return Span(
        exact_times(a.value, b.value),
        plus(times(a.rate, b.value), times(a.value, b.rate)),
        plus(plus(times(a.second, b.value), crossed), times(a.value, b.second)),
    )


def span_of_quotient(a: Span, b: Span) -> Span:
    """q = a/b from a = q b:  q' = (a' - q b')/b,  q'' = (a'' - 2 q' b' - q b'')/b."""
    q: Bounds = quotient(a.value, b.value)
    if is_empty(q):
        return empty_span()
    rate: Bounds = quotient(minus(a.rate, times(q, b.rate)), b.value)
    second: Bounds = minus(minus(a.second, times(scale_bounds(2.0, rate), b.rate)), times(q, b.second))
    return Span(q, rate, quotient(second, b.value))


def span_of_power(a: Span, b: Span) -> Span:
    """y = a**b; if b varies, y = exp(w) with w = b log a, so that a must be positive there."""
    n: cython.double = b.value.low
    y: Bounds = raise_to_interval(a.value, b.value)
    if is_empty(y):
        return empty_span()
    if is_constant(a) and is_constant(b):
        return constant_span(y)
    if is_constant(b) and n == b.value.high:
        df: Bounds = scale_bounds(n, raise_to_number(a.value, n - 1.0)) if n != 0.0 else point_interval(0.0)
        c: Bounds = times(point_interval(n), minus(point_interval(n), point_interval(1.0)))
        return chain_spans(a, y, df, times(c, raise_to_number(a.value, n - 2.0)) if not is_zero(c) else c)
    if not a.value.low > 0.0:
        return jumping_span(y)
    w: Bounds = logarithm(a.value)
    relative: Bounds = quotient(a.rate, a.value)
    rate: Bounds = plus(times(b.rate, w), quotient(times(b.value, a.rate), a.value))
    inner: Bounds = minus(a.second, quotient(square_of(a.rate), a.value))
    second: Bounds = plus(times(b.second, w), times(scale_bounds(2.0, b.rate), relative))
    second = plus(second, quotient(times(b.value, inner), a.value))
    return Span(y, times(y, rate), times(y, plus(square_of(rate), second)))


def span_of_angle(value: Bounds, y: Span, x: Span) -> Span:
    """The angle φ of (x, y), r² = y² + x²:  r² φ' = x y' - y x',  r² φ'' = x y'' - y x'' - 2 φ' (y y' + x x')."""
    square: Bounds = plus(square_of(y.value), square_of(x.value))
    rate: Bounds = replace_nothing(quotient(minus(times(x.value, y.rate), times(y.value, x.rate)), square))
    radial: Bounds = plus(times(y.value, y.rate), times(x.value, x.rate))
    second: Bounds = minus(times(x.value, y.second), times(y.value, x.second))
    return Span(value, rate, replace_nothing(quotient(minus(second, times(scale_bounds(2.0, rate), radial)), square)))


def span_of_distance(a: Span, b: Span) -> Span:
    """r² = a² + b²:  r r' = a a' + b b',  r r'' = a'² + b'² + a a'' + b b'' - r'²;  |r'| <= |a'| + |b'|."""
    r: Bounds = distance(a.value, b.value)
    if is_constant(a) and is_constant(b):
        return constant_span(r)
    most: Bounds = plus(magnitude(a.rate), magnitude(b.rate))
    rate: Bounds = replace_nothing(quotient(plus(times(a.value, a.rate), times(b.value, b.rate)), r))
    rate = intersect_or_first(rate, Bounds(-library_above(most.high), library_above(most.high)))
    square: Bounds = plus(plus(square_of(a.rate), square_of(b.rate)), times(a.value, a.second))
    square = plus(square, times(b.value, b.second))
    return Span(r, rate, replace_nothing(quotient(minus(square, square_of(rate)), r)))


def span_of_extreme(op: cython.int, a: Span, b: Span) -> Span:
    """Return the smaller or the larger of two: one of them, or both in turn, with a kink between."""
    second: cython.int = selects_second(op, a.value, b.value)
    if second != 2:
        return b if second == 1 else a
    low: cython.bint = (a.value.low < b.value.low) == (op == MIN)
    high: cython.bint = (a.value.high < b.value.high) == (op == MIN)
    value: Bounds = Bounds(a.value.low if low else b.value.low, a.value.high if high else b.value.high)
    return Span(value, hull(a.rate, b.rate), all_numbers())


def selects_second(op: cython.int, a: Bounds, b: Bounds) -> cython.int:
    """Return whether MIN or MAX selects the second operand: 1 everywhere, 0 nowhere, 2 undecided."""
    return compare_bounds(LT, b, a) if op == MIN else compare_bounds(GT, b, a)


def span_of_one(op: cython.int, u: Span, n: cython.int) -> Span:
    """Apply an operation to one span; n: the exponent of a whole power."""
    if is_empty(u.value):
        return empty_span()
    if op <= STEP:
        return span_of_piecewise(op, u, n)
    elif op <= ATAN:
        return span_of_circular(op, u)
    else:
        return span_of_exponential(op, u)


def span_of_piecewise(op: cython.int, u: Span, n: cython.int) -> Span:
    """-u, the whole power n, |u|, and its functions with jumps, which are constant between them."""
    a: Bounds = u.value
    if op == POWER:
        df: Bounds = scale_bounds(n, a if n == 2 else raise_to_whole(a, n - 1))
        return chain_spans(
            u,
            raise_to_whole(a, n),
            df,
            scale_bounds(n * (n - 1), point_interval(1.0) if n == 2 else raise_to_whole(a, n - 2)),
        )
    elif op == NEG or (op == ABS and a.high < 0.0):
        return negate_span(u)
    elif op == ABS:
        return u if a.low >= 0.0 else Span(magnitude(a), hull(u.rate, negative(u.rate)), all_numbers())
    low: cython.double = 1.0 if a.low >= 0.0 else 0.0
    high: cython.double = 1.0 if a.high >= 0.0 else 0.0
    if op == SIGN:
        low = 1.0 if a.low > 0.0 else -1.0 if a.low < 0.0 else 0.0
        high = 1.0 if a.high > 0.0 else -1.0 if a.high < 0.0 else 0.0
    return constant_span(point_interval(low)) if low == high else jumping_span(Bounds(low, high))


def negate_span(u: Span) -> Span:
    """-u."""
    return Span(negative(u.value), negative(u.rate), negative(u.second))


def span_of_circular(op: cython.int, u: Span) -> Span:
    """Apply a trigonometric function or its inverse."""
    a: Bounds = u.value
    one: Bounds = point_interval(1.0)
    f: Bounds
    df: Bounds
    if op == SIN:
        f = sine(a)
        return chain_spans(u, f, cosine(a), negative(f))
    elif op == COS:
        f = cosine(a)
        return chain_spans(u, f, negative(sine(a)), negative(f))
    elif op == TAN:
        f = tangent(a)
        df = plus(one, square_of(f))
        return chain_spans(u, f, df, times(scale_bounds(2.0, f), df))
    elif op == ATAN:
        df = quotient(one, plus(one, square_of(a)))
        return chain_spans(u, arctangent(a), df, times(times(scale_bounds(-2.0, a), df), df))
    a = intersect(a, Bounds(-1.0, 1.0))
    if is_empty(a):
        return empty_span()
    df = replace_nothing(quotient(one, square_root(times(minus(one, a), plus(one, a)))))
    ddf: Bounds = times(times(times(a, df), df), df)
    if op == ASIN:
        return chain_spans(u, arcsine(a), df, ddf)
    return chain_spans(u, arccosine(a), negative(df), negative(ddf))


def span_of_exponential(op: cython.int, u: Span) -> Span:
    """Apply a hyperbolic function, the exponential, the logarithm or the square root."""
    a: Bounds = u.value
    f: Bounds
    df: Bounds
    if op == SINH:
        f = hyperbolic_sine(a)
        return chain_spans(u, f, hyperbolic_cosine(a), f)
    elif op == COSH:
        f = hyperbolic_cosine(a)
        return chain_spans(u, f, hyperbolic_sine(a), f)
    elif op == TANH:
        f = hyperbolic_tangent(a)
        df = minus(point_interval(1.0), square_of(f))
        return chain_spans(u, f, df, times(scale_bounds(-2.0, f), df))
    elif op == EXP:
        f = exponential_function(a)
        return chain_spans(u, f, f, f)
    f = logarithm(a) if op == LOG else square_root(a)
    if is_empty(f):
        return empty_span()
    if op == LOG:
        df = quotient(point_interval(1.0), Bounds(a.low if a.low > 0.0 else 0.0, a.high))
        return chain_spans(u, f, df, negative(square_of(df)))
    df = replace_nothing(quotient(point_interval(0.5), f))
    return chain_spans(u, f, df, quotient(negative(square_of(df)), f))


def widen_bounds(a: Bounds, size: cython.double) -> Bounds:
    """Widen bounds by the rounding of a polynomial whose terms have this size together."""
    return Bounds(a.low - 8.9e-16 * size, a.high + 8.9e-16 * size)


def span_of_upper_angle(y: Span, x: Span) -> Span:
    """Return atan2 on the branch of y >= 0, which continues below the negative x axis."""
    if x.value.low >= 0.0:
        value: Bounds = polar_angle(y.value, x.value)
        return span_of_angle(value, y, x) if is_off_cut(y.value, x.value) else jumping_span(value)
    bounds: Bounds = empty_interval()
    i: cython.int
    if y.value.low > 0.0 or x.value.high < 0.0:
        for i in range(4):
            side: cython.double = y.value.low if i < 2 else y.value.high
            f: cython.double = angle_on_branch(1.0, side, x.value.low if i % 2 == 0 else x.value.high)
            bounds = hull(bounds, Bounds(library_below(f), library_above(f)))
        return span_of_angle(bounds, y, x)
    if y.value.low >= 0.0:  # round the origin, which may be met
        return span_of_angle(Bounds(0.0, library_above(3.141592653589793)), y, x)
    return jumping_span(Bounds(library_below(-1.5707963267948966), library_above(4.71238898038469)))
