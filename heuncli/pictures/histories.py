"""Numbers over time, or over another number of the same run: grouped by unit, a panel each, under each other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from heuncli.drawing.figure import Band, Blank, Figure, Item, Panel, Scaling, Spot, Trace, Upright
from heuncli.drawing.ticks import ends, short
from heuncli.named_tuples import NamedTuple
from heuncli.pictures.courses import Course, Pictured, course_of, instants, jumps_of, values_at
from heuncli.report.table_units import Units
from heuncli.results import Array, Results
from heuncli.study.ask.measure import Peak
from heuncli.variants.stated import unit_of

DIGITS = 5  # of the words at an extreme
MOST_MARKS = 12  # vertical marks with words; beyond, without
VISIBLE = 0.004  # of a panel's height: half a pixel, below which the band of an error is not seen


class Measured(NamedTuple):
    """Points that were measured, (n,): over what a panel shows, in SI, and of which unit."""

    name: str
    unit: str
    x: Array
    y: Array


class Drawn(NamedTuple):
    """A course in a panel: its name in the legend, its pen, over what it is drawn (n,)."""

    name: str
    pen: int
    x: Array
    course: Course


def history(
    sources: Sequence[Pictured],
    paths: Sequence[str],
    units: Units,
    over: str | None = None,
    measured: Sequence[Measured] = (),
) -> Figure:
    """The figure of some paths, of one run or of several over each other; over: the path along the axis across."""
    drawn = list(_drawn(sources, paths, over))
    results = sources[0].study.results
    across, size = _across(sources[0], over, units)
    xs = np.concatenate([each.x for each in drawn] + [each.x for each in measured]) * size
    known = xs[np.isfinite(xs)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    if over is None and results.accuracy.get("horizon") is not None:
        high = float(results.time[-1])
    x = Scaling(across, *ends(low, high, spare=0.0 if over is None else 0.04))
    groups: dict[str, list[Drawn]] = {}
    for each in drawn:
        groups.setdefault(each.course.unit, []).append(each)
    marks = [] if over is not None else list(_marks(sources, drawn))
    points = {unit: [each for each in measured if each.unit == unit] for unit in groups}
    panels = [
        _panel(unit, own, points[unit], units, x._replace(label=""), size, marks, named=not k)
        for k, (unit, own) in enumerate(groups.items())
    ]
    panels[-1] = panels[-1]._replace(x=x)
    legend = [(each.name, each.pen) for each in drawn]
    legend += [(each.name, len(drawn) + k) for k, each in enumerate(measured)]
    words = [sentence for source in sources for sentence in _words(source)]
    return Figure(results.title, words, panels, legend, _notes(drawn))


def _drawn(sources: Sequence[Pictured], paths: Sequence[str], over: str | None) -> Iterator[Drawn]:
    """The courses, each with its pen."""
    number = 0
    for source in sources:
        times = instants(source.study)
        x = times if over is None else values_at(source.study, over, times)
        for path in paths:
            name = f"{source.name}: {path}" if source.name else path
            yield Drawn(name, number, x, course_of(source.study, path, times))
            number += 1


def _across(source: Pictured, over: str | None, units: Units) -> tuple[str, float]:
    """What the axis across tells, and how many of its unit are one in SI."""
    if over is None:
        return "t [s]", 1.0
    unit, size = units.of(unit_of(over, source.study.spec))
    return f"{over} [{unit}]", size


def _panel(
    unit: str,
    drawn: Sequence[Drawn],
    measured: Sequence[Measured],
    units: Units,
    x: Scaling,
    size_x: float,
    marks: Sequence[Upright],
    *,
    named: bool,
) -> Panel:
    """The panel of one unit; named: whether the vertical marks have their words in it."""
    shown, size = units.of(unit)
    values = np.concatenate([each.course.values for each in drawn] + [each.y for each in measured]) * size
    peaks = [size * peak.value for each in drawn for peak in (each.course.low, each.course.high)]
    known = np.concatenate([values[np.isfinite(values)], [value for value in peaks if np.isfinite(value)]])
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    y = Scaling(f"[{shown}]" if shown != "1" else "[-]", *ends(low, high, zero=_near_zero(low, high), spare=0.12))
    items: list[Item] = [Upright(mark.x, mark.text if named else "") for mark in marks]
    items += [item for each in drawn for item in _course(each, y, size, size_x)]
    for number, each in enumerate(measured):
        pen = len(drawn) + number
        items += [Spot(a * size_x, b * size, "", pen, "square") for a, b in zip(each.x, each.y, strict=True)]
    if size_x == 1.0 and x.high > (last := max(float(each.course.times[-1]) for each in drawn)) and not measured:
        items.append(Blank(last, x.high, "beyond the horizon: nothing is claimed"))
    return Panel(x, y, tuple(items))


def _near_zero(low: float, high: float) -> bool:
    """Whether zero belongs on an axis: it is in reach of what is drawn, beside how far that goes."""
    return low <= 0.0 <= high or min(abs(low), abs(high)) < high - low


def _course(drawn: Drawn, y: Scaling, size: float, size_x: float) -> Iterator[Item]:
    """A curve with the band of its error, where that is seen, and its extremes."""
    course = drawn.course
    values, x = size * course.values, size_x * drawn.x
    error = size * (course.error or 0.0)
    if error > VISIBLE * (y.high - y.low) and np.isfinite(error):
        yield Band(f"stated error of {drawn.name}", x, values - error, values + error, drawn.pen)
    yield Trace(drawn.name, x, values, drawn.pen)
    if drawn.x is course.times:
        yield from _extremes(drawn, size)


def _extremes(drawn: Drawn, size: float) -> Iterator[Spot]:
    """The lowest and the highest with their values and instants; of what does not vary neither."""
    low, high = drawn.course.low, drawn.course.high
    if not high.value - low.value > 1e-9 * max(abs(low.value), abs(high.value)):
        return
    peaks: list[Peak] = [high, low]
    for peak in peaks:
        if peak.at is not None and np.isfinite(peak.value):
            text = f"{size * peak.value:.{DIGITS}g} at {short(float(f'{peak.at:.4g}'))} s"
            yield Spot(peak.at, size * peak.value, text, drawn.pen, filled=True)


def _marks(sources: Sequence[Pictured], drawn: Sequence[Drawn]) -> Iterator[Upright]:
    """Events, blows and jumps of what is drawn, each instant once."""
    found: dict[float, str] = {}
    for source in sources:
        for at, words in _happenings(source.study.results).items():
            found.setdefault(at, words)
    for each in drawn:
        for at in jumps_of(each.course).tolist():
            if not any(abs(at - other) <= 1e-9 * max(1.0, abs(at)) for other in found):
                found[at] = ""
    spoken = len([words for words in found.values() if words]) <= MOST_MARKS
    for at, words in sorted(found.items()):
        yield Upright(at, words if spoken else "")


def _happenings(results: Results) -> Mapping[float, str]:
    """The instants of blows and events with their names."""
    found = {float(blow["time"]): ", ".join(blow["names"]) or "blow" for blow in results.impulses}
    for name, event in results.events.items():
        for at in np.asarray(event["time"]).tolist():
            found.setdefault(float(at), name)
    return found


def _words(source: Pictured) -> Iterator[str]:
    """Of which run it is, and how well that is known."""
    results = source.study.results
    horizon = results.accuracy.get("horizon")
    file = str(results.spec.get("path", ""))
    told = f"{source.name or file}: {results.model.get('method', '')}"
    yield told + (f"; nothing is claimed from t = {horizon:.6g} s on" if horizon is not None else "")


def _notes(drawn: Sequence[Drawn]) -> list[str]:
    """What is open somewhere, and so is not drawn there."""
    lost = [each.name for each in drawn if np.isnan(each.course.values).any()]
    return [f"open or not known in parts, and not drawn there: {', '.join(lost)}"] if lost else []
