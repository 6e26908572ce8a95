"""Interval arithmetic: the least and the largest that a number may be, both rounded outward (Moore 1966).

    [a, b] + [c, d] = [a + c, b + d],    f([a, b]) = [f(a), f(b)] where f rises,    ...

Sums, square roots, and products and quotients named exact are moved by the sign of their own rounding error (Knuth,
Dekker): what is a number stays that number, so that what touches zero is not moved across. What the C library computes
is moved by four units in the last place, more than it errs. Ends may be infinite: then they are not reached. An
interval without numbers, as the root of [-2, -1], has NaN ends.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import acos, asin, atan, atan2, fabs, log, sqrt, tanh

    from heuncli.kernel.evaluator import length
    from heuncli.kernel.libm import INFINITY, NAN, cos, cosh, exp, floor, pow, sin, sinh, tan
    from heuncli.kernel.programs import Bounds
    from heuncli.kernel.shadow import cython


# Directed rounding


def down(x: cython.double) -> cython.double:
    """Below x by a unit in the last place or two (Rump and others 2009).

    And by 1e-250, so that what began at 0 has products that are normal numbers: those below 1e-308 are slow.
    """
    if x == INFINITY:
        return 1.7976931348623157e308
    return x - (1.1102230246251568e-16 * fabs(x) + 1e-250)


def up(x: cython.double) -> cython.double:
    """Above x by a unit in the last place or two."""
    return -down(-x)


def sum_below(a: cython.double, b: cython.double) -> cython.double:
    """The largest number not above a + b."""
    s: cython.double = a + b
    if not -INFINITY < s < INFINITY:
        return down(s) if s == s else -INFINITY
    c: cython.double = s - a
    error: cython.double = (a - (s - c)) + (b - c)
    return s if error >= 0.0 else down(s)


def sum_above(a: cython.double, b: cython.double) -> cython.double:
    """The least number not below a + b."""
    return -sum_below(-a, -b)


def product_error(a: cython.double, b: cython.double, p: cython.double) -> cython.double:
    """a b - p, where p is their rounded product; NaN where its halves would leave the range of numbers."""
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
    """At most a b, and a b itself where that is a number; 0 times infinity, which is not reached, is 0."""
    p: cython.double = a * b
    if a == 0.0 or b == 0.0:
        return p if p == p else 0.0
    if p == 0.0 and (a > 0.0) == (b > 0.0):
        return 0.0
    error: cython.double = product_error(a, b, p)
    return p if error >= 0.0 else down(p)


def product_above(a: cython.double, b: cython.double) -> cython.double:
    """At least a b, and a b itself where that is a number."""
    return -product_below(-a, b)


def quotient_below(a: cython.double, b: cython.double) -> cython.double:
    """At most a / b, and a / b itself where that is a number; b is not 0."""
    q: cython.double = a / b
    if a == 0.0:
        return q
    if q != q:
        return -INFINITY
    p: cython.double = q * b
    rest: cython.double = (a - p) - product_error(q, b, p)
    return q if (rest >= 0.0 if b > 0.0 else rest <= 0.0) else down(q)


def quotient_above(a: cython.double, b: cython.double) -> cython.double:
    """At least a / b, and a / b itself where that is a number; b is not 0."""
    return -quotient_below(-a, b)


def less(f: cython.double) -> cython.double:
    """Below what the C library says is f; a 0 of its functions is exact."""
    if f == 0.0:
        return f
    return down(f - 8.9e-16 * fabs(f) if f - f == 0.0 else f)


def more(f: cython.double) -> cython.double:
    """Above what the C library says is f; a 0 of its functions is exact."""
    return -less(-f)


# Intervals


def point(x: cython.double) -> Bounds:
    """One number."""
    return Bounds(x, x)


def anything() -> Bounds:
    """All numbers."""
    return Bounds(-INFINITY, INFINITY)


def nothing() -> Bounds:
    """No number."""
    return Bounds(NAN, NAN)


def is_nothing(a: Bounds) -> cython.bint:
    """Whether there is no number in it."""
    return a.low != a.low


def is_zero(a: Bounds) -> cython.bint:
    """Whether it is 0 and nothing else."""
    return a.low == 0.0 and a.high == 0.0


def hull(a: Bounds, b: Bounds) -> Bounds:
    """What is in one or the other, and between."""
    if is_nothing(a):
        return b
    if is_nothing(b):
        return a
    return Bounds(a.low if a.low < b.low else b.low, a.high if a.high > b.high else b.high)


def meet(a: Bounds, b: Bounds) -> Bounds:
    """What is in both; nothing where they are apart."""
    low: cython.double = a.low if a.low > b.low else b.low
    high: cython.double = a.high if a.high < b.high else b.high
    return Bounds(low, high) if low <= high else nothing()


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
    """a b, by the signs of the ends."""
    if is_zero(a) or is_zero(b):
        return point(0.0)
    if a.low >= 0.0:
        return outward(
            (a.low if b.low >= 0.0 else a.high) * b.low,
            (a.low if b.high <= 0.0 else a.high) * b.high,
        )
    if a.high <= 0.0:
        return negative(times(negative(a), b))
    if b.low >= 0.0 or b.high <= 0.0:
        return times(b, a)
    found: Bounds = outward(a.low * b.high, a.low * b.low)
    other: Bounds = outward(a.high * b.low, a.high * b.high)
    return Bounds(
        found.low if found.low < other.low else other.low, found.high if found.high > other.high else other.high
    )


def outward(low: cython.double, high: cython.double) -> Bounds:
    """From one product to another; 0 times infinity, which is not reached, is 0."""
    return Bounds(down(low if low == low else 0.0), up(high if high == high else 0.0))


def exact_times(a: Bounds, b: Bounds) -> Bounds:
    """a b, by the signs of the ends; what is a number stays that number."""
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
    return times(point(s), a)


def squared(a: Bounds) -> Bounds:
    """a²."""
    if is_zero(a):
        return a
    m: Bounds = magnitude(a)
    low: cython.double = m.low * m.low
    return Bounds(down(low) if low > 0.0 else 0.0, up(m.high * m.high))


def over(a: Bounds, b: Bounds) -> Bounds:
    """a / b, where b is not 0; what is a number stays that number."""
    if b.high < 0.0 or (b.high == 0.0 and b.low < 0.0):
        return over(negative(a), negative(b))
    if b.low > 0.0:
        return Bounds(
            quotient_below(a.low, b.high if a.low >= 0.0 else b.low),
            quotient_above(a.high, b.low if a.high >= 0.0 else b.high),
        )
    if is_zero(b):
        return nothing()
    if is_zero(a):
        return point(0.0)
    if b.low < 0.0:
        return anything()
    return Bounds(
        quotient_below(a.low, b.high) if a.low >= 0.0 else -INFINITY,
        quotient_above(a.high, b.high) if a.high <= 0.0 else INFINITY,
    )


# Powers


def power_below(x: cython.double, n: cython.int) -> cython.double:
    """At most x to the whole power n, of x >= 0."""
    product: cython.double = 1.0
    while n > 0:
        if n & 1:
            product = product_below(product, x)
        n = n >> 1
        if n > 0:
            x = product_below(x, x)
    return product


def power_above(x: cython.double, n: cython.int) -> cython.double:
    """At least x to the whole power n, of x >= 0."""
    product: cython.double = 1.0
    while n > 0:
        if n & 1:
            product = product_above(product, x)
        n = n >> 1
        if n > 0:
            x = product_above(x, x)
    return product


def to_whole(a: Bounds, n: cython.int) -> Bounds:
    """a to the whole power n >= 0."""
    m: Bounds = magnitude(a)
    if n % 2 == 0 or a.low >= 0.0:
        return Bounds(power_below(m.low, n), power_above(m.high, n))
    if a.high <= 0.0:
        return Bounds(-power_above(m.high, n), -power_below(m.low, n))
    return Bounds(-power_above(-a.low, n), power_above(a.high, n))


def to_number(a: Bounds, n: cython.double) -> Bounds:
    """a**n: of all of a where n is whole, else of what is not negative."""
    if n < 0.0:
        return over(point(1.0), to_number(a, -n))
    if floor(n) != n:
        if a.high < 0.0 and a.low > -INFINITY:
            return nothing()
        low: cython.double = less(pow(a.low, n)) if a.low > 0.0 else 0.0
        return Bounds(low, power_over(a.high, n) if a.low > -INFINITY else INFINITY)  # (-infinity)**n is infinity in C
    m: Bounds = magnitude(a)
    if floor(0.5 * n) == 0.5 * n:
        return Bounds(less(pow(m.low, n)), power_over(m.high, n))
    return Bounds(
        less(pow(a.low, n)) if a.low >= 0.0 else -power_over(-a.low, n),
        -less(pow(-a.high, n)) if a.high < 0.0 else power_over(a.high, n),
    )


def power_over(x: cython.double, n: cython.double) -> cython.double:
    """At least x**n, of x >= 0; of a positive x it is positive, though computed as 0."""
    f: cython.double = pow(x, n)
    return more(f) if f > 0.0 or x == 0.0 else up(0.0)


def to_power(a: Bounds, b: Bounds) -> Bounds:
    """a**b: of a positive a monotone in either; of a negative one there are only the whole powers, of both signs."""
    if b.low == b.high:
        return to_number(a, b.low)
    m: Bounds = magnitude(a)
    found: Bounds = nothing()
    i: cython.int
    for i in range(4):
        x: cython.double = m.low if i < 2 else m.high
        y: cython.double = b.low if i % 2 == 0 else b.high
        f: cython.double = INFINITY if x == 0.0 and y < 0.0 else pow(x, y)
        found = hull(found, Bounds(less(f), more(f)))
    if found.low < 0.0:
        found = Bounds(0.0, found.high)
    return found if a.low >= 0.0 else Bounds(-found.high, found.high)


def root(a: Bounds) -> Bounds:
    """The square root of what is not negative."""
    if a.high < 0.0:
        return nothing()
    return Bounds(root_of(a.low, 0) if a.low > 0.0 else 0.0, root_of(a.high, 1))


def root_of(x: cython.double, upward: cython.int) -> cython.double:
    """The square root of x >= 0, or the number beside it that is below or above the true one."""
    s: cython.double = sqrt(x)
    if s == 0.0 or s - s != 0.0:
        return s
    p: cython.double = s * s
    rest: cython.double = (x - p) - product_error(s, s, p)
    if upward:
        return s if rest <= 0.0 else up(s)
    return s if rest >= 0.0 else down(s)


# The circle


def comes_to(a: Bounds, phase: cython.double, period: cython.double) -> cython.bint:
    """Whether phase + k period may be in it for some whole k; near its ends it may."""
    reach: cython.double = fabs(a.low) if fabs(a.low) > fabs(a.high) else fabs(a.high)
    reach = 8.9e-16 * reach
    return not (floor((a.high + reach - phase) / period) < (a.low - reach - phase) / period)


def within_one(a: Bounds) -> Bounds:
    """Cut down to [-1, 1]."""
    return Bounds(a.low if a.low > -1.0 else -1.0, a.high if a.high < 1.0 else 1.0)


def sine(a: Bounds) -> Bounds:
    """Between the values at the ends, but for crests and troughs within."""
    f: cython.double = sin(a.low)
    g: cython.double = sin(a.high)
    low: cython.double = -1.0 if comes_to(a, -1.5707963267948966, 6.283185307179586) else less(f if f < g else g)
    high: cython.double = 1.0 if comes_to(a, 1.5707963267948966, 6.283185307179586) else more(f if f > g else g)
    return within_one(Bounds(low, high))


def cosine(a: Bounds) -> Bounds:
    """Between the values at the ends, but for crests and troughs within."""
    f: cython.double = cos(a.low)
    g: cython.double = cos(a.high)
    low: cython.double = -1.0 if comes_to(a, 3.141592653589793, 6.283185307179586) else less(f if f < g else g)
    high: cython.double = 1.0 if comes_to(a, 0.0, 6.283185307179586) else more(f if f > g else g)
    return within_one(Bounds(low, high))


def tangent(a: Bounds) -> Bounds:
    """Rising between its poles."""
    if comes_to(a, 1.5707963267948966, 3.141592653589793):
        return anything()
    return Bounds(less(tan(a.low)), more(tan(a.high)))


def arcsine(a: Bounds) -> Bounds:
    """Of what is between -1 and 1."""
    inside: Bounds = meet(a, Bounds(-1.0, 1.0))
    return inside if is_nothing(inside) else Bounds(less(asin(inside.low)), more(asin(inside.high)))


def arccosine(a: Bounds) -> Bounds:
    """Of what is between -1 and 1."""
    inside: Bounds = meet(a, Bounds(-1.0, 1.0))
    return inside if is_nothing(inside) else Bounds(less(acos(inside.high)), more(acos(inside.low)))


def arctangent(a: Bounds) -> Bounds:
    """Rising."""
    return Bounds(less(atan(a.low)), more(atan(a.high)))


def off_the_cut(y: Bounds, x: Bounds) -> cython.bint:
    """Whether the points (x, y) all lie off the negative x axis and the origin, where the angle jumps."""
    return y.low > 0.0 or y.high < 0.0 or x.low > 0.0


def angle(y: Bounds, x: Bounds) -> Bounds:
    """atan2: least and largest at corners off the cut, else all round."""
    if not off_the_cut(y, x):
        return Bounds(-3.1415926535897936, 3.1415926535897936)
    found: Bounds = nothing()
    i: cython.int
    for i in range(4):
        f: cython.double = atan2(y.low if i < 2 else y.high, x.low if i % 2 == 0 else x.high)
        found = hull(found, Bounds(less(f), more(f)))
    return found


def distance(a: Bounds, b: Bounds) -> Bounds:
    """sqrt(a² + b²)."""
    m: Bounds = magnitude(a)
    n: Bounds = magnitude(b)
    low: cython.double = less(length(m.low, n.low))
    high: cython.double = more(length(m.high, n.high))
    return Bounds(low if low == low else down(INFINITY), high if high == high else INFINITY)


# The hyperbola


def hyperbolic_sine(a: Bounds) -> Bounds:
    """Rising."""
    return Bounds(less(sinh(a.low)), more(sinh(a.high)))


def hyperbolic_cosine(a: Bounds) -> Bounds:
    """Rising with |a|, from 1."""
    m: Bounds = magnitude(a)
    low: cython.double = less(cosh(m.low))
    return Bounds(low if low > 1.0 else 1.0, more(cosh(m.high)))


def hyperbolic_tangent(a: Bounds) -> Bounds:
    """Rising from -1 to 1."""
    return within_one(Bounds(less(tanh(a.low)), more(tanh(a.high))))


def exponential_of(a: Bounds) -> Bounds:
    """Rising, never negative; what is computed as 0 is not."""
    low: cython.double = less(exp(a.low))
    high: cython.double = exp(a.high)
    return Bounds(low if low > 0.0 else 0.0, more(high) if high > 0.0 else up(0.0))


def logarithm(a: Bounds) -> Bounds:
    """Of what is positive."""
    if not a.high > 0.0:
        return nothing()
    return Bounds(less(log(a.low)) if a.low > 0.0 else -INFINITY, more(log(a.high)))
