"""What is found of a measure over an interval: where it meets its value, jumps across it, comes near it, or is not."""

from __future__ import annotations

from typing import Literal

from heuncli.analyses.variants.conditions import Sign
from heuncli.analyses.variants.course import Sample
from heuncli.base.named_tuples import NamedTuple

EdgeKind = Literal["crossing", "jump", "touch", "end", "unsolved", "bracket"]


class FindCondition(NamedTuple):
    """A condition in SI, with the SI unit of its measure (empty: none); own: the unit in which the value was given."""

    text: str
    relation: Sign
    value: float
    unit: str
    own: str


class Crossing(NamedTuple):
    """Where the measure passes its value, within an error; sample: the variant there.

    way: 1 it rises through it, -1 it falls; 0: at an end of what is known, where only one side is; flat: its slope is
    below what its error makes of it there, and the error of the place is that of the neighbours that are told from it.
    """

    sample: Sample
    error: float
    way: int
    flat: bool = False


class Touch(NamedTuple):
    """Where the measure is not told from its value and lies on one side of it around: at its best, from low to high.

    low, high: the next places on both sides at which it is told from the value again, or the ends of what is known;
    side: on which it lies around; 0: it is not told from the value wherever it is known.
    """

    sample: Sample
    low: float
    high: float
    side: int


class CourseJump(NamedTuple):
    """Neighbours between which the measure jumps across its value."""

    before: Sample
    after: Sample


class OpenBracket(NamedTuple):
    """Neighbours on different sides of the value between which the search did not go on: a crossing, or a jump."""

    before: Sample
    after: Sample


class NotExcluded(NamedTuple):
    """Places on one side of the value between which samples and their errors do not exclude that it is met."""

    before: Sample
    after: Sample


class UnsolvedStretch(NamedTuple):
    """Where there is no measure, between the last places at which there is one: why, and how many variants tell it.

    first, last: of the variants that fail; withheld: the variants of singular poses among them.
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
    """An end of where a condition is met: its place, within an error, and what it is."""

    x: float
    error: float
    kind: EdgeKind


class Met(NamedTuple):
    """A stretch in which an inequality is met."""

    low: MetEdge
    high: MetEdge


class CourseFindings(NamedTuple):
    """All that was found, in the order of the interval.

    least, greatest: of what is known, refined where nothing is met (refined); spacing: of the scan; complete: whether
    all was asked that was wanted.
    """

    crossings: tuple[Crossing, ...]
    touches: tuple[Touch, ...]
    jumps: tuple[CourseJump, ...]
    brackets: tuple[OpenBracket, ...]
    not_excluded: tuple[NotExcluded, ...]
    unsolved: tuple[UnsolvedStretch, ...]
    met: tuple[Met, ...]
    least: Sample | None
    greatest: Sample | None
    refined: bool
    samples: tuple[Sample, ...]
    spacing: float
    complete: bool

    @property
    def is_met_nowhere(self) -> bool:
        """Whether the samples allow to say that the value is met nowhere."""
        return self.complete and not (self.crossings or self.touches or self.brackets or self.not_excluded)
