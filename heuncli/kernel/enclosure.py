"""Enclosures of programs: what an expression, its rate and its second derivative may be over a stretch of time.

A program runs on spans as evaluator.py runs it on numbers (`value`) and on derivatives (`jet`): natural interval
arithmetic with the chain rules of the jets. No value of the stretch is outside, seen or not. `ranges` says what t and
the coordinates may be. Functions are taken over the part of a span on which they have values.

A branch that may change within the stretch leaves the hull of both; where it may jump the derivatives are unknown, and
where it may bend the second is. Held branches (HOLD) go on smoothly, and `doubt` tells where the operands cannot
exclude that the branch changes.

    f in f(m) + f' [t0 - m, t1 - m],    f in f(m) + f'(m) [t0 - m, t1 - m] + f''/2 [t0 - m, t1 - m]²

The natural bounds are too wide by what goes with the stretch, the second by its square, the third by its cube.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

from collections.abc import Sequence

if not cython.compiled:
    from math import fabs, sqrt

    from heuncli.kernel.evaluator import (
        angle_on,
        integral,
        integrated,
        piece,
        piece_counted,
        side_of_cut,
        summed_at,
        table_at,
        takes_two,
    )
    from heuncli.kernel.expressions import Expressions
    from heuncli.kernel.intervals import (
        angle,
        anything,
        arccosine,
        arcsine,
        arctangent,
        cosine,
        distance,
        exact_times,
        exponential_of,
        hull,
        hyperbolic_cosine,
        hyperbolic_sine,
        hyperbolic_tangent,
        is_nothing,
        is_zero,
        less,
        logarithm,
        magnitude,
        meet,
        minus,
        more,
        negative,
        nothing,
        off_the_cut,
        over,
        plus,
        point,
        root,
        scale_bounds,
        sine,
        squared,
        tangent,
        times,
        to_number,
        to_power,
        to_whole,
    )
    from heuncli.kernel.libm import INFINITY, floor
    from heuncli.kernel.programs import (
        ABS,
        ADD,
        ASIN,
        ATAN,
        ATAN2,
        CONST,
        COS,
        COSH,
        DIV,
        EQ,
        EXP,
        EXTENDED,
        GE,
        GT,
        HELD,
        HOLD,
        HYPOT,
        INTEGRAL,
        JUMP,
        KNOT,
        LE,
        LOG,
        LT,
        MAX,
        MIN,
        MUL,
        NE,
        NEG,
        PERIODIC,
        POW,
        POWER,
        SIGN,
        SIN,
        SINH,
        SQRT,
        STEP,
        SUB,
        TABLE,
        TAN,
        TANH,
        UNLESS,
        VAR,
        Bounds,
        Program,
        Programs,
        Span,
        Table,
    )
    from heuncli.kernel.shadow import cython


# Programs


def enclose(programs: cython.pointer[Programs], program: Program) -> Span:
    """What a program and its derivatives may be over `ranges`; nothing where it has no value at all."""
    return run_on(programs, programs.ranges, program, 0, no_span())


def enclose_closely(programs: cython.pointer[Programs], program: Program) -> Span:
    """Closer bounds than `enclose` gives, from those at a point of the stretch, where `middles` are the ranges."""
    whole: Span = enclose(programs, program)
    there: Span = run_on(programs, programs.middles, program, 0, no_span())
    if is_nothing(whole.value) or is_nothing(there.value):
        return whole
    away: Bounds = minus(programs.ranges[0].value, programs.middles[0].value)
    square: Bounds = scale_bounds(0.5, squared(away))
    rounding: cython.double = there.value.high - there.value.low  # as it is met elsewhere, too
    centre: Bounds = Bounds(there.value.low - rounding, there.value.high + rounding)
    first: Bounds = plus(centre, times(whole.rate, away))
    second: Bounds = plus(plus(centre, times(there.rate, away)), times(whole.second, square))
    rate: Bounds = plus(there.rate, times(whole.second, away))
    return Span(closer(closer(whole.value, first), second), closer(whole.rate, rate), whole.second)


def closer(a: Bounds, b: Bounds) -> Bounds:
    """What is in both; a where rounding parts them."""
    both: Bounds = meet(a, b)
    return a if is_nothing(both) else both


def run_on(
    programs: cython.pointer[Programs], ranges: cython.pointer[Span], program: Program, height: cython.int, x: Span
) -> Span:
    """Runs a program, or a branch of it, on ranges of the variables; x: the topmost span, below it `height`."""
    stack: cython.pointer[Span] = programs.spans
    at: cython.int = program.start
    end: cython.int = at + program.count
    while at < end:
        op: cython.int = programs.code[at].op
        k: cython.int = programs.code[at].argument
        at += 1
        if op <= VAR:
            stack[height] = x
            height += 1
            x = still(point(programs.constants[k])) if op == CONST else ranges[k]
        elif op <= MAX:
            height -= 1
            x = span_of_two(op, stack[height], x)
        elif op <= SQRT:
            x = span_of_one(op, x, k)
        elif op <= KNOT:
            x = span_of_table(op, programs.tables[k], table_at(programs, at, k), x)
            at += 1
        elif op == JUMP:
            at += k
        elif op == UNLESS:
            condition: Bounds = x.value
            height -= 1
            x = stack[height]
            if is_nothing(condition):
                return no_span()
            if is_zero(condition):
                at += k
            elif condition.low <= 0.0 and condition.high >= 0.0:
                then: Span = run_on(programs, ranges, Program(at, k - 1), height, x)
                at += k  # behind the jump over the other branch
                k = programs.code[at - 1].argument
                other: Span = run_on(programs, ranges, Program(at, k), height, x)
                at += k
                stack[height] = x
                height += 1
                x = either(then, other)
        elif op == INTEGRAL:
            x = span_of_integral(programs, ranges, at, k)
            at = end
        elif op <= NE or programs.holding == HELD:
            result: Span
            if op == HOLD:
                result = span_on_branch(programs, k, at, stack[height - 1], x)
                op = programs.code[at].op
                k = programs.code[at].argument
                at += 2 if op == TABLE or op == KNOT else 1
            else:
                result = truth(compared(op, stack[height - 1].value, x.value))
            if op >= LT and k == 1:
                stack[height - 1] = result
            else:
                height -= takes_two(op)
                x = result
    return x


def still(a: Bounds) -> Span:
    """What stands still within a."""
    return Span(a, point(0.0), point(0.0))


def loose(a: Bounds) -> Span:
    """What may jump within a."""
    return Span(a, anything(), anything())


def no_span() -> Span:
    """What has no value at all."""
    return Span(nothing(), nothing(), nothing())


def stands_still(u: Span) -> cython.bint:
    """Whether it certainly does not move."""
    return is_zero(u.rate) and is_zero(u.second)


def known(a: Bounds) -> Bounds:
    """a, or anything where a derivative has no value."""
    return anything() if is_nothing(a) else a


def chained(u: Span, f: Bounds, df: Bounds, ddf: Bounds) -> Span:
    """f(u), given f and its derivatives in u; where u stands still so does f(u), whatever f' is."""
    if is_nothing(f):
        return no_span()
    if stands_still(u):
        return still(f)
    first: Bounds = known(df)
    rate: Bounds = times(first, u.rate)
    return Span(f, rate, plus(times(known(ddf), squared(u.rate)), times(first, u.second)))


