"""What measures hang on: their derivatives by numbers of a spec, and what spreads of these make of them."""

from __future__ import annotations

from typing import Literal

from heuncli.base.named_tuples import NamedTuple

DerivativeKind = Literal["", "nothing", "one-sided", "kink", "refused"]


class NoisyValue(NamedTuple):
    """A measure of a variant within its stated error; None: there is none, and why, a code and a sentence."""

    value: float | None
    error: float = 0.0
    why: tuple[str, str] = ("", "")


class NoisyDerivative(NamedTuple):
    """dm/dp within an error, in units of m and p.

    kind: "nothing" hangs on it, it is known from one side alone, it bends there (left and right of it, each with its
    error), or it is refused, and why: a code and a sentence. step: half the distance of the variants it is from; where
    it bends, how far from the number that may be.
    """

    value: float | None
    error: float = 0.0
    kind: DerivativeKind = ""
    why: tuple[str, str] = ("", "")
    left: tuple[float, float] | None = None
    right: tuple[float, float] | None = None
    step: float = 0.0


class Contribution(NamedTuple):
    """What a spread of one number makes of a measure: by the derivative, and by the variants within it.

    size: what it is counted with, within an error: the largest change that is known, None where that is not known.
    linear: what the derivative says; below, above: what the measure changes by at the ends; None where there is none.
    bent: the variants do not lie on the line of the derivative, and the spread was searched with so many variants, for
    the distances from the number and the changes of the least and the greatest; why: a code and a sentence where a part
    of the spread cannot be solved.
    """

    name: str
    spread: float
    unit: str
    size: float | None
    error: float
    linear: float | None
    below: float | None
    above: float | None
    bent: bool = False
    least: tuple[float, float] | None = None
    greatest: tuple[float, float] | None = None
    variants: int = 0
    why: tuple[str, str] = ("", "")


class SpreadSum(NamedTuple):
    """What all spreads together make of a measure, each way: worst case and root of the sum of squares, with errors.

    corners: the measure where each number is where it lowers it most, and where it raises it most. by_variant: the
    worst case is what a variant showed, since that is more than the sum. largest: the largest change that a variant of
    several numbers showed, and its error. None: not known.
    """

    contributions: tuple[Contribution, ...]
    worst: tuple[float, float] | None
    square: tuple[float, float] | None
    corners: tuple[NoisyValue, NoisyValue]
    by_variant: bool = False
    largest: tuple[float, float] | None = None
