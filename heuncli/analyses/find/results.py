"""Findings about a measure over an interval: where it meets its value, jumps across it, comes near it, or does not
exist.
"""

from __future__ import annotations

from typing import Literal

from heuncli.analyses.variants.conditions import Comparison
from heuncli.analyses.variants.parameters import DesignVariable
from heuncli.analyses.variants.samples import Sample
from heuncli.base.named_tuples import NamedTuple

EdgeKind = Literal["crossing", "jump", "touch", "end", "unsolved", "bracket"]
FALLS, AT_END, RISES = -1, 0, 1  # the direction of a crossing; the numbers are signs of its slope


class Crossing(NamedTuple):
    """A place where the measure passes its value, with its error.

    sample: the variant there
    direction: RISES or FALLS; AT_END of the known range it may not pass the value
    flat: the slope there is smaller than its own error; the error of the place then reaches to the neighbours that
    are certainly on one side of the value
    """

    sample: Sample
    error: float
    direction: int
    flat: bool = False


class Touch(NamedTuple):
    """A place where the measure cannot be distinguished from its value and lies on one side of it on both ends.

    sample: the nearest one
    low, high: next places that are distinguishable from the value, or the ends of the known range
    side: BELOW or ABOVE around it; AT_VALUE if it is indistinguishable from the value wherever it is known
    """

    sample: Sample
    low: float
    high: float
    side: int


class MeasureJump(NamedTuple):
    """Adjacent samples between which the measure jumps across its value."""

    left: Sample
    right: Sample


class UnresolvedBracket(NamedTuple):
    """Adjacent samples on different sides of the value where the search stopped: a crossing or a jump."""

    left: Sample
    right: Sample


class PossibleMeeting(NamedTuple):
    """Samples on one side of the value between which samples and errors do not exclude that it is met."""

    left: Sample
    right: Sample


class UnsolvedStretch(NamedTuple):
    """A stretch without a measure, between the last places that have one: the reason, and how many variants failed.

    first, last: the outermost variants that fail
    withheld: variants at singular poses among them
    """

    low: float
    high: float
    code: str
    reason: str
    variants: int
    first: float
    last: float
    withheld: tuple[Sample, ...] = ()


class MetEdge(NamedTuple):
    """An end of a stretch where a condition is met: its place, the error of the place, and its kind."""

    x: float
    error: float
    kind: EdgeKind


class MetStretch(NamedTuple):
    """A stretch in which an inequality is met."""

    low: MetEdge
    high: MetEdge


class IntervalFindings(NamedTuple):
    """All findings, in the order of the interval.

    least, greatest: extremes of the known range, refined if the value is met nowhere (is_refined)
    spacing: spacing of the scan
    is_complete: whether the search ended before its limit of evaluations
    """

    crossings: tuple[Crossing, ...]
    touches: tuple[Touch, ...]
    jumps: tuple[MeasureJump, ...]
    brackets: tuple[UnresolvedBracket, ...]
    not_excluded: tuple[PossibleMeeting, ...]
    unsolved_stretches: tuple[UnsolvedStretch, ...]
    met_stretches: tuple[MetStretch, ...]
    least: Sample | None
    greatest: Sample | None
    is_refined: bool
    samples: tuple[Sample, ...]
    spacing: float
    is_complete: bool

    @property
    def is_met_nowhere(self) -> bool:
        """Whether the samples show that the value is met nowhere."""
        return self.is_complete and not (self.crossings or self.touches or self.brackets or self.not_excluded)


class FindResults(NamedTuple):
    """All that a search found: the scene's title, the condition, the interval of the unknown, and the findings there.

    scan: number of values in the scan
    """

    title: str
    condition: Comparison
    interval: DesignVariable
    findings: IntervalFindings
    scan: int
