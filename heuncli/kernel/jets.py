"""Programs with their derivatives: how an expression's value changes with the time, or with a coordinate.

A program runs on jets (value, first and second derivative) as evaluator.py runs it on numbers, by the chain rule of
each operation. `jet` propagates the derivatives in time on the selected branches; at a jump or kink they are those of
the piece that begins there, which the derivatives of equal values decide. `slope` is the first derivative along any
direction of the variables, on the branches that `evaluate_program` takes.

An infinite rate marks a value that is continuous and has no derivative, as sqrt(x) at 0; a rate that is not a number
may belong to a jump, as of an angle at the origin. Where u(x) = 0 and v is continuous, (u v)' = u' v, whatever v' is:
x*sqrt(abs(x)) has the derivative 0 at 0. A program's own rate is finite or NaN.
"""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from math import atan2, log, sqrt

from heuncli.kernel.declarations import *
from heuncli.kernel.evaluator import (
    apply_exponential,
    apply_piecewise,
    apply_trigonometric,
    compare,
    evaluate_integral,
    evaluate_on_branch,
    find_integrand,
    find_piece,
    find_unwrapped_piece,
    hypotenuse,
    map_into_table,
    read_table,
    real_power,
    takes_two,
    whole_power,
)
from heuncli.kernel.expressions import Expressions, address_of
from heuncli.kernel.libm import INFINITY, NAN, cos, cosh, floor, sin, sinh

# Programs


def jet(programs: cython.pointer[Programs], program: Program, t: cython.double) -> Jet:
    """Return value, first and second derivative of a program in time alone; NaN if it cannot be computed."""
    x: Jet = run_on_jets(programs, program, t, cython.NULL)
    if x.value - x.value != 0.0:
        return Jet(NAN, NAN, NAN)
    return x if x.rate - x.rate == 0.0 else Jet(x.value, NAN, NAN)


def slope(programs: cython.pointer[Programs], program: Program, slopes: cython.p_double) -> cython.double:
    """Return the derivative of a program along the slopes of its variables; NaN if it has no value or no derivative
    there.
    """
    t: cython.double = programs.variables[0]
    x: Jet = run_on_jets(programs, program, t, slopes)
    if x.value - x.value != 0.0 and programs.holding == HELD:
        programs.holding = FREE
        x = run_on_jets(programs, program, t, slopes)
        programs.holding = HELD
    return x.rate if x.value - x.value == 0.0 and x.rate - x.rate == 0.0 else NAN


def run_on_jets(programs: cython.pointer[Programs], program: Program, t: cython.double, slopes: cython.p_double) -> Jet:
    """Return value and derivatives of a program as its variables change: the time alone, or all by their slopes.

    With slopes only the first derivative counts, on the branches that `evaluate_program` takes; in time alone no other
    variable has a value.
    """
    jets: cython.pointer[Jet] = programs.jets  # what lies below x
    height: cython.Py_ssize_t = 0
    x: Jet = constant_jet(NAN)  # the topmost
    position: cython.Py_ssize_t = program.start
    end: cython.Py_ssize_t = position + program.count
    while position < end:
        op: cython.int = programs.code[position].op
        k: cython.int = programs.code[position].argument
        position += 1
        if op <= VAR:
            jets[height] = x
            height += 1
            x = constant_jet(programs.constants[k]) if op == CONST else moving_variable(programs, k, t, slopes)
        elif op <= MAX:
            height -= 1
            if slopes or op < MIN or jets[height].value != x.value:
                x = jet_of_two(op, jets[height], x)
            elif (sign_after(subtract_jets(x, jets[height])) < 0.0) != (op == MIN):
                x = jets[height]
        elif op <= SQRT:
            if slopes or x.value != 0.0 or op < ABS or op > STEP:
                x = jet_of_one(op, x, k)
            else:
                x = jet_after_zero(op, x)
        elif op <= KNOT:
            x = jet_of_table(op, programs.tables[k], read_table(programs, position, k), x, not slopes)
            position += 1
        elif op == JUMP:
            position += k
        elif op == UNLESS:
            if x.value == 0.0:
                position += k
            elif x.value != x.value:
                return Jet(NAN, NAN, NAN)
            height -= 1
            x = jets[height]
        elif op == INTEGRAL:
            x = jet_of_integral(programs, position, k, moving_variable(programs, 0, t, slopes))
            position = end
        elif op != HOLD:
            f: Jet = constant_jet(compare(op, jets[height - 1].value, x.value))
            if not slopes and jets[height - 1].value == x.value:
                f = constant_jet(compare(op, sign_after(subtract_jets(jets[height - 1], x)), 0.0))
            height -= 1 - k
            if k == 1:  # the right operand stays above
                jets[height - 1] = f
            else:
                x = f
        elif slopes and programs.holding == HELD:
            x = jet_of_held(programs, position, k, height, x)
            op = programs.code[position].op
            height -= takes_two(op) if op < LT or programs.code[position].argument == 0 else 0
            position += 2 if op == TABLE or op == KNOT else 1
    return x


