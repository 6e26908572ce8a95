"""The evaluator of expressions: a stack machine that runs programs in postfix order.

An instruction takes its operands from the top of a stack and leaves its result there. A value that does not exist (the
square root of -1, division by zero, an argument outside a table) is NaN, and so is all that depends on it; nothing
raises.

    CONST k, VAR k     push constants[k] or variables[k]; variable 0 is the time t, the others are coordinates
    ADD ... MAX        two operands, one result
    NEG ... SQRT       one operand; POWER n is the whole power n
    TABLE k, KNOT k    tables[k], its numbers (period, knots, coefficients), at the operand: its value, or the number of
                       its piece. The instruction that follows is data: (pieces, outside).
    JUMP k, UNLESS k   skip k instructions, UNLESS only if the number it pops is 0: only one of the two branches of a
                       condition is run, so the other may be NaN
    LT ... NE          1 or 0; with the argument 1 the right operand stays above the result, for 0 < t < 1
    HOLD k             the operation that follows has branches and depends on coordinates: held[k] is its branch
    INTEGRAL k         the integral over time, from 0, of the program that follows, which is in time alone; it is all of
                       its program. An instruction that is data comes between: (pieces, length of the integrand).

A branch that changes within a step of the integrator would be a jump or kink in what should be smooth. So it can be
held: `holding` says what HOLD does.

    FREE     nothing: the operands decide the branches
    HELD     the operation takes the branch held[k], whatever its operands are, and continues smoothly past its end
    TAKEN    the operands decide the branches, which are written into held
    branch   LT ... NE: 1, 0;  SIGN: -1, 0, 1;  STEP: 1, 0;  ABS: 1, -1;  MIN, MAX: 1 for the second operand, else 0;
             ATAN2: 1 for y >= 0, 0 for y < 0 and -0.0;  TABLE: the number of the piece, as for KNOT

A NaN operand gives NaN, held or not. Where a held program has no value, as sqrt(x) if x > 0 else 0 for x < 0, it takes
the value that its operands decide.

A table is a piecewise cubic, c0 + c1 h + c2 h² + c3 h³ with h from the knot at which the piece begins.

An integral has in the constants from k on the nodes and weights of a quadrature on [0, 1], the knots, and the integral
at each of them: from the last knot before t it is summed up by the quadrature. Its derivative is the program itself.

Derivatives of programs: jets.py; bounds of their values: enclosure.py.
"""

from __future__ import annotations

from math import acos, asin, atan, atan2, fabs, log, sqrt, tanh

from heuncli.kernel.declarations import *
from heuncli.kernel.libm import NAN, cos, cosh, exp, floor, pow, sin, sinh, tan

# Values


def evaluate_program(programs: cython.pointer[Programs], program: Program) -> cython.double:
    """Return the value of a program at the variables; NaN if it cannot be computed."""
    stack: cython.p_double = programs.stack  # what lies below x
    height: cython.Py_ssize_t = 0
    x: cython.double = NAN  # the topmost number
    position: cython.Py_ssize_t = program.start
    end: cython.Py_ssize_t = position + program.count
    while position < end:
        op: cython.int = programs.code[position].op
        k: cython.int = programs.code[position].argument
        position += 1
        if op <= VAR:
            stack[height] = x
            height += 1
            x = programs.constants[k] if op == CONST else programs.variables[k]
        elif op <= MAX:
            height -= 1
            x = apply_binary(op, stack[height], x)
        elif op <= SQRT:
            x = apply_unary(op, x, k)
        elif op <= KNOT:
            x = evaluate_table(op, programs.tables[k], read_table(programs, position, k), x)
            position += 1
        elif op == JUMP:
            position += k
        elif op == UNLESS:
            if x == 0.0:
                position += k
            elif x != x:
                break
            height -= 1
            x = stack[height]
        elif op == INTEGRAL:
            x = evaluate_integral(programs, position, k, programs.variables[0])
            position = end
        elif op == HOLD and programs.holding != HELD:
            if programs.holding == TAKEN:
                record_branch(programs, k, position, stack[height - 1], x)
        else:
            f: cython.double
            if op == HOLD:
                f = evaluate_on_branch(programs, position, programs.branches[k], stack[height - 1], x)
                op = programs.code[position].op
                k = programs.code[position].argument
                position += 2 if op == TABLE or op == KNOT else 1
            else:
                f = compare(op, stack[height - 1], x)
            if op >= LT and k == 1:
                stack[height - 1] = f
            else:
                height -= takes_two(op)
                x = f
    return x if x - x == 0.0 else evaluate_released(programs, program)


