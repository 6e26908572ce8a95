"""Enclosures of programs: bounds of an expression, its rate and its second derivative over an interval of time.

A program runs on spans as evaluator.py runs it on numbers (`evaluate_program`) and on derivatives (`jet`): natural
interval arithmetic with the chain rules of the jets. No value within the interval lies outside the bounds. `ranges`
bounds t and the coordinates. Functions are taken over the part of a span on which they have values.

A branch that may change within the interval gives the hull of both; where it may jump the derivatives are unknown, and
where it may have a kink the second one is. Held branches (HOLD) continue smoothly, and `doubt` marks those that may
change within the operands' bounds.

    f in f(m) + f' [t0 - m, t1 - m],    f in f(m) + f'(m) [t0 - m, t1 - m] + f''/2 [t0 - m, t1 - m]²

The natural bounds are too wide by a term proportional to the interval's length, the second ones to its square, the
third ones to its cube.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import fabs, sqrt

from heuncli.kernel.declarations import *
from heuncli.kernel.evaluator import (
    angle_on_branch,
    evaluate_integral,
    find_integrand,
    find_piece,
    find_unwrapped_piece,
    read_integral_table,
    read_table,
    side_of_cut,
    takes_two,
)
from heuncli.kernel.expressions import Expressions
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
from heuncli.kernel.libm import INFINITY, floor

# Programs


def enclose(programs: cython.pointer[Programs], program: Program) -> Span:
    """Bound a program and its derivatives over `ranges`; an empty span if it has no value at all."""
    return run_on_spans(programs, programs.ranges, program, 0, empty_span())


def enclose_closely(programs: cython.pointer[Programs], program: Program) -> Span:
    """Bound a program more closely than `enclose` does, from its bounds at a point of the interval, where `middles` are
    the ranges.
    """
    whole: Span = enclose(programs, program)
    midpoint: Span = run_on_spans(programs, programs.middles, program, 0, empty_span())
    if is_empty(whole.value) or is_empty(midpoint.value):
        return whole
    distance_bounds: Bounds = minus(programs.ranges[0].value, programs.middles[0].value)
    square: Bounds = scale_bounds(0.5, square_of(distance_bounds))
    rounding: cython.double = midpoint.value.high - midpoint.value.low  # as it is met elsewhere, too
    midpoint_bounds: Bounds = Bounds(midpoint.value.low - rounding, midpoint.value.high + rounding)
    first: Bounds = plus(midpoint_bounds, times(whole.rate, distance_bounds))
    second: Bounds = plus(plus(midpoint_bounds, times(midpoint.rate, distance_bounds)), times(whole.second, square))
    rate: Bounds = plus(midpoint.rate, times(whole.second, distance_bounds))
    return Span(
        intersect_or_first(intersect_or_first(whole.value, first), second),
        intersect_or_first(whole.rate, rate),
        whole.second,
    )


def intersect_or_first(a: Bounds, b: Bounds) -> Bounds:
    """Return the intersection; a if rounding makes the two disjoint."""
    both: Bounds = intersect(a, b)
    return a if is_empty(both) else both


def run_on_spans(
    programs: cython.pointer[Programs], ranges: cython.pointer[Span], program: Program, height: cython.int, x: Span
) -> Span:
    """Run a program, or a branch of it, on ranges of the variables; x: the topmost span, below it `height` spans."""
    stack: cython.pointer[Span] = programs.spans
    position: cython.int = program.start
    end: cython.int = position + program.count
    while position < end:
        op: cython.int = programs.code[position].op
        k: cython.int = programs.code[position].argument
        position += 1
        if op <= VAR:
            stack[height] = x
            height += 1
            x = constant_span(point_interval(programs.constants[k])) if op == CONST else ranges[k]
        elif op <= MAX:
            height -= 1
            x = span_of_two(op, stack[height], x)
        elif op <= SQRT:
            x = span_of_one(op, x, k)
        elif op <= KNOT:
            x = span_of_table(op, programs.tables[k], read_table(programs, position, k), x)
            position += 1
        elif op == JUMP:
            position += k
        elif op == UNLESS:
            condition: Bounds = x.value
            height -= 1
            x = stack[height]
            if is_empty(condition):
                return empty_span()
            if is_zero(condition):
                position += k
            elif condition.low <= 0.0 and condition.high >= 0.0:
                then: Span = run_on_spans(programs, ranges, Program(position, k - 1), height, x)
                position += k  # behind the jump over the other branch
                k = programs.code[position - 1].argument
                other: Span = run_on_spans(programs, ranges, Program(position, k), height, x)
                position += k
                stack[height] = x
                height += 1
                x = merge_branches(then, other)
        elif op == INTEGRAL:
            x = span_of_integral(programs, ranges, position, k)
            position = end
        elif op <= NE or programs.holding == HELD:
            result: Span
            if op == HOLD:
                result = span_on_branch(programs, k, position, stack[height - 1], x)
                op = programs.code[position].op
                k = programs.code[position].argument
                position += 2 if op == TABLE or op == KNOT else 1
            else:
                result = span_of_truth(compare_bounds(op, stack[height - 1].value, x.value))
            if op >= LT and k == 1:
                stack[height - 1] = result
            else:
                height -= takes_two(op)
                x = result
    return x


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


def widen_bounds(a: Bounds, size: cython.double) -> Bounds:
    """Widen bounds by the rounding of a polynomial whose terms have this size together."""
    return Bounds(a.low - 8.9e-16 * size, a.high + 8.9e-16 * size)


# Integrals


def span_of_integral(
    programs: cython.pointer[Programs], ranges: cython.pointer[Span], position: cython.Py_ssize_t, k: cython.int
) -> Span:
    """Return the span of an integral over time: its values at the ends of the interval, and at most what its rate adds
    from either.
    """
    rate: Span = run_on_spans(programs, ranges, find_integrand(programs, position), 0, empty_span())
    if is_empty(rate.value):
        return empty_span()
    t: Bounds = ranges[0].value
    change: Bounds = times(rate.value, Bounds(0.0, minus(point_interval(t.high), point_interval(t.low)).high))
    first: Bounds = bound_integral(programs, ranges, position, k, t.low)
    last: Bounds = bound_integral(programs, ranges, position, k, t.high)
    if is_empty(first) or is_empty(last):
        return Span(all_numbers(), rate.value, rate.rate)
    return Span(intersect_or_first(plus(first, change), minus(last, change)), rate.value, rate.rate)


def bound_integral(
    programs: cython.pointer[Programs],
    ranges: cython.pointer[Span],
    position: cython.Py_ssize_t,
    k: cython.int,
    t: cython.double,
) -> Bounds:
    """Bound an integral at an instant; nothing where it has no value.

    Its error is the rounding of the instants at which the rate is summed up since the last knot.
    """
    f: cython.double = evaluate_integral(programs, position, k, t)
    if f - f != 0.0:
        return empty_interval()
    knots: Table = read_integral_table(programs, position, k)
    knot: cython.double = programs.constants[knots.knots + find_piece(programs.constants, knots, t)]
    time_range: Span = ranges[0]
    ranges[0] = Span(Bounds(knot if knot < t else t, t if knot < t else knot), point_interval(1.0), point_interval(0.0))
    rate: Bounds = run_on_spans(programs, ranges, find_integrand(programs, position), 0, empty_span()).value
    ranges[0] = time_range
    size: cython.double = 0.0 if is_empty(rate) else magnitude(rate).high
    return widen_bounds(point_interval(f), fabs(f) + size * (fabs(t) + fabs(knot)))


# Held branches


def span_on_branch(
    programs: cython.pointer[Programs], k: cython.int, position: cython.Py_ssize_t, a: Span, b: Span
) -> Span:
    """Return the span of the operation at `position` on the branch held[k], continued on both sides of its end; mark
    `doubt` if the branch may change.
    """
    op: cython.int = programs.code[position].op
    branch: cython.double = programs.held[k]
    if is_empty(b.value) or (takes_two(op) and is_empty(a.value)):
        return empty_span()
    if may_change(programs, position, branch, a.value, b.value):
        programs.doubt[k] = 1
    if op == ABS:
        return b if branch > 0.0 else negate_span(b)
    elif op == MIN or op == MAX:
        return b if branch == 1.0 else a
    elif op == ATAN2:
        return negate_span(span_of_upper_angle(negate_span(a), b)) if branch == 0.0 else span_of_upper_angle(a, b)
    elif op == TABLE:
        number: cython.int = programs.code[position].argument
        return span_of_piece(programs.tables[number], read_table(programs, position + 1, number), branch, b)
    return constant_span(point_interval(branch))


def may_change(
    programs: cython.pointer[Programs], position: cython.Py_ssize_t, branch: cython.double, a: Bounds, b: Bounds
) -> cython.bint:
    """Return whether the operation at `position` may take another branch within its operands (b alone, if it takes
    one).
    """
    op: cython.int = programs.code[position].op
    if op >= LT:
        return compare_bounds(op, a, b) != branch
    elif op == MIN or op == MAX:
        return selects_second(op, a, b) != branch
    elif op == ATAN2:  # the angle jumps behind the origin only
        return b.low < 0.0 and (a.low < 0.0 if branch == 1.0 else side_of_cut(a.high) == 1.0)
    elif op == TABLE or op == KNOT:
        k: cython.int = programs.code[position].argument
        table: Table = read_table(programs, position + 1, k)
        low: cython.double = find_unwrapped_piece(programs.tables[k], table, b.low)
        return low != branch or find_unwrapped_piece(programs.tables[k], table, b.high) != branch
    elif op == SIGN and branch == 0.0:
        return not is_zero(b)
    elif op == SIGN and branch == 1.0:
        return not b.low > 0.0
    return not (b.low >= 0.0 if branch > 0.0 else b.high < 0.0)


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


# The doors


def find_span(
    expressions: Expressions, start: cython.int, count: cython.int, ranges: Sequence[Sequence[float]]
) -> tuple[float, ...]:
    """Bound one program: low and high of its value, its rate and its second derivative.

    ranges: the same six numbers for each variable, t first.
    """
    programs: cython.pointer[Programs] = cython.address(expressions.programs)
    set_ranges(expressions, start, count, programs.ranges, ranges)
    return span_limits(enclose(programs, Program(start, count)))


def find_close_span(
    expressions: Expressions,
    start: cython.int,
    count: cython.int,
    ranges: Sequence[Sequence[float]],
    middles: Sequence[Sequence[float]],
) -> tuple[float, ...]:
    """Bound one program as `find_span` does, more closely, from the ranges at an instant of the interval."""
    programs: cython.pointer[Programs] = cython.address(expressions.programs)
    set_ranges(expressions, start, count, programs.ranges, ranges)
    set_ranges(expressions, start, count, programs.middles, middles)
    return span_limits(enclose_closely(programs, Program(start, count)))


def set_ranges(
    expressions: Expressions,
    start: cython.Py_ssize_t,
    count: cython.Py_ssize_t,
    target: cython.pointer[Span],
    ranges: Sequence[Sequence[float]],
) -> None:
    """Set the ranges of the variables, six numbers each. Raises ValueError for a wrong number of variables."""
    i: cython.Py_ssize_t
    expressions.check(start, count)
    if len(ranges) != expressions.variables:
        raise ValueError(f"there are {expressions.variables} variables, not {len(ranges)}")
    for i in range(expressions.variables):
        a, b, c, d, e, f = ranges[i]
        target[i] = Span(Bounds(a, b), Bounds(c, d), Bounds(e, f))


def span_limits(u: Span) -> tuple[float, ...]:
    """Return a span's six limits."""
    return (u.value.low, u.value.high, u.rate.low, u.rate.high, u.second.low, u.second.high)


