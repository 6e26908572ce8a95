"""Work and precision of the methods as a figure: error of the motion over time, both logarithmic, a curve a method.

Above it, on the same axis, stand the runs that failed or were not run: a row for each method and reason, with the
number of its note.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np

from heuncli.analyses.work_precision.results import (
    COMPLETED,
    FAILED,
    ChartResults,
    ChartRun,
    format_setting,
    make_remark,
)
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.tolerances import LOST
from heuncli.output.drawing.figure import Figure, Item, Panel, PlaceLabel, Scaling, Spot, Strokes, Trace, share_x_axis

HEIGHT, ROW_HEIGHT = 480.0, 16.0  # pixels: of the panel of errors, of a row of failures
SHAPES = ("square", "triangle", "diamond", "tip", "bow")  # of methods in turn: with the pens forty looks
MARGIN = 0.08  # decades left of the fastest run and right of the slowest
MIN_SPAN = 0.3  # decades of time
MILLISECONDS = 1e3  # in a second
MAX_NOTES = 12
TIME_LABEL = "processor time of the integration only [ms]"
ERROR_LABEL = "largest error of any point, relative to the model size"
FAILURES_TITLE = "failed, or not run"
REFERENCE_LABEL = "error of the reference"
FRONT_NOTE = "Filled marks on a grey line: Pareto front; no other run is better in both."
REFERENCE_NOTE = "Horizontal grey line: error of the reference; smaller errors are not significant."
LOST_NOTE = f"At the upper edge: errors of {LOST:g} or more."


class FailedRuns(NamedTuple):
    """Runs of a method that failed for the same reason, and the number of their note."""

    number: int
    runs: tuple[ChartRun, ...]


def make_work_precision_figure(chart: ChartResults) -> Figure:
    """Make the figure of a chart."""
    groups = group_failures(chart.runs)
    pens = {name: k for k, name in enumerate(chart.runs_by_method)}
    times = _choose_time_axis(chart.runs)
    panels = [_make_failure_panel(groups, pens, times)] if groups else []
    errors = _choose_error_axis(chart)
    panels.append(Panel(times, errors, tuple(_iter_items(chart, pens, times, errors)), HEIGHT))
    reference = chart.reference
    words = (
        f"Compared up to t = {reference.last_time:.6g} s with a reference: {reference.description}",
        *reference.notes,
    )
    return Figure(
        f"{chart.title}: speed against accuracy" if chart.title else "Speed against accuracy",
        words,
        share_x_axis(panels),
        marks=[(name, pen, _choose_shape(pen)) for name, pen in pens.items()],
        notes=list(_iter_notes(chart, groups)),
    )


def group_failures(runs: Iterable[ChartRun]) -> list[FailedRuns]:
    """Group the runs that failed or were not run, by method and reason."""
    groups: dict[tuple[str, str, str], list[ChartRun]] = {}
    for run in runs:
        if run.status != COMPLETED:
            groups.setdefault((run.row.method, run.status, run.code), []).append(run)
    return [FailedRuns(k, tuple(group)) for k, group in enumerate(groups.values(), 1)]


class MeasuredRun(NamedTuple):
    """A completed run in the figure: time [ms] and error, and whether it is on the front."""

    time: float
    error: float
    is_front: bool


def list_measured(runs: Iterable[ChartRun]) -> list[MeasuredRun]:
    """List the completed runs; errors of LOST and more only say that a run is useless, and count as LOST."""
    return [
        MeasuredRun(MILLISECONDS * run.seconds, min(error, LOST), run.front)
        for run in runs
        if run.status == COMPLETED and run.seconds is not None and (error := run.error["motion"]) is not None
    ]


def _choose_time_axis(runs: Iterable[ChartRun]) -> Scaling:
    """Choose the axis of time: that of the completed runs."""
    logarithms = [math.log10(max(run.time, 1e-6)) for run in list_measured(runs)] or [0.0]
    low, high = min(logarithms), max(max(logarithms), min(logarithms) + MIN_SPAN)
    return Scaling(TIME_LABEL, 10.0 ** (low - MARGIN), 10.0 ** (high + MARGIN), is_logarithmic=True)


def _choose_error_axis(chart: ChartResults) -> Scaling:
    """Choose the axis of errors, in whole decades, with the reference's own error on it."""
    errors = [*(run.error for run in list_measured(chart.runs)), chart.reference.error["motion"] or 0.0]
    logarithms = [math.log10(error) for error in errors if error > 0.0] or [-1.0]
    low, high = math.floor(min(logarithms)), math.ceil(max(logarithms))
    return Scaling(ERROR_LABEL, 10.0**low, 10.0 ** max(high, low + 1), is_logarithmic=True)


