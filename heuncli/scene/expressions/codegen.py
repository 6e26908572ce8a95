"""Generate code for the parts of an expression, in postfix order; a constant part is folded into one number.

Only the kernel's evaluator calculates numbers, also here, where constants are folded.

A number is calculated again with other parameter values without parsing the text again. An expression of parameters
alone becomes a row of numbers: each is a literal, a parameter, or the result of an operation on earlier ones. With
other values the row stays the same, unless a choice depends on a value (`a if c else b`, tables, an exponent that is no
literal): then nothing is cached.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Mapping, Sequence
from functools import cache

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.kernel.choose import expressions
from heuncli.scene.expressions.dimensions import (
    COORDINATES,
    FACTOR,
    FREE,
    TIME_DIMENSION,
    MeasuredDimension,
    coordinate_dimension,
    operation_dimension,
    table_dimension,
)
from heuncli.scene.expressions.programs import Code, Expression, Switch, TableFunction, out_of_range_texts

# Calculations

Dimension = tuple[int, int, int]


class Operation(NamedTuple):
    """An operation on earlier numbers of the row; length: that of its program."""

    program: expressions.Expressions
    length: int
    operands: tuple[int, ...]


MAX_OLDER_ENTRIES = 7  # older calculations stored for one text, besides the latest
NumberSource = float | str | Operation  # where a number comes from: a literal, a parameter's name, or an operation


class Calculation(NamedTuple):
    """An expression, the sources of its numbers, and the dimensions of its parameters (None without one)."""

    expression: Expression
    sources: tuple[NumberSource, ...]
    dimensions: dict[str, Dimension | None]

    def recalculate(self, parameters: Mapping[str, float | None]) -> Expression | None:
        """Return the expression with these values; None if it has to be parsed, because of an error to report."""
        numbers: list[float] = []
        for source in self.sources:
            if isinstance(source, Operation):
                operands = [numbers[k] for k in source.operands]
                numbers.append(source.program.evaluate(0, source.length, operands))
            elif isinstance(source, str):
                value = parameters[source]
                if value is None:
                    return None
                numbers.append(value)
            else:
                numbers.append(source)
        constant = numbers[self.expression.code[1]]
        if not math.isfinite(constant):
            return None
        recalculated: Expression = replace(self.expression, constant=constant, constants=tuple(numbers))
        return recalculated


class CalculationCache:
    """Cache of parsed numbers by their texts. Impure: entries are added, which changes no number.

    A text has several entries if its parameters were given with and without units.
    """

    def __init__(self) -> None:
        self.entries: dict[str, tuple[Calculation, ...]] = {}

    def recalculate(
        self, text: str, parameters: Mapping[str, float | None], dimension_of: Callable[[str], Dimension | None]
    ) -> Expression | None:
        """Return the expression of a text with these values; None if it has to be parsed."""
        for entry in self.entries.get(text, ()):
            if all(dimension_of(name) == dimension for name, dimension in entry.dimensions.items()):
                return entry.recalculate(parameters)
        return None

    def store(
        self,
        text: str,
        expression: Expression,
        sources: Sequence[NumberSource] | None,
        dimension_of: Callable[[str], Dimension | None],
    ) -> None:
        """Store how a number was calculated. sources: None if a choice depends on a value; then nothing is stored."""
        if sources is not None:
            dimensions = {name: dimension_of(name) for name in sources if isinstance(name, str)}
            others = self.entries.get(text, ())[-MAX_OLDER_ENTRIES:]
            self.entries[text] = (*others, Calculation(expression, tuple(sources), dimensions))


# Codegen

OP = expressions.OPERATIONS
MAX_NODES = 500
NOT_FINITE_HINT = "avoid division by 0, roots and logarithms of negative numbers, and values above 1e308"
COMPARISONS = {"<": "lt", "<=": "le", ">": "gt", ">=": "ge", "==": "eq", "!=": "ne"}
NO_VARIABLES: frozenset[int] = frozenset()
TRUTH_OPERATIONS = frozenset({*COMPARISONS.values(), "step"})
BRANCHING_OPERATIONS = frozenset({*TRUTH_OPERATIONS, "sign", "abs", "min", "max", "atan2"})


class Part(NamedTuple):
    """A compiled part of an expression: its code, the variables it reads, and its value if it is constant.

    is_truth: it is 1 or 0, and changes only where a branch in its own code changes
    measure: its dimension
    is_condition: it is written as a comparison, or with `and`, `or`, `not`
    """

    code: Code
    uses: frozenset[int]
    constant: float | None = None
    is_truth: bool = False
    measure: MeasuredDimension = FREE
    is_condition: bool = False


@cache
def operation_program(name: str, argument: int, operand_count: int) -> expressions.Expressions:
    """Make the program of one operation, whose operands are its variables. It is cached, as it serves any numbers."""
    code = [*(x for k in range(operand_count) for x in (OP["var"], k)), OP[name], argument]
    return expressions.Expressions(array("i", code), array("d"), operand_count)


class CodeGenerator:
    """The constants, variables, tables and switches of one expression, collected while its parts are made.

    strict: refuse to compare or add a quantity with a unit and the time or a coordinate of another dimension
    """

    def __init__(self, strict: bool = False) -> None:
        self.strict = strict
        self.nodes = 0
        self.constants: list[float] = []
        self.variables: dict[tuple[str, str], int] = {}
        self.tables: list[TableFunction] = []
        self.switches: list[Switch] = []
        self.held_branches: list[str] = []
        self.out_of_range: Finding | None = None  # a table at a constant outside its range: an error ...
        self.branches = False  # ... unless it may be in a branch that is not chosen
        self.sources: list[NumberSource] | None = []  # sources of the constants; None: a choice depends on one of them

    def make_expression(self, text: str, part: Part) -> Expression:
        """Make the expression of a part. Raises Finding if it is constant and not finite."""
        is_not_finite = part.constant is not None and not math.isfinite(part.constant)
        if self.out_of_range is not None and (is_not_finite or not self.branches):
            raise self.out_of_range
        if is_not_finite:
            raise Finding("not-computable", f"'{text.strip()}' is not a finite number", NOT_FINITE_HINT)
        return Expression(
            source=text, constant=part.constant, uses=tuple(self.variables), time_dependent=0 in part.uses,
            code=part.code, constants=tuple(self.constants), tables=tuple(self.tables),
            switches=tuple(self.switches), held_branches=tuple(self.held_branches), is_truth=part.is_truth,
            dimension=part.measure.dimension if part.measure.kind == "known" else None, is_condition=part.is_condition,
        )  # fmt: skip

    def make_time(self) -> Part:
        """Return the variable t."""
        return self.count_part(Part((OP["var"], 0), frozenset({0}), measure=TIME_DIMENSION))

    def make_coordinate(self, joint: str, quantity: str) -> Part:
        """Return the variable of a joint's coordinate."""
        number = self.variables.setdefault((joint, quantity), len(self.variables) + 1)
        return self.count_part(
            Part((OP["var"], number), frozenset({number}), measure=coordinate_dimension(COORDINATES[quantity]))
        )

    def hold_branch(self, text: str, uses: frozenset[int]) -> Code:
        """Return the code before an operation with branches, which holds its branch if that depends on coordinates."""
        if uses <= {0}:
            return ()
        self.held_branches.append(text)
        return (OP["hold"], len(self.held_branches) - 1)

    def is_literal(self, part: Part) -> bool:
        """Return whether a number depends on no parameter."""
        if self.sources is None or part.constant is None:
            return False
        pending = [part.code[1]]
        while pending:
            source = self.sources[pending.pop()]
            if isinstance(source, str):
                return False
            pending += source.operands if isinstance(source, Operation) else ()
        return True

    def make_lookup(self, table: TableFunction, argument: Part, text: str) -> Part:
        """Return a table's value at the argument."""
        if table not in self.tables:
            self.tables.append(table)
        measure = table_dimension(table.name, table.dimensions, argument.measure)
        operation = (OP["table"], self.tables.index(table), table.pieces, table.kind)
        self.sources = None
        code = (*argument.code, *self.hold_branch(text, argument.uses), *operation)
        if argument.constant is not None:
            value = self.evaluate_lookup(code, table)
            if math.isnan(value) and math.isfinite(argument.constant):
                message, hint = out_of_range_texts(table)
                self.out_of_range = Finding("not-computable", f"{message}, not {argument.constant:.9g}", hint)
            return self.make_number(value, measure)
        if argument.uses <= {0}:
            self.switches.append(Switch((*argument.code, OP["knot"], *code[-3:]), None))
        return self.count_part(Part(code, argument.uses, measure=measure))

    def make_chain(self, first: Part, links: list[tuple[str, Part, Part, str]]) -> Part:
        """Return a < b < c as one condition, in which each part runs once; links: comparison, left, right, text."""
        self.sources = None
        if all(part.constant is not None for _, left, right, _ in links for part in (left, right)):
            truth = self.make_number(1.0)
            for name, left, right, _ in links:
                truth = self.make_operation("mul", truth, self.make_operation(name, left, right))
            return truth
        code, uses = first.code, first.uses
        for n, (name, left, right, text) in enumerate(links):
            operation_dimension(name, (left.measure, right.measure), strict=self.strict)
            self.add_comparison_switch(name, left, right)
            keep_right = 0 if n == len(links) - 1 else 1  # 1: the right one is needed again
            code = (*code, *right.code, *self.hold_branch(text, left.uses | right.uses), OP[name], keep_right)
            uses |= right.uses
        return self.count_part(Part(code + (OP["mul"], 0) * (len(links) - 1), uses, is_truth=True, measure=FACTOR))

    def make_number(
        self, value: float, measure: MeasuredDimension = FACTOR, source: NumberSource | None = None
    ) -> Part:
        """Return a number; source: where it comes from, unless it is a literal."""
        self.constants.append(value)
        if self.sources is not None:
            self.sources.append(value if source is None else source)
        return self.count_part(Part((OP["const"], len(self.constants) - 1), NO_VARIABLES, value, False, measure))

    def count_part(self, part: Part) -> Part:
        """Count a part. Raises Finding [expression-limit] if there are too many."""
        self.nodes += 1
        if self.nodes > MAX_NODES:
            message = f"an expression of more than {MAX_NODES} parts"
            raise Finding("expression-limit", message, "put the values in a table: tables: {gas: {file: ...}}")
        return part

    def evaluate_lookup(self, code: Code, table: TableFunction) -> float:
        """Evaluate the code of a table lookup at a constant."""
        code = (*code[:-3], 0, *code[-2:])
        programs = expressions.Expressions(array("i", code), array("d", self.constants), 0, tables=(table.numbers,))
        return float(programs.evaluate(0, len(code) // 2, ()))

    def make_operation(self, name: str, *parts: Part, argument: int = 0, text: str = "") -> Part:
        """Apply an operation to its operands; numbers are folded. text: that of an operation with branches of its
        own.
        """
        code: Code = ()
        uses = NO_VARIABLES
        for part in parts:
            code += part.code
            uses |= part.uses
        measure = operation_dimension(name, [part.measure for part in parts], argument, self.strict)
        if not uses:
            operands = [part.constant for part in parts if part.constant is not None]
            program = operation_program(name, argument, len(operands))
            length = len(operands) + 1
            source = Operation(program, length, tuple(part.code[1] for part in parts))
            return self.make_number(program.evaluate(0, length, operands), measure, source)
        if uses <= {0}:
            self.add_switch(name, parts)
        hold_code = self.hold_branch(text, uses) if text and name in BRANCHING_OPERATIONS else ()
        return self.count_part(
            Part((*code, *hold_code, OP[name], argument), uses, is_truth=name in TRUTH_OPERATIONS, measure=measure)
        )

    def make_choice(self, condition: Part, then: Part, otherwise: Part, text: str = "") -> Part:
        """Return `then` where the condition is not 0, else `otherwise`; only the chosen one runs. text: that of the
        condition.
        """
        self.branches, self.sources = True, None
        measure = operation_dimension("choose", (then.measure, otherwise.measure), strict=self.strict)
        if condition.constant is not None:
            if math.isnan(condition.constant):
                return condition
            return (then if condition.constant != 0.0 else otherwise)._replace(measure=measure)
        condition_code = condition.code
        if not condition.is_truth and not condition.uses <= {0}:
            self.constants.append(0.0)
            condition_code += (
                OP["const"],
                len(self.constants) - 1,
                *self.hold_branch(text, condition.uses),
                OP["ne"],
                0,
            )
        code = (
            *condition_code, OP["unless"], len(then.code) // 2 + 1, *then.code,
            OP["jump"], len(otherwise.code) // 2, *otherwise.code,
        )  # fmt: skip
        is_truth = all(part.is_truth or part.constant in (0.0, 1.0) for part in (then, otherwise))
        uses = condition.uses | then.uses | otherwise.uses
        return self.count_part(Part(code, uses, is_truth=is_truth, measure=measure))

    def make_truth(self, part: Part, text: str, name: str = "ne") -> Part:
        """Return 1 where a part is not 0, else 0; with "eq" the other way round."""
        return self.make_operation(name, part, self.make_number(0.0), text="" if part.is_truth else text)

    def add_switch(self, name: str, parts: tuple[Part, ...]) -> None:
        """Record where an operation on parts that depend on time alone may change its branch."""
        a = parts[0].code
        if name in ("sign", "step"):
            self.switches.append(Switch((*a, OP[name], 0), a))
        elif name == "abs":
            self.switches.append(Switch((*a, OP["step"], 0), a))
        elif name in ("min", "max"):
            self.add_comparison_switch("lt" if name == "min" else "gt", parts[1], parts[0])
        elif name in COMPARISONS.values():
            self.add_comparison_switch(name, parts[0], parts[1])
        elif name == "atan2":  # jumps by 2 pi where y changes its sign at x < 0
            zero, two = self.make_number(0.0).code, self.make_number(2.0).code
            decision_at_negative_x = (*a, OP["step"], 0)
            decision = (
                *parts[1].code,
                *zero,
                OP["lt"],
                0,
                OP["unless"],
                len(decision_at_negative_x) // 2 + 1,
                *decision_at_negative_x,
                OP["jump"],
                1,
                *two,
            )
            self.switches.append(Switch(decision, a))

    def add_comparison_switch(self, name: str, first: Part, second: Part) -> None:
        """Record where a comparison of parts that depend on time alone may change."""
        if (first.uses | second.uses) == {0}:
            code = first.code + second.code
            self.switches.append(Switch((*code, OP[name], 0), (*code, OP["sub"], 0)))
