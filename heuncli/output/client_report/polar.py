"""The chapter of load directions: polar diagrams of the most loaded joints of a machine that turns all around."""

from __future__ import annotations

from heuncli.base.joint_kinds import TYPES
from heuncli.output.client_report.extremes import find_extremes
from heuncli.output.client_report.machine import HALF_WIDTH
from heuncli.output.client_report.report_data import ReportData, ReportedRun
from heuncli.output.client_report.summary_table import find_crank, find_summary_lines
from heuncli.output.documents.document import Drawing, Part
from heuncli.output.figures.courses import FigureSource, is_claimed
from heuncli.output.figures.polar import make_polar_figure
from heuncli.output.figures.refusals import NotDrawable
from heuncli.results.results_schema import XYZ
from heuncli.study.quantities.captions import describe_object

MAX_DIAGRAMS = 2
HEIGHT = 210.0  # pixels
MIN_WIDTH = 0.1  # of a curve of tips, beside its length: a narrower one says no more than a history


def _is_on_a_line(run: ReportedRun, path: str) -> bool:
    """Return whether a force has little more than one direction: its components vary along one axis alone."""
    ends = [find_extremes(run, f"{path}.{axis}") for axis in XYZ]
    spans = sorted(max(each.values) - min(each.values) for each in ends if each is not None and each.values)
    return len(spans) < len(XYZ) or spans[1] < MIN_WIDTH * spans[2]


def make_polar_parts(data: ReportData) -> list[Part]:
    """Make the polar diagrams of the most loaded joints that turn, each in its governing case."""
    if find_crank(data) is None:
        return []
    parts: list[Part] = []
    for line in find_summary_lines(data):
        greatest = line.greatest
        kind, _, rest = (greatest.path if greatest is not None else "").partition(".")
        name, _, quantity = rest.partition(".")
        if greatest is None or greatest.is_steady or kind != "joints" or quantity != "force":
            continue
        if _is_on_a_line(greatest.run, greatest.path):
            continue
        if "angle" not in TYPES[data.labels.joints[name].type].coordinates or not is_claimed(greatest.run.study):
            continue
        try:
            figure = make_polar_figure([FigureSource("", greatest.run.study)], [greatest.path], data.units)
        except NotDrawable:
            continue
        panels = [panel._replace(height=min(panel.height, HEIGHT)) for panel in figure.panels]
        words = describe_object("joints", name, data.labels)
        case = f", load case {greatest.run.name}" if greatest.run.name else ""
        caption = f"{words}: force in world axes{case}; marks: crank angle"
        figure = figure._replace(title="", words=(), legend=(), notes=(), panels=panels)
        parts.append(Drawing(figure, caption, HALF_WIDTH, "half"))
        if len(parts) == MAX_DIAGRAMS:
            break
    return parts