def subtract_jets(a: Jet, b: Jet) -> Jet:
    """a - b."""
    return Jet(a.value - b.value, a.rate - b.rate, a.second - b.second)


def sign_after(u: Jet) -> cython.double:
    """Return a number of the sign that a value has just after its instant, as far as its derivatives tell."""
    if u.value != 0.0 or u.rate - u.rate != 0.0:
        return u.value
    if u.rate != 0.0 or u.second != u.second:
        return u.rate
    return u.second


def jet_after_zero(op: cython.int, u: Jet) -> Jet:
    """Return |u|, its sign or step just after an instant at which u is zero."""
    if op == ABS:
        return Jet(u.value, -u.rate, -u.second) if sign_after(u) < 0.0 else u
    return constant_jet(apply_piecewise(op, sign_after(u), 0))


def moving_variable(
    programs: cython.pointer[Programs], k: cython.int, t: cython.double, slopes: cython.p_double
) -> Jet:
    """Return a variable's jet: without slopes the time runs evenly and others have no value."""
    if slopes:
        return Jet(t if k == 0 else programs.variables[k], slopes[k], 0.0)
    return Jet(t if k == 0 else NAN, 1.0, 0.0)


def jet_of_integral(programs: cython.pointer[Programs], position: cython.Py_ssize_t, k: cython.int, t: Jet) -> Jet:
    """Return the integral up to a moving time; its derivative is the integrand."""
    first: Jet = jet(programs, find_integrand(programs, position), t.value)
    return Jet(evaluate_integral(programs, position, k, t.value), first.value * t.rate, first.rate * t.rate * t.rate)


def jet_of_held(
    programs: cython.pointer[Programs], position: cython.Py_ssize_t, k: cython.int, height: cython.Py_ssize_t, b: Jet
) -> Jet:
    """Return the operation at `position` on the branch held[k], with its first derivative; a right operand may stay
    above.
    """
    op: cython.int = programs.code[position].op
    f: Jet = jet_on_branch(programs, position, programs.branches[k], programs.jets[height - 1], b)
    if op >= LT and programs.code[position].argument == 1:
        programs.jets[height - 1] = f
        return b
    return f


def jet_on_branch(
    programs: cython.pointer[Programs], position: cython.Py_ssize_t, branch: cython.double, a: Jet, b: Jet
) -> Jet:
    """Return the operation at `position` on a branch (`evaluate_on_branch`), with its first derivative."""
    op: cython.int = programs.code[position].op
    f: cython.double = evaluate_on_branch(programs, position, branch, a.value, b.value)
    if f != f:
        return constant_jet(NAN)
    if op == ABS:
        return Jet(f, b.rate if branch > 0.0 else -b.rate, 0.0)
    elif op == MIN or op == MAX:
        return b if branch == 1.0 else a
    elif op == ATAN2:
        return Jet(f, jet_of_angle(a, b).rate, 0.0)
    elif op == TABLE:
        k: cython.int = programs.code[position].argument
        return chain_jets(
            b, f, slope_of_piece(programs.tables[k], read_table(programs, position + 1, k), branch, b.value), 0.0
        )
    return constant_jet(f)