def find_bounds(
    expressions: Expressions,
    start: cython.int,
    count: cython.int,
    begins: cython.double[::1],
    ends: cython.double[::1],
    least: cython.double[::1],
    largest: cython.double[::1],
) -> None:
    """Bound one program in time alone over many intervals of time; write to `least` and `largest`."""
    i: cython.Py_ssize_t
    programs: cython.pointer[Programs] = cython.address(expressions.programs)
    expressions.check(start, count)
    if not len(begins) == len(ends) == len(least) == len(largest):
        raise ValueError("as many ends and bounds as stretches")
    for i in range(expressions.variables):
        programs.ranges[i] = jumping_span(all_numbers())
        programs.middles[i] = jumping_span(all_numbers())
    for i in range(len(begins)):
        middle: cython.double = begins[i] + 0.5 * (ends[i] - begins[i])
        programs.ranges[0] = Span(Bounds(begins[i], ends[i]), point_interval(1.0), point_interval(0.0))
        programs.middles[0] = Span(point_interval(middle), point_interval(1.0), point_interval(0.0))
        found: Span = enclose_closely(programs, Program(start, count))
        least[i] = found.value.low
        largest[i] = found.value.high


def find_natural_bounds(
    expressions: Expressions,
    start: cython.int,
    count: cython.int,
    begins: cython.double[::1],
    ends: cython.double[::1],
    least: cython.double[::1],
    largest: cython.double[::1],
    slowest: cython.double[::1],
    fastest: cython.double[::1],
) -> None:
    """Write natural bounds of the value and the rate of one program in time alone over many intervals of time."""
    i: cython.Py_ssize_t
    programs: cython.pointer[Programs] = cython.address(expressions.programs)
    expressions.check(start, count)
    if not len(begins) == len(ends) == len(least) == len(largest) == len(slowest) == len(fastest):
        raise ValueError("as many ends and bounds as stretches")
    for i in range(expressions.variables):
        programs.ranges[i] = jumping_span(all_numbers())
    for i in range(len(begins)):
        programs.ranges[0] = Span(Bounds(begins[i], ends[i]), point_interval(1.0), point_interval(0.0))
        found: Span = enclose(programs, Program(start, count))
        least[i] = found.value.low
        largest[i] = found.value.high
        slowest[i] = found.rate.low
        fastest[i] = found.rate.high
