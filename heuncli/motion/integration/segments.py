"""The segments of a run, within which no load or drive is discontinuous in time, and the instants next to their
ends.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cached_property

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array
from heuncli.scene.expressions.discontinuities import find_run_discontinuities


class Segment(NamedTuple):
    """A part of a run without discontinuities: its begin, the last instant before its end, and its end."""

    begin: float
    before_end: float
    end: float


@record
class Segments:
    """The segments of a run, (n, 3): begin, before_end, end.

    They stay one array because a table given point by point makes a million of them.
    """

    rows: Array

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[Segment]:
        return (Segment(*map(float, row)) for row in self.rows)

    @cached_property
    def ends(self) -> Array:
        """End of each segment, (n,)."""
        return self.rows[:, 2].copy()

    def find_segment(self, t: float) -> Segment:
        """Return the segment that contains an instant; at an end, the following one."""
        return Segment(*map(float, self.rows[np.searchsorted(self.ends, t, side="right")]))


NO_SEGMENTS = Segments(np.zeros((0, 3)))


def make_segments(last: float, jumps: Sequence[float]) -> Segments:
    """Split (0, last) into segments without discontinuities, which are at `jumps`.

    Each segment ends with the left limits of what jumps; the next one begins with the right limits.
    """
    if not len(jumps):
        return Segments(np.array([[0.0, just_before(last), last]]))
    instants = np.asarray(jumps, dtype=float)
    left, right = find_one_sided_limits(instants[(instants > 0.0) & (instants < last)])
    begins, ends = np.append(0.0, right), np.append(left, just_before(last))
    segments = np.column_stack([begins, ends, np.nextafter(ends, np.inf)])
    # a discontinuity at t = 0 makes a first segment without length
    non_empty = segments[ends > begins] if (ends > begins).any() else segments[-1:]
    # where a discontinuity is the double before the last instant, no segment follows it
    non_empty[-1, 2] = max(non_empty[-1, 2], last)
    return Segments(non_empty)


def find_one_sided_limits(jumps: Sequence[float] | Array) -> tuple[Array, Array]:
    """Return the last instants before discontinuities, ascending, and the first after them, as `pair_adjacent_instants`
    does.
    """
    instants = np.asarray(jumps, dtype=float)
    before = np.nextafter(instants, -np.inf)
    # neighbouring doubles are one discontinuity
    is_separate = np.append(True, instants[:-1] < before[1:])[: len(instants)]
    return before[is_separate], instants[np.append(is_separate[1:], True)[: len(instants)]]


def just_before(t: float) -> float:
    """Return the last instant before t, where the left limit at a jump is taken."""
    return math.nextafter(t, -math.inf)


def just_after(t: float) -> float:
    """Return the first instant after t."""
    return math.nextafter(t, math.inf)


def find_discontinuities(mechanism: Mechanism, last: float) -> list[float]:
    """Find the instants in (0, last] of impulses at a given time, and where a load, a drive or a derivative is
    discontinuous.

    For a discontinuity at the end of the run, the instants after it are included, up to the first one at which the new
    branch holds.
    """
    expressions = set(mechanism.iter_expressions())
    blows = {blow.time for blow in mechanism.impulses if blow.when is None and 0.0 < blow.time < last}
    return sorted({t for e in expressions if e.time_dependent for t in find_run_discontinuities(e, last)} | blows)