def either(a: Span, b: Span) -> Span:
    """One or the other, with jumps between."""
    if is_nothing(a.value):
        return b
    if is_nothing(b.value):
        return a
    value: Bounds = hull(a.value, b.value)
    return still(value) if value.low == value.high and stands_still(a) and stands_still(b) else loose(value)


def compared(op: cython.int, a: Bounds, b: Bounds) -> cython.int:
    """1 where a comparison holds throughout, 0 where it holds nowhere, 2 where that is open; -1 without operands."""
    if is_nothing(a) or is_nothing(b):
        return -1
    if op == LT:
        return 1 if a.high < b.low else 0 if a.low >= b.high else 2
    elif op == LE:
        return 1 if a.high <= b.low else 0 if a.low > b.high else 2
    elif op == GT:
        return compared(LT, b, a)
    elif op == GE:
        return compared(LE, b, a)
    apart: cython.bint = a.high < b.low or b.high < a.low
    same: cython.bint = a.low == a.high and b.low == b.high and a.low == b.low
    if op == EQ:
        return 1 if same else 0 if apart else 2
    return 1 if apart else 0 if same else 2


def truth(holds: cython.int) -> Span:
    """The span of a comparison."""
    if holds < 0:
        return no_span()
    return loose(Bounds(0.0, 1.0)) if holds == 2 else still(point(1.0 if holds == 1 else 0.0))


