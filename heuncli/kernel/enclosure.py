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
from math import fabs

from heuncli.kernel.declarations import *
from heuncli.kernel.evaluator import (
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
    empty_interval,
    is_empty,
    is_zero,
    magnitude,
    minus,
    plus,
    point_interval,
    scale_bounds,
    square_of,
    times,
)
from heuncli.kernel.span_tables import span_of_piece, span_of_table
from heuncli.kernel.spans import (
    compare_bounds,
    constant_span,
    empty_span,
    intersect_or_first,
    jumping_span,
    merge_branches,
    negate_span,
    selects_second,
    span_of_one,
    span_of_truth,
    span_of_two,
    span_of_upper_angle,
    widen_bounds,
)

# The bounds that `find_natural_bounds` writes for an interval.
VALUE_LOW, VALUE_HIGH, RATE_LOW, RATE_HIGH = range(4)
BOUND_COUNT = 4


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
    branch: cython.double = programs.branches[k]
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
    bounds: cython.double[::1],
) -> None:
    """Write natural bounds of one program in time alone over many intervals of time: four numbers for each, the least
    and largest value, and the least and largest rate.
    """
    i: cython.Py_ssize_t
    programs: cython.pointer[Programs] = cython.address(expressions.programs)
    expressions.check(start, count)
    if not len(begins) == len(ends) or len(bounds) != BOUND_COUNT * len(begins):
        raise ValueError("as many ends as starts, and four bounds for each")
    for i in range(expressions.variables):
        programs.ranges[i] = jumping_span(all_numbers())
    for i in range(len(begins)):
        programs.ranges[0] = Span(Bounds(begins[i], ends[i]), point_interval(1.0), point_interval(0.0))
        found: Span = enclose(programs, Program(start, count))
        bounds[BOUND_COUNT * i + VALUE_LOW] = found.value.low
        bounds[BOUND_COUNT * i + VALUE_HIGH] = found.value.high
        bounds[BOUND_COUNT * i + RATE_LOW] = found.rate.low
        bounds[BOUND_COUNT * i + RATE_HIGH] = found.rate.high
