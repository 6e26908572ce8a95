"""Histories: numbers over time, or over another number of the same run, in stacked panels, one for each unit.

Load cases of one instant are bars, a group for each case.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.output.drawing.axes import choose_ends, format_short, is_zero_near
from heuncli.output.drawing.figure import Band, Blank, Figure, Item, Panel, Scaling, VerticalMark, share_x_axis
from heuncli.output.drawing.style import PANEL_HEIGHT
from heuncli.output.figures.courses import (
    FigureSource,
    NotDrawable,
    NumberCourse,
    choose_instants,
    describe_number,
    find_jumps,
    find_values,
    is_varying,
    make_course,
    make_title,
    require_one_number,
)
from heuncli.output.figures.curves import (
    MAX_PERIODS,
    HorizontalAxis,
    MeasuredPoints,
    PanelCourse,
    choose_number_style,
    draw_case_bars,
    draw_curves,
    draw_points,
    find_visible_points,
    make_marks,
)
from heuncli.results.results import Array
from heuncli.study.compose.warnings import has_smoothed_friction
from heuncli.study.quantities.digits import ReaderStyle, choose_reader_style
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.measure_uncertainty import find_unit
from heuncli.study.queries.study import make_friction_warning

LABEL_MARGIN, BAR_MARGIN = 0.14, 0.2  # share above and below the curves, for labels; above bars
PANEL_HEIGHTS = (290.0, 220.0, PANEL_HEIGHT)  # pixels of a panel, by the number of panels: one, two, more
MAX_PATH_HEIGHT = 520.0  # maximum height of the path of a point, pixels
MAX_TIME_INSTANTS, MAX_NUMBER_INSTANTS = 1_000_000, 20_000  # maxima over time (thinned later), over a number
BEYOND_HORIZON_NOTE = "past the horizon: no results claimed"
ALL_OPEN_NOTE = "open: statically indeterminate, depends on stiffness"
# SI unit -> quantity, for labels of axes
QUANTITY_NAMES = {
    "N": "force", "N·m": "moment", "N·s": "impulse", "N·m·s": "angular impulse", "m": "length", "rad": "angle",
    "m/s": "velocity", "rad/s": "angular velocity", "m/s²": "acceleration", "rad/s²": "angular acceleration",
    "J": "energy", "W": "power", "Pa": "stress",
}  # fmt: skip


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
    groups: dict[str, list[PanelCourse]] = {}
    for curve in curves:
        own = groups.setdefault(curve.course.unit, [])
        own.append(curve._replace(pen=len(own)))
    if x_path is None and len(sources) > 1 and all(source.study.has_one_instant for source in sources):
        return _make_case_figure(sources, groups, units)
    x_axis = _choose_x_axis(sources, curves, x_path, units)
    x = _make_x_axis(sources, curves, measured_points, x_axis)
    marks, notes = ([], []) if x_path is not None else make_marks(sources, [curve.course for curve in curves])
    # a length over a length is the path of a point: a circle must look like one
    has_equal_scales = x_path is not None and list(groups) == ["m"] and find_unit(x_path, sources[0].study.spec) == "m"
    height = MAX_PATH_HEIGHT if has_equal_scales else PANEL_HEIGHTS[min(len(groups), len(PANEL_HEIGHTS)) - 1]
    panels: list[Panel] = []
    entries: list[tuple[str, int, str]] = []
    for unit, courses in groups.items():
        points_of_unit = [(len(courses) + k, c) for k, c in enumerate(c for c in measured_points if c.unit == unit)]
        entries += [(curve.name, pen, "square") for pen, curve in points_of_unit]
        style = _choose_style(unit, courses, x_axis if has_equal_scales else None, units)
        label = courses[0].caption if has_equal_scales and len(courses) == 1 else _choose_axis_words(courses, unit)
        y = _make_y_axis(label, style, courses, [curve for _, curve in points_of_unit], is_path=has_equal_scales)
        words = marks if not panels else [VerticalMark(mark.x, "", is_tick=mark.is_tick) for mark in marks]
        items = [
            *words,
            *_draw_blanks(sources, courses, x, x_axis),
            *(item for pen, curve in points_of_unit for item in draw_points(curve, pen, x_axis.per_si, style.per_si)),
            *draw_curves(courses, x, y, style, x_axis, height),
        ]
        title, legend = _choose_names(courses)
        panels.append(Panel(x, y, tuple(items), height, has_equal_scales, title=title, legend=legend))
    sentences = [sentence for source in sources for sentence in _describe_source(source)]
    notes = [*_make_notes(curves, panels), *notes]
    return Figure(make_title(sources), sentences, share_x_axis(panels), (), notes, entries)


def _make_case_figure(sources: Sequence[FigureSource], groups: dict[str, list[PanelCourse]], units: Units) -> Figure:
    """Make the figure of numbers of one instant each: load cases along the axis, paths as colours."""
    names = [source.name for source in sources]
    x = Scaling("load case", -0.5, len(names) - 0.5, tick_texts=tuple((float(k), name) for k, name in enumerate(names)))
    panels = []
    for unit, courses in groups.items():
        paths = list(dict.fromkeys(curve.course.path for curve in courses))
        own = [curve._replace(pen=paths.index(curve.course.path)) for curve in courses]
        style = _choose_style(unit, own, None, units)
        values = style.per_si * np.array([curve.course.values[0] for curve in own])
        low, high = _find_range(values)
        ends = choose_ends(min(low, 0.0), max(high, 0.0), zero=True, margin=BAR_MARGIN)
        captions = {curve.pen: describe_number(curve.source, curve.course.path) for curve in own}
        legend = tuple((caption, pen) for pen, caption in captions.items())
        y = Scaling(_join_label(QUANTITY_NAMES.get(unit, ""), style.unit), *ends)
        title = legend[0][0] if len(legend) == 1 else ""
        items = tuple(draw_case_bars(own, style))
        height = PANEL_HEIGHTS[min(len(groups), 2)]
        panels.append(Panel(x, y, items, height, title=title, legend=legend if len(legend) > 1 else ()))
    curves = [curve for own in groups.values() for curve in own]
    return Figure(make_title(sources), (), share_x_axis(panels), (), _make_notes(curves, []))


def _choose_names(courses: Sequence[PanelCourse]) -> tuple[str, tuple[tuple[str, int], ...]]:
    """Return the title of a panel in words and its legend: what all curves share stands in the title once."""
    captions = list(dict.fromkeys(curve.caption for curve in courses))
    if len(courses) == 1:
        return ": ".join(part for part in (courses[0].source.name, captions[0]) if part), ()
    if len(captions) == 1:
        return captions[0], tuple((curve.source.name, curve.pen) for curve in courses)
    return "", tuple(
        (f"{curve.source.name}: {curve.caption}" if curve.source.name else curve.caption, curve.pen)
        for curve in courses
    )


def _choose_axis_words(courses: Sequence[PanelCourse], unit: str) -> str:
    """Return the words of a vertical axis: for a length what it is, as a displacement, if all curves show the same."""
    words = {curve.caption.rpartition(", ")[2] for curve in courses}
    return words.pop() if unit == "m" and len(words) == 1 else QUANTITY_NAMES.get(unit, "")


def _choose_x_axis(
    sources: Sequence[FigureSource], curves: Sequence[PanelCourse], x_path: str | None, units: Units
) -> HorizontalAxis:
    """Choose the unit of the horizontal axis: that of the user, else by size."""
    if x_path is None:
        return HorizontalAxis(None, "s", 1.0)
    largest = max((float(np.nanmax(np.abs(curve.x), initial=0.0)) for curve in curves), default=0.0)
    style = choose_reader_style(find_unit(x_path, sources[0].study.spec), largest, units)
    return HorizontalAxis(x_path, style.unit, style.per_si)


def _choose_style(
    unit: str, courses: Sequence[PanelCourse], x_axis: HorizontalAxis | None, units: Units
) -> ReaderStyle:
    """Choose how the numbers of a panel are written; of a path in the unit of its horizontal axis."""
    peaks = [abs(peak.value) for curve in courses for peak in (curve.course.low, curve.course.high)]
    style = choose_number_style(unit, max((peak for peak in peaks if math.isfinite(peak)), default=0.0), units)
    return style if x_axis is None else style._replace(unit=x_axis.unit, per_si=x_axis.per_si)


def _join_label(words: str, unit: str) -> str:
    """Return the label of an axis: what it is, and its unit."""
    return f"{words} [{'-' if unit in ('', '1') else '°' if unit == 'deg' else unit}]".strip()


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
            caption = describe_number(source, path)
            course = make_course(source.study, path, times)
            if x_path is None:
                course = _thin_course(course)
            yield PanelCourse(name, number, source, course.times if x_path is None else x, course, caption)
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
    low, high = _find_range(np.concatenate(values) * x_axis.per_si)
    words = "t" if x_axis.path is None else describe_number(sources[0], x_axis.path)
    label = _join_label(words, x_axis.unit)
    if low == high:  # the horizon leaves one instant only
        return Scaling(label, *choose_ends(low, high), tick_texts=((low, format_short(low)),))
    return Scaling(label, *choose_ends(low, high, margin=0.0 if x_axis.path is None else 0.04))


def _make_y_axis(
    words: str,
    style: ReaderStyle,
    curves: Sequence[PanelCourse],
    measured_points: Sequence[MeasuredPoints],
    *,
    is_path: bool = False,
) -> Scaling:
    """Make the vertical axis of a panel: around the curves, from zero if that is near; is_path: of a point."""
    label, per_si = _join_label(words, style.unit), style.per_si
    if _are_all_open(curves):
        return Scaling(label, 0.0, 1.0, tick_texts=((0.0, ""),))
    peaks = [peak.value for curve in curves for peak in (curve.course.low, curve.course.high)]
    low, high = _find_range(
        np.concatenate([*(curve.course.values for curve in curves), *(curve.y for curve in measured_points), peaks])
    )
    error = max(curve.course.error or 0.0 for curve in curves)
    margin = error if math.isfinite(error) else 0.0
    band = per_si * (low - margin), per_si * (high + margin)  # of errors, which may extend beyond the curves
    if not is_varying(low, high, error):
        low = high = 0.0 if max(abs(low), abs(high)) <= error else 0.5 * (low + high)
    if is_path:
        return Scaling(label, *choose_ends(per_si * low, per_si * high))
    low, high = choose_ends(per_si * low, per_si * high, zero=is_zero_near(low, high), margin=LABEL_MARGIN)
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


def _describe_source(source: FigureSource) -> Iterator[str]:
    """Yield what a reader must know of a run: the axes of its joint loads, and its horizon."""
    results = source.study.results
    parts = []
    if "axes" in results.model and any(results.joints):
        parts.append(f"joint loads in the axes of the '{results.model['axes']}' body")
    if results.horizon is not None:
        parts.append(f"no results claimed from t = {results.horizon:.6g} s on")
    if parts:
        yield f"{source.name}: {'; '.join(parts)}" if source.name else "; ".join(parts)


def _make_notes(curves: Sequence[PanelCourse], panels: Sequence[Panel]) -> list[str]:
    """Return notes on curves that are open throughout or in part, and on the error bands."""
    gaps = [np.isnan(curve.course.values) for curve in curves]
    all_open = [curve.caption for curve, is_gap in zip(curves, gaps, strict=True) if is_gap.all()]
    in_parts = [curve.caption for curve, is_gap in zip(curves, gaps, strict=True) if is_gap.any() and not is_gap.all()]
    notes = [f"open, not drawn: {'; '.join(all_open)}"] if all_open else []
    notes += [f"open or unknown at some times, not drawn there: {'; '.join(in_parts)}"] if in_parts else []
    bands = [item.name for panel in panels for item in panel.items if isinstance(item, Band)]
    if any(name.startswith("stated error") for name in bands):
        notes.append("light bands: stated error")
    if any(name.startswith("range") for name in bands):
        notes.append(f"bands between thin lines: the range of an oscillation of more than {MAX_PERIODS} periods")
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