# Operations


def span_of_two(op: cython.int, a: Span, b: Span) -> Span:
    """An operation on two spans."""
    if is_nothing(a.value) or is_nothing(b.value):
        return no_span()
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
        value: Bounds = angle(a.value, b.value)
        return span_of_angle(value, a, b) if off_the_cut(a.value, b.value) else loose(value)
    elif op == HYPOT:
        return span_of_distance(a, b)
    return span_of_chosen(op, a, b)


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
    q: Bounds = over(a.value, b.value)
    if is_nothing(q):
        return no_span()
    rate: Bounds = over(minus(a.rate, times(q, b.rate)), b.value)
    second: Bounds = minus(minus(a.second, times(scale_bounds(2.0, rate), b.rate)), times(q, b.second))
    return Span(q, rate, over(second, b.value))


def span_of_power(a: Span, b: Span) -> Span:
    """y = a**b; where b moves, by y = exp(w), w = b log a, so that a must be positive there."""
    n: cython.double = b.value.low
    y: Bounds = to_power(a.value, b.value)
    if is_nothing(y):
        return no_span()
    if stands_still(a) and stands_still(b):
        return still(y)
    if stands_still(b) and n == b.value.high:
        df: Bounds = scale_bounds(n, to_number(a.value, n - 1.0)) if n != 0.0 else point(0.0)
        c: Bounds = times(point(n), minus(point(n), point(1.0)))
        return chained(a, y, df, times(c, to_number(a.value, n - 2.0)) if not is_zero(c) else c)
    if not a.value.low > 0.0:
        return loose(y)
    w: Bounds = logarithm(a.value)
    relative: Bounds = over(a.rate, a.value)
    rate: Bounds = plus(times(b.rate, w), over(times(b.value, a.rate), a.value))
    inner: Bounds = minus(a.second, over(squared(a.rate), a.value))
    second: Bounds = plus(times(b.second, w), times(scale_bounds(2.0, b.rate), relative))
    second = plus(second, over(times(b.value, inner), a.value))
    return Span(y, times(y, rate), times(y, plus(squared(rate), second)))


def span_of_angle(value: Bounds, y: Span, x: Span) -> Span:
    """The angle φ of (x, y), r² = y² + x²:  r² φ' = x y' - y x',  r² φ'' = x y'' - y x'' - 2 φ' (y y' + x x')."""
    square: Bounds = plus(squared(y.value), squared(x.value))
    rate: Bounds = known(over(minus(times(x.value, y.rate), times(y.value, x.rate)), square))
    radial: Bounds = plus(times(y.value, y.rate), times(x.value, x.rate))
    second: Bounds = minus(times(x.value, y.second), times(y.value, x.second))
    return Span(value, rate, known(over(minus(second, times(scale_bounds(2.0, rate), radial)), square)))


def span_of_distance(a: Span, b: Span) -> Span:
    """r² = a² + b²:  r r' = a a' + b b',  r r'' = a'² + b'² + a a'' + b b'' - r'²;  |r'| <= |a'| + |b'|."""
    r: Bounds = distance(a.value, b.value)
    if stands_still(a) and stands_still(b):
        return still(r)
    most: Bounds = plus(magnitude(a.rate), magnitude(b.rate))
    rate: Bounds = known(over(plus(times(a.value, a.rate), times(b.value, b.rate)), r))
    rate = closer(rate, Bounds(-more(most.high), more(most.high)))
    square: Bounds = plus(plus(squared(a.rate), squared(b.rate)), times(a.value, a.second))
    square = plus(square, times(b.value, b.second))
    return Span(r, rate, known(over(minus(square, squared(rate)), r)))


def span_of_chosen(op: cython.int, a: Span, b: Span) -> Span:
    """The less or the larger of two: one of them, or both in turn, with a kink between."""
    second: cython.int = second_is_taken(op, a.value, b.value)
    if second != 2:
        return b if second == 1 else a
    low: cython.bint = (a.value.low < b.value.low) == (op == MIN)
    high: cython.bint = (a.value.high < b.value.high) == (op == MIN)
    value: Bounds = Bounds(a.value.low if low else b.value.low, a.value.high if high else b.value.high)
    return Span(value, hull(a.rate, b.rate), anything())


