"""The chapters of diagrams: the most loaded joints, couplings and forces over time or over the crank angle, and polar
diagrams of the joints of a machine that turns all around.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cached_property

import numpy as np

from heuncli.base.joint_kinds import TYPES
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.output.client_report.extremes import GreatestOfCases, choose_family, find_extremes, format_instant
from heuncli.output.client_report.machine import HALF_WIDTH
from heuncli.output.client_report.report_data import AT_WORST, ReportData, ReportedRun
from heuncli.output.client_report.summary_table import ReportedLoad, find_crank, list_loads
from heuncli.output.documents.document import Drawing, Part
from heuncli.output.drawing.axes import choose_ends
from heuncli.output.drawing.figure import Figure, Item, Panel, Scaling, Spot, Trace
from heuncli.output.figures.courses import FigureSource, NotDrawable, choose_instants, is_claimed
from heuncli.output.figures.polar import make_polar_figure
from heuncli.results.results import Array, Results
from heuncli.results.results_paths import find_values
from heuncli.results.results_schema import XYZ
from heuncli.study.quantities.captions import describe_object, describe_path
from heuncli.study.quantities.labels import Labels

MAX_PANELS = 6
MAX_CURVES = 4  # cases in one panel; of more, the governing one
MAX_ALIKE = 4  # names in a title
ALIKE = 0.01  # relative to their greatest value: loads whose extremes agree to it share a panel
MAX_SEARCH_INSTANTS = 400  # instants of the search that a curve takes
HEIGHT = 98.0  # pixels
MARGIN = 0.12  # above a curve, for its words

MAX_DIAGRAMS = 2
POLAR_HEIGHT = 182.0  # pixels
LABEL_STEP = 180  # degrees between the labels of marks, at half the width of a sheet
MIN_WIDTH = 0.1  # width of a curve of tips relative to its length: a narrower one says no more than a history


class SharedPanel(NamedTuple):
    """A load with a panel, and the names of others whose extremes agree with its own; kind: before its name, where
    needed.
    """

    greatest: GreatestOfCases
    names: Sequence[str]
    kind: str = ""


@record
class RunCourse:
    """The loads of a run over its instants."""

    run: ReportedRun
    crank: str | None

    @cached_property
    def times(self) -> Array:
        """The instants of the curves, (n,): with those of all extremes."""
        times = np.concatenate([choose_instants(self.run.study, MAX_SEARCH_INSTANTS), self.run.worst_times])
        horizon = self.run.results.horizon
        return np.unique(times if horizon is None else times[times < horizon])

    @cached_property
    def results(self) -> Results:
        """The results there, solved in one call."""
        return self.run.study.compute_reports(self.times, AT_WORST)

    @cached_property
    def x(self) -> Array:
        """The angle of the turning joint in degrees, or the time."""
        if self.crank is None:
            return self.times
        return np.asarray(np.degrees(self.results.coordinates[self.crank]["angle"]))

    def find_numbers(self, path: str) -> Array:
        """Return the number at a path, of a vector its magnitude, (n,)."""
        values = np.asarray(find_values(self.results, path).values)
        return np.asarray(values if values.ndim == 1 else np.sqrt(np.einsum("nk,nk->n", values, values)))


def make_history_parts(data: ReportData) -> list[Part]:
    """Make a panel for each of the most loaded objects, with a curve for each case."""
    moving = [run for run in data.runs if len(run.results.time) > 1 and is_claimed(run.study)]
    shared = _share_panels(list_loads(data))
    if not moving or not shared:
        return []
    crank = find_crank(data)
    courses = {run.name: RunCourse(run, crank) for run in moving}
    parts: list[Part] = []
    for panel in shared[:MAX_PANELS]:
        shown = [courses[run.name] for run in moving] if len(moving) <= MAX_CURVES else []
        shown = shown or [courses[panel.greatest.run.name]]
        figure = _make_figure(data, panel.greatest, shown, crank)
        parts.append(Drawing(figure, _make_caption(data, panel), HALF_WIDTH, "half"))
    return parts


def _share_panels(lines: Sequence[ReportedLoad]) -> list[SharedPanel]:
    """Give each load a panel that varies; those with equal extremes share one."""
    panels: list[SharedPanel] = []
    for line in lines:
        greatest = line.greatest
        if greatest.is_steady:
            continue
        same = next((k for k, panel in enumerate(panels) if _are_alike(panel.greatest, greatest)), None)
        if same is None:
            panels.append(SharedPanel(greatest, [line.name, *line.alike], line.kind))
        else:
            panels[same] = panels[same]._replace(names=[*panels[same].names, line.name, *line.alike])
    return panels


def _are_alike(first: GreatestOfCases, second: GreatestOfCases) -> bool:
    """Return whether two loads have the same case and the same least and greatest magnitudes."""
    if first.run is not second.run or first.ends.unit != second.ends.unit:
        return False
    (low, high), (other_low, other_high) = (sorted(map(abs, each.ends.values)) for each in (first, second))
    return abs(high - other_high) <= ALIKE * high and abs(low - other_low) <= ALIKE * high


def _make_caption(data: ReportData, panel: SharedPanel) -> str:
    """Make the caption: what is drawn, and what else is alike."""
    words = f"{panel.kind} {describe_load(panel.greatest.path, data.labels)}".strip()
    names = panel.names[1:]
    if not names:
        return words
    more = f" and {len(names) - MAX_ALIKE} more" if len(names) > MAX_ALIKE else ""
    return f"{words} (alike: {', '.join(names[:MAX_ALIKE])}{more})"


def describe_load(path: str, labels: Labels) -> str:
    """Describe the path of a load in words; of a coupling's load on a body: that body."""
    kind, name, *rest = path.split(".")
    if kind == "couplings" and rest[:1] == ["on"]:
        body = describe_object("bodies", rest[1], labels)
        return f"{describe_object(kind, name, labels)}, {' '.join(rest[2:])} on {body}"
    return describe_path(path, labels)


