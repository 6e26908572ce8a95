"""The most loaded joints over time, in the cases that govern them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from heuncli.output.client_report.extremes import governing
from heuncli.output.client_report.parts import Drawing, Part
from heuncli.output.client_report.reported import Reported, ReportedRun
from heuncli.output.drawing.figure import Figure, over_one_axis
from heuncli.output.figures.courses import Pictured
from heuncli.output.figures.histories import history
from heuncli.output.snapshots.envelopes import Bound

MOST = 3  # joints in a figure
MOST_OVER = 4  # cases over each other


def history_parts(of: Reported) -> list[Part]:
    """The joints with the largest forces and the one with the largest moment: a figure of all cases, if these are few.

    Of many cases each that governs one of them has a figure of its own.
    """
    chosen = list(_chosen(of))
    moving = [run for run in of.runs if len(run.results.time) > 1]
    if not chosen or not moving:
        return []
    if 1 < len(moving) <= MOST_OVER:
        figure = _figure(of, moving, [path for path, _ in chosen])
        return [Drawing(figure, "The most loaded joints over time, in all load cases: magnitudes")]
    parts: list[Part] = []
    for run in moving:
        paths = [path for path, case in chosen if case == run.name]
        if paths:
            case = f", load case {run.name}" if run.name else ""
            parts.append(Drawing(_figure(of, [run], paths), f"The most loaded joints over time{case}: magnitudes"))
    return parts


def _figure(of: Reported, runs: Sequence[ReportedRun], paths: Sequence[str]) -> Figure:
    """A panel a path, so that courses that are nearly the same can be told apart; a curve a case."""
    names = [run.name for run in runs] if len(runs) > 1 else [""]
    sources = [Pictured(name, run.study) for name, run in zip(names, runs, strict=True)]
    figures = [history(sources, [path], of.units) for path in paths]
    panels = [figure.panels[0]._replace(title=path) for figure, path in zip(figures, paths, strict=True)]
    notes = dict.fromkeys(note for figure in figures for note in figure.notes)
    pens = [pen for _, pen in figures[0].legend]
    legend = list(zip(names, pens, strict=True)) if len(runs) > 1 else []
    return Figure("", (), over_one_axis(panels), legend, list(notes))


def _chosen(of: Reported) -> Iterator[tuple[str, str]]:
    """The paths of the largest forces and of the largest moment, each with the case that governs it."""
    for quantity, most in (("force", MOST), ("moment", 1)):
        found = [(f"joints.{name}.{quantity}", bound) for name, bound in _bounds(of, quantity)]
        found.sort(key=lambda pair: -pair[1].value)
        yield from ((path, (bound.governing or bound.alike)[0]) for path, bound in found[:most])


def _bounds(of: Reported, quantity: str) -> Iterator[tuple[str, Bound]]:
    """The joints whose load is known and not rounding, each with its largest."""
    governs = governing(of)
    for name in of.runs[0].results.joints:
        path = f"joints.{name}.{quantity}"
        bound = governs.high(path)
        errors = [run.kept.numbers[path].error for run in of.runs if path in run.kept.numbers]
        if bound is not None and bound.value > max(errors, default=0.0):
            yield name, bound
