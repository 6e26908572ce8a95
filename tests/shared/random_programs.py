"""Random programs for the evaluator, instruction by instruction: more than any text can say, in all its operations."""

from __future__ import annotations

import math
from array import array
from dataclasses import dataclass, field
from random import Random
from typing import Any

from heuncli.kernel.choose import expressions
from heuncli.scene.expressions.programs import OPS

ONE = (
    "neg", "abs", "sign", "step", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log",
    "sqrt",
)  # fmt: skip
TWO = ("add", "sub", "mul", "div", "pow", "atan2", "hypot", "min", "max")
COMPARISONS = ("lt", "le", "gt", "ge", "eq", "ne")
BRANCHING = {*COMPARISONS, "sign", "step", "abs", "min", "max", "atan2", "table", "knot"}
NUMBERS = (
    0.0, -0.0, 1.0, -1.0, 0.5, -0.5, 2.0, 3.0, -7.0, 0.1, 1e-3, 1e8, 709.9, -745.3, 1e308, -1e308, 1e-308, 5e-324,
    math.inf, -math.inf, math.nan,
)  # fmt: skip
VARIABLES = 3
FREE, HELD, TAKEN = (expressions.HOLDING[name] for name in ("free", "held", "taken"))


@dataclass
class Program:
    """Code as (name or number of pieces, argument), with the constants it points into and the tables it counts."""

    code: list[tuple[str | int, int]] = field(default_factory=list)
    constants: list[float] = field(default_factory=list)
    tables: list[array[float]] = field(default_factory=list)

    def numbered(self, operations: dict[str, int]) -> array[int]:
        """The code as an evaluator with these numbers of operations takes it."""
        return array("i", [x for op, k in self.code for x in (operations[op] if isinstance(op, str) else op, k)])

    def in_time(self) -> Program:
        """The same with the time in place of all other variables."""
        return Program([(op, 0 if op == "var" else k) for op, k in self.code], self.constants, self.tables)

    def holding(self) -> tuple[Program, list[str]]:
        """The same with all its branches held, and what these are branches of. Jumps go as far as before."""
        is_data = [i > 0 and self.code[i - 1][0] in ("table", "knot") for i in range(len(self.code))]
        branches = [op in BRANCHING and not data for (op, _), data in zip(self.code, is_data, strict=True)]
        code: list[tuple[str | int, int]] = []
        held: list[str] = []
        for i, (op, k) in enumerate(self.code):
            if branches[i]:
                code.append(("hold", len(held)))
                held.append(str(op))
            code.append((op, k + sum(branches[i + 1 : i + 1 + k]) if op in ("jump", "unless") else k))
        return Program(code, self.constants, self.tables), held


def random_program(random: Random) -> Program:
    program = Program()
    _part(program, random, random.choice((1, 2, 3, 4, 6)))
    return program


def _part(program: Program, random: Random, deep: int) -> None:
    """A part that leaves one number on the stack."""
    emit = program.code.append
    kind = random.random() if deep else 0.0
    if kind < 0.12:
        if random.random() < 0.5:
            emit(("var", random.choice((0, 0, 0, 1, 2))))
        else:
            emit(("const", len(program.constants)))
            program.constants.append(random.choice(NUMBERS) if random.random() < 0.4 else random.uniform(-4.0, 4.0))
    elif kind < 0.45:
        _part(program, random, deep - 1)
        _part(program, random, deep - 1)
        emit((random.choice(TWO), 0))
    elif kind < 0.68:
        _part(program, random, deep - 1)
        emit((random.choice(ONE), 0))
    elif kind < 0.73:
        _part(program, random, deep - 1)
        emit(("power", random.choice((2, 3, 4, 7, 64))))
    elif kind < 0.8:
        _comparisons(program, random, deep)
    elif kind < 0.9:
        _branches(program, random, deep)
    else:
        _table(program, random, deep)


def _comparisons(program: Program, random: Random, deep: int) -> None:
    links = random.choice((1, 1, 2, 3))
    _part(program, random, deep - 1)
    for n in range(links):
        _part(program, random, deep - 1)
        program.code.append((random.choice(COMPARISONS), int(n < links - 1)))
    program.code += [("mul", 0)] * (links - 1)


def _branches(program: Program, random: Random, deep: int) -> None:
    _part(program, random, deep - 1)
    unless = len(program.code)
    program.code.append(("unless", 0))
    _part(program, random, deep - 1)
    jump = len(program.code)
    program.code.append(("jump", 0))
    _part(program, random, deep - 1)
    program.code[unless] = ("unless", jump - unless)
    program.code[jump] = ("jump", len(program.code) - jump - 1)


def _table(program: Program, random: Random, deep: int) -> None:
    _part(program, random, deep - 1)
    pieces, outside = random.choice((1, 2, 3, 8)), random.choice((0, 1, 2))
    knots = sorted(random.choice((0.0, -0.0, random.uniform(-3.0, 3.0))) + 0.01 * k for k in range(pieces + 1))
    coefficients = [random.uniform(-2.0, 2.0) for _ in range(4 * pieces)]
    program.tables.append(array("d", [knots[-1] - knots[0], *knots, *coefficients]))
    program.code += [(random.choice(("table", "table", "knot")), len(program.tables) - 1), (pieces, outside)]


def programs_of(program: Program, held: int = 0) -> Any:
    """The program as the kernel's evaluator holds it, with so many held branches."""
    code = program.numbered(OPS)
    return expressions.Expressions(code, array("d", program.constants), VARIABLES, held, tables=program.tables)


def some_stretch(random: Random, shortest: float = -9.0) -> tuple[float, float]:
    """Of lengths from 10**shortest to 3, or none."""
    begin = random.choice((0.0, random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0)))
    return begin, begin + random.choice((0.0, *[10.0 ** random.uniform(shortest, 0.5)] * 6))