def apply_binary(op: cython.int, a: cython.double, b: cython.double) -> cython.double:
    """Apply an operation to two numbers."""
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
        return hypotenuse(a, b)
    elif op == MIN:
        return b if b < a or b != b else a
    else:
        return b if b > a or b != b else a


def compare(op: cython.int, a: cython.double, b: cython.double) -> cython.double:
    """Return 1 or 0; NaN if an operand is."""
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


def apply_unary(op: cython.int, a: cython.double, n: cython.int) -> cython.double:
    """Apply an operation to one number; n: the exponent of a whole power."""
    if op <= STEP:
        return apply_piecewise(op, a, n)
    elif op <= ATAN:
        return apply_trigonometric(op, a)
    else:
        return apply_exponential(op, a)


def apply_piecewise(op: cython.int, a: cython.double, n: cython.int) -> cython.double:
    """-a, the whole power n, |a|, and the functions with jumps."""
    if op == NEG:
        return -a
    elif op == POWER:
        return whole_power(a, n)
    elif op == ABS:
        return fabs(a)
    elif op == SIGN:
        return 1.0 if a > 0.0 else -1.0 if a < 0.0 else a
    else:
        return 1.0 if a >= 0.0 else 0.0 if a < 0.0 else NAN


def apply_trigonometric(op: cython.int, a: cython.double) -> cython.double:
    """Apply a trigonometric function or its inverse."""
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


def apply_exponential(op: cython.int, a: cython.double) -> cython.double:
    """Apply a hyperbolic function, the exponential, the logarithm or the square root."""
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


def whole_power(x: cython.double, n: cython.int) -> cython.double:
    """x to the whole power n >= 0, by squaring."""
    product: cython.double = 1.0
    while n > 0:
        if n & 1:
            product = product * x
        x = x * x
        n = n >> 1
    return product


def real_power(x: cython.double, y: cython.double) -> cython.double:
    """x**y; NaN for a negative base with a fractional exponent and for 0 to a negative power."""
    if (x == 0.0 and y < 0.0) or x != x or y != y:  # 1**y and x**0 are 1 for C, whatever x and y are
        return NAN
    return pow(x, y)


def hypotenuse(a: cython.double, b: cython.double) -> cython.double:
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


def evaluate_released(programs: cython.pointer[Programs], program: Program) -> cython.double:
    """Return the value of a program whose held branches have none: its value with free branches, or NaN."""
    f: cython.double = NAN
    if programs.holding == HELD:
        programs.holding = FREE
        f = evaluate_program(programs, program)
        programs.holding = HELD
    return f


def takes_two(op: cython.int) -> cython.int:
    """Return 1 for an operation on two numbers, else 0."""
    return 1 if op <= MAX or op >= LT else 0


def record_branch(
    programs: cython.pointer[Programs], k: cython.int, position: cython.Py_ssize_t, a: cython.double, b: cython.double
) -> cython.void:
    """Write the branch that the operands select for the operation at `position` (b alone, if it takes one) into
    held[k].
    """
    op: cython.int = programs.code[position].op
    branch: cython.double
    if b != b or (takes_two(op) and a != a):
        return
    if op >= LT:
        branch = compare(op, a, b)
    elif op == MIN:
        branch = 1.0 if b < a else 0.0
    elif op == MAX:
        branch = 1.0 if b > a else 0.0
    elif op == ATAN2:
        branch = side_of_cut(a)
    elif op == ABS:
        branch = 1.0 if b >= 0.0 else -1.0
    elif op == TABLE or op == KNOT:
        number: cython.int = programs.code[position].argument
        branch = find_unwrapped_piece(programs.tables[number], read_table(programs, position + 1, number), b)
    else:
        branch = apply_piecewise(op, b, 0)
    programs.branches[k] = branch


