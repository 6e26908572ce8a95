"""Expressions as Python asks for them: programs with the memory they run in (evaluator.py says what programs are)."""

from __future__ import annotations

try:
    import cython
except ImportError:
    from heuncli.kernel.shadow import cython

from array import array
from collections.abc import Sequence
from typing import Any

if not cython.compiled:
    from heuncli.kernel.evaluator import value
    from heuncli.kernel.libm import NAN
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
        NE,
        NEG,
        NODES,
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
        Bounds,
        Instruction,
        Jet,
        Program,
        Programs,
        Span,
    )
    from heuncli.kernel.shadow import cython

OPERATIONS = {
    "const": CONST, "var": VAR, "add": ADD, "sub": SUB, "mul": MUL, "div": DIV, "pow": POW, "atan2": ATAN2,
    "hypot": HYPOT, "min": MIN, "max": MAX, "lt": LT, "le": LE, "gt": GT, "ge": GE, "eq": EQ, "ne": NE, "neg": NEG,
    "power": POWER, "abs": ABS, "sign": SIGN, "step": STEP, "sin": SIN, "cos": COS, "tan": TAN, "asin": ASIN,
    "acos": ACOS, "atan": ATAN, "sinh": SINH, "cosh": COSH, "tanh": TANH, "exp": EXP, "log": LOG, "sqrt": SQRT,
    "table": TABLE, "knot": KNOT, "jump": JUMP, "unless": UNLESS, "hold": HOLD,
    "integral": INTEGRAL,
}  # fmt: skip
HOLDING = {"free": FREE, "held": HELD, "taken": TAKEN}
QUADRATURE = NODES  # nodes of integrals, for those who lay out their constants

COMPILED = cython.compiled


def stack_depth(code: Sequence[int]) -> int:
    """How many numbers a program has on its stack at most; code: pairs (operation, argument), one after another.

    Walked along every way through its branches. Raises ValueError for what is no program: where an operation lacks an
    operand, a jump leaves the code, two ways meet with different heights, or not one number is left.
    """
    count = len(code) // 2
    deepest = 0
    heights: dict[int, int] = {0: 0}  # before an instruction that is met on some way; never before one that is data
    for at in range(count):
        if at not in heights:
            continue
        op, argument = code[2 * at], code[2 * at + 1]
        takes, leaves = operands(op, argument)
        height = heights[at] - takes + leaves
        deepest = max(deepest, height)
        for onward in followers(op, argument, at):
            if takes > heights[at] or not at < onward <= count or heights.setdefault(onward, height) != height:
                raise ValueError(f"no program: instruction {at} is ({op}, {argument}) at height {heights[at]}")
    if len(code) % 2 or heights.get(count) != 1:
        raise ValueError(f"no program: {count} instructions leave {heights.get(count, 'no way to the end')}, not 1")
    return deepest


def operands(op: int, argument: int) -> tuple[int, int]:
    """How many numbers an instruction takes from the stack, and how many it leaves there."""
    if op <= VAR:
        return 0, 1
    if op <= MAX:
        return 2, 1
    if op <= KNOT:
        return 1, 1
    if op == UNLESS:
        return 1, 0
    if op == JUMP or op >= HOLD:
        return 0, 0  # what an integral is over is a program of its own, its number that of the integral
    return 2, 1 + argument


def followers(op: int, argument: int, at: int) -> tuple[int, ...]:
    """The instructions that may be run after the one at `at`."""
    if op == JUMP:
        return (at + 1 + argument,)
    if op == UNLESS:
        return at + 1, at + 1 + argument
    return (at + 2 if op in (TABLE, KNOT, INTEGRAL) else at + 1,)


