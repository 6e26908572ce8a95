"""Interval arithmetic: the smallest and the largest that a number may be, both rounded outward (Moore 1966).

    [a, b] + [c, d] = [a + c, b + d],    f([a, b]) = [f(a), f(b)] where f rises,    ...

Sums, square roots, and products and quotients named exact are moved by the sign of their own rounding error (Knuth,
Dekker): an exact result stays that number, so that what touches zero is not moved across it. Results of the C library
are moved by four units in the last place, more than their error. Limits may be infinite: then they are not reached. An
empty interval, as the square root of [-2, -1], has NaN limits.
"""

from __future__ import annotations

from math import acos, asin, atan, atan2, fabs, log, sqrt, tanh

from heuncli.kernel.declarations import *
from heuncli.kernel.evaluator import hypotenuse
from heuncli.kernel.libm import INFINITY, NAN, cos, cosh, exp, floor, pow, sin, sinh, tan

# Directed rounding


def round_down(x: cython.double) -> cython.double:
    """Return a number below x by one or two units in the last place (Rump and others 2009).

    It is also lower by 1e-250, so that products of what began at 0 are normal numbers: those below 1e-308 are slow.
    """
    if x == INFINITY:
        return 1.7976931348623157e308
    return x - (1.1102230246251568e-16 * fabs(x) + 1e-250)


def round_up(x: cython.double) -> cython.double:
    """Return a number above x by one or two units in the last place."""
    return -round_down(-x)


def sum_below(a: cython.double, b: cython.double) -> cython.double:
    """Return the largest number not above a + b."""
    s: cython.double = a + b
    if not -INFINITY < s < INFINITY:
        return round_down(s) if s == s else -INFINITY
    c: cython.double = s - a
    error: cython.double = (a - (s - c)) + (b - c)
    return s if error >= 0.0 else round_down(s)


def sum_above(a: cython.double, b: cython.double) -> cython.double:
    """Return the smallest number not below a + b."""
    return -sum_below(-a, -b)


def product_error(a: cython.double, b: cython.double, p: cython.double) -> cython.double:
    """a b - p, where p is their rounded product; NaN if its halves would leave the range of numbers."""
    if not (fabs(p) > 1e-270 and fabs(a) < 1e150 and fabs(b) < 1e150):
        return NAN
    c: cython.double = 134217729.0 * a  # 2**27 + 1 splits 53 bits into two halves
    a1: cython.double = c - (c - a)
    a2: cython.double = a - a1
    c = 134217729.0 * b
    b1: cython.double = c - (c - b)
    b2: cython.double = b - b1
    return ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2


def product_below(a: cython.double, b: cython.double) -> cython.double:
    """Return at most a b, and a b itself if that is a number; 0 times infinity, which is not reached, is 0."""
    p: cython.double = a * b
    if a == 0.0 or b == 0.0:
        return p if p == p else 0.0
    if p == 0.0 and (a > 0.0) == (b > 0.0):
        return 0.0
    error: cython.double = product_error(a, b, p)
    return p if error >= 0.0 else round_down(p)


def product_above(a: cython.double, b: cython.double) -> cython.double:
    """Return at least a b, and a b itself if that is a number."""
    return -product_below(-a, b)


def quotient_below(a: cython.double, b: cython.double) -> cython.double:
    """Return at most a / b, and a / b itself if that is a number; b is not 0."""
    q: cython.double = a / b
    if a == 0.0:
        return q
    if q != q:
        return -INFINITY
    p: cython.double = q * b
    rest: cython.double = (a - p) - product_error(q, b, p)
    return q if (rest >= 0.0 if b > 0.0 else rest <= 0.0) else round_down(q)


def quotient_above(a: cython.double, b: cython.double) -> cython.double:
    """Return at least a / b, and a / b itself if that is a number; b is not 0."""
    return -quotient_below(-a, b)


def library_below(f: cython.double) -> cython.double:
    """Return a number below a result f of the C library; its zeros are exact."""
    if f == 0.0:
        return f
    return round_down(f - 8.9e-16 * fabs(f) if f - f == 0.0 else f)


def library_above(f: cython.double) -> cython.double:
    """Return a number above a result f of the C library; its zeros are exact."""
    return -library_below(-f)


# Intervals


def point_interval(x: cython.double) -> Bounds:
    """Return the interval of one number."""
    return Bounds(x, x)


def all_numbers() -> Bounds:
    """Return the interval of all numbers."""
    return Bounds(-INFINITY, INFINITY)


def empty_interval() -> Bounds:
    """Return the interval without numbers."""
    return Bounds(NAN, NAN)


