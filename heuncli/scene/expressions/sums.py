"""Sums of expressions: components of a vector in time along other axes."""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.scene.expressions.programs import CONST, HOLD, KNOT, OPS, TABLE, VAR, Code, Expression

ADD, MULTIPLY = OPS["add"], OPS["mul"]


def weighted_sum(parts: Sequence[tuple[float, Expression]]) -> Expression | None:
    """The sum of factor times expression; None where it has branches, which belong to each expression by itself."""
    parts = [(factor, e) for factor, e in parts if factor != 0.0]
    if len(parts) == 1 and parts[0][0] == 1.0:
        return parts[0][1]
    known = [(factor, e.constant) for factor, e in parts if e.constant is not None]
    rest = sum((factor * constant for factor, constant in known), 0.0)
    varying = [(factor, e) for factor, e in parts if e.constant is None]
    if not varying:
        return Expression.of(rest)
    if any(e.held or e.switches for _, e in varying):
        return None
    return _joined(varying, rest)


def _joined(parts: Sequence[tuple[float, Expression]], rest: float) -> Expression:
    """The sum as one program: the first number is what does not vary."""
    constants = [rest]
    tables = tuple(table for _, e in parts for table in e.tables)
    uses = tuple(dict.fromkeys(use for _, e in parts for use in e.uses))
    code: list[int] = [CONST, 0]
    at_table = 0
    for factor, e in parts:
        code += moved(e, len(constants), at_table, uses)
        constants += [*e.constants, factor]
        code += [CONST, len(constants) - 1, MULTIPLY, 0, ADD, 0]
        at_table += len(e.tables)
    source = " + ".join(f"{factor:.9g}*({e.source.strip()})" for factor, e in parts)
    in_time = any(e.time_dependent for _, e in parts)
    return Expression(
        source=f"{rest:.9g} + {source}", constant=None, uses=uses, time_dependent=in_time,
        location=parts[0][1].location, code=tuple(code), constants=tuple(constants), tables=tables,
    )  # fmt: skip


def moved(e: Expression, constants: int, tables: int, uses: tuple[tuple[str, str], ...]) -> Code:
    """An expression's program with its constants and tables counted from there on, its coordinates as in `uses`."""
    code: list[int] = []
    is_data = False
    for op, argument in zip(e.code[::2], e.code[1::2], strict=True):
        if is_data:
            is_data = False
        elif op == CONST:
            argument += constants
        elif op == VAR and argument > 0:
            argument = 1 + uses.index(e.uses[argument - 1])
        elif op in (TABLE, KNOT):
            argument, is_data = argument + tables, True
        assert is_data or op != HOLD
        code += [op, argument]
    return tuple(code)
