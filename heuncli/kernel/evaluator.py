"""The evaluator of expressions: a stack machine that runs programs in postfix order.

An instruction takes its operands from the top of a stack and leaves its result there. What is not a number (the root of
-1, division by zero, a place outside a table) is NaN, and so is all that depends on it; nothing raises.

    CONST k, VAR k     put constants[k] or variables[k] on the stack; variable 0 is the time t, the others coordinates
    ADD ... MAX        two operands, one result
    NEG ... SQRT       one operand; POWER n is the whole power n
    TABLE k, KNOT k    tables[k], its numbers (period, knots, coefficients), at the operand: its value, or the number of
                       its piece. An instruction follows that is data: (pieces, outside).
    JUMP k, UNLESS k   skip k instructions, UNLESS only where the number it takes off the stack is 0: only one of the
                       two branches of a condition is run, so the other may be NaN
    LT ... NE          1 or 0; with the argument 1 the right operand stays above the result, for 0 < t < 1
    HOLD k             the operation that follows has branches and hangs on coordinates: held[k] is its branch
    INTEGRAL k         the integral over time, from 0, of the program that follows, which is in time alone; it is all of
                       its program. An instruction that is data comes between: (pieces, length of what is integrated).

A branch that changes within a step of the integrator would be a jump or kink in what should be smooth. So it can be
held: `holding` says what HOLD means.

    FREE     nothing: branches are as the operands say
    HELD     the operation takes the branch held[k], whatever its operands say, and goes on smoothly beyond its end
    TAKEN    branches are as the operands say, and are written into held

    branch   LT ... NE: 1, 0;  SIGN: -1, 0, 1;  STEP: 1, 0;  ABS: 1, -1;  MIN, MAX: 1 for the second operand, else 0;
             ATAN2: 1 for y >= 0, 0 for y < 0 and -0.0;  TABLE: the number of the piece, as KNOT has it

An operand that is no number gives none, held or not. Where a held program has no value, as sqrt(x) if x > 0 else 0
beyond x = 0, it has that of the branches as they are.

A table is a piecewise cubic, c0 + c1 h + c2 h² + c3 h³ with h from the knot at which the piece begins.

An integral has in the constants from k the nodes and the weights of a quadrature on [0, 1], the knots, and what the
integral is at each of them: from the last knot before t it is summed up by the quadrature. Its derivative is the
program itself.

Derivatives of programs: jets.py; bounds of what they may be: enclosure.py.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython


if not cython.compiled:
    from math import acos, asin, atan, atan2, fabs, log, sqrt, tanh

    from heuncli.kernel.libm import NAN, cos, cosh, exp, floor, pow, sin, sinh, tan
    from heuncli.kernel.programs import (
        ABS,
        ACOS,
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
        FREE,
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
        NEG,
        NODES,
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
        TAKEN,
        TAN,
        TANH,
        UNLESS,
        VAR,
        Instruction,
        Program,
        Programs,
        Table,
    )
    from heuncli.kernel.shadow import cython


# Values


def value(programs: cython.pointer[Programs], program: Program) -> cython.double:
    """Value of a program at the variables; NaN when not computable."""
    stack: cython.p_double = programs.stack  # what lies below x
    height: cython.Py_ssize_t = 0
    x: cython.double = NAN  # the topmost number
    at: cython.Py_ssize_t = program.start
    end: cython.Py_ssize_t = at + program.count
    while at < end:
        op: cython.int = programs.code[at].op
        k: cython.int = programs.code[at].argument
        at += 1
        if op <= VAR:
            stack[height] = x
            height += 1
            x = programs.constants[k] if op == CONST else programs.variables[k]
        elif op <= MAX:
            height -= 1
            x = of_two(op, stack[height], x)
        elif op <= SQRT:
            x = of_one(op, x, k)
        elif op <= KNOT:
            x = of_table(op, programs.tables[k], table_at(programs, at, k), x)
            at += 1
        elif op == JUMP:
            at += k
        elif op == UNLESS:
            if x == 0.0:
                at += k
            elif x != x:
                break
            height -= 1
            x = stack[height]
        elif op == INTEGRAL:
            x = integral(programs, at, k, programs.variables[0])
            at = end
        elif op == HOLD and programs.holding != HELD:
            if programs.holding == TAKEN:
                take_branch(programs, k, at, stack[height - 1], x)
        else:
            f: cython.double
            if op == HOLD:
                f = on_branch(programs, at, programs.held[k], stack[height - 1], x)
                op = programs.code[at].op
                k = programs.code[at].argument
                at += 2 if op == TABLE or op == KNOT else 1
            else:
                f = compare(op, stack[height - 1], x)
            if op >= LT and k == 1:
                stack[height - 1] = f
            else:
                height -= takes_two(op)
                x = f
    return x if x - x == 0.0 else without_branches(programs, program)


def of_two(op: cython.int, a: cython.double, b: cython.double) -> cython.double:
    """An operation on two numbers."""
    if op == ADD:
        return a + b
    elif op == SUB:
        return a - b
    elif op == MUL:
        return a * b
    elif op == DIV:
        return a / b if b != 0.0 else NAN
    elif op == POW:
        return real_power(a, b)
    elif op == ATAN2:
        return atan2(a, b)
    elif op == HYPOT:
        return length(a, b)
    elif op == MIN:
        return b if b < a or b != b else a
    else:
        return b if b > a or b != b else a


def compare(op: cython.int, a: cython.double, b: cython.double) -> cython.double:
    """1 or 0; NaN where an operand is."""
    holds: cython.bint
    if a != a or b != b:
        return NAN
    if op == LT:
        holds = a < b
    elif op == LE:
        holds = a <= b
    elif op == GT:
        holds = a > b
    elif op == GE:
        holds = a >= b
    elif op == EQ:
        holds = a == b
    else:
        holds = a != b
    return 1.0 if holds else 0.0


def of_one(op: cython.int, a: cython.double, n: cython.int) -> cython.double:
    """An operation on one number; n: the exponent of a whole power."""
    if op <= STEP:
        return piecewise(op, a, n)
    elif op <= ATAN:
        return trigonometric(op, a)
    else:
        return exponential(op, a)


def piecewise(op: cython.int, a: cython.double, n: cython.int) -> cython.double:
    """-a, the whole power n, |a|, and its jumps."""
    if op == NEG:
        return -a
    elif op == POWER:
        return power(a, n)
    elif op == ABS:
        return fabs(a)
    elif op == SIGN:
        return 1.0 if a > 0.0 else -1.0 if a < 0.0 else a
    else:
        return 1.0 if a >= 0.0 else 0.0 if a < 0.0 else NAN


def trigonometric(op: cython.int, a: cython.double) -> cython.double:
    """The functions of the circle and their inverses."""
    if op == SIN:
        return sin(a)
    elif op == COS:
        return cos(a)
    elif op == TAN:
        return tan(a)
    elif op == ASIN:
        return asin(a) if -1.0 <= a and a <= 1.0 else NAN
    elif op == ACOS:
        return acos(a) if -1.0 <= a and a <= 1.0 else NAN
    else:
        return atan(a)


def exponential(op: cython.int, a: cython.double) -> cython.double:
    """The functions of the hyperbola, the exponential, and what undoes powers."""
    if op == SINH:
        return sinh(a)
    elif op == COSH:
        return cosh(a)
    elif op == TANH:
        return tanh(a)
    elif op == EXP:
        return exp(a)
    elif op == LOG:
        return log(a) if a > 0.0 else NAN
    else:
        return sqrt(a) if a >= 0.0 else NAN


def power(x: cython.double, n: cython.int) -> cython.double:
    """x to the whole power n >= 0, by squaring."""
    product: cython.double = 1.0
    while n > 0:
        if n & 1:
            product = product * x
        x = x * x
        n = n >> 1
    return product


def real_power(x: cython.double, y: cython.double) -> cython.double:
    """x**y; NaN for a negative base with a broken exponent and for 0 to a negative power."""
    if (x == 0.0 and y < 0.0) or x != x or y != y:  # 1**y and x**0 are 1 for C, whatever x and y are
        return NAN
    return pow(x, y)


def length(a: cython.double, b: cython.double) -> cython.double:
    """sqrt(a² + b²) without overflow."""
    larger: cython.double = fabs(a)
    smaller: cython.double = fabs(b)
    if larger < smaller:
        larger, smaller = smaller, larger
    if not larger > 0.0:
        return larger + smaller
    ratio: cython.double = smaller / larger
    return larger * sqrt(1.0 + ratio * ratio)


# Branches


def without_branches(programs: cython.pointer[Programs], program: Program) -> cython.double:
    """What a program is that has no value as it was run: where branches were held, its value without that."""
    f: cython.double = NAN
    if programs.holding == HELD:
        programs.holding = FREE
        f = value(programs, program)
        programs.holding = HELD
    return f


def takes_two(op: cython.int) -> cython.int:
    """1 for an operation on two numbers, else 0."""
    return 1 if op <= MAX or op >= LT else 0


def take_branch(
    programs: cython.pointer[Programs], k: cython.int, at: cython.Py_ssize_t, a: cython.double, b: cython.double
) -> cython.void:
    """The branch on which the operation at `at` finds its operands (b alone, if it takes one) becomes held[k]."""
    op: cython.int = programs.code[at].op
    met: cython.double
    if b != b or (takes_two(op) and a != a):
        return
    if op >= LT:
        met = compare(op, a, b)
    elif op == MIN:
        met = 1.0 if b < a else 0.0
    elif op == MAX:
        met = 1.0 if b > a else 0.0
    elif op == ATAN2:
        met = side_of_cut(a)
    elif op == ABS:
        met = 1.0 if b >= 0.0 else -1.0
    elif op == TABLE or op == KNOT:
        number: cython.int = programs.code[at].argument
        met = piece_counted(programs.tables[number], table_at(programs, at + 1, number), b)
    else:
        met = piecewise(op, b, 0)
    programs.held[k] = met


def on_branch(
    programs: cython.pointer[Programs], at: cython.Py_ssize_t, branch: cython.double, a: cython.double, b: cython.double
) -> cython.double:
    """The operation at `at` on a branch, whether its operands (b alone, if it takes one) are there or beyond."""
    op: cython.int = programs.code[at].op
    if b != b or (takes_two(op) and a != a):
        return NAN
    if op == ABS:
        return b if branch > 0.0 else -b
    elif op == MIN or op == MAX:
        return b if branch == 1.0 else a
    elif op == ATAN2:
        return angle_on(branch, a, b)
    elif op == TABLE:
        k: cython.int = programs.code[at].argument
        return of_piece(programs.tables[k], table_at(programs, at + 1, k), branch, b)
    return branch


def angle_on(branch: cython.double, y: cython.double, x: cython.double) -> cython.double:
    """atan2(y, x), by a turn more or less where the negative x axis was crossed from the side of the branch."""
    turn: cython.double = 6.283185307179586
    f: cython.double = atan2(y, x)
    side: cython.double = side_of_cut(y)
    if x < 0.0 and side != branch:
        return f + turn if side == 0.0 else f - turn
    return f


def side_of_cut(y: cython.double) -> cython.double:
    """1 above the negative x axis and on it, 0 below; -0.0 is below."""
    return 1.0 if atan2(y, -1.0) > 0.0 else 0.0


# Tables


def table_at(programs: cython.pointer[Programs], at: cython.Py_ssize_t, k: cython.Py_ssize_t) -> Table:
    """Where the parts of table k stand in its numbers; its data are the instruction at `at`."""
    data: Instruction = programs.code[at]
    return Table(data.op, data.argument, programs.tables[k][0], 1, 2 + data.op)


def of_table(op: cython.int, c: cython.p_double, table: Table, x: cython.double) -> cython.double:
    """The table's value at x, or the number of its piece there."""
    if op == KNOT:
        return piece_counted(c, table, x)
    inside: cython.double = in_range(c, table, x)
    if inside != inside:
        return NAN
    number: cython.int = piece(c, table, inside)
    h: cython.double = inside - c[table.knots + number]
    i: cython.Py_ssize_t = table.coefficients + 4 * number
    return ((c[i + 3] * h + c[i + 2]) * h + c[i + 1]) * h + c[i]


