"""The evaluator of expressions: flat programs of numbers, run on a small stack.

    code       pairs (op, argument); a program is `count` pairs from pair number `start`
    constants  what CONST and TABLE point into
    x          the variables: x[0] = t, then coordinates of joints
    stack      room for the results under way: `depth` doubles for `value`, 3 * depth for `jet`

An operation takes its operands from the top of the stack and leaves its result there. What is not a number (the root
of -1, division by zero, a place outside a table) is NaN, and so is all that depends on it; nothing raises. Of the two
branches of a condition only the chosen one is run, so the other may be NaN. Comparisons give 1 or 0; with the argument
1 they leave their right operand above the result, for chains like 0 < t < 1.

A table is a piecewise cubic of n pieces: TABLE k, followed by the pair (n, kind) that is data, not an instruction;
constants[k...] = period, n + 1 knots, then 4 coefficients a piece, c0 + c1 h + c2 h2 + c3 h3 with h from the left knot.
kind: what lies outside is NaN (0), the nearest end (1) or the period again (2). KNOT gives the number of the piece in
place of the value.

Derivatives (`jet`) are those of the chosen branches, in time alone; at a jump or kink they are those of the piece that
begins there.
"""

from __future__ import annotations

try:
    import cython
except ImportError:  # Cython is a build requirement only
    from heuncli.kernel.shadow import cython

if cython.compiled:
    from cython.cimports.libc.math import (
        NAN,
        acos,
        asin,
        atan,
        atan2,
        cos,
        cosh,
        exp,
        fabs,
        floor,
        log,
        pow,
        sin,
        sinh,
        sqrt,
        tan,
        tanh,
    )
else:
    import math
    from collections.abc import Callable
    from math import acos, asin, atan, atan2, fabs, log, sqrt, tanh

    NAN = math.nan

    # The codes of the operations; for C they stand in program.pxd, in the same order.
    CONST, VAR = range(2)
    ADD, SUB, MUL, DIV, POW, ATAN2, HYPOT, MIN, MAX = range(2, 11)
    NEG, POWER, ABS, SIGN, STEP = range(11, 16)
    SIN, COS, TAN, ASIN, ACOS, ATAN = range(16, 22)
    SINH, COSH, TANH, EXP, LOG, SQRT = range(22, 28)
    TABLE, KNOT, JUMP, UNLESS = range(28, 32)
    LT, LE, GT, GE, EQ, NE = range(32, 38)

    # C's functions answer everywhere where Python's raise.
    def exp(x: float) -> float:
        return math.exp(x) if x < 709.8 else _beyond(math.exp, x)

    def _beyond(f: Callable[[float], float], x: float) -> float:
        try:
            return f(x)
        except OverflowError:
            return math.inf

    def sinh(x: float) -> float:
        return math.sinh(x) if -710.0 < x < 710.0 else math.copysign(_beyond(math.sinh, abs(x)), x)

    def cosh(x: float) -> float:
        return math.cosh(x) if -710.0 < x < 710.0 else _beyond(math.cosh, x)

    def sin(x: float) -> float:
        return math.sin(x) if x - x == 0.0 else NAN

    def cos(x: float) -> float:
        return math.cos(x) if x - x == 0.0 else NAN

    def tan(x: float) -> float:
        return math.tan(x) if x - x == 0.0 else NAN

    def floor(x: float) -> float:
        return float(math.floor(x)) if x - x == 0.0 else NAN

    def pow(x: float, y: float) -> float:
        try:
            return math.pow(x, y)
        except ValueError:  # 0 to a negative power is shut out before
            return math.nan
        except OverflowError:
            return -math.inf if x < 0.0 and math.fmod(y, 2.0) != 0.0 else math.inf


