"""Bounds of tables, which are piecewise cubics, over a span of their argument.

A cubic's extremes are found exactly, and widened by the rounding of the polynomial.
"""

from __future__ import annotations

from math import fabs, sqrt

from heuncli.kernel.declarations import *
from heuncli.kernel.evaluator import find_piece, find_unwrapped_piece
from heuncli.kernel.intervals import (
    all_numbers,
    exact_times,
    hull,
    intersect,
    is_empty,
    is_zero,
    magnitude,
    minus,
    plus,
    point_interval,
    scale_bounds,
    times,
)
from heuncli.kernel.libm import INFINITY, floor
from heuncli.kernel.spans import chain_spans, constant_span, empty_span, jumping_span, widen_bounds

# Tables


def span_of_table(op: cython.int, c: cython.p_double, table: Table, u: Span) -> Span:
    """Return the table at u, over all the pieces that u meets, or the numbers of these pieces."""
    if is_empty(u.value):
        return empty_span()
    a: Bounds = u.value
    if op == KNOT:
        numbers: Bounds = Bounds(find_unwrapped_piece(c, table, a.low), find_unwrapped_piece(c, table, a.high))
        return constant_span(numbers) if numbers.low == numbers.high else jumping_span(numbers)
    result: Span
    if table.outside == PERIODIC:
        result = span_of_periodic_table(c, table, a)
        return chain_spans(u, result.value, result.rate, result.second)
    inside: Bounds = intersect(a, Bounds(c[table.knots], c[table.knots + table.pieces]))
    if is_empty(inside):
        return span_outside_table(c, table, a.low < c[table.knots])
    result = span_of_pieces(c, table, inside, find_piece(c, table, inside.low), find_piece(c, table, inside.high))
    if inside.low == a.low and inside.high == a.high:
        return chain_spans(u, result.value, result.rate, result.second)
    # it stands still beyond, or has no value
    return chain_spans(u, result.value, hull(result.rate, point_interval(0.0)), all_numbers())


def span_outside_table(c: cython.p_double, table: Table, is_before: cython.bint) -> Span:
    """Return a table's span before its first or after its last knot: its value there, or none."""
    if table.outside != EXTENDED:
        return empty_span()
    k: cython.int = 0 if is_before else table.pieces - 1
    x: cython.double = c[table.knots + (0 if is_before else table.pieces)]
    return constant_span(span_of_pieces(c, table, point_interval(x), k, k).value)


def span_of_periodic_table(c: cython.p_double, table: Table, a: Bounds) -> Span:
    """Return value, slope and second derivative of a periodic table over a."""
    n: cython.int = table.pieces
    first: cython.double = find_unwrapped_piece(c, table, a.low)
    last: cython.double = find_unwrapped_piece(c, table, a.high)
    turn: cython.double = floor(first / n)
    whole: Bounds = Bounds(c[table.knots], c[table.knots + n])
    if not (last - first < n and fabs(first) < 1e15):  # whole numbers have no more digits
        return allow_kinks(span_of_pieces(c, table, whole, 0, n - 1))
    first_period: Bounds = minus(a, exact_times(point_interval(turn), point_interval(table.period)))
    begin: cython.int = int(first - n * turn)
    if floor(last / n) == turn:
        return span_of_pieces(c, table, first_period, begin, int(last - n * turn))
    second_period: Bounds = minus(a, exact_times(point_interval(turn + 1.0), point_interval(table.period)))
    end: cython.int = int(last - n * (turn + 1.0))
    result: Span = span_of_pieces(c, table, Bounds(first_period.low, whole.high), begin, n - 1)
    return allow_kinks(merge_pieces(result, span_of_pieces(c, table, Bounds(whole.low, second_period.high), 0, end)))


def span_of_pieces(c: cython.p_double, table: Table, inside: Bounds, begin: cython.int, end: cython.int) -> Span:
    """Return value, slope and second derivative within the table's own range, from piece `begin` to piece `end`."""
    result: Span = empty_span()
    k: cython.int
    for k in range(begin, end + 1):
        knot: cython.double = c[table.knots + k]
        h: Bounds = minus(inside, point_interval(knot))
        width: cython.double = minus(point_interval(c[table.knots + k + 1]), point_interval(knot)).high
        low: cython.double = h.low if k == begin and h.low > 0.0 else 0.0
        high: cython.double = h.high if k == end and h.high < width else width
        low = low if low < width else width
        result = merge_pieces(
            result, span_of_cubic(c, table.coefficients + 4 * k, Bounds(low, high if high > low else low))
        )
    return allow_kinks(result) if end > begin else result