class Expressions:
    """Programs side by side, with the memory they run in: the door from Python, and what the kernel's scene holds.

    code: pairs (operation, argument); constants: what CONST points into; variables: their number, t included; held: how
    many branches the programs hold; starts: where they begin, one behind the other; tables: what TABLE counts, each as
    (period, knots, coefficients). What is given is copied but for the tables: they may have millions of numbers, and
    are read where they stand, by however many programs; none can change its length meanwhile. The stacks are as high as
    the code asks for. Raises ValueError where it is none.
    """

    def __init__(
        self, code: array[int], constants: array[float], variables: int, held: int = 0, starts: Sequence[int] = (0,),
        tables: Sequence[array[float]] = (),
    ) -> None:  # fmt: skip
        ends: list[int] = [*starts[1:], len(code) // 2]
        self.counts: dict[int, int] = {start: end - start for start, end in zip(starts, ends, strict=False)}
        depth = 1
        for start, count in self.counts.items():
            depth = max(depth, stack_depth(code[2 * start : 2 * (start + count)]))
        self.variables: cython.Py_ssize_t = variables
        self.held: cython.Py_ssize_t = held
        if not cython.compiled:
            self.programs: Programs = Programs.blank()
            self.programs.code = [Instruction(*pair) for pair in zip(code[::2], code[1::2], strict=True)]
            self.programs.constants = list(constants)
            self.programs.tables = list(tables)
            self.programs.variables = [0.0] * max(variables, 1)
            self.programs.stack = [0.0] * depth
            self.programs.jets = [Jet(0.0, 0.0, 0.0)] * depth
            self.programs.held = [0.0] * held
            self.programs.doubt = [0] * held
            nothing = Bounds(NAN, NAN)
            self.programs.ranges = [Span(nothing, nothing, nothing)] * max(variables, 1)
            self.programs.middles = list(self.programs.ranges)
            self.programs.spans = [self.programs.ranges[0]] * depth
        else:
            wide: bool = cython.sizeof(cython.p_double) == 8
            self.memory: tuple[Any, ...] = (
                array("i", code),
                array("d", constants),
                array("d", bytes(8 * max(variables, 1))),
                array("d", bytes(8 * depth)),
                array("d", bytes(24 * depth)),
                array("d", bytes(8 * max(held, 1))),
                array("i", bytes(4 * max(held, 1))),
                array("d", bytes(48 * max(variables, 1))),
                array("d", bytes(48 * max(variables, 1))),
                array("d", bytes(48 * depth)),
                array("Q" if wide else "L", [where(table) for table in tables]),
                tuple([memoryview(table) for table in tables]),
            )
            self.programs.code = cython.cast(cython.pointer[Instruction], where(self.memory[0]))
            self.programs.constants = cython.cast(cython.p_double, where(self.memory[1]))
            self.programs.variables = cython.cast(cython.p_double, where(self.memory[2]))
            self.programs.stack = cython.cast(cython.p_double, where(self.memory[3]))
            self.programs.jets = cython.cast(cython.pointer[Jet], where(self.memory[4]))
            self.programs.held = cython.cast(cython.p_double, where(self.memory[5]))
            self.programs.doubt = cython.cast(cython.p_int, where(self.memory[6]))
            self.programs.ranges = cython.cast(cython.pointer[Span], where(self.memory[7]))
            self.programs.middles = cython.cast(cython.pointer[Span], where(self.memory[8]))
            self.programs.spans = cython.cast(cython.pointer[Span], where(self.memory[9]))
            self.programs.tables = cython.cast(cython.pointer[cython.p_double], where(self.memory[10]))
        self.programs.holding = FREE

    def evaluate(self, start: cython.int, count: cython.int, x: Sequence[float]) -> float:
        """Value of one program at the variables x; NaN when not computable."""
        i: cython.Py_ssize_t
        self.check(start, count)
        if len(x) != self.variables:
            raise ValueError(f"there are {self.variables} variables, not {len(x)}")
        for i in range(self.variables):
            self.programs.variables[i] = x[i]
        return value(cython.address(self.programs), Program(start, count))

    def hold(self, holding: cython.int) -> None:
        """What becomes of branches in coordinates from now on: one of HOLDING."""
        self.programs.holding = holding

    def branches(self) -> list[float]:
        """The branches held, by the programs' HOLD instructions."""
        return [self.programs.held[k] for k in range(self.held)]

    def hold_branches(self, branches: Sequence[float]) -> None:
        """Other branches to hold, one an HOLD instruction."""
        k: cython.Py_ssize_t
        if len(branches) != self.held:
            raise ValueError(f"{self.held} branches are held, not {len(branches)}")
        for k in range(self.held):
            self.programs.held[k] = branches[k]

    def take_doubts(self) -> list[int]:
        """Numbers of the branches that enclosures (enclosure.py) found in doubt since this was asked last."""
        k: cython.Py_ssize_t
        doubts: list[int] = [k for k in range(self.held) if self.programs.doubt[k]]
        for k in range(self.held):
            self.programs.doubt[k] = 0
        return doubts

    def sample(self, start: cython.int, count: cython.int, times: cython.double[::1], out: cython.double[::1]) -> None:
        """Values of one program in time alone at instants, into out, as long as times; coordinates are NaN."""
        i: cython.Py_ssize_t
        self.check(start, count)
        if len(out) != len(times):
            raise ValueError(f"{len(times)} instants, but room for {len(out)} values")
        for i in range(self.variables):
            self.programs.variables[i] = NAN
        for i in range(len(times)):
            self.programs.variables[0] = times[i]
            out[i] = value(cython.address(self.programs), Program(start, count))

    def check(self, start: cython.Py_ssize_t, count: cython.Py_ssize_t) -> None:
        """Raise where there is no such program."""
        if self.counts.get(start) != count:
            raise ValueError(f"no program of {count} instructions begins at {start}; there are {len(self.counts)}")


def where(memory: array[int] | array[float]) -> cython.size_t:
    """Address of an array's first number."""
    address: cython.size_t = memory.buffer_info()[0]
    return address
