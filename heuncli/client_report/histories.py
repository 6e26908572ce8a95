"""The most loaded joints over time, in the cases that govern them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from heuncli.client_report.extremes import governing
from heuncli.client_report.parts import Drawing, Part
from heuncli.client_report.reported import Reported, ReportedRun
from heuncli.drawing.figure import Figure
from heuncli.pictures.courses import Pictured
from heuncli.pictures.histories import history
from heuncli.telling.envelopes import Bound

MOST = 3  # joints in a figure


def history_parts(of: Reported) -> list[Part]:
    """A figure for each case that governs one of the joints with the largest forces, or the largest moment."""
    by_case: dict[str, list[str]] = {}
    for path, case in _chosen(of):
        by_case.setdefault(case, []).append(path)
    parts: list[Part] = []
    for run in of.runs:
        if run.name in by_case and len(run.results.time) > 1:
            case = f", load case {run.name}" if run.name else ""
            caption = f"The most loaded joints over time{case}: magnitudes"
            parts.append(Drawing(_figure(of, run, by_case[run.name]), caption))
    return parts


def _figure(of: Reported, run: ReportedRun, paths: Sequence[str]) -> Figure:
    """A panel a path, so that courses that are nearly the same can be told apart."""
    figures = [history([Pictured("", run.study)], [path], of.units) for path in paths]
    panels = [figure.panels[0]._replace(title=path) for figure, path in zip(figures, paths, strict=True)]
    above = [panel._replace(x=panel.x._replace(label="")) for panel in panels[:-1]]
    notes = dict.fromkeys(note for figure in figures for note in figure.notes)
    return Figure("", (), [*above, panels[-1]], (), list(notes))


def _chosen(of: Reported) -> Iterator[tuple[str, str]]:
    """The paths of the largest forces and of the largest moment, each with the case that governs it."""
    for quantity, most in (("force", MOST), ("moment", 1)):
        found = [(f"joints.{name}.{quantity}", bound) for name, bound in _bounds(of, quantity)]
        found.sort(key=lambda pair: -pair[1].value)
        yield from ((path, bound.case) for path, bound in found[:most])


def _bounds(of: Reported, quantity: str) -> Iterator[tuple[str, Bound]]:
    """The joints whose load is known and not rounding, each with its largest."""
    governs = governing(of)
    for name in of.runs[0].results.joints:
        path = f"joints.{name}.{quantity}"
        bound = governs.high(path)
        errors = [run.kept.numbers[path].error for run in of.runs if path in run.kept.numbers]
        if bound is not None and bound.value > max(errors, default=0.0):
            yield name, bound
