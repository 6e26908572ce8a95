"""Expressions made of others: with a coordinate told otherwise, multiplied, kept within limits.

Each has its own constants, tables, coordinates and branches; in what is made of them these are counted on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from heuncli.base.records import replace
from heuncli.scene.expressions.programs import CONST, HOLD, KNOT, OPS, TABLE, VAR, Code, Expression, Switch

MULTIPLY, ADD, LEAST, LARGEST = OPS["mul"], OPS["add"], OPS["min"], OPS["max"]
JUMPS = frozenset({OPS["jump"], OPS["unless"]})
Use = tuple[str, str]


def renamed(e: Expression, uses: Mapping[Use, Use]) -> Expression:
    """The expression of other coordinates."""
    return replace(e, uses=tuple(uses.get(use, use) for use in e.uses)) if e.uses else e


def with_factor(e: Expression, use: Use, factor: float) -> Expression:
    """The expression in which a coordinate is told by so many times what it is: f(factor * x)."""
    if use not in e.uses or factor == 1.0:
        return e
    variable, constant = 1 + e.uses.index(use), len(e.constants)
    code = _lengthened(e.code, variable, constant)
    source = f"{e.source.strip()} [{use[1]} times {factor:.9g}]"
    return replace(e, source=source, code=code, constants=(*e.constants, factor))


def _lengthened(code: Code, variable: int, constant: int) -> Code:
    """A program with two instructions more behind each use of a variable; jumps lead where they led."""
    pairs = list(zip(code[::2], code[1::2], strict=True))
    data = _data(pairs)
    longer = [(op, k) == (VAR, variable) and not is_data for (op, k), is_data in zip(pairs, data, strict=True)]
    at = [i + 2 * sum(longer[:i]) for i in range(len(pairs) + 1)]
    out: list[int] = []
    for i, (op, k) in enumerate(pairs):
        if op in JUMPS and not data[i]:
            k = at[i + 1 + k] - at[i + 1]
        out += [op, k]
        if longer[i]:
            out += [CONST, constant, MULTIPLY, 0]
    return tuple(out)


def _data(pairs: Sequence[tuple[int, int]]) -> list[bool]:
    """Which of the pairs are no instructions: those behind the use of a table."""
    found: list[bool] = []
    behind = False
    for op, _ in pairs:
        found.append(behind)
        behind = not behind and op in (TABLE, KNOT)
    return found


def product(a: Expression, b: Expression) -> Expression:
    """a times b."""
    if a.constant == 1.0:
        return b
    return combined(a, b, MULTIPLY, f"({a.source.strip()})*({b.source.strip()})")


def total(a: Expression, b: Expression) -> Expression:
    """a plus b."""
    if a.constant == 0.0:
        return b
    return combined(a, b, ADD, f"{a.source.strip()} + {b.source.strip()}")


def within(e: Expression, limit: float) -> Expression:
    """The expression, not above the limit, nor below minus it; where it comes to one it has a branch."""
    above = combined(e, Expression.of(limit), LEAST, f"min({e.source.strip()}, {limit:.9g})")
    return combined(above, Expression.of(-limit), LARGEST, f"max({above.source}, {-limit:.9g})")


def variable(use: Use) -> Expression:
    """The expression that is one coordinate."""
    return Expression(source=use[1], constant=None, uses=(use,), code=(VAR, 1))


def above(e: Expression, limit: float) -> Expression:
    """The expression of coordinates, not below the limit; where it comes to it, it has a branch."""
    return combined(e, Expression.of(limit), LARGEST, f"max({e.source.strip()}, {limit:.9g})")


def stepped(e: Expression) -> Expression:
    """1 where an expression of coordinates is not below 0, else 0."""
    source = f"step({e.source.strip()})"
    return replace(e, source=source, code=(*e.code, HOLD, len(e.held), OPS["step"], 0), held=(*e.held, source))


def combined(a: Expression, b: Expression, op: int, source: str) -> Expression:
    """An operation on two expressions, as one program."""
    uses = tuple(dict.fromkeys((*a.uses, *b.uses)))
    held = (*a.held, *b.held)
    parts = [
        _moved(a, a.code, (0, 0, 0), uses),
        _moved(b, b.code, (len(a.constants), len(a.tables), len(a.held)), uses),
    ]
    code = (*parts[0], *parts[1])
    switches = [
        Switch(_moved(e, s.decision, by, uses), None if s.margin is None else _moved(e, s.margin, by, uses))
        for e, by in ((a, (0, 0, 0)), (b, (len(a.constants), len(a.tables), len(a.held))))
        for s in e.switches
    ]
    in_time = a.time_dependent or b.time_dependent
    if op in (LEAST, LARGEST):
        if uses:
            held, code = (*held, source), (*code, HOLD, len(held))
        elif in_time:
            compared = OPS["lt"] if op == LEAST else OPS["gt"]
            swapped = (*parts[1], *parts[0])
            switches.append(Switch((*swapped, compared, 0), (*swapped, OPS["sub"], 0)))
    made = Expression(
        source=source, constant=None, uses=uses, time_dependent=in_time, location=a.location or b.location,
        code=(*code, op, 0), constants=(*a.constants, *b.constants), tables=(*a.tables, *b.tables),
        switches=tuple(switches), held=held,
    )  # fmt: skip
    if a.constant is None or b.constant is None:
        return made
    return replace(Expression.of(made.pack.value(0, made.count, [0.0]), made.location), source=source)


def _moved(e: Expression, code: Code, by: tuple[int, int, int], uses: tuple[Use, ...]) -> Code:
    """A program with its constants, tables and branches counted from there on, its coordinates as in `uses`."""
    constants, tables, held = by
    pairs = list(zip(code[::2], code[1::2], strict=True))
    out: list[int] = []
    for (op, k), is_data in zip(pairs, _data(pairs), strict=True):
        if not is_data:
            if op == CONST:
                k += constants
            elif op == VAR and k > 0:
                k = 1 + uses.index(e.uses[k - 1])
            elif op in (TABLE, KNOT):
                k += tables
            elif op == HOLD:
                k += held
        out += [op, k]
    return tuple(out)