def second_is_taken(op: cython.int, a: Bounds, b: Bounds) -> cython.int:
    """Whether MIN or MAX takes the second operand: 1 throughout, 0 nowhere, 2 where that is open."""
    return compared(LT, b, a) if op == MIN else compared(GT, b, a)


def span_of_one(op: cython.int, u: Span, n: cython.int) -> Span:
    """An operation on one span; n: the exponent of a whole power."""
    if is_nothing(u.value):
        return no_span()
    if op <= STEP:
        return span_of_piecewise(op, u, n)
    elif op <= ATAN:
        return span_of_circular(op, u)
    else:
        return span_of_exponential(op, u)


def span_of_piecewise(op: cython.int, u: Span, n: cython.int) -> Span:
    """-u, the whole power n, |u|, and its jumps, between which it stands still."""
    a: Bounds = u.value
    if op == POWER:
        df: Bounds = scale_bounds(n, a if n == 2 else to_whole(a, n - 1))
        return chained(u, to_whole(a, n), df, scale_bounds(n * (n - 1), point(1.0) if n == 2 else to_whole(a, n - 2)))
    elif op == NEG or (op == ABS and a.high < 0.0):
        return negate_span(u)
    elif op == ABS:
        return u if a.low >= 0.0 else Span(magnitude(a), hull(u.rate, negative(u.rate)), anything())
    low: cython.double = 1.0 if a.low >= 0.0 else 0.0
    high: cython.double = 1.0 if a.high >= 0.0 else 0.0
    if op == SIGN:
        low = 1.0 if a.low > 0.0 else -1.0 if a.low < 0.0 else 0.0
        high = 1.0 if a.high > 0.0 else -1.0 if a.high < 0.0 else 0.0
    return still(point(low)) if low == high else loose(Bounds(low, high))


def negate_span(u: Span) -> Span:
    """-u."""
    return Span(negative(u.value), negative(u.rate), negative(u.second))


def span_of_circular(op: cython.int, u: Span) -> Span:
    """The functions of the circle and their inverses."""
    a: Bounds = u.value
    one: Bounds = point(1.0)
    f: Bounds
    df: Bounds
    if op == SIN:
        f = sine(a)
        return chained(u, f, cosine(a), negative(f))
    elif op == COS:
        f = cosine(a)
        return chained(u, f, negative(sine(a)), negative(f))
    elif op == TAN:
        f = tangent(a)
        df = plus(one, squared(f))
        return chained(u, f, df, times(scale_bounds(2.0, f), df))
    elif op == ATAN:
        df = over(one, plus(one, squared(a)))
        return chained(u, arctangent(a), df, times(times(scale_bounds(-2.0, a), df), df))
    a = meet(a, Bounds(-1.0, 1.0))
    if is_nothing(a):
        return no_span()
    df = known(over(one, root(times(minus(one, a), plus(one, a)))))
    ddf: Bounds = times(times(times(a, df), df), df)
    if op == ASIN:
        return chained(u, arcsine(a), df, ddf)
    return chained(u, arccosine(a), negative(df), negative(ddf))


def span_of_exponential(op: cython.int, u: Span) -> Span:
    """The functions of the hyperbola, the exponential, and what undoes powers."""
    a: Bounds = u.value
    f: Bounds
    df: Bounds
    if op == SINH:
        f = hyperbolic_sine(a)
        return chained(u, f, hyperbolic_cosine(a), f)
    elif op == COSH:
        f = hyperbolic_cosine(a)
        return chained(u, f, hyperbolic_sine(a), f)
    elif op == TANH:
        f = hyperbolic_tangent(a)
        df = minus(point(1.0), squared(f))
        return chained(u, f, df, times(scale_bounds(-2.0, f), df))
    elif op == EXP:
        f = exponential_of(a)
        return chained(u, f, f, f)
    f = logarithm(a) if op == LOG else root(a)
    if is_nothing(f):
        return no_span()
    if op == LOG:
        df = over(point(1.0), Bounds(a.low if a.low > 0.0 else 0.0, a.high))
        return chained(u, f, df, negative(squared(df)))
    df = known(over(point(0.5), f))
    return chained(u, f, df, over(negative(squared(df)), f))


