"""Numbers over time, or over another number of the same run: grouped by unit, a panel each, under each other."""

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
    Upright,
    over_one_axis,
)
from heuncli.output.drawing.ticks import ends, near_zero, short
from heuncli.output.figures.courses import (
    NumberCourse,
    Pictured,
    course_of,
    instants,
    jumps_of,
    require_one_number,
    title_of,
    values_at,
    varies,
)
from heuncli.output.figures.error_bands import is_seen
from heuncli.output.figures.happenings import instant, marks_of
from heuncli.output.figures.measured_points import MeasuredPoints, seen
from heuncli.output.figures.refusals import NotDrawable
from heuncli.output.figures.thinning import seen_places
from heuncli.results.results import Array
from heuncli.study.ask.measure import Peak
from heuncli.study.ask.smoothed_friction import friction_warning
from heuncli.study.compose.smoothed_friction import has_smoothed_friction
from heuncli.study.quantities.digits import rough
from heuncli.study.quantities.stated import unit_of
from heuncli.study.quantities.table_units import Units

DIGITS = 5  # of the words at an extreme, where the run can stand behind so many
SPARE = 0.12  # of what is drawn, above and below it: room for the words at extremes
HEIGHTS = (280.0, 210.0, HEIGHT)  # pixels of a panel that stands alone, of each of two, of more
OF_PATHS = 480.0  # pixels at most, of the path of a point
MOST_TIMES, MOST_OVER = 1_000_000, 20_000  # instants of a curve over time, of which few are kept, and over a number
OVER_NOTHING = "beyond the horizon: nothing is claimed"
ALL_OPEN = "open: the laws of rigid bodies do not give this number"
# what is measured in a unit, as axes tell it
QUANTITIES = {
    "N": "force", "N·m": "moment", "N·s": "impulse", "N·m·s": "angular impulse", "m": "length", "rad": "angle",
    "m/s": "velocity", "rad/s": "angular velocity", "m/s²": "acceleration", "rad/s²": "angular acceleration",
    "J": "energy", "W": "power", "Pa": "stress",
}  # fmt: skip


class PanelCourse(NamedTuple):
    """A course in a panel: its name in the legend, its pen, its run, and over what it is drawn (n,), in SI."""

    name: str
    pen: int
    source: Pictured
    x: Array
    course: NumberCourse


class Across(NamedTuple):
    """The axis across: the path along it (None: time), its unit as it is shown, and how many of that are one in SI."""

    over: str | None
    unit: str
    size: float


def history(
    sources: Sequence[Pictured],
    paths: Sequence[str],
    units: Units,
    over: str | None = None,
    measured: Sequence[MeasuredPoints] = (),
) -> Figure:
    """The figure of some paths, of one run or of several over each other; over: the path along the axis across.

    Raises NotDrawable.
    """
    _require_one_axis(sources, over)
    drawn = list(_drawn(sources, paths, over))
    across = Across(over, *(("s", 1.0) if over is None else units.of(unit_of(over, sources[0].study.spec))))
    groups: dict[str, list[PanelCourse]] = {}
    for each in drawn:
        groups.setdefault(each.course.unit, []).append(each)
    x = _axis_across(sources, drawn, measured, across)
    marks, notes = ([], []) if over is not None else marks_of(sources, [each.course for each in drawn])
    # a length over a length is the path of a point: a circle is to be seen as one
    equal = over is not None and list(groups) == ["m"] and unit_of(over, sources[0].study.spec) == "m"
    height = OF_PATHS if equal else HEIGHTS[min(len(groups), len(HEIGHTS)) - 1]
    panels: list[Panel] = []
    for unit, own in groups.items():
        here = [(len(drawn) + k, each) for k, each in enumerate(measured) if each.unit == unit]
        y = _axis_up(unit, own, [each for _, each in here], units)
        size = units.of(unit)[1]
        words = marks if not panels else [Upright(mark.x, "") for mark in marks]
        points = [item for pen, each in here for item in seen(each, pen, across.size, size)]
        items = [*words, *_blanks(sources, own, x, across), *points, *_curves(own, y, size, across, height)]
        panels.append(Panel(x, y, tuple(items), height, equal))
    return Figure(
        title_of(sources),
        [sentence for source in sources for sentence in _words(source)],
        over_one_axis(panels),
        [(each.name, each.pen) for each in drawn],
        [*_notes(drawn, panels), *notes],
        [(each.name, len(drawn) + k, "square") for k, each in enumerate(measured)],
    )


