"""Expressions for Python callers: programs with the memory they run in (evaluator.py describes programs)."""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from typing import Any

from heuncli.kernel.declarations import *
from heuncli.kernel.evaluator import evaluate_program
from heuncli.kernel.libm import NAN

# The arrays of `Expressions.memory`, in their order.
CODE_MEMORY, CONSTANT_MEMORY, VARIABLE_MEMORY, STACK_MEMORY, JET_MEMORY, HELD_MEMORY, DOUBT_MEMORY = range(7)
RANGE_MEMORY, MIDDLE_MEMORY, SPAN_MEMORY, TABLE_MEMORY = range(7, 11)

OPERATIONS = {
    "const": CONST, "var": VAR, "add": ADD, "sub": SUB, "mul": MUL, "div": DIV, "pow": POW, "atan2": ATAN2,
    "hypot": HYPOT, "min": MIN, "max": MAX, "lt": LT, "le": LE, "gt": GT, "ge": GE, "eq": EQ, "ne": NE, "neg": NEG,
    "power": POWER, "abs": ABS, "sign": SIGN, "step": STEP, "sin": SIN, "cos": COS, "tan": TAN, "asin": ASIN,
    "acos": ACOS, "atan": ATAN, "sinh": SINH, "cosh": COSH, "tanh": TANH, "exp": EXP, "log": LOG, "sqrt": SQRT,
    "table": TABLE, "knot": KNOT, "jump": JUMP, "unless": UNLESS, "hold": HOLD,
    "integral": INTEGRAL,
}  # fmt: skip
HOLDING = {"free": FREE, "held": HELD, "taken": TAKEN}
QUADRATURE = NODES  # nodes of integrals, for callers that write their constants

COMPILED = cython.compiled


def stack_depth(code: Sequence[int]) -> int:
    """Return the largest number of values that a program has on its stack; code: pairs (operation, argument) in
    sequence.

    Follows every path through its branches. Raises ValueError for an invalid program: an operation lacks an operand, a
    jump leaves the code, two paths meet with different heights, or not exactly one number is left.
    """
    count = len(code) // 2
    deepest = 0
    heights: dict[int, int] = {0: 0}  # before each instruction that can be reached; never before one that is data
    for position in range(count):
        if position not in heights:
            continue
        op, argument = code[2 * position], code[2 * position + 1]
        takes, leaves = count_operands(op, argument)
        height = heights[position] - takes + leaves
        deepest = max(deepest, height)
        for successor in find_successors(op, argument, position):
            if (
                takes > heights[position]
                or not position < successor <= count
                or heights.setdefault(successor, height) != height
            ):
                raise ValueError(
                    f"no program: instruction {position} is ({op}, {argument}) at height {heights[position]}"
                )
    if len(code) % 2 or heights.get(count) != 1:
        raise ValueError(f"no program: {count} instructions leave {heights.get(count, 'no way to the end')}, not 1")
    return deepest


def count_operands(op: int, argument: int) -> tuple[int, int]:
    """Return how many numbers an instruction takes from the stack, and how many it leaves there."""
    if op <= VAR:
        return 0, 1
    if op <= MAX:
        return 2, 1
    if op <= KNOT:
        return 1, 1
    if op == UNLESS:
        return 1, 0
    if op == JUMP or op >= HOLD:
        return 0, 0  # the integrand is a program of its own, whose result is the integral's
    return 2, 1 + argument


def find_successors(op: int, argument: int, position: int) -> tuple[int, ...]:
    """Return the instructions that may be run after the one at `position`."""
    if op == JUMP:
        return (position + 1 + argument,)
    if op == UNLESS:
        return position + 1, position + 1 + argument
    return (position + 2 if op in (TABLE, KNOT, INTEGRAL) else position + 1,)