def _choose_shape(pen: int) -> str:
    return SHAPES[pen % len(SHAPES)]


def _clip(value: float, axis: Scaling) -> float:
    """Return the value, or the border of the axis that it lies beyond."""
    return min(max(value, axis.low), axis.high)


def _iter_items(chart: ChartResults, pens: Mapping[str, int], times: Scaling, errors: Scaling) -> Iterator[Item]:
    """Yield the front and the reference's error, below the curves of the methods with their marks and names."""
    front = np.array(sorted(run[:2] for run in list_measured(chart.runs) if run.is_front)).reshape(-1, 2)
    yield Strokes(np.stack([front[:-1], front[1:]], axis=1))
    if reference_error := chart.reference.error["motion"]:
        yield Strokes(np.array([[(times.low, reference_error), (times.high, reference_error)]]))
        yield PlaceLabel(times.low, reference_error, REFERENCE_LABEL, is_optional=True)
    for name, runs in chart.runs_by_method.items():
        pen, points = pens[name], [(_clip(run.time, times), _clip(run.error, errors)) for run in list_measured(runs)]
        if not points:
            continue
        x_values, y_values = np.array(points).T
        yield Trace(name, x_values, y_values, pen)
        for (x, y), run in zip(points, list_measured(runs), strict=True):
            yield Spot(x, y, "", pen, _choose_shape(pen), run.is_front)
        yield PlaceLabel(*points[-1], name, pen=pen, is_optional=True)


def _make_failure_panel(groups: Sequence[FailedRuns], pens: Mapping[str, int], times: Scaling) -> Panel:
    """Make the panel of runs that did not end: a row for each group, each run at the time of its end, or at the right
    border.
    """
    places = {group.number: float(len(groups) - group.number) for group in groups}
    items = []
    for group in groups:
        pen = pens[group.runs[0].row.method]
        for run in group.runs:
            x = _clip(MILLISECONDS * run.seconds, times) if run.seconds else times.high
            items.append(Spot(x, places[group.number], "", pen, _choose_shape(pen)))
    ticks = tuple((place, f"× {number}") for number, place in places.items())
    rows = Scaling("", -0.5, len(groups) - 0.5, tick_texts=ticks)
    return Panel(times, rows, tuple(items), ROW_HEIGHT * len(groups), title=FAILURES_TITLE)


def _iter_notes(chart: ChartResults, groups: Sequence[FailedRuns]) -> Iterator[str]:
    """Yield what the marks say, and why runs failed."""
    measured = list_measured(chart.runs)
    if any(run.is_front for run in measured):
        yield FRONT_NOTE
    if chart.reference.error["motion"]:
        yield REFERENCE_NOTE
    if any(run.error >= LOST for run in measured):
        yield LOST_NOTE
    yield from chart.notes
    yield from map(_format_note, groups[:MAX_NOTES])
    if len(groups) > MAX_NOTES:
        yield f"and {len(groups) - MAX_NOTES} more"


def _format_note(group: FailedRuns) -> str:
    """Format which runs a row stands for, and why they failed."""
    first = group.runs[0]
    kind = "step" if first.row.has_fixed_step else "tolerance"
    settings = ", ".join(format_setting(run.row) for run in group.runs)
    others = " (the first)" if len(group.runs) > 1 and first.status == FAILED else ""
    return f"× {group.number}  {first.row.method}, {kind} {settings}{others}: {make_remark(first)}"
