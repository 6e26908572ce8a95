"""The segments of a run, within which no load or drive in time is discontinuous, and the instants beside their ends."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cached_property

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array
from heuncli.scene.expressions.discontinuities import breaks_within


class Segment(NamedTuple):
    """A part of a run without discontinuities: begin, the last instant before its end, and its end."""

    begin: float
    before_end: float
    end: float


@record
class Segments:
    """The segments of a run, (n, 3): begin, before_end, end. A table met point by point makes a million of them."""

    rows: Array

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[Segment]:
        return (Segment(*map(float, row)) for row in self.rows)

    @cached_property
    def ends(self) -> Array:
        """Where they end, (n,)."""
        return self.rows[:, 2].copy()

    def at(self, t: float) -> Segment:
        """The one that an instant lies in; at an end the one behind it."""
        return Segment(*map(float, self.rows[np.searchsorted(self.ends, t, side="right")]))


NO_SEGMENTS = Segments(np.zeros((0, 3)))


def smooth_segments(last: float, jumps: Sequence[float]) -> Segments:
    """The segments of (0, last) without discontinuities, which are at `jumps`.

    Each ends with the left limits of what jumps, the next one begins with the right limits.
    """
    if not len(jumps):
        return Segments(np.array([[0.0, just_before(last), last]]))
    within = np.asarray(jumps, dtype=float)
    left, right = limits_of(within[(within > 0.0) & (within < last)])
    begins, ends = np.append(0.0, right), np.append(left, just_before(last))
    segments = np.column_stack([begins, ends, np.nextafter(ends, np.inf)])
    # a discontinuity at t = 0 makes a first segment without length
    kept = segments[ends > begins] if (ends > begins).any() else segments[-1:]
    # where a discontinuity is the double before the last instant, no segment is left behind it
    kept[-1, 2] = max(kept[-1, 2], last)
    return Segments(kept)


def limits_of(jumps: Sequence[float] | Array) -> tuple[Array, Array]:
    """The last instants before discontinuities, ascending, and the first after them, as `one_sided_limits` has them."""
    instants = np.asarray(jumps, dtype=float)
    before = np.nextafter(instants, -np.inf)
    fresh = np.append(True, instants[:-1] < before[1:])[: len(instants)]  # neighbouring doubles are one discontinuity
    return before[fresh], instants[np.append(fresh[1:], True)[: len(instants)]]


def just_before(t: float) -> float:
    """The last instant before t: at a jump, the left limit is taken there."""
    return math.nextafter(t, -math.inf)


def just_after(t: float) -> float:
    """The first instant after t."""
    return math.nextafter(t, math.inf)


def discontinuities_of(mechanism: Mechanism, last: float) -> list[float]:
    """Instants in (0, last] of blows given a time, or where a load, a drive or a derivative of one is discontinuous.

    Of a discontinuity at the end of the run also the instants behind, up to the first at which the new branch holds.
    """
    expressions = set(mechanism.expressions())
    blows = {blow.time for blow in mechanism.blows if blow.when is None and 0.0 < blow.time < last}
    return sorted({t for e in expressions if e.time_dependent for t in breaks_within(e, last)} | blows)