def _make_figure(
    data: ReportData, greatest: GreatestOfCases, courses: Sequence[RunCourse], crank: str | None
) -> Figure:
    """Make the figure of one load in some cases."""
    style = choose_family([greatest.ends], data).style
    curves = [style.per_si * course.find_numbers(greatest.path) for course in courses]
    known = np.concatenate([curve[np.isfinite(curve)] for curve in curves])
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    x_values = np.concatenate([course.x for course in courses])
    x_label = "t [s]" if crank is None else "angle [°]"
    x = Scaling(x_label, *choose_ends(float(x_values.min()), float(x_values.max()), margin=0.0))
    y_low, y_high = choose_ends(min(low, 0.0), max(high, 0.0), margin=MARGIN)
    quantity = "force" if greatest.ends.unit == "N" else "moment"
    y = Scaling(f"{quantity} [{style.unit}]", min(y_low, 0.0) if low < 0.0 else 0.0, y_high)
    items: list[Item] = [Trace(course.run.case_label, course.x, curve, k)
                         for k, (course, curve) in enumerate(zip(courses, curves, strict=True))]  # fmt: skip
    items += _mark_greatest(data, greatest, courses, crank)
    legend = [(course.run.case_label, k) for k, course in enumerate(courses)] if data.has_cases else []
    return Figure("", (), [Panel(x, y, tuple(items), HEIGHT)], legend)


def _mark_greatest(
    data: ReportData, greatest: GreatestOfCases, courses: Sequence[RunCourse], crank: str | None
) -> Iterator[Spot]:
    """Mark the greatest value of all cases with its instant or angle."""
    for k, course in enumerate(courses):
        ends = find_extremes(course.run, greatest.path)
        time = greatest.extreme.time
        if course.run is not greatest.run or ends is None or time is None:
            continue
        value = greatest.family.style.per_si * greatest.value
        x = float(course.x[int(np.argmin(np.abs(course.times - time)))])
        where = f"{x:.0f}°" if crank is not None else f"{format_instant(time, course.run)} s"
        if math.isfinite(value):
            yield Spot(x, value, f"{greatest.family.style.write(greatest.value)} at {where}", k, is_filled=True)


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
    return panel._replace(height=min(panel.height, POLAR_HEIGHT), items=tuple(items))


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