def slope_of_piece(
    c: cython.p_double, table: Table, unwrapped_number: cython.double, x: cython.double
) -> cython.double:
    """Return the derivative of the cubic of a piece, by its unwrapped number, at any x; 0 outside a table that is
    extended.
    """
    n: cython.int = table.pieces
    turns: cython.double = floor(unwrapped_number / n) if table.outside == PERIODIC else 0.0
    number: cython.double = unwrapped_number - n * turns
    if number < 0.0 or number >= n:
        return 0.0
    k: cython.Py_ssize_t = int(number)
    h: cython.double = x - table.period * turns - c[table.knots + k]
    i: cython.Py_ssize_t = table.coefficients + 4 * k
    return (3.0 * c[i + 3] * h + 2.0 * c[i + 2]) * h + c[i + 1]


# Operations


def constant_jet(f: cython.double) -> Jet:
    """Return the jet of a constant f."""
    return Jet(f, 0.0, 0.0)


def is_infinite(x: cython.double) -> cython.bint:
    """Return whether x is inf or -inf."""
    return x == x and x - x != 0.0


def scale_rate(factor: cython.double, rate: cython.double) -> cython.double:
    """Return factor times a rate, and 0 for the factor 0 even if the rate is infinite."""
    return 0.0 if factor == 0.0 and is_infinite(rate) else factor * rate


def chain_jets(u: Jet, f: cython.double, df: cython.double, ddf: cython.double) -> Jet:
    """Return f(u) from f and its derivatives at u; if u is constant so is f(u), whatever f' is.

    f is continuous at u where f' is not NaN.
    """
    if u.rate == 0.0 and u.second == 0.0:
        return Jet(f, u.rate, u.second)
    if (is_infinite(df) and u.rate == u.rate) or (is_infinite(u.rate) and df == df):
        return Jet(f, INFINITY, NAN)
    return Jet(f, df * u.rate, ddf * u.rate * u.rate + df * u.second)


def jet_of_two(op: cython.int, a: Jet, b: Jet) -> Jet:
    """Apply an operation to two jets."""
    if op == ADD:
        return Jet(a.value + b.value, a.rate + b.rate, a.second + b.second)
    elif op == SUB:
        return Jet(a.value - b.value, a.rate - b.rate, a.second - b.second)
    elif op == MUL:
        return jet_of_product(a, b)
    elif op == DIV:
        return jet_of_quotient(a, b)
    elif op == POW:
        return jet_of_power(a, b)
    elif op == ATAN2:
        return jet_of_angle(a, b)
    elif op == HYPOT:
        return jet_of_length(a, b)
    is_b: cython.bint = b.value < a.value if op == MIN else b.value > a.value
    if is_b or b.value != b.value:
        return b
    return a


def jet_of_product(a: Jet, b: Jet) -> Jet:
    """(a b)' = a' b + a b',  (a b)'' = a'' b + 2 a' b' + a b''."""
    return Jet(
        a.value * b.value,
        scale_rate(b.value, a.rate) + scale_rate(a.value, b.rate),
        a.second * b.value + 2.0 * a.rate * b.rate + a.value * b.second,
    )


def jet_of_quotient(a: Jet, b: Jet) -> Jet:
    """q = a/b from a = q b:  q' = (a' - q b')/b,  q'' = (a'' - 2 q' b' - q b'')/b."""
    if b.value == 0.0:
        return constant_jet(NAN)
    q: cython.double = a.value / b.value
    rate: cython.double = (a.rate - scale_rate(q, b.rate)) / b.value
    return Jet(q, rate, (a.second - 2.0 * rate * b.rate - q * b.second) / b.value)


def jet_of_power(a: Jet, b: Jet) -> Jet:
    """y = a**b; if b varies, y = exp(w) with w = b log a, so that a must be positive there."""
    x: cython.double = a.value
    n: cython.double = b.value
    y: cython.double = real_power(x, n)
    if b.rate == 0.0 and b.second == 0.0:
        df: cython.double = INFINITY if x == 0.0 and 0.0 < n < 1.0 else scaled_power(n, x, n - 1.0)
        return chain_jets(a, y, df, scaled_power(n * (n - 1.0), x, n - 2.0))
    rate: cython.double = NAN
    second: cython.double = NAN
    if x > 0.0:
        rate = b.rate * log(x) + n * a.rate / x
        second = b.second * log(x) + 2.0 * b.rate * a.rate / x + n * (a.second - a.rate * a.rate / x) / x
    return Jet(y, y * rate, y * (rate * rate + second))


