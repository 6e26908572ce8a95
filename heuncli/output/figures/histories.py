"""Histories: numbers over time, or over another number of the same run, in stacked panels, one for each unit."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import (
    HEIGHT,
    Band,
    Blank,
    Figure,
    Item,
    Panel,
    Scaling,
    Spot,
    Trace,
    VerticalMark,
    share_x_axis,
)
from heuncli.output.drawing.ticks import choose_ends, format_short, is_zero_near
from heuncli.output.figures.courses import (
    FigureSource,
    NumberCourse,
    choose_instants,
    find_jumps,
    find_values,
    is_varying,
    make_course,
    make_title,
    require_one_number,
)
from heuncli.output.figures.error_bands import is_visible
from heuncli.output.figures.event_marks import format_instant, make_marks
from heuncli.output.figures.measured_points import MeasuredPoints, draw_points
from heuncli.output.figures.refusals import NotDrawable
from heuncli.output.figures.thinning import find_visible_points
from heuncli.results.results import Array
from heuncli.study.compose.warnings import has_smoothed_friction
from heuncli.study.quantities.digits import format_error
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.measure import Peak
from heuncli.study.queries.measure_uncertainty import find_unit
from heuncli.study.queries.study import make_friction_warning

MAX_DIGITS = 5  # maximum in labels of extremes
LABEL_MARGIN = 0.12  # share above and below the curves, for labels
PANEL_HEIGHTS = (280.0, 210.0, HEIGHT)  # pixels of a panel, by the number of panels: one, two, more
MAX_PATH_HEIGHT = 480.0  # maximum height of the path of a point, pixels
MAX_TIME_INSTANTS, MAX_NUMBER_INSTANTS = 1_000_000, 20_000  # maxima over time (thinned later), over a number
BEYOND_HORIZON_NOTE = "past the horizon: no results claimed"
ALL_OPEN_NOTE = "open: statically indeterminate, depends on stiffness"
# SI unit -> quantity, for labels of axes
QUANTITY_NAMES = {
    "N": "force", "N·m": "moment", "N·s": "impulse", "N·m·s": "angular impulse", "m": "length", "rad": "angle",
    "m/s": "velocity", "rad/s": "angular velocity", "m/s²": "acceleration", "rad/s²": "angular acceleration",
    "J": "energy", "W": "power", "Pa": "stress",
}  # fmt: skip


class PanelCourse(NamedTuple):
    """A course in a panel: its name in the legend, pen, run, and the values along the horizontal axis (n,), SI
    units.
    """

    name: str
    pen: int
    source: FigureSource
    x: Array
    course: NumberCourse


class HorizontalAxis(NamedTuple):
    """The horizontal axis: its path (None for time), its display unit, and how many of these are one SI unit."""

    path: str | None
    unit: str
    size: float


def make_history(
    sources: Sequence[FigureSource],
    paths: Sequence[str],
    units: Units,
    x_path: str | None = None,
    measured_points: Sequence[MeasuredPoints] = (),
) -> Figure:
    """Make the figure of some paths, of one run or of several over each other.

    x_path: the path along the horizontal axis, None for time

    Raises NotDrawable.
    """
    _require_one_axis(sources, x_path)
    curves = list(_make_curves(sources, paths, x_path))
    x_axis = HorizontalAxis(
        x_path, *(("s", 1.0) if x_path is None else units.find(find_unit(x_path, sources[0].study.spec)))
    )
    groups: dict[str, list[PanelCourse]] = {}
    for curve in curves:
        groups.setdefault(curve.course.unit, []).append(curve)
    x = _make_x_axis(sources, curves, measured_points, x_axis)
    marks, notes = ([], []) if x_path is not None else make_marks(sources, [curve.course for curve in curves])
    # a length over a length is the path of a point: a circle must look like one
    has_equal_scales = x_path is not None and list(groups) == ["m"] and find_unit(x_path, sources[0].study.spec) == "m"
    height = MAX_PATH_HEIGHT if has_equal_scales else PANEL_HEIGHTS[min(len(groups), len(PANEL_HEIGHTS)) - 1]
    panels: list[Panel] = []
    for unit, courses in groups.items():
        points_of_unit = [(len(curves) + k, curve) for k, curve in enumerate(measured_points) if curve.unit == unit]
        y = _make_y_axis(unit, courses, [curve for _, curve in points_of_unit], units)
        size = units.find(unit)[1]
        words = marks if not panels else [VerticalMark(mark.x, "") for mark in marks]
        points = [item for pen, curve in points_of_unit for item in draw_points(curve, pen, x_axis.size, size)]
        items = [
            *words,
            *_draw_blanks(sources, courses, x, x_axis),
            *points,
            *_draw_curves(courses, y, size, x_axis, height),
        ]
        panels.append(Panel(x, y, tuple(items), height, has_equal_scales))
    return Figure(
        make_title(sources),
        [sentence for source in sources for sentence in _describe_source(source)],
        share_x_axis(panels),
        [(curve.name, curve.pen) for curve in curves],
        [*_make_notes(curves, panels), *notes],
        [(curve.name, len(curves) + k, "square") for k, curve in enumerate(measured_points)],
    )


def _make_curves(sources: Sequence[FigureSource], paths: Sequence[str], x_path: str | None) -> Iterator[PanelCourse]:
    """Yield the courses, each with its pen."""
    number = 0
    for source in sources:
        times = choose_instants(source.study, MAX_TIME_INSTANTS if x_path is None else MAX_NUMBER_INSTANTS)
        for path in (*paths, *([] if x_path is None else [x_path])):
            require_one_number(source.study, path)
        x = times if x_path is None else find_values(source.study, x_path, times)
        for path in dict.fromkeys(paths):
            name = f"{source.name}: {path}" if source.name else path
            course = make_course(source.study, path, times)
            if x_path is None:
                course = _thin_course(course)
            yield PanelCourse(name, number, source, course.times if x_path is None else x, course)
            number += 1


def _thin_course(course: NumberCourse) -> NumberCourse:
    """Reduce a course over time to its visible points, both sides of its jumps included."""
    jumps = np.searchsorted(course.times, find_jumps(course))
    indices = np.unique(np.concatenate([find_visible_points(course.values), jumps, jumps + 1]))
    return course._replace(times=course.times[indices], values=course.values[indices])


def _require_one_axis(sources: Sequence[FigureSource], x_path: str | None) -> None:
    """Raise NotDrawable if the path along the horizontal axis has different units in the runs."""
    if x_path is None:
        return
    first, *others = [(source.name, find_unit(x_path, source.study.spec)) for source in sources]
    for name, unit in others:
        if unit != first[1]:
            first_kind, other = (
                QUANTITY_NAMES.get(unit_of_run, unit_of_run or "a number") for unit_of_run in (first[1], unit)
            )
            message = f"--x {x_path}: kind '{first_kind}' in {first[0]}, '{other}' in {name}: they cannot share an axis"
            raise NotDrawable(message, "draw them separately")


def _make_x_axis(
    sources: Sequence[FigureSource],
    curves: Sequence[PanelCourse],
    measured_points: Sequence[MeasuredPoints],
    x_axis: HorizontalAxis,
) -> Scaling:
    """Make the horizontal axis of all panels; that of time extends beyond horizons to the end of the longest run."""
    values = [curve.x for curve in curves] + [curve.x for curve in measured_points]
    if x_axis.path is None:
        values += [source.study.results.time for source in sources]
    low, high = _find_range(np.concatenate(values) * x_axis.size)
    label = f"{x_axis.path or 't'} [{x_axis.unit if x_axis.unit not in ('', '1') else '-'}]"
    if low == high:  # the horizon leaves one instant only
        return Scaling(label, *choose_ends(low, high), tick_texts=((low, format_short(low)),))
    return Scaling(label, *choose_ends(low, high, margin=0.0 if x_axis.path is None else 0.04))


def _make_y_axis(
    unit: str, curves: Sequence[PanelCourse], measured_points: Sequence[MeasuredPoints], units: Units
) -> Scaling:
    """Make the vertical axis of a panel: around the curves, with zero if that is near."""
    shown_unit, size = units.find(unit)
    label = f"{QUANTITY_NAMES.get(unit, '')} [{'-' if shown_unit in ('', '1') else shown_unit}]".strip()
    if _are_all_open(curves):
        return Scaling(label, 0.0, 1.0, tick_texts=((0.0, ""),))
    peaks = [peak.value for curve in curves for peak in (curve.course.low, curve.course.high)]
    low, high = _find_range(
        np.concatenate([*(curve.course.values for curve in curves), *(curve.y for curve in measured_points), peaks])
    )
    error = max(curve.course.error or 0.0 for curve in curves)
    margin = error if math.isfinite(error) else 0.0
    band = size * (low - margin), size * (high + margin)  # of errors, which may extend beyond the curves
    if not is_varying(low, high, error):
        low = high = 0.0 if max(abs(low), abs(high)) <= error else 0.5 * (low + high)
    low, high = choose_ends(size * low, size * high, zero=is_zero_near(low, high), margin=LABEL_MARGIN)
    return Scaling(label, min(low, band[0]), max(high, band[1]))


def _are_all_open(curves: Sequence[PanelCourse]) -> bool:
    """Return whether there is nothing to draw."""
    return all(np.isnan(curve.course.values).all() for curve in curves)


def _find_range(values: Array) -> tuple[float, float]:
    """Return the smallest and largest known value; 0 and 1 if there is none."""
    finite = values[np.isfinite(values)]
    return (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)


def _draw_blanks(
    sources: Sequence[FigureSource], curves: Sequence[PanelCourse], x: Scaling, x_axis: HorizontalAxis
) -> Iterator[Item]:
    """Draw the empty areas with their reason: beyond the horizon of every run, or a whole panel whose numbers are
    open.
    """
    if _are_all_open(curves):
        yield Blank(x.low, x.high, ALL_OPEN_NOTE)
        return
    last_horizon = max(
        float(results.time[-1]) if (horizon := results.horizon) is None else horizon
        for results in (source.study.results for source in sources)
    )
    if x_axis.path is None and any(last_horizon < source.study.results.time[-1] for source in sources):
        yield Blank(last_horizon, x.high, BEYOND_HORIZON_NOTE)


def _draw_curves(
    curves: Sequence[PanelCourse], y: Scaling, size: float, x_axis: HorizontalAxis, height: float
) -> Iterator[Item]:
    """Draw the curves with their extremes, and with the bands of their errors where these are visible."""
    for curve in curves:
        values, x = size * curve.course.values, x_axis.size * curve.x
        error = size * (curve.course.error or 0.0)
        if is_visible(error, y, height):
            yield Band(f"stated error of {curve.name}", x, values - error, values + error, curve.pen)
        yield Trace(curve.name, x, values, curve.pen)
    for curve in curves:
        yield from _mark_extremes(curve, size, x_axis)


def _mark_extremes(curve: PanelCourse, size: float, x_axis: HorizontalAxis) -> Iterator[Spot]:
    """Mark the lowest and highest value with their instants; of a constant its value."""
    low, high, error = curve.course.low, curve.course.high, curve.course.error or 0.0
    has_range = is_varying(low.value, high.value, error)
    for word, peak in (("maximum", high), ("minimum", low)) if has_range else (("", high),):
        if peak.time is None or not math.isfinite(peak.value):
            continue
        x, place_text = _locate_peak(curve, peak, x_axis)
        if has_range:
            text = f"{format_number(peak.value, error, size)} at {place_text}"
        else:
            text = format_constant(peak.value, error, size) + ("" if len(curve.x) == 1 else " at all times")
            x = x_axis.size * float(curve.x[np.argmax(np.isfinite(curve.x + curve.course.values))])
        if not math.isfinite(x):  # the number on the horizontal axis is open there
            continue
        yield Spot(x, size * peak.value, text, curve.pen, is_filled=True, note=f"{curve.name}: {word} {text}")


def _locate_peak(curve: PanelCourse, peak: Peak, x_axis: HorizontalAxis) -> tuple[float, str]:
    """Return the place of an extreme along the horizontal axis, as a number and as text."""
    assert peak.time is not None
    if x_axis.path is None:
        return peak.time, format_instant(peak.time)
    x = x_axis.size * float(find_values(curve.source.study, x_axis.path, np.array([peak.time]))[0])
    return x, f"{format_short(x, 4)} {'' if x_axis.unit == '1' else x_axis.unit}".rstrip()


def format_constant(value: float, error: float, size: float) -> str:
    """Format a number that does not vary. If it is below its error, so that its sign is unknown, format that error;
    `?`: unknown.
    """
    if 0.0 < abs(value) <= error:
        return "?" if math.isinf(error) else f"within its stated error, {format_error(size * error)},"
    return format_number(value, error, size)


def format_number(value: float, error: float, size: float) -> str:
    """Format a number in its display unit, with no more digits than its error leaves."""
    if value == 0.0 or abs(value) <= error:
        return "?" if math.isinf(error) else "0"
    digits = MAX_DIGITS
    if error > 0.0:
        digits = min(MAX_DIGITS, math.floor(math.log10(abs(value))) - math.floor(math.log10(error)))
    return format_short(size * value, max(digits, 1))


def _describe_source(source: FigureSource) -> Iterator[str]:
    """Yield the sentence that names the run and its accuracy."""
    results = source.study.results
    horizon = results.horizon
    parts = [source.name or str(results.spec.get("path", "")), f"method {results.model.get('method', 'none')}"]
    motion = results.accuracy.get("estimate", {}).get("motion")
    if motion:
        parts.append(f"motion within {format_error(motion)} of model size")
    if "axes" in results.model and any(results.joints):
        parts.append(f"joint loads in the axes of the '{results.model['axes']}' body")
    if horizon is not None:
        parts.append(f"no results claimed from t = {horizon:.6g} s on")
    yield "; ".join(parts)


def _make_notes(curves: Sequence[PanelCourse], panels: Sequence[Panel]) -> list[str]:
    """Return notes on curves that are open throughout or in part, and on the error bands."""
    gaps = [np.isnan(curve.course.values) for curve in curves]
    all_open = [curve.name for curve, is_gap in zip(curves, gaps, strict=True) if is_gap.all()]
    in_parts = [curve.name for curve, is_gap in zip(curves, gaps, strict=True) if is_gap.any() and not is_gap.all()]
    notes = [f"open, not drawn: {', '.join(all_open)}"] if all_open else []
    notes += [f"open or unknown at some times, not drawn there: {', '.join(in_parts)}"] if in_parts else []
    if any(isinstance(item, Band) for panel in panels for item in panel.items):
        notes.append("light bands: stated error")
    return [*notes, *_warn_of_friction(curves)]


def _warn_of_friction(curves: Sequence[PanelCourse]) -> Iterator[str]:
    """Yield the extremes at instants at which smoothed friction is not at its full value."""
    for curve in curves:
        study, course = curve.source.study, curve.course
        if not has_smoothed_friction(study.setup.scene.mechanism) or course.low.value == course.high.value:
            continue
        for word, peak in (("minimum", course.low), ("maximum", course.high)):
            if math.isfinite(peak.value) and (text := make_friction_warning(study, course.path, peak.time)) is not None:
                yield f"the {word} of {text}"
