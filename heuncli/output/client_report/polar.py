"""The chapter of load directions: polar diagrams of the most loaded joints of a machine that turns all around."""

from __future__ import annotations

from heuncli.base.joint_kinds import TYPES
from heuncli.output.client_report.extremes import find_extremes
from heuncli.output.client_report.machine import HALF_WIDTH
from heuncli.output.client_report.report_data import ReportData, ReportedRun
from heuncli.output.client_report.summary_table import find_crank, list_loads
from heuncli.output.documents.document import Drawing, Part
from heuncli.output.drawing.figure import Item, Panel, Spot
from heuncli.output.figures.courses import FigureSource, NotDrawable, is_claimed
from heuncli.output.figures.polar import make_polar_figure
from heuncli.results.results_schema import XYZ
from heuncli.study.quantities.captions import describe_object

MAX_DIAGRAMS = 2
HEIGHT = 182.0  # pixels
LABEL_STEP = 180  # degrees between the labels of marks, at half the width of a sheet
MIN_WIDTH = 0.1  # of a curve of tips, beside its length: a narrower one says no more than a history


def _is_on_a_line(run: ReportedRun, path: str) -> bool:
    """Return whether a force has little more than one direction: its components vary along one axis alone."""
    ends = [find_extremes(run, f"{path}.{axis}") for axis in XYZ]
    spans = sorted(max(each.values) - min(each.values) for each in ends if each is not None and each.values)
    return len(spans) < len(XYZ) or spans[1] < MIN_WIDTH * spans[2]


def _is_firing(item: Item) -> bool:
    return isinstance(item, Spot) and item.shape == "diamond"


def _is_largest(item: Spot) -> bool:
    return item.is_filled and item.shape == "circle"


def _shorten_panel(panel: Panel) -> Panel:
    """Return a panel for half the width: fewer labels of marks; the greatest load and firings are in the caption."""
    items = []
    for item in panel.items:
        if isinstance(item, Spot):
            angle = item.text.removesuffix("°")
            is_dropped = item.is_filled or (angle.isdigit() and int(angle) % LABEL_STEP != 0)
            item = item._replace(text="") if is_dropped else item
        items.append(item)
    return panel._replace(height=min(panel.height, HEIGHT), items=tuple(items))


def make_polar_parts(data: ReportData) -> list[Part]:
    """Make the polar diagrams of the most loaded joints that turn, each in its governing case."""
    if find_crank(data) is None:
        return []
    parts: list[Part] = []
    for line in list_loads(data):
        greatest = line.greatest
        kind, _, rest = greatest.path.partition(".")
        name, _, quantity = rest.partition(".")
        if greatest.is_steady or kind != "joints" or quantity != "force":
            continue
        if _is_on_a_line(greatest.run, greatest.path):
            continue
        if "angle" not in TYPES[data.labels.joints[name].type].coordinates or not is_claimed(greatest.run.study):
            continue
        try:
            figure = make_polar_figure([FigureSource("", greatest.run.study)], [greatest.path], data.units)
        except NotDrawable:
            continue
        case = f", load case {greatest.run.case_label}" if greatest.run.name else ""
        firing = ", filled: peaks of actuators" if any(map(_is_firing, figure.panels[0].items)) else ""
        spots = [item for item in figure.panels[0].items if isinstance(item, Spot)]
        largest = next((spot.text for spot in spots if _is_largest(spot)), "")
        words = describe_object("joints", name, data.labels)
        caption = f"{words}: force{case}{f', greatest {largest}' if largest else ''}; marks: crank angle{firing}"
        figure = figure._replace(
            title="", words=(), legend=(), notes=(), panels=list(map(_shorten_panel, figure.panels))
        )
        parts.append(Drawing(figure, caption, HALF_WIDTH, "half"))
        if len(parts) == MAX_DIAGRAMS:
            break
    return parts
