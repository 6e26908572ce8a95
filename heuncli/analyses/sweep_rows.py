"""The description of a sweep, its results, one row per variant, and the columns made of them.

All formats use the columns: the headings and cells of CSV and Parquet, and the values under `set` in JSON.

A jump of a measure is recognised from its values at a few places: it changes by more than a smooth measure could there,
and than its errors explain. A sweep solves nothing more than its variants: it judges every interval by the two before
it and the two behind it. A rise that is so much steeper between two samples counts as a jump, too.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

from heuncli.analyses.variants.measures import MISSING_KINDS, MeasureLabel, VariantResult
from heuncli.analyses.variants.parameters import Values
from heuncli.analyses.variants.plans import Plan
from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.quantity import NumberWithUnit, ParameterValue


class SweepHead(NamedTuple):
    """The description of a sweep: the spec with its digest, what is varied, what is measured."""

    title: str
    path: str
    sha256: str
    version: str
    plan: Plan
    measures: tuple[MeasureLabel, ...]


class SweptRow(NamedTuple):
    """A variant: its number in the plan, its values, and its result."""

    number: int
    values: Values
    result: VariantResult


NUMBER = "number"
CODE, REASON = "code", "reason"
SEPARATOR = "; "  # between the reasons of several measures
Cell = int | float | str | None


class ParameterColumn(NamedTuple):
    """The column of a parameter; unit: of its numbers (empty: SI), None if its values are texts."""

    name: str
    unit: str | None

    @property
    def label(self) -> str:
        """The name; that of a parameter with the name of another column is marked."""
        return f"{self.name} (parameter)" if self.name in (NUMBER, CODE, REASON) else self.name

    @property
    def heading(self) -> str:
        """The label with the unit, such as `n [rpm]`."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label

    def make_value(self, cell: float | str) -> ParameterValue:
        """Return the value of a cell."""
        return cell if isinstance(cell, str) else NumberWithUnit(cell, self.unit or "")


def make_parameter_columns(plan: Plan) -> tuple[ParameterColumn, ...]:
    """Make the columns of all varied parameters."""
    laws = plan.draws.laws if plan.draws is not None else ()
    axis_columns = (ParameterColumn(axis.name, axis.unit) for axis in (*plan.columns, *plan.axes))
    return (*axis_columns, *(ParameterColumn(law.name, law.unit) for law in laws))


def to_cell(value: ParameterValue) -> float | str:
    """Return a value as a cell: a number in the unit of its column, or a text."""
    return value if isinstance(value, str) else float(value.value)


class SweepColumns(NamedTuple):
    """The columns of a sweep in CSV and Parquet."""

    parameters: tuple[ParameterColumn, ...]
    measures: tuple[str, ...]

    @property
    def headings(self) -> list[str]:
        """Number, parameters, of each measure its value, its error and its instant, then the reason why there is
        none.
        """
        measures = (head for text in self.measures for head in (text, f"{text} error", f"{text} at [s]"))
        return [NUMBER, *(parameter.heading for parameter in self.parameters), *measures, CODE, REASON]

    def make_cells(self, row: SweptRow) -> list[Cell]:
        """Return the cells of a variant; None where there is no value."""
        measures: list[Cell] = [None] * (3 * len(self.measures))
        for place, measure in enumerate(row.result.measures):
            numbers = (measure.value, measure.error, measure.time)
            measures[3 * place : 3 * place + 3] = map(to_finite, numbers)
        return [
            row.number,
            *(to_cell(row.values[parameter.name]) for parameter in self.parameters),
            *measures,
            row.result.code,
            explain_missing(row, self.measures),
        ]


def make_columns(head: SweepHead) -> SweepColumns:
    """Make the columns of a sweep: its parameters, then value, error and instant of each measure."""
    measures = tuple(f"{one.text} [{one.unit}]" if one.unit else one.text for one in head.measures)
    return SweepColumns(make_parameter_columns(head.plan), measures)


def to_finite(number: float | None) -> float | None:
    """Return a number as files hold it: None for an infinite one, and 0 for minus zero."""
    return None if number is None or not math.isfinite(number) else number + 0.0


def explain_missing(row: SweptRow, measures: Sequence[str]) -> str:
    """Say why a variant, or a measure of it, has no value; empty if all have one."""
    if row.result.code:
        return row.result.reason
    missing = [(text, one.word) for text, one in zip(measures, row.result.measures, strict=True) if one.word]
    return SEPARATOR.join(f"{text}: {MISSING_KINDS[word].sentence} [{word}]" for text, word in missing)


def find_missing_words(reason: str, measures: Sequence[str]) -> dict[str, str]:
    """Return the words of the measures without a value, by measure, from what `explain_missing` gives."""
    entries = [entry.removesuffix("]").rpartition(" [") for entry in reason.split(SEPARATOR) if entry.endswith("]")]
    return {
        measure: word
        for measure in measures
        for text, _, word in entries
        if text.startswith(f"{measure}: ") and word in MISSING_KINDS
    }


NOISE = 4.0  # ratio of a difference of two values to their errors up to which it is no jump
WINDOW = 6  # samples that are in memory, of which the interval in the middle is judged
LATER_SAMPLES, LAST_SAMPLES = 3, 2  # samples after the beginning of a judged interval; fewer where the course ends


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
        self._axis = plan.course_axis
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
            measured = row.result.measures[k] if row.result.measures else None
            value = math.nan if measured is None or measured.value is None else measured.value
            error = 0.0 if measured is None or measured.error is None else measured.error
            window.append(SweptSample(row.number, x, value, error))
        self._judge(LATER_SAMPLES)

    def _end_course(self) -> None:
        """Judge what lacks the second neighbour behind it, and forget the course."""
        self._judge(LAST_SAMPLES)
        for window in self._windows:
            window.clear()

    def _judge(self, later_count: int) -> None:
        """Judge the interval that begins so many samples before the last one, by two intervals before it."""
        for k, window in enumerate(self._windows):
            samples = list(window)[-(later_count + 3) :]
            place = len(samples) - 1 - later_count
            if place >= 1 and is_swept_jump(samples, place):
                self.jumps.append(SweptJump(k, samples[place], samples[place + 1]))


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