def _drawn(sources: Sequence[Pictured], paths: Sequence[str], over: str | None) -> Iterator[PanelCourse]:
    """The courses, each with its pen."""
    number = 0
    for source in sources:
        times = instants(source.study, MOST_TIMES if over is None else MOST_OVER)
        for path in (*paths, *([] if over is None else [over])):
            require_one_number(source.study, path)
        x = times if over is None else values_at(source.study, over, times)
        for path in dict.fromkeys(paths):
            name = f"{source.name}: {path}" if source.name else path
            course = course_of(source.study, path, times)
            if over is None:
                course = _thinned(course)
            yield PanelCourse(name, number, source, course.times if over is None else x, course)
            number += 1


def _thinned(course: NumberCourse) -> NumberCourse:
    """A course over time with as many points as are seen, both sides of its jumps among them."""
    jumps = np.searchsorted(course.times, jumps_of(course))
    kept = np.unique(np.concatenate([seen_places(course.values), jumps, jumps + 1]))
    return course._replace(times=course.times[kept], values=course.values[kept])


def _require_one_axis(sources: Sequence[Pictured], over: str | None) -> None:
    """Raise NotDrawable where the path along the axis across is of one unit in one run, of another in the next."""
    if over is None:
        return
    first, *others = [(source.name, unit_of(over, source.study.spec)) for source in sources]
    for name, unit in others:
        if unit != first[1]:
            of, other = (QUANTITIES.get(own, own or "a number") for own in (first[1], unit))
            message = f"--x {over}: of kind '{of}' in {first[0]}, '{other}' in {name}: no axis is of both"
            raise NotDrawable(message, "draw them one after the other")


def _axis_across(
    sources: Sequence[Pictured], drawn: Sequence[PanelCourse], measured: Sequence[MeasuredPoints], across: Across
) -> Scaling:
    """The axis across all panels; that of time goes on beyond horizons, to the end of the longest run."""
    values = [each.x for each in drawn] + [each.x for each in measured]
    if across.over is None:
        values += [source.study.results.time for source in sources]
    low, high = _range(np.concatenate(values) * across.size)
    label = f"{across.over or 't'} [{across.unit if across.unit not in ('', '1') else '-'}]"
    if low == high:  # one instant alone: nothing is claimed about it
        return Scaling(label, *ends(low, high), named=((low, short(low)),))
    return Scaling(label, *ends(low, high, spare=0.0 if across.over is None else 0.04))


def _axis_up(unit: str, drawn: Sequence[PanelCourse], measured: Sequence[MeasuredPoints], units: Units) -> Scaling:
    """The axis of a panel: around what is drawn, with zero where that is near."""
    shown, size = units.of(unit)
    label = f"{QUANTITIES.get(unit, '')} [{'-' if shown in ('', '1') else shown}]".strip()
    if _all_open(drawn):
        return Scaling(label, 0.0, 1.0, named=((0.0, ""),))
    peaks = [peak.value for each in drawn for peak in (each.course.low, each.course.high)]
    low, high = _range(np.concatenate([*(each.course.values for each in drawn), *(each.y for each in measured), peaks]))
    error = max(each.course.error or 0.0 for each in drawn)
    reach = error if math.isfinite(error) else 0.0
    band = size * (low - reach), size * (high + reach)  # of errors, which may reach farther than what is drawn
    if not varies(low, high, error):
        low = high = 0.0 if max(abs(low), abs(high)) <= error else 0.5 * (low + high)
    low, high = ends(size * low, size * high, zero=near_zero(low, high), spare=SPARE)
    return Scaling(label, min(low, band[0]), max(high, band[1]))


def _all_open(drawn: Sequence[PanelCourse]) -> bool:
    """Whether there is nothing to draw."""
    return all(np.isnan(each.course.values).all() for each in drawn)


def _range(values: Array) -> tuple[float, float]:
    """The least and the greatest that is known; 0 and 1 where nothing is."""
    known = values[np.isfinite(values)]
    return (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)


def _blanks(sources: Sequence[Pictured], drawn: Sequence[PanelCourse], x: Scaling, across: Across) -> Iterator[Item]:
    """What stays empty, and why: beyond the horizon of every run, or all of a panel whose numbers are open."""
    if _all_open(drawn):
        yield Blank(x.low, x.high, ALL_OPEN)
        return
    claimed = max(
        float(results.time[-1]) if (horizon := results.horizon) is None else horizon
        for results in (source.study.results for source in sources)
    )
    if across.over is None and any(claimed < source.study.results.time[-1] for source in sources):
        yield Blank(claimed, x.high, OVER_NOTHING)