def evaluate_on_branch(
    programs: cython.pointer[Programs],
    position: cython.Py_ssize_t,
    branch: cython.double,
    a: cython.double,
    b: cython.double,
) -> cython.double:
    """Evaluate the operation at `position` on a branch, even where its operands (b alone, if it takes one) are outside
    it.
    """
    op: cython.int = programs.code[position].op
    if b != b or (takes_two(op) and a != a):
        return NAN
    if op == ABS:
        return b if branch > 0.0 else -b
    elif op == MIN or op == MAX:
        return b if branch == 1.0 else a
    elif op == ATAN2:
        return angle_on_branch(branch, a, b)
    elif op == TABLE:
        k: cython.int = programs.code[position].argument
        return evaluate_piece(programs.tables[k], read_table(programs, position + 1, k), branch, b)
    return branch


def angle_on_branch(branch: cython.double, y: cython.double, x: cython.double) -> cython.double:
    """atan2(y, x), plus or minus one turn where the negative x axis was crossed from the branch's side."""
    turn: cython.double = 6.283185307179586
    f: cython.double = atan2(y, x)
    side: cython.double = side_of_cut(y)
    if x < 0.0 and side != branch:
        return f + turn if side == 0.0 else f - turn
    return f


def side_of_cut(y: cython.double) -> cython.double:
    """Return 1 above the negative x axis and on it, 0 below; -0.0 is below."""
    return 1.0 if atan2(y, -1.0) > 0.0 else 0.0


# Tables


def read_table(programs: cython.pointer[Programs], position: cython.Py_ssize_t, k: cython.Py_ssize_t) -> Table:
    """Return where the parts of table k are among its numbers; its data are the instruction at `position`."""
    data: Instruction = programs.code[position]
    return Table(data.op, data.argument, programs.tables[k][0], 1, 2 + data.op)


def evaluate_table(op: cython.int, c: cython.p_double, table: Table, x: cython.double) -> cython.double:
    """Return the table's value at x, or the number of its piece there."""
    if op == KNOT:
        return find_unwrapped_piece(c, table, x)
    inside: cython.double = map_into_table(c, table, x)
    if inside != inside:
        return NAN
    number: cython.int = find_piece(c, table, inside)
    h: cython.double = inside - c[table.knots + number]
    i: cython.Py_ssize_t = table.coefficients + 4 * number
    return ((c[i + 3] * h + c[i + 2]) * h + c[i + 1]) * h + c[i]


def map_into_table(c: cython.p_double, table: Table, x: cython.double) -> cython.double:
    """Return the point of the table's own range that corresponds to x; NaN if there is none."""
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


def find_piece(c: cython.p_double, table: Table, x: cython.double) -> cython.int:
    """Return the number of the piece that contains x, by bisection; a knot belongs to the piece that begins there."""
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


def find_unwrapped_piece(c: cython.p_double, table: Table, x: cython.double) -> cython.double:
    """Return the number of the piece that contains x, counted on over the periods; -1 before a table that ends, n after
    it.
    """
    n: cython.int = table.pieces
    first: cython.double = c[table.knots]
    if x != x:
        return NAN
    if table.outside == PERIODIC:
        turns: cython.double = floor((x - first) / table.period)
        if x - table.period * turns >= c[table.knots + n]:  # by rounding x is the first point of the next period
            turns = turns + 1.0
        return find_piece(c, table, map_into_table(c, table, x)) + n * turns
    if x < first:
        return -1.0
    if x > c[table.knots + n]:
        return float(n)
    return float(find_piece(c, table, x))