def is_empty(a: Bounds) -> cython.bint:
    """Return whether an interval contains no number."""
    return a.low != a.low


def is_zero(a: Bounds) -> cython.bint:
    """Return whether an interval contains 0 only."""
    return a.low == 0.0 and a.high == 0.0


def hull(a: Bounds, b: Bounds) -> Bounds:
    """Return the smallest interval that contains both."""
    if is_empty(a):
        return b
    if is_empty(b):
        return a
    return Bounds(a.low if a.low < b.low else b.low, a.high if a.high > b.high else b.high)


def intersect(a: Bounds, b: Bounds) -> Bounds:
    """Return the intersection; empty if they are disjoint."""
    low: cython.double = a.low if a.low > b.low else b.low
    high: cython.double = a.high if a.high < b.high else b.high
    return Bounds(low, high) if low <= high else empty_interval()


def negative(a: Bounds) -> Bounds:
    """-a."""
    return Bounds(-a.high, -a.low)


def magnitude(a: Bounds) -> Bounds:
    """|a|."""
    if a.low >= 0.0:
        return a
    if a.high <= 0.0:
        return negative(a)
    return Bounds(0.0, a.high if a.high > -a.low else -a.low)


def plus(a: Bounds, b: Bounds) -> Bounds:
    """a + b."""
    return Bounds(sum_below(a.low, b.low), sum_above(a.high, b.high))


def minus(a: Bounds, b: Bounds) -> Bounds:
    """a - b."""
    return Bounds(sum_below(a.low, -b.high), sum_above(a.high, -b.low))


def times(a: Bounds, b: Bounds) -> Bounds:
    """a b, by the signs of the limits."""
    if is_zero(a) or is_zero(b):
        return point_interval(0.0)
    if a.low >= 0.0:
        return widen_products(
            (a.low if b.low >= 0.0 else a.high) * b.low,
            (a.low if b.high <= 0.0 else a.high) * b.high,
        )
    if a.high <= 0.0:
        return negative(times(negative(a), b))
    if b.low >= 0.0 or b.high <= 0.0:
        return times(b, a)
    found: Bounds = widen_products(a.low * b.high, a.low * b.low)
    other: Bounds = widen_products(a.high * b.low, a.high * b.high)
    return Bounds(
        found.low if found.low < other.low else other.low, found.high if found.high > other.high else other.high
    )


def widen_products(low: cython.double, high: cython.double) -> Bounds:
    """Return the interval from one product to another; 0 times infinity, which is not reached, is 0."""
    return Bounds(round_down(low if low == low else 0.0), round_up(high if high == high else 0.0))


def exact_times(a: Bounds, b: Bounds) -> Bounds:
    """a b, by the signs of the limits; an exact product stays that number."""
    if a.low >= 0.0:
        return Bounds(
            product_below(a.low if b.low >= 0.0 else a.high, b.low),
            product_above(a.low if b.high <= 0.0 else a.high, b.high),
        )
    if a.high <= 0.0:
        return negative(exact_times(negative(a), b))
    if b.low >= 0.0 or b.high <= 0.0:
        return exact_times(b, a)
    low: cython.double = product_below(a.low, b.high)
    other: cython.double = product_below(a.high, b.low)
    high: cython.double = product_above(a.low, b.low)
    highest: cython.double = product_above(a.high, b.high)
    return Bounds(low if low < other else other, high if high > highest else highest)


def scale_bounds(s: cython.double, a: Bounds) -> Bounds:
    """s a, for a number s."""
    return times(point_interval(s), a)


def square_of(a: Bounds) -> Bounds:
    """a²."""
    if is_zero(a):
        return a
    m: Bounds = magnitude(a)
    low: cython.double = m.low * m.low
    return Bounds(round_down(low) if low > 0.0 else 0.0, round_up(m.high * m.high))


def quotient(a: Bounds, b: Bounds) -> Bounds:
    """a / b where b is not 0; an exact quotient stays that number."""
    if b.high < 0.0 or (b.high == 0.0 and b.low < 0.0):
        return quotient(negative(a), negative(b))
    if b.low > 0.0:
        return Bounds(
            quotient_below(a.low, b.high if a.low >= 0.0 else b.low),
            quotient_above(a.high, b.low if a.high >= 0.0 else b.high),
        )
    if is_zero(b):
        return empty_interval()
    if is_zero(a):
        return point_interval(0.0)
    if b.low < 0.0:
        return all_numbers()
    return Bounds(
        quotient_below(a.low, b.high) if a.low >= 0.0 else -INFINITY,
        quotient_above(a.high, b.high) if a.high <= 0.0 else INFINITY,
    )


# Powers


