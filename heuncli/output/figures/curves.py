"""The curves of a figure: traces, bands, envelopes of long oscillations, bars of load cases, marked extremes, points;
and its vertical marks: events, impacts, jumps of the curves, horizons.

Of a long course each short interval shows its minimum, its maximum, and its gaps.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.axes import format_short
from heuncli.output.drawing.figure import Arrow, Band, Bars, Item, Scaling, Spot, Trace, VerticalMark
from heuncli.output.drawing.style import PANEL_HEIGHT
from heuncli.output.figures.courses import FigureSource, NumberCourse, find_jumps, find_values, is_varying
from heuncli.results.results import Array, Results
from heuncli.study.quantities.digits import UNKNOWN, ReaderStyle, choose_reader_style, format_error
from heuncli.study.quantities.table_units import PREFIXES, Units
from heuncli.study.queries.measure import Peak

MAX_PERIODS, MAX_STRETCHES = 60, 240  # with more periods the curve is an envelope of at most so many stretches
ARROW_PLACES, ARROW_SHARE = (0.2, 0.55, 0.9), 0.03  # of a closed curve's points, and of the panel's width
GROUP_WIDTH = 0.8  # share of a load case that its bars take
N_INTERVALS = 1500  # nearly two a pixel of a panel
MIN_HALF_WIDTH = 0.5  # pixels: half width of a band
# The largest number of a panel in a product of chosen units, such as N·mm; beyond, its unit is chosen by size.
MIN_READABLE, MAX_READABLE = 0.1, 1e4
MAX_SPOTS = 150  # more points are drawn as a line
MAX_REPEATED_LABELS = 5  # more repetitions are labelled once
INSTANT_DIGITS = 4


def choose_number_style(unit: str, largest: float, units: Units) -> ReaderStyle:
    """Choose how the numbers of a panel are written: in the units chosen, but a product of them that would make the
    numbers long or small in a unit of their size.

    unit: SI unit; largest: magnitude, SI
    """
    chosen = choose_reader_style(unit, largest, units)
    if "·" not in unit or unit not in PREFIXES:
        return chosen
    by_size = choose_reader_style(unit, largest, Units())
    is_short, is_shorter = (MIN_READABLE <= style.per_si * largest < MAX_READABLE for style in (chosen, by_size))
    return by_size if is_shorter and not is_short else chosen


class PanelCourse(NamedTuple):
    """A course in a panel: its name, pen, run, the values along the horizontal axis (n,), SI units, and its caption."""

    name: str
    pen: int
    source: FigureSource
    x: Array
    course: NumberCourse
    caption: str = ""


class HorizontalAxis(NamedTuple):
    """The horizontal axis: its path (None for time), its display unit, and how many of these are one SI unit."""

    path: str | None
    unit: str
    per_si: float


def draw_curves(
    curves: Sequence[PanelCourse], x: Scaling, y: Scaling, style: ReaderStyle, x_axis: HorizontalAxis, height: float
) -> Iterator[Item]:
    """Draw the curves with their extremes, and with the bands of their errors where these are visible."""
    for curve in curves:
        values, places = style.per_si * curve.course.values, x_axis.per_si * curve.x
        error = style.per_si * (curve.course.error or 0.0)
        if is_visible(error, y, height):
            yield Band(f"stated error of {curve.name}", places, values - error, values + error, curve.pen)
        if x_axis.path is None and _count_periods(curve.course.values) > MAX_PERIODS:
            yield _make_envelope(curve, places, values)
            continue
        yield Trace(curve.name, places, values, curve.pen)
        if x_axis.path is not None:
            length = ARROW_SHARE * (x.high - x.low)
            yield from draw_direction_arrows(places, values, curve.pen, length, (y.high - y.low) / (x.high - x.low))
    for curve in curves:
        yield from _mark_extremes(curve, style, x_axis)


def _count_periods(values: Array) -> float:
    """Count how often a course passes its middle, two passes a period."""
    known = values[np.isfinite(values)]
    if not known.size:
        return 0.0
    above = known > 0.5 * (known.min() + known.max())
    return 0.5 * float(np.count_nonzero(above[1:] != above[:-1]))


def _make_envelope(curve: PanelCourse, x: Array, values: Array) -> Band:
    """Return the lowest and highest value of stretches of at least two periods each as a band."""
    is_known = np.isfinite(values)
    x, values = x[is_known], values[is_known]
    count = min(int(0.5 * _count_periods(values)), MAX_STRETCHES)
    edges = np.linspace(x[0], x[-1], count + 1)
    first = np.unique(np.minimum(np.searchsorted(x, edges[:-1]), len(x) - 1))
    low, high = np.minimum.reduceat(values, first), np.maximum.reduceat(values, first)
    middle = 0.5 * (x[first] + np.append(x[first[1:]], x[-1]))
    places = np.concatenate([x[:1], middle, x[-1:]])
    low, high = (np.concatenate([edge[:1], edge, edge[-1:]]) for edge in (low, high))
    return Band(f"range of {curve.name}", places, low, high, curve.pen, has_edges=True)


def draw_direction_arrows(x: Array, y: Array, number: int, length: float, aspect: float = 1.0) -> Iterator[Arrow]:
    """Draw short arrows along a curve in the direction of time; aspect: units of y as long as a unit of x."""
    for share in ARROW_PLACES:
        k = int(share * (len(x) - 1))
        distances = np.hypot(x[k + 1 :] - x[k], (y[k + 1 :] - y[k]) / aspect)
        far_enough = np.flatnonzero(distances >= 0.5 * length)
        if len(far_enough):
            j = k + 1 + int(far_enough[0])
            scale = length / float(distances[far_enough[0]])
            yield Arrow(x[k], y[k], scale * (x[j] - x[k]), scale * (y[j] - y[k]), number)


def _mark_extremes(curve: PanelCourse, style: ReaderStyle, x_axis: HorizontalAxis) -> Iterator[Spot]:
    """Mark the greatest magnitude with its instant, and the lowest value if it is negative; of a constant its value."""
    low, high, error = curve.course.low, curve.course.high, curve.course.error or 0.0
    if not is_varying(low.value, high.value, error):
        if high.time is not None and math.isfinite(high.value):
            x = x_axis.per_si * float(curve.x[np.argmax(np.isfinite(curve.x + curve.course.values))])
            text = format_constant(high.value, error, style) + ("" if len(curve.x) == 1 else " at all times")
            if math.isfinite(x):
                yield _make_spot(x, high, text, curve, style, "")
        return
    marked = [("maximum", high)] if high.value > 0.0 else []
    marked += [("minimum", low)] if low.value < 0.0 else []
    for word, peak in marked or [("maximum", high)]:
        if peak.time is None or not math.isfinite(peak.value):
            continue
        x, place_text = _locate_peak(curve, peak, x_axis)
        if math.isfinite(x):  # else the number on the horizontal axis is open there
            yield _make_spot(x, peak, f"{format_number(peak.value, error, style)} at {place_text}", curve, style, word)


def _make_spot(x: float, peak: Peak, text: str, curve: PanelCourse, style: ReaderStyle, word: str) -> Spot:
    note = f"{curve.caption or curve.name}: {word} {text}"
    return Spot(x, style.per_si * peak.value, text, curve.pen, is_filled=True, note=note)


def _locate_peak(curve: PanelCourse, peak: Peak, x_axis: HorizontalAxis) -> tuple[float, str]:
    """Return the place of an extreme along the horizontal axis, as a number and as text."""
    assert peak.time is not None
    if x_axis.path is None:
        return peak.time, f"{format_short(peak.time, 4)} s"
    x = x_axis.per_si * float(find_values(curve.source.study, x_axis.path, np.array([peak.time]))[0])
    return x, join_unit(format_short(x, 4), x_axis.unit)


def join_unit(number: str, unit: str) -> str:
    """Join a number with its unit; degrees have a sign without a blank."""
    return number if unit in ("", "1") else f"{number}°" if unit in ("deg", "°") else f"{number} {unit}"


def format_constant(value: float, error: float, style: ReaderStyle) -> str:
    """Format a number that does not vary. If it is below its error, so that its sign is unknown, format that error;
    `?`: unknown.
    """
    if 0.0 < abs(value) <= error:
        return UNKNOWN if math.isinf(error) else f"within its stated error, {format_error(style.per_si * error)},"
    return format_number(value, error, style)


def format_number(value: float, error: float, style: ReaderStyle) -> str:
    """Format a number with its unit, no digits below its error, and the error if it reaches the last digit."""
    if value == 0.0 or abs(value) <= error:
        return UNKNOWN if math.isinf(error) else join_unit("0", style.unit)
    shown = style.per_si * error
    decimals = min(style.decimals, max(0, -math.ceil(math.log10(2.0 * shown)))) if shown > 0.0 else style.decimals
    text = style._replace(decimals=decimals, error=0.0).write(value)
    is_coarse = shown >= 0.5 * 10.0**-decimals
    return join_unit(f"{text} ± {format_error(shown)}" if is_coarse else text, style.unit)


def draw_case_bars(curves: Sequence[PanelCourse], style: ReaderStyle) -> Iterator[Item]:
    """Draw numbers of one instant as bars: load cases along the axis, a pen for each path."""
    names = list(dict.fromkeys(curve.source.name for curve in curves))
    pens = sorted({curve.pen for curve in curves})
    width = GROUP_WIDTH / len(pens)
    for pen in pens:
        own = [curve for curve in curves if curve.pen == pen]
        offset = (pens.index(pen) + 0.5) * width - 0.5 * GROUP_WIDTH
        x = np.array([names.index(curve.source.name) + offset for curve in own])
        values = [float(curve.course.values[0]) for curve in own]
        yield Bars(own[0].course.path, x, style.per_si * np.array(values), pen, 0.9 * width)
        for place, value, curve in zip(x.tolist(), values, own, strict=True):
            if math.isfinite(value):
                text = format_number(value, curve.course.error or 0.0, style).removesuffix(f" {style.unit}")
                yield Spot(place, style.per_si * value, text, pen, "")


def find_visible_points(values: Array, n_intervals: int = N_INTERVALS) -> NDArray[np.intp]:
    """Return the indices (m,) of values (n,), ascending, that a figure shows; all of them if they are few."""
    count = len(values)
    if count <= 4 * n_intervals:
        return np.arange(count)
    n_per_interval = -(-count // n_intervals)
    places = np.minimum(np.arange(n_intervals * n_per_interval), count - 1).reshape(n_intervals, n_per_interval)
    parts = values[places]
    unknown = np.isnan(parts)
    rows = np.arange(n_intervals)
    chosen = [
        places[rows, np.where(unknown, np.inf, parts).argmin(axis=1)],
        places[rows, np.where(unknown, -np.inf, parts).argmax(axis=1)],
        places[rows, unknown.argmax(axis=1)],  # a gap, else the first
        places[-1:, -1],
    ]
    return np.unique(np.concatenate(chosen))


def is_visible(error: float, y: Scaling, height: float = PANEL_HEIGHT) -> bool:
    """Return whether an error is visible on a vertical axis of a height [pixels]; error and axis have the same unit."""
    return math.isfinite(error) and error * height > MIN_HALF_WIDTH * (y.high - y.low)


class MeasuredPoints(NamedTuple):
    """Measured points (n,), in SI units of the axes of a panel.

    unit: SI unit of y
    """

    name: str
    unit: str
    x: Array
    y: Array


def draw_points(points: MeasuredPoints, pen: int, size_x: float, size_y: float) -> Iterator[Item]:
    """Draw squares, or if there are many a thin line through them.

    size_x, size_y: factors from SI to the display units
    """
    x, y = size_x * points.x, size_y * points.y
    if len(x) <= MAX_SPOTS:
        for a, b in zip(x.tolist(), y.tolist(), strict=True):
            yield Spot(a, b, "", pen, "square")
        return
    visible = find_visible_points(y)
    yield Trace(points.name, x[visible], y[visible], pen, is_thin=True)


def make_marks(
    sources: Sequence[FigureSource], courses: Sequence[NumberCourse]
) -> tuple[list[VerticalMark], list[str]]:
    """Make the marks, ascending, each instant once, and notes; of several runs the events of any of them.

    An event that repeats often is a tick without a label; a note tells how often it happens.
    """
    names: dict[float, dict[str, None]] = {}  # by instant: names of what happens in any run, in order
    for source in sources:
        results = source.study.results
        horizon_time = _find_horizon(results)
        for time, words in (*_iter_impacts(results), *_iter_events(results)):
            if time < horizon_time:
                names.setdefault(time, {})[words] = None
    if len(sources) > 1:  # with one run the panel is hatched beyond the horizon instead
        for source in sources:
            if (horizon := _find_horizon(source.study.results)) < np.inf:
                names.setdefault(horizon, {})[f"horizon of {source.name}"] = None
    texts = {time: ", ".join(own) for time, own in names.items()}
    sorted_times = np.sort(np.array(list(texts)))
    for time in (time for course in courses for time in find_jumps(course).tolist()):
        if not _has_instant(sorted_times, time):
            texts.setdefault(time, "")
    times_of_text: dict[str, list[float]] = {}
    for time, words in sorted(texts.items()):
        times_of_text.setdefault(words, []).append(time)
    marks = [
        VerticalMark(
            time,
            words if len(times_of_text[words]) <= MAX_REPEATED_LABELS else "",
            format_event(words, time),
            is_tick=bool(words) and len(times_of_text[words]) > MAX_REPEATED_LABELS,
        )
        for time, words in sorted(texts.items())
    ]
    return marks, [
        f"{words}: {len(repeated_times)} times, first at {format_instant(repeated_times[0])}, last at "
        f"{format_instant(repeated_times[-1])}"
        for words, repeated_times in times_of_text.items()
        if words and len(repeated_times) > MAX_REPEATED_LABELS
    ]


def _find_horizon(results: Results) -> float:
    """Return the horizon of a run, or infinity."""
    horizon = results.horizon
    return np.inf if horizon is None else float(horizon)


def format_event(words: str, time: float) -> str:
    """Format an event with its instant."""
    return f"{words} at {format_instant(time)}" if words else ""


def format_instant(time: float) -> str:
    """Format an instant."""
    return f"{format_short(time, INSTANT_DIGITS)} s"


def _has_instant(times: Array, time: float) -> bool:
    """Return whether one of the ascending instants equals the time within rounding."""
    if not times.size:
        return False
    k = int(np.searchsorted(times, time))
    return bool(np.abs(times[max(k - 1, 0) : k + 1] - time).min() <= tolerances.SAME_INSTANT * max(1.0, abs(time)))


def _iter_impacts(results: Results) -> Iterator[tuple[float, str]]:
    """Yield the instants of impacts with the names of what met."""
    for impulse in results.impulses:
        yield float(impulse["time"]), ", ".join(impulse["names"]) or "impulse"


def _iter_events(results: Results) -> Iterator[tuple[float, str]]:
    """Yield the instants at which conditions change, with their names."""
    for name, event in results.events.items():
        for time in np.asarray(event["time"]).tolist():
            yield float(time), name
