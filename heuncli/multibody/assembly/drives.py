"""A drive's prescribed coordinate at one instant: the one place where the assembly meets expressions in time."""

from __future__ import annotations

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.expressions.programs import Expression


class CoordinateJet(NamedTuple):
    """A coordinate, its rate and its acceleration."""

    value: float
    rate: float
    acceleration: float


def drive_jet(expression: Expression, t: float) -> CoordinateJet:
    """The expression and its first and second derivative at t."""
    return CoordinateJet(*expression.derivatives(t))