def power_below(x: cython.double, n: cython.int) -> cython.double:
    """Return at most x to the whole power n, for x >= 0."""
    product: cython.double = 1.0
    while n > 0:
        if n & 1:
            product = product_below(product, x)
        n = n >> 1
        if n > 0:
            x = product_below(x, x)
    return product


def power_above(x: cython.double, n: cython.int) -> cython.double:
    """Return at least x to the whole power n, for x >= 0."""
    product: cython.double = 1.0
    while n > 0:
        if n & 1:
            product = product_above(product, x)
        n = n >> 1
        if n > 0:
            x = product_above(x, x)
    return product


def raise_to_whole(a: Bounds, n: cython.int) -> Bounds:
    """a to the whole power n >= 0."""
    m: Bounds = magnitude(a)
    if n % 2 == 0 or a.low >= 0.0:
        return Bounds(power_below(m.low, n), power_above(m.high, n))
    if a.high <= 0.0:
        return Bounds(-power_above(m.high, n), -power_below(m.low, n))
    return Bounds(-power_above(-a.low, n), power_above(a.high, n))


def raise_to_number(a: Bounds, n: cython.double) -> Bounds:
    """a**n: of all of a if n is whole, else of its part that is not negative."""
    if n < 0.0:
        return quotient(point_interval(1.0), raise_to_number(a, -n))
    if floor(n) != n:
        if a.high < 0.0 and a.low > -INFINITY:
            return empty_interval()
        low: cython.double = library_below(pow(a.low, n)) if a.low > 0.0 else 0.0
        # (-infinity)**n is infinity in C
        return Bounds(low, library_power_above(a.high, n) if a.low > -INFINITY else INFINITY)
    m: Bounds = magnitude(a)
    if floor(0.5 * n) == 0.5 * n:
        return Bounds(library_below(pow(m.low, n)), library_power_above(m.high, n))
    return Bounds(
        library_below(pow(a.low, n)) if a.low >= 0.0 else -library_power_above(-a.low, n),
        -library_below(pow(-a.high, n)) if a.high < 0.0 else library_power_above(a.high, n),
    )


def library_power_above(x: cython.double, n: cython.double) -> cython.double:
    """Return at least x**n, for x >= 0; for a positive x it is positive, even if computed as 0."""
    f: cython.double = pow(x, n)
    return library_above(f) if f > 0.0 or x == 0.0 else round_up(0.0)


def raise_to_interval(a: Bounds, b: Bounds) -> Bounds:
    """a**b: for a positive a monotone in either; for a negative one there are only the whole powers, of both signs."""
    if b.low == b.high:
        return raise_to_number(a, b.low)
    m: Bounds = magnitude(a)
    found: Bounds = empty_interval()
    i: cython.int
    for i in range(4):
        x: cython.double = m.low if i < 2 else m.high
        y: cython.double = b.low if i % 2 == 0 else b.high
        f: cython.double = INFINITY if x == 0.0 and y < 0.0 else pow(x, y)
        found = hull(found, Bounds(library_below(f), library_above(f)))
    if found.low < 0.0:
        found = Bounds(0.0, found.high)
    return found if a.low >= 0.0 else Bounds(-found.high, found.high)


def square_root(a: Bounds) -> Bounds:
    """Return the square root of the part of a that is not negative."""
    if a.high < 0.0:
        return empty_interval()
    return Bounds(directed_root(a.low, 0) if a.low > 0.0 else 0.0, directed_root(a.high, 1))


def directed_root(x: cython.double, upward: cython.int) -> cython.double:
    """Return the square root of x >= 0, or the adjacent number below or above the true one."""
    s: cython.double = sqrt(x)
    if s == 0.0 or s - s != 0.0:
        return s
    p: cython.double = s * s
    rest: cython.double = (x - p) - product_error(s, s, p)
    if upward:
        return s if rest <= 0.0 else round_up(s)
    return s if rest >= 0.0 else round_down(s)


# The circle


def may_contain_phase(a: Bounds, phase: cython.double, period: cython.double) -> cython.bint:
    """Return whether the interval may contain phase + k period for some whole k; near its limits it may."""
    reach: cython.double = fabs(a.low) if fabs(a.low) > fabs(a.high) else fabs(a.high)
    reach = 8.9e-16 * reach
    return not (floor((a.high + reach - phase) / period) < (a.low - reach - phase) / period)


def clip_to_one(a: Bounds) -> Bounds:
    """Clip to [-1, 1]."""
    return Bounds(a.low if a.low > -1.0 else -1.0, a.high if a.high < 1.0 else 1.0)


