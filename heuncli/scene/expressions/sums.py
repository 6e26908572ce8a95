"""Sum expressions: components of a vector in time along other axes."""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.scene.expressions.programs import CONST, HOLD, KNOT, OPS, TABLE, VAR, Code, Expression

ADD, MULTIPLY = OPS["add"], OPS["mul"]


def weighted_sum(parts: Sequence[tuple[float, Expression]]) -> Expression | None:
    """Return the sum of factor times expression; None if one has branches, which belong to each expression by
    itself.
    """
    parts = [(factor, e) for factor, e in parts if factor != 0.0]
    if len(parts) == 1 and parts[0][0] == 1.0:
        return parts[0][1]
    constant_parts = [(factor, e.constant) for factor, e in parts if e.constant is not None]
    constant_sum = sum((factor * constant for factor, constant in constant_parts), 0.0)
    varying = [(factor, e) for factor, e in parts if e.constant is None]
    if not varying:
        return Expression.from_number(constant_sum)
    if any(e.held_branches or e.switches for _, e in varying):
        return None
    return _join_programs(varying, constant_sum)


def _join_programs(parts: Sequence[tuple[float, Expression]], constant_sum: float) -> Expression:
    """Make the sum as one program; its first constant is the sum of the constant parts."""
    constants = [constant_sum]
    tables = tuple(table for _, e in parts for table in e.tables)
    uses = tuple(dict.fromkeys(use for _, e in parts for use in e.uses))
    code: list[int] = [CONST, 0]
    table_count = 0
    for factor, e in parts:
        code += shift_indices(e, len(constants), table_count, uses)
        constants += [*e.constants, factor]
        code += [CONST, len(constants) - 1, MULTIPLY, 0, ADD, 0]
        table_count += len(e.tables)
    source = " + ".join(f"{factor:.9g}*({e.source.strip()})" for factor, e in parts)
    time_dependent = any(e.time_dependent for _, e in parts)
    return Expression(
        source=f"{constant_sum:.9g} + {source}", constant=None, uses=uses, time_dependent=time_dependent,
        location=parts[0][1].location, code=tuple(code), constants=tuple(constants), tables=tables,
    )  # fmt: skip


def shift_indices(e: Expression, constant_offset: int, table_offset: int, uses: tuple[tuple[str, str], ...]) -> Code:
    """Return an expression's program with its constants and tables counted from offsets, its coordinates as in
    `uses`.
    """
    code: list[int] = []
    is_data = False
    for op, argument in zip(e.code[::2], e.code[1::2], strict=True):
        if is_data:
            is_data = False
        elif op == CONST:
            argument += constant_offset
        elif op == VAR and argument > 0:
            argument = 1 + uses.index(e.uses[argument - 1])
        elif op in (TABLE, KNOT):
            argument, is_data = argument + table_offset, True
        assert is_data or op != HOLD
        code += [op, argument]
    return tuple(code)
