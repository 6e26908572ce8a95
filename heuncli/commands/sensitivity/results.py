"""What measures hang on: their derivatives by numbers of a spec, and what spreads of these make of them."""

from __future__ import annotations

from typing import Literal

from heuncli.named_tuples import NamedTuple

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
    """What a spread of one number makes of a measure: by the derivative, and by the variants at its ends.

    size: what it is counted with, within an error: by the derivative where the variants agree with it, else the larger
    of what these differ by. below, above: what the measure changes by there; None where there is none.
    """

    name: str
    spread: float
    unit: str
    size: float | None
    error: float
    linear: float | None
    below: float | None
    above: float | None

    @property
    def bent(self) -> bool:
        """Whether the variants at the ends do not agree with the derivative."""
        return self.size is not None and self.size != self.linear


class SpreadSum(NamedTuple):
    """What all spreads together make of a measure, each way: worst case and root of the sum of squares, with errors.

    corners: the measure where all numbers are at the ends that lower it, and that raise it. None: not known.
    """

    contributions: tuple[Contribution, ...]
    worst: tuple[float, float] | None
    square: tuple[float, float] | None
    corners: tuple[NoisyValue, NoisyValue]