# Tables


def span_of_table(op: cython.int, c: cython.p_double, table: Table, u: Span) -> Span:
    """The table at u, over all the pieces that u meets, or the numbers of these."""
    if is_nothing(u.value):
        return no_span()
    a: Bounds = u.value
    if op == KNOT:
        numbers: Bounds = Bounds(piece_counted(c, table, a.low), piece_counted(c, table, a.high))
        return still(numbers) if numbers.low == numbers.high else loose(numbers)
    found: Span
    if table.outside == PERIODIC:
        found = pieces_in_turn(c, table, a)
        return chained(u, found.value, found.rate, found.second)
    inside: Bounds = meet(a, Bounds(c[table.knots], c[table.knots + table.pieces]))
    if is_nothing(inside):
        return beyond_table(c, table, a.low < c[table.knots])
    found = pieces_met(c, table, inside, piece(c, table, inside.low), piece(c, table, inside.high))
    if inside.low == a.low and inside.high == a.high:
        return chained(u, found.value, found.rate, found.second)
    return chained(u, found.value, hull(found.rate, point(0.0)), anything())  # it stands still beyond, or has no value


def beyond_table(c: cython.p_double, table: Table, before: cython.bint) -> Span:
    """What stands before a table that ends, or beyond: its value there, or none."""
    if table.outside != EXTENDED:
        return no_span()
    k: cython.int = 0 if before else table.pieces - 1
    x: cython.double = c[table.knots + (0 if before else table.pieces)]
    return still(pieces_met(c, table, point(x), k, k).value)


def pieces_in_turn(c: cython.p_double, table: Table, a: Bounds) -> Span:
    """Of a periodic table over a: what its value, slope and bend may be."""
    n: cython.int = table.pieces
    first: cython.double = piece_counted(c, table, a.low)
    last: cython.double = piece_counted(c, table, a.high)
    turn: cython.double = floor(first / n)
    whole: Bounds = Bounds(c[table.knots], c[table.knots + n])
    if not (last - first < n and fabs(first) < 1e15):  # whole numbers have no more digits
        return bent(pieces_met(c, table, whole, 0, n - 1))
    here: Bounds = minus(a, exact_times(point(turn), point(table.period)))
    begin: cython.int = int(first - n * turn)
    if floor(last / n) == turn:
        return pieces_met(c, table, here, begin, int(last - n * turn))
    there: Bounds = minus(a, exact_times(point(turn + 1.0), point(table.period)))
    end: cython.int = int(last - n * (turn + 1.0))
    found: Span = pieces_met(c, table, Bounds(here.low, whole.high), begin, n - 1)
    return bent(joined(found, pieces_met(c, table, Bounds(whole.low, there.high), 0, end)))


def pieces_met(c: cython.p_double, table: Table, inside: Bounds, begin: cython.int, end: cython.int) -> Span:
    """What value, slope and bend may be within the table's own range, from piece `begin` to piece `end`."""
    found: Span = no_span()
    k: cython.int
    for k in range(begin, end + 1):
        knot: cython.double = c[table.knots + k]
        h: Bounds = minus(inside, point(knot))
        width: cython.double = minus(point(c[table.knots + k + 1]), point(knot)).high
        low: cython.double = h.low if k == begin and h.low > 0.0 else 0.0
        high: cython.double = h.high if k == end and h.high < width else width
        low = low if low < width else width
        found = joined(found, cubic(c, table.coefficients + 4 * k, Bounds(low, high if high > low else low)))
    return bent(found) if end > begin else found


def joined(a: Span, b: Span) -> Span:
    """One or the other, without jumps between."""
    return Span(hull(a.value, b.value), hull(a.rate, b.rate), hull(a.second, b.second))


def bent(pieces: Span) -> Span:
    """Pieces with knots between: curves go on in one direction there (scene/expressions/curves.py), lines do not."""
    return Span(pieces.value, pieces.rate, anything()) if is_zero(pieces.second) else pieces