def in_range(c: cython.p_double, table: Table, x: cython.double) -> cython.double:
    """The point of the table's own range that stands for x; NaN where there is none."""
    first: cython.double = c[table.knots]
    last: cython.double = c[table.knots + table.pieces]
    if x != x:
        return NAN
    if table.outside == PERIODIC:
        x = x - table.period * floor((x - first) / table.period)
        if x < first:
            x = first
        elif x >= last:
            x = first if x - last < table.period else NAN
        return x
    if x < first:
        return first if table.outside == EXTENDED else NAN
    if x > last:
        return last if table.outside == EXTENDED else NAN
    return x


def piece(c: cython.p_double, table: Table, x: cython.double) -> cython.int:
    """Number of the piece that holds x, by bisection; a knot belongs to the piece that begins there."""
    low: cython.int = 0
    high: cython.int = table.pieces
    middle: cython.int
    knots: cython.Py_ssize_t = table.knots
    while high - low > 1:
        middle = (low + high) >> 1
        if c[knots + middle] <= x:
            low = middle
        else:
            high = middle
    return low


def piece_counted(c: cython.p_double, table: Table, x: cython.double) -> cython.double:
    """Number of the piece that holds x, counted on over the periods; -1 before a table that ends, n beyond it."""
    n: cython.int = table.pieces
    first: cython.double = c[table.knots]
    if x != x:
        return NAN
    if table.outside == PERIODIC:
        turns: cython.double = floor((x - first) / table.period)
        if x - table.period * turns >= c[table.knots + n]:  # by rounding: it is the first point of the next turn
            turns = turns + 1.0
        return piece(c, table, in_range(c, table, x)) + n * turns
    if x < first:
        return -1.0
    if x > c[table.knots + n]:
        return float(n)
    return float(piece(c, table, x))