OPERATIONS = {
    "const": CONST, "var": VAR, "add": ADD, "sub": SUB, "mul": MUL, "div": DIV, "pow": POW, "neg": NEG, "power": POWER,
    "sin": SIN, "cos": COS, "tan": TAN, "asin": ASIN, "acos": ACOS, "atan": ATAN, "atan2": ATAN2, "sinh": SINH,
    "cosh": COSH, "tanh": TANH, "exp": EXP, "log": LOG, "sqrt": SQRT, "abs": ABS, "sign": SIGN, "min": MIN, "max": MAX,
    "step": STEP, "hypot": HYPOT, "lt": LT, "le": LE, "gt": GT, "ge": GE, "eq": EQ, "ne": NE, "unless": UNLESS,
    "jump": JUMP, "table": TABLE, "knot": KNOT,
}  # fmt: skip

COMPILED = cython.compiled


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def power(x: cython.double, n: cython.int) -> cython.double:
    """x to the whole power n >= 0, by squaring."""
    r: cython.double = 1.0
    while n > 0:
        if n & 1:
            r = r * x
        x = x * x
        n = n >> 1
    return r


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def real_power(x: cython.double, y: cython.double) -> cython.double:
    """x**y; NaN for a negative base with a broken exponent and for 0 to a negative power."""
    if x == 0.0 and y < 0.0:
        return NAN
    return pow(x, y)


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def length(a: cython.double, b: cython.double) -> cython.double:
    """sqrt(a**2 + b**2) without overflow."""
    c: cython.double
    a = fabs(a)
    b = fabs(b)
    if a < b:
        c = a
        a = b
        b = c
    if not a > 0.0:
        return a + b
    c = b / a
    return a * sqrt(1.0 + c * c)


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
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


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def within(
    c: cython.p_double, k: cython.Py_ssize_t, n: cython.int, kind: cython.int, x: cython.double
) -> cython.double:
    """The place in the table's own range that stands for x; NaN where there is none."""
    first: cython.double = c[k + 1]
    last: cython.double = c[k + 1 + n]
    if x != x:
        return NAN
    if kind == 2:
        x = x - c[k] * floor((x - first) / c[k])
        if x < first:
            x = first
        elif x >= last:
            x = first if x - last < c[k] else NAN
        return x
    if x < first:
        return first if kind == 1 else NAN
    if x > last:
        return last if kind == 1 else NAN
    return x


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def piece(c: cython.p_double, k: cython.Py_ssize_t, n: cython.int, x: cython.double) -> cython.int:
    """Number of the table's piece that holds x; a knot belongs to the piece that begins there."""
    low: cython.int = 0
    high: cython.int = n
    middle: cython.int
    while high - low > 1:
        middle = (low + high) >> 1
        if c[k + 1 + middle] <= x:
            low = middle
        else:
            high = middle
    return low


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def knot(c: cython.p_double, k: cython.Py_ssize_t, n: cython.int, kind: cython.int, x: cython.double) -> cython.double:
    """Number of the piece x falls into, counted on over the periods; -1 before and n beyond a table that ends."""
    if kind == 2:
        return piece(c, k, n, within(c, k, n, kind, x)) + n * floor((x - c[k + 1]) / c[k])
    if x < c[k + 1]:
        return -1.0
    if x > c[k + 1 + n]:
        return n
    return piece(c, k, n, x)


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def value(
    code: cython.p_int,
    constants: cython.p_double,
    start: cython.Py_ssize_t,
    count: cython.Py_ssize_t,
    x: cython.p_double,
    stack: cython.p_double,
) -> cython.double:
    """Value of a program at the variables x; NaN when not computable."""
    i: cython.Py_ssize_t = start
    end: cython.Py_ssize_t = start + count
    top: cython.Py_ssize_t = -1
    k: cython.Py_ssize_t
    op: cython.int
    n: cython.int
    a: cython.double
    b: cython.double
    while i < end:
        op = code[2 * i]
        k = code[2 * i + 1]
        i += 1
        if op == CONST:
            top += 1
            stack[top] = constants[k]
        elif op == VAR:
            top += 1
            stack[top] = x[k]
        elif op == ADD:
            top -= 1
            stack[top] = stack[top] + stack[top + 1]
        elif op == SUB:
            top -= 1
            stack[top] = stack[top] - stack[top + 1]
        elif op == MUL:
            top -= 1
            stack[top] = stack[top] * stack[top + 1]
        elif op == DIV:
            top -= 1
            b = stack[top + 1]
            stack[top] = stack[top] / b if b != 0.0 else NAN
        elif op == NEG:
            stack[top] = -stack[top]
        elif op == POWER:
            stack[top] = power(stack[top], k)
        elif op == POW:
            top -= 1
            stack[top] = real_power(stack[top], stack[top + 1])
        elif op == SIN:
            stack[top] = sin(stack[top])
        elif op == COS:
            stack[top] = cos(stack[top])
        elif op == TAN:
            stack[top] = tan(stack[top])
        elif op == ASIN:
            a = stack[top]
            stack[top] = asin(a) if -1.0 <= a and a <= 1.0 else NAN
        elif op == ACOS:
            a = stack[top]
            stack[top] = acos(a) if -1.0 <= a and a <= 1.0 else NAN
        elif op == ATAN:
            stack[top] = atan(stack[top])
        elif op == ATAN2:
            top -= 1
            stack[top] = atan2(stack[top], stack[top + 1])
        elif op == SINH:
            stack[top] = sinh(stack[top])
        elif op == COSH:
            stack[top] = cosh(stack[top])
        elif op == TANH:
            stack[top] = tanh(stack[top])
        elif op == EXP:
            stack[top] = exp(stack[top])
        elif op == LOG:
            a = stack[top]
            stack[top] = log(a) if a > 0.0 else NAN
        elif op == SQRT:
            a = stack[top]
            stack[top] = sqrt(a) if a >= 0.0 else NAN
        elif op == ABS:
            stack[top] = fabs(stack[top])
        elif op == SIGN:
            a = stack[top]
            stack[top] = 1.0 if a > 0.0 else -1.0 if a < 0.0 else a
        elif op == STEP:
            a = stack[top]
            stack[top] = 1.0 if a >= 0.0 else 0.0 if a < 0.0 else NAN
        elif op == MIN:
            top -= 1
            b = stack[top + 1]
            if b < stack[top] or b != b:
                stack[top] = b
        elif op == MAX:
            top -= 1
            b = stack[top + 1]
            if b > stack[top] or b != b:
                stack[top] = b
        elif op == HYPOT:
            top -= 1
            a = stack[top]
            b = stack[top + 1]
            stack[top] = length(a, b)
        elif op == UNLESS:
            a = stack[top]
            top -= 1
            if a == 0.0:
                i += k
            elif a != a:
                return NAN
        elif op == JUMP:
            i += k
        elif op == TABLE:
            n = code[2 * i]
            a = within(constants, k, n, code[2 * i + 1], stack[top])
            i += 1
            if a == a:
                op = piece(constants, k, n, a)
                a = a - constants[k + 1 + op]
                k = k + 2 + n + 4 * op
                a = ((constants[k + 3] * a + constants[k + 2]) * a + constants[k + 1]) * a + constants[k]
            stack[top] = a
        elif op == KNOT:
            stack[top] = knot(constants, k, code[2 * i], code[2 * i + 1], stack[top])
            i += 1
        else:
            top -= 1
            a = stack[top]
            b = stack[top + 1]
            stack[top] = compare(op, a, b)
            if k == 1:
                top += 1
    a = stack[0]
    return a if a - a == 0.0 else NAN


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def chain(
    s: cython.p_double, p: cython.Py_ssize_t, f: cython.double, f1: cython.double, f2: cython.double
) -> cython.void:
    """Put f(u) in place of u, given f and its derivatives there; what stands still has rate 0 whatever f' is."""
    u1: cython.double = s[p + 1]
    u2: cython.double = s[p + 2]
    s[p] = f
    if u1 == 0.0 and u2 == 0.0:
        return
    s[p + 1] = f1 * u1
    s[p + 2] = f2 * u1 * u1 + f1 * u2


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def still(s: cython.p_double, p: cython.Py_ssize_t, f: cython.double) -> cython.void:
    """Put f, constant for a while, in place of the operand."""
    s[p] = f
    s[p + 1] = 0.0
    s[p + 2] = 0.0


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def scaled_power(c: cython.double, x: cython.double, y: cython.double) -> cython.double:
    """c x**y, and 0 for c = 0 also where x**y is not a number."""
    return c * real_power(x, y) if c != 0.0 else 0.0


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def jet_of_power(s: cython.p_double, p: cython.Py_ssize_t, q: cython.Py_ssize_t) -> cython.void:
    """a**b in place of a at p, b at q, with derivatives; a must be positive where b moves."""
    a: cython.double = s[p]
    b: cython.double = s[q]
    y: cython.double = real_power(a, b)
    w1: cython.double
    w2: cython.double
    if s[q + 1] == 0.0 and s[q + 2] == 0.0:
        chain(s, p, y, scaled_power(b, a, b - 1.0), scaled_power(b * (b - 1.0), a, b - 2.0))
        return
    w1 = NAN
    w2 = NAN
    if a > 0.0:  # y = exp(w), w = b log a
        w1 = s[q + 1] * log(a) + b * s[p + 1] / a
        w2 = s[q + 2] * log(a) + 2.0 * s[q + 1] * s[p + 1] / a + b * (s[p + 2] - s[p + 1] * s[p + 1] / a) / a
    s[p] = y
    s[p + 1] = y * w1
    s[p + 2] = y * (w1 * w1 + w2)


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def jet_of_table(
    s: cython.p_double, p: cython.Py_ssize_t, c: cython.p_double, k: cython.Py_ssize_t, n: cython.int, kind: cython.int
) -> cython.void:
    """The table's value in place of its argument, with derivatives; held ends stand still."""
    h: cython.double = within(c, k, n, kind, s[p])
    number: cython.int
    at: cython.Py_ssize_t
    y: cython.double
    if h != h:
        still(s, p, NAN)
        return
    number = piece(c, k, n, h)
    at = k + 2 + n + 4 * number
    h = h - c[k + 1 + number]
    y = ((c[at + 3] * h + c[at + 2]) * h + c[at + 1]) * h + c[at]
    if kind == 1 and (s[p] < c[k + 1] or s[p] > c[k + 1 + n]):
        still(s, p, y)
        return
    chain(s, p, y, (3.0 * c[at + 3] * h + 2.0 * c[at + 2]) * h + c[at + 1], 6.0 * c[at + 3] * h + 2.0 * c[at + 2])