def cubic(c: cython.p_double, i: cython.Py_ssize_t, h: Bounds) -> Span:
    """Value, slope and bend of the cubic c0 + c1 h + c2 h² + c3 h³, whose coefficients stand from i."""
    value: Bounds = hull(cubic_at(c, i, h.low), cubic_at(c, i, h.high))
    if c[i + 2] == 0.0 and c[i + 3] == 0.0:  # rising or falling, also as it is computed
        return Span(value, point(c[i + 1]), point(0.0))
    m: cython.double = magnitude(h).high
    if not m < INFINITY:
        return loose(anything())
    slope: Bounds = hull(slope_at(c, i, h.low), slope_at(c, i, h.high))
    if c[i + 3] == 0.0:
        value = with_extreme(value, c, i, h, -0.5 * c[i + 1] / c[i + 2])
    else:
        vertex: cython.double = -c[i + 2] / (3.0 * c[i + 3])
        if h.low < vertex and vertex < h.high:
            slope = hull(slope, slope_at(c, i, vertex))
        square: cython.double = c[i + 2] * c[i + 2] - 3.0 * c[i + 3] * c[i + 1]
        if square >= 0.0:
            q: cython.double = sqrt(square)
            q = -(c[i + 2] + (q if c[i + 2] >= 0.0 else -q))
            value = with_extreme(value, c, i, h, q / (3.0 * c[i + 3]))
            if q != 0.0:
                value = with_extreme(value, c, i, h, c[i + 1] / q)
    bend: Bounds = plus(scale_bounds(2.0, point(c[i + 2])), times(scale_bounds(6.0, point(c[i + 3])), h))
    second: cython.double = fabs(c[i + 2]) * m
    third: cython.double = fabs(c[i + 3]) * m * m
    slope = widened(slope, fabs(c[i + 1]) + 2.0 * second + 3.0 * third)
    return Span(widened(value, fabs(c[i]) + m * (fabs(c[i + 1]) + second + third)), slope, bend)


def cubic_at(c: cython.p_double, i: cython.Py_ssize_t, h: cython.double) -> Bounds:
    """Bounds of the cubic at one h."""
    x: Bounds = point(h)
    inner: Bounds = plus(exact_times(plus(exact_times(point(c[i + 3]), x), point(c[i + 2])), x), point(c[i + 1]))
    return plus(exact_times(inner, x), point(c[i]))


def slope_at(c: cython.p_double, i: cython.Py_ssize_t, h: cython.double) -> Bounds:
    """Bounds of its slope at one h."""
    x: Bounds = point(h)
    inner: Bounds = plus(times(scale_bounds(3.0, point(c[i + 3])), x), scale_bounds(2.0, point(c[i + 2])))
    return plus(times(inner, x), point(c[i + 1]))


def with_extreme(value: Bounds, c: cython.p_double, i: cython.Py_ssize_t, h: Bounds, x: cython.double) -> Bounds:
    """With the cubic's value at x, where it has an extreme, if that is within h."""
    return hull(value, cubic_at(c, i, x)) if h.low < x and x < h.high else value


def widened(a: Bounds, size: cython.double) -> Bounds:
    """By the rounding of a polynomial whose terms are that large together."""
    return Bounds(a.low - 8.9e-16 * size, a.high + 8.9e-16 * size)


# Integrals


def span_of_integral(
    programs: cython.pointer[Programs], ranges: cython.pointer[Span], at: cython.Py_ssize_t, k: cython.int
) -> Span:
    """An integral over time: what it is at the ends of the stretch, and no more than its rate adds from either."""
    rate: Span = run_on(programs, ranges, integrated(programs, at), 0, no_span())
    if is_nothing(rate.value):
        return no_span()
    t: Bounds = ranges[0].value
    way: Bounds = times(rate.value, Bounds(0.0, minus(point(t.high), point(t.low)).high))
    first: Bounds = integral_at(programs, ranges, at, k, t.low)
    last: Bounds = integral_at(programs, ranges, at, k, t.high)
    if is_nothing(first) or is_nothing(last):
        return Span(anything(), rate.value, rate.rate)
    return Span(closer(plus(first, way), minus(last, way)), rate.value, rate.rate)


