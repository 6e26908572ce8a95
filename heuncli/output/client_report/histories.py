"""The chapter of histories: the most loaded joints over time, in the cases that govern them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from heuncli.output.client_report.extremes import find_governing
from heuncli.output.client_report.report_data import ReportData, ReportedRun
from heuncli.output.documents.document import Drawing, Part
from heuncli.output.drawing.figure import Figure, share_x_axis
from heuncli.output.figures.courses import FigureSource
from heuncli.output.figures.histories import make_history
from heuncli.output.snapshots.envelopes import Bound

MAX_JOINTS = 3  # joints in a figure
MAX_CURVES = 4  # cases in one panel


def make_history_parts(data: ReportData) -> list[Part]:
    """Make the figures of the joints with the largest forces and of the one with the largest moment.

    A few cases share one figure. If there are many, each case that governs one of these loads gets its own figure.
    """
    governed_paths = list(_choose_paths(data))
    moving = [run for run in data.runs if len(run.results.time) > 1]
    if not governed_paths or not moving:
        return []
    if 1 < len(moving) <= MAX_CURVES:
        figure = _make_figure(data, moving, [path for path, _ in governed_paths])
        return [Drawing(figure, "Most heavily loaded joints over time, all load cases: magnitudes")]
    parts: list[Part] = []
    for run in moving:
        paths = [path for path, case in governed_paths if case == run.name]
        if paths:
            case = f", load case {run.name}" if run.name else ""
            parts.append(
                Drawing(_make_figure(data, [run], paths), f"Most heavily loaded joints over time{case}: magnitudes")
            )
    return parts


def _make_figure(data: ReportData, runs: Sequence[ReportedRun], paths: Sequence[str]) -> Figure:
    """Make a figure with one panel per path, so that similar histories can be distinguished, and one curve per case."""
    names = [run.name for run in runs] if len(runs) > 1 else [""]
    sources = [FigureSource(name, run.study) for name, run in zip(names, runs, strict=True)]
    figures = [make_history(sources, [path], data.units) for path in paths]
    panels = [figure.panels[0] for figure in figures]
    notes = dict.fromkeys(note for figure in figures for note in figure.notes)
    return Figure("", (), share_x_axis(panels), (), list(notes))


def _choose_paths(data: ReportData) -> Iterator[tuple[str, str]]:
    """Choose the paths of the largest forces and of the largest moment, each with the case that governs it."""
    for quantity, count in (("force", MAX_JOINTS), ("moment", 1)):
        bounds = [(f"joints.{name}.{quantity}", bound) for name, bound in _iter_bounds(data, quantity)]
        bounds.sort(key=lambda pair: -pair[1].value)
        yield from ((path, (bound.governing or bound.similar)[0]) for path, bound in bounds[:count])


def _iter_bounds(data: ReportData, quantity: str) -> Iterator[tuple[str, Bound]]:
    """Yield the joints whose load is known and larger than its error, each with its maximum."""
    governing_bounds = find_governing(data)
    for name in data.runs[0].results.joints:
        path = f"joints.{name}.{quantity}"
        bound = governing_bounds.find_greatest(path)
        errors = [run.snapshot.numbers[path].error for run in data.runs if path in run.snapshot.numbers]
        if bound is not None and bound.value > max(errors, default=0.0):
            yield name, bound