def of_piece(c: cython.p_double, table: Table, counted: cython.double, x: cython.double) -> cython.double:
    """The cubic of a piece, by its counted number, at any x; beyond the ends the value there, or none."""
    n: cython.int = table.pieces
    turns: cython.double = floor(counted / n) if table.outside == PERIODIC else 0.0
    number: cython.double = counted - n * turns
    if not (-1.0 <= number and number <= n):
        return NAN
    if number < 0.0:
        return of_table(TABLE, c, table, c[table.knots]) if table.outside == EXTENDED else NAN
    if number >= n:
        return of_table(TABLE, c, table, c[table.knots + n]) if table.outside == EXTENDED else NAN
    k: cython.Py_ssize_t = int(number)
    h: cython.double = x - table.period * turns - c[table.knots + k]
    i: cython.Py_ssize_t = table.coefficients + 4 * k
    return ((c[i + 3] * h + c[i + 2]) * h + c[i + 1]) * h + c[i]


def area_under(c: cython.p_double, table: Table, x: cython.double) -> cython.double:
    """The integral of a table from 0 to x, of one that has its areas behind the coefficients
    (scene/expressions/areas.py).

    From x's own piece on it is summed up where its area from 0 is known, or from 0 itself, so that what is little
    beside the piece is told as well: by two nodes of Gauss, which are exact for cubics.
    """
    n: cython.int = table.pieces
    k: cython.double = piece_counted(c, table, x)
    home: cython.double = piece_counted(c, table, 0.0)
    areas: cython.Py_ssize_t = table.coefficients + 4 * n
    begin: cython.double = 0.0
    found: cython.double = 0.0
    if table.outside == PERIODIC:
        turns: cython.double = floor(k / n)
        turned: cython.double = floor(home / n)
        found = (turns - turned) * (c[areas + n] - c[areas])
        k = k - n * turns
        home = home - n * turned
        x = x - table.period * turns
        begin = -table.period * turned
    if not (-1.0 <= k and k <= n):
        return NAN
    i: cython.Py_ssize_t
    if k != home or k < 0.0 or k >= n:
        i = int(k)
        if k < home:
            i = i + 1
        elif k < 0.0:
            i = 0
        begin = c[table.knots + i]
        found += c[areas + i]
    half: cython.double = 0.5 * (x - begin)
    node: cython.double = 0.5773502691896258 * half
    middle: cython.double = begin + half
    return found + half * (of_piece(c, table, k, middle - node) + of_piece(c, table, k, middle + node))