def _curves(drawn: Sequence[PanelCourse], y: Scaling, size: float, across: Across, height: float) -> Iterator[Item]:
    """The curves with the bands of their errors, where these are seen, and their extremes."""
    for each in drawn:
        values, x = size * each.course.values, across.size * each.x
        error = size * (each.course.error or 0.0)
        if is_seen(error, y, height):
            yield Band(f"stated error of {each.name}", x, values - error, values + error, each.pen)
        yield Trace(each.name, x, values, each.pen)
    for each in drawn:
        yield from _extremes(each, size, across)


def _extremes(drawn: PanelCourse, size: float, across: Across) -> Iterator[Spot]:
    """The lowest and the highest with their values and instants; of what does not vary its value."""
    low, high, error = drawn.course.low, drawn.course.high, drawn.course.error or 0.0
    is_varying = varies(low.value, high.value, error)
    for word, peak in (("greatest", high), ("least", low)) if is_varying else (("", high),):
        if peak.at is None or not math.isfinite(peak.value):
            continue
        x, at = _place(drawn, peak, across)
        if is_varying:
            text = f"{figures(peak.value, error, size)} at {at}"
        else:
            text = steady(peak.value, error, size) + ("" if len(drawn.x) == 1 else " throughout")
            x = across.size * float(drawn.x[np.argmax(np.isfinite(drawn.x + drawn.course.values))])
        if not math.isfinite(x):  # what it is drawn over is open there
            continue
        yield Spot(x, size * peak.value, text, drawn.pen, filled=True, note=f"{drawn.name}: {word} {text}")


def _place(drawn: PanelCourse, peak: Peak, across: Across) -> tuple[float, str]:
    """Where an extreme stands along the axis across, and that in words."""
    assert peak.at is not None
    if across.over is None:
        return peak.at, instant(peak.at)
    x = across.size * float(values_at(drawn.source.study, across.over, np.array([peak.at]))[0])
    return x, f"{short(x, 4)} {'' if across.unit == '1' else across.unit}".rstrip()


def steady(value: float, error: float, size: float) -> str:
    """A number that does not vary; of one below its error, which may be of either sign, that error; ?: not known."""
    if 0.0 < abs(value) <= error:
        return "?" if math.isinf(error) else f"not above its stated error, {rough(size * error)},"
    return figures(value, error, size)


def figures(value: float, error: float, size: float) -> str:
    """A number in its unit as it is shown, to no more digits than its error leaves."""
    if value == 0.0 or abs(value) <= error:
        return "?" if math.isinf(error) else "0"
    known = DIGITS
    if error > 0.0:
        known = min(DIGITS, math.floor(math.log10(abs(value))) - math.floor(math.log10(error)))
    return short(size * value, max(known, 1))


def _words(source: Pictured) -> Iterator[str]:
    """Of which run it is, and how well that is known."""
    results = source.study.results
    horizon = results.horizon
    parts = [source.name or str(results.spec.get("path", "")), f"method {results.model.get('method', 'none')}"]
    motion = results.accuracy.get("estimate", {}).get("motion")
    if motion:
        parts.append(f"motion estimated to {rough(motion)} of the scene's size")
    if "axes" in results.model and any(results.joints):
        parts.append(f"joint loads in the axes of the '{results.model['axes']}' body")
    if horizon is not None:
        parts.append(f"nothing is claimed from t = {horizon:.6g} s on")
    yield "; ".join(parts)


def _notes(drawn: Sequence[PanelCourse], panels: Sequence[Panel]) -> list[str]:
    """What is open, throughout or somewhere, and so is not drawn there; what bands are."""
    gaps = [np.isnan(each.course.values) for each in drawn]
    all_open = [each.name for each, lost in zip(drawn, gaps, strict=True) if lost.all()]
    in_parts = [each.name for each, lost in zip(drawn, gaps, strict=True) if lost.any() and not lost.all()]
    notes = [f"open, and not drawn: {', '.join(all_open)}"] if all_open else []
    notes += [f"open or not known at some instants, and not drawn there: {', '.join(in_parts)}"] if in_parts else []
    if any(isinstance(item, Band) for panel in panels for item in panel.items):
        notes.append("light bands: the stated error")
    return [*notes, *_near_rest(drawn)]


def _near_rest(drawn: Sequence[PanelCourse]) -> Iterator[str]:
    """Which extremes stand where smoothed friction is not at its value."""
    for each in drawn:
        study, course = each.source.study, each.course
        if not has_smoothed_friction(study.setup.scene.mechanism) or course.low.value == course.high.value:
            continue
        for word, peak in (("least", course.low), ("greatest", course.high)):
            if math.isfinite(peak.value) and (text := friction_warning(study, course.path, peak.at)) is not None:
                yield f"the {word} of {text}"
