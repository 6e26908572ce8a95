"""What a program changes by along a direction of its variables: the evaluator's run with derivatives carried along.

    d f(x)/ds,   dx/ds = slopes,   d²x/ds² = 0
The operations are those of `jet` (expressions.py), of which the first derivative counts; branches are those that
`value` takes, held ones among them.
"""

from __future__ import annotations

from collections.abc import Sequence

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

if not cython.compiled:
    from math import nan

    from heuncli.kernel.expressions import (
        ABS,
        ATAN2,
        CONST,
        FREE,
        HELD,
        HOLD,
        INTEGRAL,
        JUMP,
        KNOT,
        LT,
        MAX,
        MIN,
        PERIODIC,
        SQRT,
        TABLE,
        UNLESS,
        VAR,
        Expressions,
        chain,
        compare,
        constant,
        integral,
        integrated,
        jet_of_angle,
        jet_of_one,
        jet_of_table,
        jet_of_two,
        on_branch,
        table_at,
        takes_two,
        value,
    )
    from heuncli.kernel.libm import floor
    from heuncli.kernel.memory import Memory
    from heuncli.kernel.shadow import cython
    from heuncli.kernel.structs import Jet, Program, Programs, Table

    NAN = nan


def gradient(expressions: Expressions, start: cython.int, count: cython.int, x: Sequence[float]) -> list[float]:
    """The derivatives of a program in all its variables, at x; the door from Python."""
    i: cython.Py_ssize_t
    memory: Memory = Memory()
    expressions.check(start, count)
    slopes: cython.p_double = memory.zeros(len(x))
    found: list[float] = []
    for i in range(len(x)):
        expressions.programs.variables[i] = x[i]
    for i in range(len(x)):
        slopes[i] = 1.0
        found.append(slope(cython.address(expressions.programs), Program(start, count), slopes))
        slopes[i] = 0.0
    return found


def slope(
    programs: cython.pointer[Programs], program: Program, slopes: cython.p_double
) -> cython.double:
    """The derivative of a program along the slopes of its variables; NaN where it has no value, or none there."""
    found: Jet = jet_along(programs, program, slopes)
    if found.value - found.value != 0.0 and programs.holding == HELD:
        programs.holding = FREE
        found = jet_along(programs, program, slopes)
        programs.holding = HELD
    return found.rate if found.value - found.value == 0.0 else NAN


def jet_along(programs: cython.pointer[Programs], program: Program, slopes: cython.p_double) -> Jet:
    """Value and first derivative of a program along the slopes of its variables."""
    jets: cython.pointer[Jet] = programs.jets  # what lies below x
    height: cython.Py_ssize_t = 0
    x: Jet = constant(NAN)  # the topmost
    at: cython.Py_ssize_t = program.start
    end: cython.Py_ssize_t = at + program.count
    while at < end:
        op: cython.int = programs.code[at].op
        k: cython.int = programs.code[at].argument
        at += 1
        if op <= VAR:
            jets[height] = x
            height += 1
            x = constant(programs.constants[k]) if op == CONST else Jet(programs.variables[k], slopes[k], 0.0)
        elif op <= MAX:
            height -= 1
            x = jet_of_two(op, jets[height], x)
        elif op <= SQRT:
            x = jet_of_one(op, x, k)
        elif op <= KNOT:
            x = jet_of_table(op, programs.constants, table_at(programs, at, k), x)
            at += 1
        elif op == JUMP:
            at += k
        elif op == UNLESS:
            if x.value == 0.0:
                at += k
            elif x.value != x.value:
                break
            height -= 1
            x = jets[height]
        elif op == INTEGRAL:  # it is all of its program, in time alone; its derivative is what is integrated
            over: Program = integrated(programs, at)
            x = Jet(integral(programs, at, k, programs.variables[0]), value(programs, over) * slopes[0], 0.0)
            at = end
        elif op == HOLD and programs.holding != HELD:  # the operation that follows is run as it is
            pass
        else:
            f: Jet
            if op == HOLD:
                f = jet_on_branch(programs, at, programs.held[k], jets[height - 1], x)
                op = programs.code[at].op
                k = programs.code[at].argument
                at += 2 if op == TABLE or op == KNOT else 1
            else:
                f = constant(compare(op, jets[height - 1].value, x.value))
            if op >= LT and k == 1:
                jets[height - 1] = f
            else:
                height -= takes_two(op)
                x = f
    return x


def jet_on_branch(
    programs: cython.pointer[Programs], at: cython.Py_ssize_t, branch: cython.double, a: Jet, b: Jet
) -> Jet:
    """The operation at `at` on a branch (`on_branch`), with its first derivative."""
    op: cython.int = programs.code[at].op
    f: cython.double = on_branch(programs, at, branch, a.value, b.value)
    if f != f:
        return constant(NAN)
    if op == ABS:
        return Jet(f, b.rate if branch > 0.0 else -b.rate, 0.0)
    elif op == MIN or op == MAX:
        return b if branch == 1.0 else a
    elif op == ATAN2:
        return Jet(f, jet_of_angle(a, b).rate, 0.0)
    elif op == TABLE:
        table: Table = table_at(programs, at + 1, programs.code[at].argument)
        return chain(b, f, slope_of_piece(programs.constants, table, branch, b.value), 0.0)
    return constant(f)


def slope_of_piece(c: cython.p_double, table: Table, counted: cython.double, x: cython.double) -> cython.double:
    """The derivative of the cubic of a piece, by its counted number, at any x; none beyond ends that are held."""
    n: cython.int = table.pieces
    turns: cython.double = floor(counted / n) if table.outside == PERIODIC else 0.0
    number: cython.double = counted - n * turns
    if number < 0.0 or number >= n:
        return 0.0
    k: cython.Py_ssize_t = int(number)
    h: cython.double = x - table.period * turns - c[table.knots + k]
    i: cython.Py_ssize_t = table.coefficients + 4 * k
    return (3.0 * c[i + 3] * h + 2.0 * c[i + 2]) * h + c[i + 1]
