"""Recognise a jump of a measure from its values at a few places: it changes by more than a smooth measure could there,
and than its errors explain.

A sweep solves nothing more than its variants: it judges every interval by the two before it and the two behind it. A
rise that is so much steeper between two samples counts as a jump, too.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

from heuncli.analyses.sweep_rows import SweptRow
from heuncli.analyses.variants.plans import Plan
from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple

NOISE = 4.0  # times the errors of two values: their difference that is no jump
WINDOW = 6  # samples, of which those in the middle are judged


def is_jump(change: float, smooth_change: float, errors: float) -> bool:
    """Return whether a change exceeds that of a smooth measure, and the errors of both its values together."""
    return abs(change) > smooth_change + NOISE * errors


class SweptSample(NamedTuple):
    """The value of a measure at a variant; nan if there is none.

    x: value of the last parameter, in its unit
    """

    number: int
    x: float
    value: float
    error: float


class SweptJump(NamedTuple):
    """Two neighbours on the last axis between which a measure jumps; measure: its index."""

    measure: int
    first: SweptSample
    second: SweptSample


class JumpFinder:
    """Find the jumps of measures over the last axis while rows pass, in ascending order; holds a few of them only."""

    def __init__(self, plan: Plan, measure_count: int) -> None:
        """measure_count: number of measures of each variant"""
        self._axis = plan.axes[-1] if _has_course(plan) else None
        self._course = -1
        self._windows: list[deque[SweptSample]] = [deque(maxlen=WINDOW) for _ in range(measure_count)]
        self.jumps: list[SweptJump] = []

    def record(self, rows: Iterable[SweptRow]) -> Iterator[SweptRow]:
        """Yield the rows, and find their jumps."""
        for row in rows:
            if self._axis is not None:
                self.add(row)
            yield row
        self._end_course()

    def add(self, row: SweptRow) -> None:
        """Add a variant."""
        assert self._axis is not None
        course, place = divmod(row.number, len(self._axis.values))
        x = self._axis.values[place]
        if course != self._course or isinstance(x, str):
            self._end_course()
            self._course = course
        if isinstance(x, str):
            return
        for k, window in enumerate(self._windows):
            one = row.result.measures[k] if row.result.measures else None
            value = math.nan if one is None or one.value is None else one.value
            window.append(SweptSample(row.number, x, value, (one and one.error) or 0.0))
        self._judge(from_end=3)

    def _end_course(self) -> None:
        """Judge what lacks the second neighbour behind it, and forget the course."""
        self._judge(from_end=2)
        for window in self._windows:
            window.clear()

    def _judge(self, from_end: int) -> None:
        """Judge the interval that begins so many samples before the last one."""
        for k, window in enumerate(self._windows):
            samples = list(window) if from_end == 3 else list(window)[-5:]
            place = len(samples) - 1 - from_end
            if place >= 1 and is_swept_jump(samples, place):
                self.jumps.append(SweptJump(k, samples[place], samples[place + 1]))


def _has_course(plan: Plan) -> bool:
    """Return whether the last axis varies alone, over numbers."""
    return plan.draws is None and bool(plan.axes) and (not plan.together or len(plan.axes) == 1)


def is_swept_jump(samples: Sequence[SweptSample], place: int) -> bool:
    """Return whether a measure jumps from samples[place] to the next one.

    Values of both its neighbours must be known, the parameter must rise or fall throughout.
    """
    intervals = [(after.x - before.x, after.value - before.value) for before, after in pairwise(samples)]
    width, change = intervals[place]
    if not all(step * width > 0.0 for step, _ in intervals):
        return False
    slopes = [abs(rise / step) for step, rise in intervals]
    if not all(math.isfinite(slope) for slope in slopes[place - 1 : place + 2]):
        return False
    steepest = max(slope for k, slope in enumerate(slopes) if k != place and math.isfinite(slope))
    before, after = samples[place], samples[place + 1]
    rounding = tolerances.SUM_ROUNDING * (abs(before.value) + abs(after.value))
    return is_jump(change, tolerances.SWEPT_JUMP * steepest * abs(width), before.error + after.error + rounding)
