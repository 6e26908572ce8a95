"""Elastic ropes: their pull as a function of their length and its rate.

    T = k x + c e',   x = S - l0,  k = k0 L / l0,  c = c0 L / l0,  e' = S' - S l0' / l0

S: the length along which the rope runs; l0: its unloaded length, which is L at the start where a law gives it in time.

So EA = k0 L is constant while a rope is drawn in or paid out, and equal strain means equal tension. A rope that only
pulls is slack while x < 0, and does not push where the damping force exceeds the spring force.
"""

from __future__ import annotations

from heuncli.multibody.mechanism.couplings import CoupledRow
from heuncli.multibody.mechanism.model import RopeLoad
from heuncli.scene.expressions.composition import (
    add_expressions,
    apply_step,
    combine_expressions,
    limit_below,
    make_variable,
    multiply_expressions,
)
from heuncli.scene.expressions.programs import LOADS, OPS, Expression
from heuncli.scene.file_format.couplings import Rope


def rope_load(name: str, entry: Rope, row: CoupledRow, length: float) -> RopeLoad:
    """Make the load of an elastic rope, along the parts of what would be its condition; length: unloaded [m]."""
    assert entry.stiffness is not None
    prefix = f"{LOADS}.{name}"
    free = Expression.from_number(length) if entry.law is None else entry.law
    x = combine_expressions(make_variable((prefix, "length")), free, OPS["sub"], f"stretch of rope {name}")
    pull = multiply_expressions(divide_by_length(entry.stiffness, length, entry.law), x)
    if entry.damping:
        rate = make_variable((prefix, "speed"))
        if entry.law is not None:
            strained = combine_expressions(make_variable((prefix, "length")), entry.law, OPS["div"], "1 + strain")
            rate = combine_expressions(
                rate,
                multiply_expressions(strained, make_variable((prefix, "drawn"))),
                OPS["sub"],
                "rate of the stretch",
            )
        pull = add_expressions(pull, multiply_expressions(divide_by_length(entry.damping, length, entry.law), rate))
    if entry.tension_only:
        pull = limit_below(pull, 0.0)
        if entry.damping:
            pull = multiply_expressions(apply_step(x), pull)
    value = multiply_expressions(Expression.from_number(-1.0), pull).with_source(f"tension of rope {name}")
    return RopeLoad(name, row.parts, value, entry.stiffness, length, entry.law, entry.damping, entry.tension_only)


def divide_by_length(at_length: float, length: float, law: Expression | None) -> Expression:
    """Make an expression that varies as 1 / l0 along a law, from its value at one length."""
    if law is None:
        return Expression.from_number(at_length)
    return combine_expressions(Expression.from_number(at_length * length), law, OPS["div"], "per unloaded length")