def sine(a: Bounds) -> Bounds:
    """Return the sine: between the values at the limits, except for crests and troughs within."""
    f: cython.double = sin(a.low)
    g: cython.double = sin(a.high)
    low: cython.double = (
        -1.0 if may_contain_phase(a, -1.5707963267948966, 6.283185307179586) else library_below(f if f < g else g)
    )
    high: cython.double = (
        1.0 if may_contain_phase(a, 1.5707963267948966, 6.283185307179586) else library_above(f if f > g else g)
    )
    return clip_to_one(Bounds(low, high))


def cosine(a: Bounds) -> Bounds:
    """Return the cosine: between the values at the limits, except for crests and troughs within."""
    f: cython.double = cos(a.low)
    g: cython.double = cos(a.high)
    low: cython.double = (
        -1.0 if may_contain_phase(a, 3.141592653589793, 6.283185307179586) else library_below(f if f < g else g)
    )
    high: cython.double = 1.0 if may_contain_phase(a, 0.0, 6.283185307179586) else library_above(f if f > g else g)
    return clip_to_one(Bounds(low, high))


def tangent(a: Bounds) -> Bounds:
    """Return the tangent, which rises between its poles."""
    if may_contain_phase(a, 1.5707963267948966, 3.141592653589793):
        return all_numbers()
    return Bounds(library_below(tan(a.low)), library_above(tan(a.high)))


def arcsine(a: Bounds) -> Bounds:
    """Return the arcsine of the part between -1 and 1."""
    inside: Bounds = intersect(a, Bounds(-1.0, 1.0))
    return inside if is_empty(inside) else Bounds(library_below(asin(inside.low)), library_above(asin(inside.high)))


def arccosine(a: Bounds) -> Bounds:
    """Return the arccosine of the part between -1 and 1."""
    inside: Bounds = intersect(a, Bounds(-1.0, 1.0))
    return inside if is_empty(inside) else Bounds(library_below(acos(inside.high)), library_above(acos(inside.low)))


def arctangent(a: Bounds) -> Bounds:
    """Return the arctangent, which rises."""
    return Bounds(library_below(atan(a.low)), library_above(atan(a.high)))


def is_off_cut(y: Bounds, x: Bounds) -> cython.bint:
    """Return whether all points (x, y) lie off the negative x axis and the origin, where the angle jumps."""
    return y.low > 0.0 or y.high < 0.0 or x.low > 0.0


def polar_angle(y: Bounds, x: Bounds) -> Bounds:
    """atan2: smallest and largest at the corners if off the cut, else the full circle."""
    if not is_off_cut(y, x):
        return Bounds(-3.1415926535897936, 3.1415926535897936)
    found: Bounds = empty_interval()
    i: cython.int
    for i in range(4):
        f: cython.double = atan2(y.low if i < 2 else y.high, x.low if i % 2 == 0 else x.high)
        found = hull(found, Bounds(library_below(f), library_above(f)))
    return found


def distance(a: Bounds, b: Bounds) -> Bounds:
    """sqrt(a² + b²)."""
    m: Bounds = magnitude(a)
    n: Bounds = magnitude(b)
    low: cython.double = library_below(hypotenuse(m.low, n.low))
    high: cython.double = library_above(hypotenuse(m.high, n.high))
    return Bounds(low if low == low else round_down(INFINITY), high if high == high else INFINITY)


# The hyperbola


def hyperbolic_sine(a: Bounds) -> Bounds:
    """Return the hyperbolic sine, which rises."""
    return Bounds(library_below(sinh(a.low)), library_above(sinh(a.high)))


def hyperbolic_cosine(a: Bounds) -> Bounds:
    """Return the hyperbolic cosine, which rises with |a| from 1."""
    m: Bounds = magnitude(a)
    low: cython.double = library_below(cosh(m.low))
    return Bounds(low if low > 1.0 else 1.0, library_above(cosh(m.high)))


def hyperbolic_tangent(a: Bounds) -> Bounds:
    """Return the hyperbolic tangent, which rises from -1 to 1."""
    return clip_to_one(Bounds(library_below(tanh(a.low)), library_above(tanh(a.high))))


def exponential_function(a: Bounds) -> Bounds:
    """Return the exponential, which rises and is never negative; if computed as 0 it is not."""
    low: cython.double = library_below(exp(a.low))
    high: cython.double = exp(a.high)
    return Bounds(low if low > 0.0 else 0.0, library_above(high) if high > 0.0 else round_up(0.0))


def logarithm(a: Bounds) -> Bounds:
    """Return the natural logarithm of the part that is positive."""
    if not a.high > 0.0:
        return empty_interval()
    return Bounds(library_below(log(a.low)) if a.low > 0.0 else -INFINITY, library_above(log(a.high)))