# Integrals


def integrated(programs: cython.pointer[Programs], at: cython.Py_ssize_t) -> Program:
    """The program under an integral whose data are the instruction at `at`."""
    return Program(cython.cast(cython.int, at + 1), programs.code[at].argument)


def summed_at(programs: cython.pointer[Programs], at: cython.Py_ssize_t, k: cython.Py_ssize_t) -> Table:
    """Its knots and, as coefficients, what it is at each of them; they stand in the constants behind the quadrature."""
    pieces: cython.int = programs.code[at].op
    return Table(pieces, EXTENDED, 0.0, k + 2 * NODES, k + 2 * NODES + pieces + 1)


def integral(
    programs: cython.pointer[Programs], at: cython.Py_ssize_t, k: cython.Py_ssize_t, t: cython.double
) -> cython.double:
    """The integral from 0 to t; its table stands in the constants from k, its data are the instruction at `at`."""
    c: cython.p_double = programs.constants
    table: Table = summed_at(programs, at, k)
    number: cython.int = piece(c, table, t)
    knot: cython.double = c[table.knots + number]
    h: cython.double = t - knot
    mean: cython.double = 0.0
    now: cython.double = programs.variables[0]
    i: cython.Py_ssize_t
    for i in range(NODES):
        programs.variables[0] = knot + h * c[k + i]
        mean += c[k + NODES + i] * value(programs, integrated(programs, at))
    programs.variables[0] = now
    return c[table.coefficients + number] + h * mean