def evaluate_piece(
    c: cython.p_double, table: Table, unwrapped_number: cython.double, x: cython.double
) -> cython.double:
    """Evaluate the cubic of a piece, by its unwrapped number, at any x; outside the table its end value, or NaN."""
    n: cython.int = table.pieces
    turns: cython.double = floor(unwrapped_number / n) if table.outside == PERIODIC else 0.0
    number: cython.double = unwrapped_number - n * turns
    if not (-1.0 <= number and number <= n):
        return NAN
    if number < 0.0:
        return evaluate_table(TABLE, c, table, c[table.knots]) if table.outside == EXTENDED else NAN
    if number >= n:
        return evaluate_table(TABLE, c, table, c[table.knots + n]) if table.outside == EXTENDED else NAN
    k: cython.Py_ssize_t = int(number)
    h: cython.double = x - table.period * turns - c[table.knots + k]
    i: cython.Py_ssize_t = table.coefficients + 4 * k
    return ((c[i + 3] * h + c[i + 2]) * h + c[i + 1]) * h + c[i]


def area_under(c: cython.p_double, table: Table, x: cython.double) -> cython.double:
    """Return the integral from 0 to x of a table that has its areas after the coefficients
    (scene/expressions/curves.py).

    Within x's own piece it is summed from where the area is known, or from 0 itself, so that an area much smaller than
    the piece's keeps its digits. Two Gauss nodes are exact for cubics.
    """
    n: cython.int = table.pieces
    k: cython.double = find_unwrapped_piece(c, table, x)
    zero_piece: cython.double = find_unwrapped_piece(c, table, 0.0)
    areas: cython.Py_ssize_t = table.coefficients + 4 * n
    begin: cython.double = 0.0
    area: cython.double = 0.0
    if table.outside == PERIODIC:
        turns: cython.double = floor(k / n)
        home_turns: cython.double = floor(zero_piece / n)
        area = (turns - home_turns) * (c[areas + n] - c[areas])
        k = k - n * turns
        zero_piece = zero_piece - n * home_turns
        x = x - table.period * turns
        begin = -table.period * home_turns
    if not (-1.0 <= k and k <= n):
        return NAN
    i: cython.Py_ssize_t
    if k != zero_piece or k < 0.0 or k >= n:
        i = int(k)
        if k < zero_piece:
            i = i + 1
        elif k < 0.0:
            i = 0
        begin = c[table.knots + i]
        area += c[areas + i]
    half: cython.double = 0.5 * (x - begin)
    node: cython.double = 0.5773502691896258 * half
    middle: cython.double = begin + half
    return area + half * (evaluate_piece(c, table, k, middle - node) + evaluate_piece(c, table, k, middle + node))


# Integrals


def find_integrand(programs: cython.pointer[Programs], position: cython.Py_ssize_t) -> Program:
    """Return the program under an integral whose data are the instruction at `position`."""
    return Program(cython.cast(cython.int, position + 1), programs.code[position].argument)


def read_integral_table(programs: cython.pointer[Programs], position: cython.Py_ssize_t, k: cython.Py_ssize_t) -> Table:
    """Return an integral's knots and, as coefficients, its values there; they follow the quadrature."""
    pieces: cython.int = programs.code[position].op
    return Table(pieces, EXTENDED, 0.0, k + 2 * NODES, k + 2 * NODES + pieces + 1)


def evaluate_integral(
    programs: cython.pointer[Programs], position: cython.Py_ssize_t, k: cython.Py_ssize_t, t: cython.double
) -> cython.double:
    """Integrate from 0 to t; the table begins at k in the constants, its data are the instruction at `position`."""
    c: cython.p_double = programs.constants
    table: Table = read_integral_table(programs, position, k)
    number: cython.int = find_piece(c, table, t)
    knot: cython.double = c[table.knots + number]
    h: cython.double = t - knot
    mean: cython.double = 0.0
    now: cython.double = programs.variables[0]
    i: cython.Py_ssize_t
    for i in range(NODES):
        programs.variables[0] = knot + h * c[k + i]
        mean += c[k + NODES + i] * evaluate_program(programs, find_integrand(programs, position))
    programs.variables[0] = now
    return c[table.coefficients + number] + h * mean