class Expressions:
    """Programs side by side, with the memory they run in: the interface to Python, and part of the kernel's scene.

    code: pairs (operation, argument)
    constants: what CONST refers to
    variables: their number, t included
    slots: how many branches the programs hold
    starts: where the programs begin, one after the other
    tables: what TABLE refers to, each as (period, knots, coefficients)

    Arguments are copied except the tables: they may have millions of numbers and are read in place, by any number of
    programs; nobody can change their length meanwhile. The stacks are as high as the code needs. Raises ValueError for
    an invalid program.
    """

    def __init__(
        self, code: array[int], constants: array[float], variables: int, slots: int = 0, starts: Sequence[int] = (0,),
        tables: Sequence[array[float]] = (),
    ) -> None:  # fmt: skip
        ends: list[int] = [*starts[1:], len(code) // 2]
        self.counts: dict[int, int] = {start: end - start for start, end in zip(starts, ends, strict=False)}
        depth = 1
        for start, count in self.counts.items():
            depth = max(depth, stack_depth(code[2 * start : 2 * (start + count)]))
        self.variables: cython.Py_ssize_t = variables
        self.held_count: cython.Py_ssize_t = slots
        if not cython.compiled:
            self.programs: Programs = Programs.blank()
            self.programs.code = [Instruction(*pair) for pair in zip(code[::2], code[1::2], strict=True)]
            self.programs.constants = list(constants)
            self.programs.tables = list(tables)
            self.programs.variables = [0.0] * max(variables, 1)
            self.programs.stack = [0.0] * depth
            self.programs.jets = [Jet(0.0, 0.0, 0.0)] * depth
            self.programs.branches = [0.0] * slots
            self.programs.doubt = [0] * slots
            nothing = Bounds(NAN, NAN)
            self.programs.ranges = [Span(nothing, nothing, nothing)] * max(variables, 1)
            self.programs.middles = list(self.programs.ranges)
            self.programs.spans = [self.programs.ranges[0]] * depth
        else:
            wide: bool = cython.sizeof(cython.p_double) == 8
            arrays: list[Any] = [
                array("i", code),
                array("d", constants),
                array("d", bytes(8 * max(variables, 1))),
                array("d", bytes(8 * depth)),
                array("d", bytes(24 * depth)),
                array("d", bytes(8 * max(slots, 1))),
                array("i", bytes(4 * max(slots, 1))),
                array("d", bytes(48 * max(variables, 1))),
                array("d", bytes(48 * max(variables, 1))),
                array("d", bytes(48 * depth)),
                array("Q" if wide else "L", [address_of(table) for table in tables]),
                tuple([memoryview(table) for table in tables]),
            ]
            self.memory: tuple[Any, ...] = tuple(arrays)
            self.programs.code = cython.cast(cython.pointer[Instruction], address_of(arrays[CODE_MEMORY]))
            self.programs.constants = cython.cast(cython.p_double, address_of(arrays[CONSTANT_MEMORY]))
            self.programs.variables = cython.cast(cython.p_double, address_of(arrays[VARIABLE_MEMORY]))
            self.programs.stack = cython.cast(cython.p_double, address_of(arrays[STACK_MEMORY]))
            self.programs.jets = cython.cast(cython.pointer[Jet], address_of(arrays[JET_MEMORY]))
            self.programs.branches = cython.cast(cython.p_double, address_of(arrays[HELD_MEMORY]))
            self.programs.doubt = cython.cast(cython.p_int, address_of(arrays[DOUBT_MEMORY]))
            self.programs.ranges = cython.cast(cython.pointer[Span], address_of(arrays[RANGE_MEMORY]))
            self.programs.middles = cython.cast(cython.pointer[Span], address_of(arrays[MIDDLE_MEMORY]))
            self.programs.spans = cython.cast(cython.pointer[Span], address_of(arrays[SPAN_MEMORY]))
            self.programs.tables = cython.cast(cython.pointer[cython.p_double], address_of(arrays[TABLE_MEMORY]))
        self.programs.holding = FREE

    def evaluate(self, start: cython.int, count: cython.int, x: Sequence[float]) -> float:
        """Return the value of one program at the variables x; NaN if it cannot be computed."""
        i: cython.Py_ssize_t
        self.check(start, count)
        if len(x) != self.variables:
            raise ValueError(f"there are {self.variables} variables, not {len(x)}")
        for i in range(self.variables):
            self.programs.variables[i] = x[i]
        return evaluate_program(cython.address(self.programs), Program(start, count))

    def hold(self, holding: cython.int) -> None:
        """Set what happens to branches in coordinates from now on: one of HOLDING."""
        self.programs.holding = holding

    def branches(self) -> list[float]:
        """Return the held branches in the order of the programs' HOLD instructions."""
        return [self.programs.branches[k] for k in range(self.held_count)]

    def hold_branches(self, branches: Sequence[float]) -> None:
        """Set the branches to hold, one for each HOLD instruction."""
        k: cython.Py_ssize_t
        if len(branches) != self.held_count:
            raise ValueError(f"{self.held_count} branches are held, not {len(branches)}")
        for k in range(self.held_count):
            self.programs.branches[k] = branches[k]

    def take_doubts(self) -> list[int]:
        """Return and clear the numbers of the branches that enclosures (enclosure.py) found in doubt since the last
        call.
        """
        k: cython.Py_ssize_t
        doubts: list[int] = [k for k in range(self.held_count) if self.programs.doubt[k]]
        for k in range(self.held_count):
            self.programs.doubt[k] = 0
        return doubts

    def sample(
        self, start: cython.int, count: cython.int, times: cython.double[::1], values: cython.double[::1]
    ) -> None:
        """Write the values of one program in time alone at instants into `values`, as long as `times`; coordinates are
        NaN.
        """
        i: cython.Py_ssize_t
        self.check(start, count)
        if len(values) != len(times):
            raise ValueError(f"{len(times)} instants, but room for {len(values)} values")
        for i in range(self.variables):
            self.programs.variables[i] = NAN
        for i in range(len(times)):
            self.programs.variables[0] = times[i]
            values[i] = evaluate_program(cython.address(self.programs), Program(start, count))

    def check(self, start: cython.Py_ssize_t, count: cython.Py_ssize_t) -> None:
        """Raises ValueError if there is no such program."""
        if self.counts.get(start) != count:
            raise ValueError(f"no program of {count} instructions begins at {start}; there are {len(self.counts)}")


def address_of(memory: array[int] | array[float]) -> cython.size_t:
    """Return the address of an array's first number."""
    address: cython.size_t = memory.buffer_info()[0]
    return address