@cython.cfunc
@cython.nogil
@cython.exceptval(check=False)
def jet(
    code: cython.p_int,
    constants: cython.p_double,
    start: cython.Py_ssize_t,
    count: cython.Py_ssize_t,
    t: cython.double,
    stack: cython.p_double,
    out: cython.p_double,
) -> cython.void:
    """Value, first and second time derivative of a program in t alone, into out[0..2]; NaN when not computable."""
    i: cython.Py_ssize_t = start
    end: cython.Py_ssize_t = start + count
    p: cython.Py_ssize_t = -3  # place of the topmost operand, three numbers each
    q: cython.Py_ssize_t
    k: cython.Py_ssize_t
    op: cython.int
    a: cython.double
    b: cython.double
    f: cython.double
    g: cython.double
    h: cython.double
    while i < end:
        op = code[2 * i]
        k = code[2 * i + 1]
        i += 1
        if op == CONST:
            p += 3
            still(stack, p, constants[k])
        elif op == VAR:
            p += 3
            stack[p] = t if k == 0 else NAN
            stack[p + 1] = 1.0
            stack[p + 2] = 0.0
        elif op == ADD:
            q = p
            p -= 3
            stack[p] = stack[p] + stack[q]
            stack[p + 1] = stack[p + 1] + stack[q + 1]
            stack[p + 2] = stack[p + 2] + stack[q + 2]
        elif op == SUB:
            q = p
            p -= 3
            stack[p] = stack[p] - stack[q]
            stack[p + 1] = stack[p + 1] - stack[q + 1]
            stack[p + 2] = stack[p + 2] - stack[q + 2]
        elif op == MUL:
            q = p
            p -= 3
            stack[p + 2] = stack[p + 2] * stack[q] + 2.0 * stack[p + 1] * stack[q + 1] + stack[p] * stack[q + 2]
            stack[p + 1] = stack[p + 1] * stack[q] + stack[p] * stack[q + 1]
            stack[p] = stack[p] * stack[q]
        elif op == DIV:
            q = p
            p -= 3
            b = stack[q]
            if b == 0.0:
                still(stack, p, NAN)
            else:
                f = stack[p] / b
                g = (stack[p + 1] - f * stack[q + 1]) / b
                stack[p + 2] = (stack[p + 2] - 2.0 * g * stack[q + 1] - f * stack[q + 2]) / b
                stack[p + 1] = g
                stack[p] = f
        elif op == NEG:
            stack[p] = -stack[p]
            stack[p + 1] = -stack[p + 1]
            stack[p + 2] = -stack[p + 2]
        elif op == POWER:
            a = stack[p]
            chain(stack, p, power(a, k), k * power(a, k - 1), k * (k - 1) * power(a, k - 2))
        elif op == POW:
            q = p
            p -= 3
            jet_of_power(stack, p, q)
        elif op == SIN:
            f = sin(stack[p])
            chain(stack, p, f, cos(stack[p]), -f)
        elif op == COS:
            f = cos(stack[p])
            chain(stack, p, f, -sin(stack[p]), -f)
        elif op == TAN:
            f = tan(stack[p])
            g = 1.0 + f * f
            chain(stack, p, f, g, 2.0 * f * g)
        elif op == ASIN or op == ACOS:
            a = stack[p]
            if -1.0 <= a and a <= 1.0:
                h = sqrt((1.0 - a) * (1.0 + a))
                g = 1.0 / h if h > 0.0 else NAN
                if op == ASIN:
                    chain(stack, p, asin(a), g, a * g * g * g)
                else:
                    chain(stack, p, acos(a), -g, -a * g * g * g)
            else:
                still(stack, p, NAN)
        elif op == ATAN:
            a = stack[p]
            g = 1.0 / (1.0 + a * a)
            chain(stack, p, atan(a), g, -2.0 * a * g * g)
        elif op == ATAN2:
            q = p
            p -= 3
            a = stack[p]
            b = stack[q]
            h = a * a + b * b
            f = stack[p + 1]
            g = stack[q + 1]
            stack[p] = atan2(a, b)
            if h > 0.0:
                stack[p + 1] = (b * f - a * g) / h
                stack[p + 2] = (b * stack[p + 2] - a * stack[q + 2] - 2.0 * stack[p + 1] * (a * f + b * g)) / h
            else:
                stack[p + 1] = NAN
                stack[p + 2] = NAN
        elif op == SINH:
            f = sinh(stack[p])
            chain(stack, p, f, cosh(stack[p]), f)
        elif op == COSH:
            f = cosh(stack[p])
            chain(stack, p, f, sinh(stack[p]), f)
        elif op == TANH:
            f = tanh(stack[p])
            g = 1.0 - f * f
            chain(stack, p, f, g, -2.0 * f * g)
        elif op == EXP:
            f = exp(stack[p])
            chain(stack, p, f, f, f)
        elif op == LOG:
            a = stack[p]
            if a > 0.0:
                g = 1.0 / a
                chain(stack, p, log(a), g, -g * g)
            else:
                still(stack, p, NAN)
        elif op == SQRT:
            a = stack[p]
            if a >= 0.0:
                f = sqrt(a)
                g = 0.5 / f if f > 0.0 else NAN
                chain(stack, p, f, g, -g * g / f if f > 0.0 else NAN)
            else:
                still(stack, p, NAN)
        elif op == ABS:
            if stack[p] < 0.0:
                stack[p] = -stack[p]
                stack[p + 1] = -stack[p + 1]
                stack[p + 2] = -stack[p + 2]
        elif op == SIGN:
            a = stack[p]
            still(stack, p, 1.0 if a > 0.0 else -1.0 if a < 0.0 else a)
        elif op == STEP:
            a = stack[p]
            still(stack, p, 1.0 if a >= 0.0 else 0.0 if a < 0.0 else NAN)
        elif op == MIN or op == MAX:
            q = p
            p -= 3
            b = stack[q]
            if (b < stack[p] if op == MIN else b > stack[p]) or b != b:
                stack[p] = b
                stack[p + 1] = stack[q + 1]
                stack[p + 2] = stack[q + 2]
        elif op == HYPOT:
            q = p
            p -= 3
            a = stack[p]
            b = stack[q]
            f = stack[p + 1]
            g = stack[q + 1]
            h = length(a, b)
            stack[p] = h
            if h > 0.0:
                stack[p + 1] = (a * f + b * g) / h
                stack[p + 2] = (f * f + g * g + a * stack[p + 2] + b * stack[q + 2] - stack[p + 1] * stack[p + 1]) / h
            else:
                stack[p + 1] = NAN
                stack[p + 2] = NAN
        elif op == UNLESS:
            a = stack[p]
            p -= 3
            if a == 0.0:
                i += k
            elif a != a:
                still(stack, 0, NAN)
                i = end
        elif op == JUMP:
            i += k
        elif op == TABLE:
            jet_of_table(stack, p, constants, k, code[2 * i], code[2 * i + 1])
            i += 1
        elif op == KNOT:
            still(stack, p, knot(constants, k, code[2 * i], code[2 * i + 1], stack[p]))
            i += 1
        else:
            q = p
            p -= 3
            b = stack[q]
            still(stack, p, compare(op, stack[p], b))
            if k == 1:
                p = q
    if stack[0] - stack[0] == 0.0:
        out[0] = stack[0]
        out[1] = stack[1]
        out[2] = stack[2]
    else:
        still(out, 0, NAN)
        out[1] = NAN
        out[2] = NAN


