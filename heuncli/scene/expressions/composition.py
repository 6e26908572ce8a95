"""Compose expressions from others: with scaled coordinates, products, limits, sums, components along other axes.

Each expression has its own constants, tables, coordinates and branches; in the composed one their indices are shifted.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from heuncli.base.records import replace
from heuncli.scene.expressions.programs import CONST, HOLD, KNOT, OPS, TABLE, VAR, Code, Expression, Switch

# Composition

MULTIPLY, ADD, MINIMUM, MAXIMUM = OPS["mul"], OPS["add"], OPS["min"], OPS["max"]
JUMPS = frozenset({OPS["jump"], OPS["unless"]})
Use = tuple[str, str]


def rename_coordinates(e: Expression, uses: Mapping[Use, Use]) -> Expression:
    """Replace coordinates in an expression."""
    return replace(e, uses=tuple(uses.get(use, use) for use in e.uses)) if e.uses else e


def scale_coordinate(e: Expression, use: Use, factor: float) -> Expression:
    """Replace a coordinate x in an expression by factor * x."""
    if use not in e.uses or factor == 1.0:
        return e
    variable, constant = 1 + e.uses.index(use), len(e.constants)
    code = _insert_factor(e.code, variable, constant)
    source = f"{e.source.strip()} [{use[1]} times {factor:.9g}]"
    return replace(e, source=source, code=code, constants=(*e.constants, factor))


def _insert_factor(code: Code, variable: int, constant: int) -> Code:
    """Insert a multiplication after each use of a variable; jumps keep their targets."""
    pairs = list(zip(code[::2], code[1::2], strict=True))
    is_data_pair = _find_data_pairs(pairs)
    is_use = [(op, k) == (VAR, variable) and not is_data for (op, k), is_data in zip(pairs, is_data_pair, strict=True)]
    new_index = [i + 2 * sum(is_use[:i]) for i in range(len(pairs) + 1)]
    out: list[int] = []
    for i, (op, k) in enumerate(pairs):
        if op in JUMPS and not is_data_pair[i]:
            k = new_index[i + 1 + k] - new_index[i + 1]
        out += [op, k]
        if is_use[i]:
            out += [CONST, constant, MULTIPLY, 0]
    return tuple(out)


def _find_data_pairs(pairs: Sequence[tuple[int, int]]) -> list[bool]:
    """Return which pairs are no instructions but data: those after the use of a table."""
    flags: list[bool] = []
    after_table = False
    for op, _ in pairs:
        flags.append(after_table)
        after_table = not after_table and op in (TABLE, KNOT)
    return flags


def multiply_expressions(a: Expression, b: Expression) -> Expression:
    """Return a times b."""
    if a.constant == 1.0:
        return b
    return combine_expressions(a, b, MULTIPLY, f"({a.source.strip()})*({b.source.strip()})")


def add_expressions(a: Expression, b: Expression) -> Expression:
    """Return a plus b."""
    if a.constant == 0.0:
        return b
    return combine_expressions(a, b, ADD, f"{a.source.strip()} + {b.source.strip()}")


def limit_magnitude(e: Expression, limit: float) -> Expression:
    """Limit an expression to [-limit, limit]; where it reaches a limit it has a branch."""
    capped = combine_expressions(e, Expression.from_number(limit), MINIMUM, f"min({e.source.strip()}, {limit:.9g})")
    return combine_expressions(capped, Expression.from_number(-limit), MAXIMUM, f"max({capped.source}, {-limit:.9g})")


def make_variable(use: Use) -> Expression:
    """Make the expression that is one coordinate."""
    return Expression(source=use[1], constant=None, uses=(use,), code=(VAR, 1))


def limit_below(e: Expression, limit: float) -> Expression:
    """Limit an expression of coordinates to values not below the limit; where it reaches it, it has a branch."""
    return combine_expressions(e, Expression.from_number(limit), MAXIMUM, f"max({e.source.strip()}, {limit:.9g})")


def apply_step(e: Expression) -> Expression:
    """Return 1 where an expression of coordinates is not below 0, else 0."""
    source = f"step({e.source.strip()})"
    return replace(
        e,
        source=source,
        code=(*e.code, HOLD, len(e.held_branches), OPS["step"], 0),
        held_branches=(*e.held_branches, source),
    )


def combine_expressions(a: Expression, b: Expression, op: int, source: str) -> Expression:
    """Apply an operation to two expressions, as one program."""
    uses = tuple(dict.fromkeys((*a.uses, *b.uses)))
    held_branches = (*a.held_branches, *b.held_branches)
    parts = [
        _shift_indices(a, a.code, (0, 0, 0), uses),
        _shift_indices(b, b.code, (len(a.constants), len(a.tables), len(a.held_branches)), uses),
    ]
    code = (*parts[0], *parts[1])
    switches = [
        Switch(
            _shift_indices(e, s.decision, offsets, uses),
            None if s.margin is None else _shift_indices(e, s.margin, offsets, uses),
        )
        for e, offsets in ((a, (0, 0, 0)), (b, (len(a.constants), len(a.tables), len(a.held_branches))))
        for s in e.switches
    ]
    time_dependent = a.time_dependent or b.time_dependent
    if op in (MINIMUM, MAXIMUM):
        if uses:
            held_branches, code = (*held_branches, source), (*code, HOLD, len(held_branches))
        elif time_dependent:
            compared = OPS["lt"] if op == MINIMUM else OPS["gt"]
            swapped = (*parts[1], *parts[0])
            switches.append(Switch((*swapped, compared, 0), (*swapped, OPS["sub"], 0)))
    expression = Expression(
        source=source, constant=None, uses=uses, time_dependent=time_dependent, location=a.location or b.location,
        code=(*code, op, 0), constants=(*a.constants, *b.constants), tables=(*a.tables, *b.tables),
        switches=tuple(switches), held_branches=held_branches,
    )  # fmt: skip
    if a.constant is None or b.constant is None:
        return expression
    return replace(
        Expression.from_number(expression.pack.value(0, expression.count, [0.0]), expression.location), source=source
    )


def _shift_indices(e: Expression, code: Code, offsets: tuple[int, int, int], uses: tuple[Use, ...]) -> Code:
    """Shift the indices of a program's constants, tables and branches by offsets, and number its coordinates as in
    `uses`.
    """
    constants, tables, branches = offsets
    pairs = list(zip(code[::2], code[1::2], strict=True))
    out: list[int] = []
    for (op, k), is_data in zip(pairs, _find_data_pairs(pairs), strict=True):
        if not is_data:
            if op == CONST:
                k += constants
            elif op == VAR and k > 0:
                k = 1 + uses.index(e.uses[k - 1])
            elif op in (TABLE, KNOT):
                k += tables
            elif op == HOLD:
                k += branches
        out += [op, k]
    return tuple(out)


# Sums


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