def scaled_power(c: cython.double, x: cython.double, y: cython.double) -> cython.double:
    """c x**y, and 0 for c = 0 even if x**y is not a number."""
    return c * real_power(x, y) if c != 0.0 else 0.0


def jet_of_angle(a: Jet, b: Jet) -> Jet:
    """The angle φ of (b, a), r² = a² + b²:  r² φ' = b a' - a b',  r² φ'' = b a'' - a b'' - 2 φ' (a a' + b b')."""
    x: cython.double = b.value
    y: cython.double = a.value
    square: cython.double = y * y + x * x
    if not square > 0.0:
        return Jet(atan2(y, x), NAN, NAN)
    rate: cython.double = (x * a.rate - y * b.rate) / square
    second: cython.double = (x * a.second - y * b.second - 2.0 * rate * (y * a.rate + x * b.rate)) / square
    return Jet(atan2(y, x), rate, second)


def jet_of_length(a: Jet, b: Jet) -> Jet:
    """r² = a² + b²:  r r' = a a' + b b',  r r'' = a'² + b'² + a a'' + b b'' - r'²."""
    r: cython.double = hypotenuse(a.value, b.value)
    if not r > 0.0:
        return Jet(r, INFINITY if a.rate == a.rate and b.rate == b.rate else NAN, NAN)
    rate: cython.double = (a.value * a.rate + b.value * b.rate) / r
    square: cython.double = a.rate * a.rate + b.rate * b.rate + a.value * a.second + b.value * b.second
    return Jet(r, rate, (square - rate * rate) / r)


def jet_of_one(op: cython.int, u: Jet, n: cython.int) -> Jet:
    """Apply an operation to one jet; n: the exponent of a whole power."""
    if op <= STEP:
        return jet_of_piecewise(op, u, n)
    elif op <= ATAN:
        return jet_of_trigonometric(op, u)
    else:
        return jet_of_exponential(op, u)


def jet_of_piecewise(op: cython.int, u: Jet, n: cython.int) -> Jet:
    """-u, the whole power n, |u|, and the functions with jumps, which are constant between them."""
    a: cython.double = u.value
    if op == POWER:
        return chain_jets(u, whole_power(a, n), n * whole_power(a, n - 1), n * (n - 1) * whole_power(a, n - 2))
    elif op == NEG or (op == ABS and a < 0.0):
        return Jet(-a, -u.rate, -u.second)
    elif op == ABS:
        return u
    else:
        return constant_jet(apply_piecewise(op, a, n))


def jet_of_trigonometric(op: cython.int, u: Jet) -> Jet:
    """Apply a trigonometric function or its inverse; asin and acos have no derivatives at -1 and 1."""
    a: cython.double = u.value
    f: cython.double
    df: cython.double
    if op == SIN:
        f = sin(a)
        return chain_jets(u, f, cos(a), -f)
    elif op == COS:
        f = cos(a)
        return chain_jets(u, f, -sin(a), -f)
    f = apply_trigonometric(op, a)
    if op == TAN:
        df = 1.0 + f * f
        return chain_jets(u, f, df, 2.0 * f * df)
    elif op == ATAN:
        df = 1.0 / (1.0 + a * a)
        return chain_jets(u, f, df, -2.0 * a * df * df)
    elif f != f:
        return constant_jet(NAN)
    root: cython.double = sqrt((1.0 - a) * (1.0 + a))
    df = 1.0 / root if root > 0.0 else INFINITY
    if op == ASIN:
        return chain_jets(u, f, df, a * df * df * df)
    return chain_jets(u, f, -df, -a * df * df * df)