def integral_at(
    programs: cython.pointer[Programs],
    ranges: cython.pointer[Span],
    at: cython.Py_ssize_t,
    k: cython.int,
    t: cython.double,
) -> Bounds:
    """Bounds of an integral at an instant; nothing where it has no value.

    It errs by the rounding of the instants at which the rate is summed up, since the last knot.
    """
    f: cython.double = integral(programs, at, k, t)
    if f - f != 0.0:
        return nothing()
    knots: Table = summed_at(programs, at, k)
    knot: cython.double = programs.constants[knots.knots + piece(programs.constants, knots, t)]
    asked: Span = ranges[0]
    ranges[0] = Span(Bounds(knot if knot < t else t, t if knot < t else knot), point(1.0), point(0.0))
    rate: Bounds = run_on(programs, ranges, integrated(programs, at), 0, no_span()).value
    ranges[0] = asked
    size: cython.double = 0.0 if is_nothing(rate) else magnitude(rate).high
    return widened(point(f), fabs(f) + size * (fabs(t) + fabs(knot)))


# Held branches


def span_on_branch(programs: cython.pointer[Programs], k: cython.int, at: cython.Py_ssize_t, a: Span, b: Span) -> Span:
    """The operation at `at` on held[k], on both sides of its end; `doubt` where the branch may change."""
    op: cython.int = programs.code[at].op
    branch: cython.double = programs.held[k]
    if is_nothing(b.value) or (takes_two(op) and is_nothing(a.value)):
        return no_span()
    if may_change(programs, at, branch, a.value, b.value):
        programs.doubt[k] = 1
    if op == ABS:
        return b if branch > 0.0 else negate_span(b)
    elif op == MIN or op == MAX:
        return b if branch == 1.0 else a
    elif op == ATAN2:
        return negate_span(angle_above(negate_span(a), b)) if branch == 0.0 else angle_above(a, b)
    elif op == TABLE:
        number: cython.int = programs.code[at].argument
        return span_of_piece(programs.tables[number], table_at(programs, at + 1, number), branch, b)
    return still(point(branch))


def may_change(
    programs: cython.pointer[Programs], at: cython.Py_ssize_t, branch: cython.double, a: Bounds, b: Bounds
) -> cython.bint:
    """Whether the operation at `at` may take another branch within its operands (b alone, if it takes one)."""
    op: cython.int = programs.code[at].op
    if op >= LT:
        return compared(op, a, b) != branch
    elif op == MIN or op == MAX:
        return second_is_taken(op, a, b) != branch
    elif op == ATAN2:  # the angle jumps behind the origin only
        return b.low < 0.0 and (a.low < 0.0 if branch == 1.0 else side_of_cut(a.high) == 1.0)
    elif op == TABLE or op == KNOT:
        k: cython.int = programs.code[at].argument
        table: Table = table_at(programs, at + 1, k)
        low: cython.double = piece_counted(programs.tables[k], table, b.low)
        return low != branch or piece_counted(programs.tables[k], table, b.high) != branch
    elif op == SIGN and branch == 0.0:
        return not is_zero(b)
    elif op == SIGN and branch == 1.0:
        return not b.low > 0.0
    return not (b.low >= 0.0 if branch > 0.0 else b.high < 0.0)


def angle_above(y: Span, x: Span) -> Span:
    """atan2 on the branch of y >= 0, which goes on below the negative x axis."""
    if x.value.low >= 0.0:
        value: Bounds = angle(y.value, x.value)
        return span_of_angle(value, y, x) if off_the_cut(y.value, x.value) else loose(value)
    found: Bounds = nothing()
    i: cython.int
    if y.value.low > 0.0 or x.value.high < 0.0:
        for i in range(4):
            side: cython.double = y.value.low if i < 2 else y.value.high
            f: cython.double = angle_on(1.0, side, x.value.low if i % 2 == 0 else x.value.high)
            found = hull(found, Bounds(less(f), more(f)))
        return span_of_angle(found, y, x)
    if y.value.low >= 0.0:  # round the origin, which may be met
        return span_of_angle(Bounds(0.0, more(3.141592653589793)), y, x)
    return loose(Bounds(less(-1.5707963267948966), more(4.71238898038469)))


