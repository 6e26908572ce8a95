"""Derivatives of measures by numbers of a spec, and the effect of tolerances of these numbers."""

from __future__ import annotations

from typing import Literal

from heuncli.analyses.variants.measures import NoisyValue, Reason
from heuncli.base.named_tuples import NamedTuple

DerivativeKind = Literal["", "nothing", "one-sided", "kink", "refused"]


class NoisyDerivative(NamedTuple):
    """dm/dp within an error, in units of m and p.

    kind: "nothing" if m does not depend on p; "one-sided"; "kink", with the derivatives `left` and `right` of it and
    their errors; "refused", with the reason in `why`
    step: half the distance of the variants used; at a kink, how far from the number it may be
    """

    value: float | None
    error: float = 0.0
    kind: DerivativeKind = ""
    why: Reason = Reason()
    left: tuple[float, float] | None = None
    right: tuple[float, float] | None = None
    step: float = 0.0


class Contribution(NamedTuple):
    """Effect of one number's tolerance on a measure: by the derivative, and by the variants within it.

    size: largest known change, within an error; None if unknown
    linear: change predicted by the derivative; below, above: changes at the ends, None if unsolved
    bent: the variants do not lie on the derivative's line; the tolerance was then searched with `variants` variants,
    `least` and `greatest` give distance and change of the extremes
    why: the reason if a part of the tolerance range cannot be solved
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
    why: Reason = Reason()


class SpreadSum(NamedTuple):
    """Combined effect of all tolerances on a measure, each way: worst case and root sum of squares, with errors; None
    if unknown.

    corners: the measure with every number where it lowers it most, and where it raises it most
    by_variant: the worst case comes from a variant, as that exceeds the sum
    largest: the largest change of a variant of several numbers, with its error
    """

    contributions: tuple[Contribution, ...]
    worst: tuple[float, float] | None
    square: tuple[float, float] | None
    corners: tuple[NoisyValue, NoisyValue]
    by_variant: bool = False
    largest: tuple[float, float] | None = None
