"""Code for the parts of an expression, in postfix order; a part that is constant is folded into one number.

The kernel's evaluator alone decides what a number is, also here, where constants are folded.
"""

from __future__ import annotations

import math
from array import array
from functools import cache

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.kernel.choose import expressions
from heuncli.scene.expressions.calculations import Operation, Source
from heuncli.scene.expressions.dimensions import COORDINATES, FACTOR, FREE, OF_TIME, Measure, combined, looked_up, loose
from heuncli.scene.expressions.programs import Code, Expression, Switch, TableFunction, outside

OP = expressions.OPERATIONS
MOST_NODES = 500
BEYOND = "no division by 0, no root or logarithm of what is negative, nothing beyond 1e308"
COMPARISONS = {"<": "lt", "<=": "le", ">": "gt", ">=": "ge", "==": "eq", "!=": "ne"}
NOTHING: frozenset[int] = frozenset()
TRUTHS = frozenset({*COMPARISONS.values(), "step"})
BRANCHING = frozenset({*TRUTHS, "sign", "abs", "min", "max", "atan2"})


class Part(NamedTuple):
    """The code of a part of an expression, the variables it uses, and its value where it is constant.

    is_truth: it is 1 or 0, and where it changes a branch changes in its own code. measure: its dimension.
    """

    code: Code
    uses: frozenset[int]
    constant: float | None = None
    is_truth: bool = False
    measure: Measure = FREE


@cache
def operation(name: str, argument: int, operands: int) -> expressions.Expressions:
    """The program of one operation, whose operands are its variables: made once, for however many numbers."""
    code = [*(x for k in range(operands) for x in (OP["var"], k)), OP[name], argument]
    return expressions.Expressions(array("i", code), array("d"), operands)