def merge_pieces(a: Span, b: Span) -> Span:
    """Return the span of one or the other, without jumps between them."""
    return Span(hull(a.value, b.value), hull(a.rate, b.rate), hull(a.second, b.second))


def allow_kinks(pieces: Span) -> Span:
    """Return the span of pieces with knots between them: curves have no kinks there (scene/expressions/curves.py),
    lines do.
    """
    return Span(pieces.value, pieces.rate, all_numbers()) if is_zero(pieces.second) else pieces


def span_of_cubic(c: cython.p_double, i: cython.Py_ssize_t, h: Bounds) -> Span:
    """Return value, slope and second derivative of the cubic c0 + c1 h + c2 h² + c3 h³, coefficients from i on."""
    value: Bounds = hull(bound_cubic(c, i, h.low), bound_cubic(c, i, h.high))
    if c[i + 2] == 0.0 and c[i + 3] == 0.0:  # rising or falling, also as it is computed
        return Span(value, point_interval(c[i + 1]), point_interval(0.0))
    m: cython.double = magnitude(h).high
    if not m < INFINITY:
        return jumping_span(all_numbers())
    slope: Bounds = hull(bound_cubic_slope(c, i, h.low), bound_cubic_slope(c, i, h.high))
    if c[i + 3] == 0.0:
        value = include_extreme(value, c, i, h, -0.5 * c[i + 1] / c[i + 2])
    else:
        vertex: cython.double = -c[i + 2] / (3.0 * c[i + 3])
        if h.low < vertex and vertex < h.high:
            slope = hull(slope, bound_cubic_slope(c, i, vertex))
        square: cython.double = c[i + 2] * c[i + 2] - 3.0 * c[i + 3] * c[i + 1]
        if square >= 0.0:
            q: cython.double = sqrt(square)
            q = -(c[i + 2] + (q if c[i + 2] >= 0.0 else -q))
            value = include_extreme(value, c, i, h, q / (3.0 * c[i + 3]))
            if q != 0.0:
                value = include_extreme(value, c, i, h, c[i + 1] / q)
    bend: Bounds = plus(
        scale_bounds(2.0, point_interval(c[i + 2])), times(scale_bounds(6.0, point_interval(c[i + 3])), h)
    )
    second: cython.double = fabs(c[i + 2]) * m
    third: cython.double = fabs(c[i + 3]) * m * m
    slope = widen_bounds(slope, fabs(c[i + 1]) + 2.0 * second + 3.0 * third)
    return Span(widen_bounds(value, fabs(c[i]) + m * (fabs(c[i + 1]) + second + third)), slope, bend)


def bound_cubic(c: cython.p_double, i: cython.Py_ssize_t, h: cython.double) -> Bounds:
    """Bound the cubic at one h."""
    x: Bounds = point_interval(h)
    inner: Bounds = plus(
        exact_times(plus(exact_times(point_interval(c[i + 3]), x), point_interval(c[i + 2])), x),
        point_interval(c[i + 1]),
    )
    return plus(exact_times(inner, x), point_interval(c[i]))


def bound_cubic_slope(c: cython.p_double, i: cython.Py_ssize_t, h: cython.double) -> Bounds:
    """Bound its slope at one h."""
    x: Bounds = point_interval(h)
    inner: Bounds = plus(
        times(scale_bounds(3.0, point_interval(c[i + 3])), x), scale_bounds(2.0, point_interval(c[i + 2]))
    )
    return plus(times(inner, x), point_interval(c[i + 1]))


def include_extreme(value: Bounds, c: cython.p_double, i: cython.Py_ssize_t, h: Bounds, x: cython.double) -> Bounds:
    """Include the cubic's value at x, where it has an extreme, if that is within h."""
    return hull(value, bound_cubic(c, i, x)) if h.low < x and x < h.high else value


def span_of_piece(c: cython.p_double, table: Table, unwrapped_number: cython.double, u: Span) -> Span:
    """Return the cubic of a piece, by its unwrapped number, at u; outside the table the value at its end, or none."""
    n: cython.int = table.pieces
    turns: cython.double = floor(unwrapped_number / n) if table.outside == PERIODIC else 0.0
    number: cython.double = unwrapped_number - n * turns
    if not (-1.0 <= number and number <= n):
        return empty_span()
    if number < 0.0 or number >= n:
        return span_outside_table(c, table, number < 0.0)
    k: cython.int = int(number)
    argument: Bounds = minus(u.value, exact_times(point_interval(turns), point_interval(table.period)))
    result: Span = span_of_cubic(c, table.coefficients + 4 * k, minus(argument, point_interval(c[table.knots + k])))
    return chain_spans(u, result.value, result.rate, result.second)