def jet_of_exponential(op: cython.int, u: Jet) -> Jet:
    """Apply a hyperbolic function, the exponential, the logarithm or the square root."""
    a: cython.double = u.value
    f: cython.double = apply_exponential(op, a)
    df: cython.double
    if op == SINH:
        return chain_jets(u, f, cosh(a), f)
    elif op == COSH:
        return chain_jets(u, f, sinh(a), f)
    elif op == TANH:
        df = 1.0 - f * f
        return chain_jets(u, f, df, -2.0 * f * df)
    elif op == EXP:
        return chain_jets(u, f, f, f)
    elif f != f:
        return constant_jet(NAN)
    elif op == LOG:
        df = 1.0 / a
        return chain_jets(u, f, df, -df * df)
    df = 0.5 / f if f > 0.0 else INFINITY
    return chain_jets(u, f, df, -df * df / f if f > 0.0 else NAN)


def jet_of_table(op: cython.int, c: cython.p_double, table: Table, u: Jet, is_after: cython.bint) -> Jet:
    """Return the table at u, or the number of its piece there; outside a table that is extended it is constant.

    is_after: at a point between pieces take the one that u comes to, else the one that begins there
    """
    if op == KNOT:
        return constant_jet(find_unwrapped_piece(c, table, u.value))
    inside: cython.double = map_into_table(c, table, u.value)
    if inside != inside:
        return constant_jet(NAN)
    number: cython.int = find_piece(c, table, inside)
    sign: cython.double = 0.0
    if is_after:
        sign = sign_after(Jet(0.0, u.rate, u.second))
    is_constant_here: cython.bint = table.outside == EXTENDED and inside != u.value
    if sign < 0.0 and inside == c[table.knots + number]:
        if number > 0:
            number -= 1
        elif table.outside == PERIODIC:
            number = table.pieces - 1
            inside = c[table.knots + table.pieces]
        else:
            is_constant_here = table.outside == EXTENDED
    elif sign > 0.0 and inside == c[table.knots + table.pieces]:
        is_constant_here = table.outside == EXTENDED
    h: cython.double = inside - c[table.knots + number]
    i: cython.Py_ssize_t = table.coefficients + 4 * number
    f: cython.double = ((c[i + 3] * h + c[i + 2]) * h + c[i + 1]) * h + c[i]
    if is_constant_here:
        return constant_jet(f)
    return chain_jets(u, f, (3.0 * c[i + 3] * h + 2.0 * c[i + 2]) * h + c[i + 1], 6.0 * c[i + 3] * h + 2.0 * c[i + 2])


# The door


def find_derivatives(
    expressions: Expressions, start: cython.int, count: cython.int, t: cython.double
) -> tuple[float, float, float]:
    """Return value, first and second time derivative of one program in time alone."""
    expressions.check(start, count)
    found: Jet = jet(cython.address(expressions.programs), Program(start, count), t)
    return found.value, found.rate, found.second


def sample_derivatives(
    expressions: Expressions,
    start: cython.int,
    count: cython.int,
    times: cython.double[::1],
    values: cython.double[::1],
    rates: cython.double[::1],
    seconds: cython.double[::1],
) -> None:
    """Write value, first and second time derivative of one program in time alone at many instants to three columns."""
    i: cython.Py_ssize_t
    expressions.check(start, count)
    if not len(times) == len(values) == len(rates) == len(seconds):
        raise ValueError("as many values and derivatives as instants")
    for i in range(len(times)):
        found: Jet = jet(cython.address(expressions.programs), Program(start, count), times[i])
        values[i] = found.value
        rates[i] = found.rate
        seconds[i] = found.second


def find_gradient(expressions: Expressions, start: cython.int, count: cython.int, x: Sequence[float]) -> list[float]:
    """Return the derivatives of one program in all its variables, at x; on the held branches, if they are held."""
    i: cython.Py_ssize_t
    expressions.evaluate(start, count, x)
    slopes = array("d", bytes(8 * expressions.variables))
    derivatives: list[float] = []
    for i in range(expressions.variables):
        slopes[i] = 1.0
        if cython.compiled:
            along: cython.p_double = cython.cast(cython.p_double, address_of(slopes))
            derivatives.append(slope(cython.address(expressions.programs), Program(start, count), along))
        else:
            derivatives.append(slope(expressions.programs, Program(start, count), slopes))
        slopes[i] = 0.0
    return derivatives