class Codegen:
    """The constants, variables, tables and switches of one expression, and the parts made so far.

    strict: what has a unit is not compared with the time or a coordinate of another dimension, nor added to it.
    """

    def __init__(self, strict: bool = False) -> None:
        self.strict = strict
        self.nodes = 0
        self.constants: list[float] = []
        self.variables: dict[tuple[str, str], int] = {}
        self.tables: list[TableFunction] = []
        self.switches: list[Switch] = []
        self.held: list[str] = []
        self.out_of_range: Finding | None = None  # a table at a constant outside its range: an error ...
        self.branches = False  # ... unless it may stand in a branch that is not chosen
        self.sources: list[Source] | None = []  # of the constants; None: a choice hangs on one of them

    def finished(self, text: str, part: Part) -> Expression:
        """The expression that is this part. Raises Finding where it is constant and not finite."""
        is_not_finite = part.constant is not None and not math.isfinite(part.constant)
        if self.out_of_range is not None and (is_not_finite or not self.branches):
            raise self.out_of_range
        if is_not_finite:
            raise Finding("not-computable", f"'{text.strip()}' is not a finite number", BEYOND)
        return Expression(
            source=text, constant=part.constant, uses=tuple(self.variables), time_dependent=0 in part.uses,
            code=part.code, constants=tuple(self.constants), tables=tuple(self.tables),
            switches=tuple(self.switches), held=tuple(self.held), is_truth=part.is_truth,
            dimension=part.measure.dimension if part.measure.kind == "known" else None,
        )  # fmt: skip

    def time(self) -> Part:
        """The variable t."""
        return self.counted(Part((OP["var"], 0), frozenset({0}), measure=OF_TIME))

    def coordinate(self, joint: str, quantity: str) -> Part:
        """The variable that is a joint's coordinate."""
        number = self.variables.setdefault((joint, quantity), len(self.variables) + 1)
        return self.counted(Part((OP["var"], number), frozenset({number}), measure=loose(COORDINATES[quantity])))

    def held_branch(self, text: str, uses: frozenset[int]) -> Code:
        """What stands before an operation that branches: its branch is held where it hangs on coordinates."""
        if uses <= {0}:
            return ()
        self.held.append(text)
        return (OP["hold"], len(self.held) - 1)

    def is_written(self, part: Part) -> bool:
        """Whether a number hangs on no parameter."""
        if self.sources is None or part.constant is None:
            return False
        pending = [part.code[1]]
        while pending:
            source = self.sources[pending.pop()]
            if isinstance(source, str):
                return False
            pending += source.operands if isinstance(source, Operation) else ()
        return True

    def look_up(self, table: TableFunction, argument: Part, text: str) -> Part:
        """A table's value at the argument."""
        if table not in self.tables:
            self.tables.append(table)
        measure = looked_up(table.name, table.dimensions, argument.measure)
        operation = (OP["table"], self.tables.index(table), table.pieces, table.kind)
        self.sources = None
        code = (*argument.code, *self.held_branch(text, argument.uses), *operation)
        if argument.constant is not None:
            value = self.looked_up(code, table)
            if math.isnan(value) and math.isfinite(argument.constant):
                message, hint = outside(table)
                self.out_of_range = Finding("not-computable", f"{message}, not {argument.constant:.9g}", hint)
            return self.number(value, measure)
        if argument.uses <= {0}:
            self.switches.append(Switch((*argument.code, OP["knot"], *code[-3:]), None))
        return self.counted(Part(code, argument.uses, measure=measure))

    def chain(self, first: Part, links: list[tuple[str, Part, Part, str]]) -> Part:
        """a < b < c as one condition, in which each part is run once; links: comparison, left, right, text."""
        self.sources = None
        if all(part.constant is not None for _, left, right, _ in links for part in (left, right)):
            truth = self.number(1.0)
            for name, left, right, _ in links:
                truth = self.apply("mul", truth, self.apply(name, left, right))
            return truth
        code, uses = first.code, first.uses
        for n, (name, left, right, text) in enumerate(links):
            combined(name, (left.measure, right.measure), strict=self.strict)
            self.switch_of_comparison(name, left, right)
            again = 0 if n == len(links) - 1 else 1  # 1: the right one is needed again
            code = (*code, *right.code, *self.held_branch(text, left.uses | right.uses), OP[name], again)
            uses |= right.uses
        return self.counted(Part(code + (OP["mul"], 0) * (len(links) - 1), uses, is_truth=True, measure=FACTOR))

    def number(self, value: float, measure: Measure = FACTOR, source: Source | None = None) -> Part:
        """A number; source: where it comes from, if it is not as it is written."""
        self.constants.append(value)
        if self.sources is not None:
            self.sources.append(value if source is None else source)
        return self.counted(Part((OP["const"], len(self.constants) - 1), NOTHING, value, False, measure))

    def counted(self, part: Part) -> Part:
        self.nodes += 1
        if self.nodes > MOST_NODES:
            message = f"an expression of more than {MOST_NODES} parts"
            raise Finding("expression-limit", message, "put its values in a table: tables: {gas: {file: ...}}")
        return part

    def looked_up(self, code: Code, table: TableFunction) -> float:
        """The number that the code of a table at a constant gives."""
        code = (*code[:-3], 0, *code[-2:])
        programs = expressions.Expressions(array("i", code), array("d", self.constants), 0, tables=(table.numbers,))
        return float(programs.evaluate(0, len(code) // 2, ()))

    def apply(self, name: str, *parts: Part, argument: int = 0, text: str = "") -> Part:
        """An operation on its operands; carried out at once on numbers. text: of one that has branches of its own."""
        code: Code = ()
        uses = NOTHING
        for part in parts:
            code += part.code
            uses |= part.uses
        measure = combined(name, [part.measure for part in parts], argument, self.strict)
        if not uses:
            operands = [part.constant for part in parts if part.constant is not None]
            program = operation(name, argument, len(operands))
            length = len(operands) + 1
            source = Operation(program, length, tuple(part.code[1] for part in parts))
            return self.number(program.evaluate(0, length, operands), measure, source)
        if uses <= {0}:
            self.switch(name, parts)
        held = self.held_branch(text, uses) if text and name in BRANCHING else ()
        return self.counted(Part((*code, *held, OP[name], argument), uses, is_truth=name in TRUTHS, measure=measure))

    def choose(self, condition: Part, then: Part, otherwise: Part, text: str = "") -> Part:
        """then where the condition is not 0, else otherwise; only the chosen one is run. text: of the condition."""
        self.branches, self.sources = True, None
        measure = combined("choose", (then.measure, otherwise.measure), strict=self.strict)
        if condition.constant is not None:
            if math.isnan(condition.constant):
                return condition
            return (then if condition.constant != 0.0 else otherwise)._replace(measure=measure)
        chosen = condition.code
        if not condition.is_truth and not condition.uses <= {0}:
            self.constants.append(0.0)
            chosen += (OP["const"], len(self.constants) - 1, *self.held_branch(text, condition.uses), OP["ne"], 0)
        code = (
            *chosen, OP["unless"], len(then.code) // 2 + 1, *then.code,
            OP["jump"], len(otherwise.code) // 2, *otherwise.code,
        )  # fmt: skip
        is_truth = all(part.is_truth or part.constant in (0.0, 1.0) for part in (then, otherwise))
        uses = condition.uses | then.uses | otherwise.uses
        return self.counted(Part(code, uses, is_truth=is_truth, measure=measure))

    def truth(self, part: Part, text: str, name: str = "ne") -> Part:
        """1 where a part is not 0, else 0; or, with "eq", the other way round."""
        return self.apply(name, part, self.number(0.0), text="" if part.is_truth else text)

    def switch(self, name: str, parts: tuple[Part, ...]) -> None:
        a = parts[0].code
        if name in ("sign", "step"):
            self.switches.append(Switch((*a, OP[name], 0), a))
        elif name == "abs":
            self.switches.append(Switch((*a, OP["step"], 0), a))
        elif name in ("min", "max"):
            self.switch_of_comparison("lt" if name == "min" else "gt", parts[1], parts[0])
        elif name in COMPARISONS.values():
            self.switch_of_comparison(name, parts[0], parts[1])
        elif name == "atan2":  # jumps by a turn where y changes its sign at x < 0
            zero, two = self.number(0.0).code, self.number(2.0).code
            turned = (*a, OP["step"], 0)
            left = (
                *parts[1].code,
                *zero,
                OP["lt"],
                0,
                OP["unless"],
                len(turned) // 2 + 1,
                *turned,
                OP["jump"],
                1,
                *two,
            )
            self.switches.append(Switch(left, a))

    def switch_of_comparison(self, name: str, left: Part, right: Part) -> None:
        if (left.uses | right.uses) == {0}:
            code = left.code + right.code
            self.switches.append(Switch((*code, OP[name], 0), (*code, OP["sub"], 0)))