def span_of_piece(c: cython.p_double, table: Table, counted: cython.double, u: Span) -> Span:
    """The cubic of a piece, by its counted number, at u; beyond the ends the value there, or none."""
    n: cython.int = table.pieces
    turns: cython.double = floor(counted / n) if table.outside == PERIODIC else 0.0
    number: cython.double = counted - n * turns
    if not (-1.0 <= number and number <= n):
        return no_span()
    if number < 0.0 or number >= n:
        return beyond_table(c, table, number < 0.0)
    k: cython.int = int(number)
    here: Bounds = minus(u.value, exact_times(point(turns), point(table.period)))
    found: Span = cubic(c, table.coefficients + 4 * k, minus(here, point(c[table.knots + k])))
    return chained(u, found.value, found.rate, found.second)


# The doors


def span_of(
    expressions: Expressions, start: cython.int, count: cython.int, ranges: Sequence[Sequence[float]]
) -> tuple[float, ...]:
    """What one program may be: low and high of its value, its rate and its second derivative.

    ranges: the same six numbers for each variable, t first.
    """
    programs: cython.pointer[Programs] = cython.address(expressions.programs)
    set_ranges(expressions, start, count, programs.ranges, ranges)
    return numbers_of(enclose(programs, Program(start, count)))


def close_span_of(
    expressions: Expressions,
    start: cython.int,
    count: cython.int,
    ranges: Sequence[Sequence[float]],
    middles: Sequence[Sequence[float]],
) -> tuple[float, ...]:
    """What `span_of` gives, in closer bounds from the ranges at an instant of the stretch."""
    programs: cython.pointer[Programs] = cython.address(expressions.programs)
    set_ranges(expressions, start, count, programs.ranges, ranges)
    set_ranges(expressions, start, count, programs.middles, middles)
    return numbers_of(enclose_closely(programs, Program(start, count)))


def set_ranges(
    expressions: Expressions,
    start: cython.Py_ssize_t,
    count: cython.Py_ssize_t,
    into: cython.pointer[Span],
    ranges: Sequence[Sequence[float]],
) -> None:
    """Ranges of the variables, six numbers each."""
    i: cython.Py_ssize_t
    expressions.check(start, count)
    if len(ranges) != expressions.variables:
        raise ValueError(f"there are {expressions.variables} variables, not {len(ranges)}")
    for i in range(expressions.variables):
        a, b, c, d, e, f = ranges[i]
        into[i] = Span(Bounds(a, b), Bounds(c, d), Bounds(e, f))


def numbers_of(u: Span) -> tuple[float, ...]:
    """A span's six ends."""
    return (u.value.low, u.value.high, u.rate.low, u.rate.high, u.second.low, u.second.high)


def bounds_over(
    expressions: Expressions,
    start: cython.int,
    count: cython.int,
    begins: cython.double[::1],
    ends: cython.double[::1],
    least: cython.double[::1],
    largest: cython.double[::1],
) -> None:
    """What one program in time alone may be over many stretches of time, into least and largest."""
    i: cython.Py_ssize_t
    programs: cython.pointer[Programs] = cython.address(expressions.programs)
    expressions.check(start, count)
    if not len(begins) == len(ends) == len(least) == len(largest):
        raise ValueError("as many ends and bounds as stretches")
    for i in range(expressions.variables):
        programs.ranges[i] = loose(anything())
        programs.middles[i] = loose(anything())
    for i in range(len(begins)):
        middle: cython.double = begins[i] + 0.5 * (ends[i] - begins[i])
        programs.ranges[0] = Span(Bounds(begins[i], ends[i]), point(1.0), point(0.0))
        programs.middles[0] = Span(point(middle), point(1.0), point(0.0))
        found: Span = enclose_closely(programs, Program(start, count))
        least[i] = found.value.low
        largest[i] = found.value.high


def spans_over(
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
    """Natural bounds of the value and the rate of one program in time alone over many stretches of time."""
    i: cython.Py_ssize_t
    programs: cython.pointer[Programs] = cython.address(expressions.programs)
    expressions.check(start, count)
    if not len(begins) == len(ends) == len(least) == len(largest) == len(slowest) == len(fastest):
        raise ValueError("as many ends and bounds as stretches")
    for i in range(expressions.variables):
        programs.ranges[i] = loose(anything())
    for i in range(len(begins)):
        programs.ranges[0] = Span(Bounds(begins[i], ends[i]), point(1.0), point(0.0))
        found: Span = enclose(programs, Program(start, count))
        least[i] = found.value.low
        largest[i] = found.value.high
        slowest[i] = found.rate.low
        fastest[i] = found.rate.high
