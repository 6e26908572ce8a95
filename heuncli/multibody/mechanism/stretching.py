"""Ropes that stretch: their pull as a value of how long they are, and how fast that changes.

    T = k x + c e',   x = S - l0,  k = k0 L / l0,  c = c0 L / l0,  e' = S' - S l0' / l0
S: the length along which the rope runs; l0: its length without load, which where it is told in time is L at the start.
So EA = k0 L stays while a rope is drawn in or paid out, and the same strain is the same tension. One that pulls alone
hangs slack while x < 0, and does not push where damping is more than the spring.
"""

from __future__ import annotations

from heuncli.multibody.mechanism.couplings import CoupledRow
from heuncli.multibody.mechanism.model import RopeLoad
from heuncli.scene.expressions.composed import above, combined, product, stepped, total, variable
from heuncli.scene.expressions.programs import LOADS, OPS, Expression
from heuncli.scene.file_format.couplings import Rope


def rope_load(name: str, given: Rope, row: CoupledRow, length: float) -> RopeLoad:
    """The load of a rope that stretches, along the parts of what would be its condition; length: without load [m]."""
    assert given.stiffness is not None
    own = f"{LOADS}.{name}"
    free = Expression.of(length) if given.law is None else given.law
    x = combined(variable((own, "length")), free, OPS["sub"], f"stretch of rope {name}")
    pull = product(per_length(given.stiffness, length, given.law), x)
    if given.damping:
        rate = variable((own, "speed"))
        if given.law is not None:
            strained = combined(variable((own, "length")), given.law, OPS["div"], "1 + strain")
            rate = combined(rate, product(strained, variable((own, "drawn"))), OPS["sub"], "rate of the stretch")
        pull = total(pull, product(per_length(given.damping, length, given.law), rate))
    if given.tension_only:
        pull = above(pull, 0.0)
        if given.damping:
            pull = product(stepped(x), pull)
    value = product(Expression.of(-1.0), pull).named(f"tension of rope {name}")
    return RopeLoad(name, row.parts, value, given.stiffness, length, given.law, given.damping, given.tension_only)


def per_length(at_length: float, length: float, law: Expression | None) -> Expression:
    """What goes as 1 / l0 along a law, and is told at one length."""
    if law is None:
        return Expression.of(at_length)
    return combined(Expression.of(at_length * length), law, OPS["div"], "of the length without load")