def evaluate(
    code: cython.int[::1],
    constants: cython.double[::1],
    start: cython.Py_ssize_t,
    count: cython.Py_ssize_t,
    x: cython.double[::1],
    stack: cython.double[::1],
) -> cython.double:
    """Value of a program at the variables x (array.array of int and double; stack as long as the program is deep)."""
    if cython.compiled:
        return value(
            cython.address(code[0]),
            cython.address(constants[0]),
            start,
            count,
            cython.address(x[0]),
            cython.address(stack[0]),
        )
    else:
        return value(code, constants, start, count, x, stack)


def derivatives(
    code: cython.int[::1],
    constants: cython.double[::1],
    start: cython.Py_ssize_t,
    count: cython.Py_ssize_t,
    t: cython.double,
    stack: cython.double[::1],
    out: cython.double[::1],
) -> None:
    """Value, first and second derivative at the instant t into out (3,); stack: thrice the program's depth."""
    if cython.compiled:
        jet(
            cython.address(code[0]),
            cython.address(constants[0]),
            start,
            count,
            t,
            cython.address(stack[0]),
            cython.address(out[0]),
        )
    else:
        jet(code, constants, start, count, t, stack, out)


def sample(
    code: cython.int[::1],
    constants: cython.double[::1],
    start: cython.Py_ssize_t,
    count: cython.Py_ssize_t,
    times: cython.double[::1],
    x: cython.double[::1],
    stack: cython.double[::1],
    out: cython.double[::1],
) -> None:
    """Values of a program over instants into out, as long as `times`; x[0] is overwritten, the rest of x stands."""
    i: cython.Py_ssize_t
    n: cython.Py_ssize_t = len(times)
    for i in range(n):
        x[0] = times[i]
        if cython.compiled:
            out[i] = value(
                cython.address(code[0]),
                cython.address(constants[0]),
                start,
                count,
                cython.address(x[0]),
                cython.address(stack[0]),
            )
        else:
            out[i] = value(code, constants, start, count, x, stack)
