"""A drive's prescribed coordinate at one instant: the only place where the assembly evaluates expressions in time."""

from __future__ import annotations

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.expressions.programs import Expression


class CoordinateJet(NamedTuple):
    """A coordinate, its rate and its acceleration."""

    value: float
    rate: float
    acceleration: float


def drive_jet(expression: Expression, t: float) -> CoordinateJet:
    """Evaluate the expression and its first and second derivative at t."""
    return CoordinateJet(*expression.derivatives(t))
