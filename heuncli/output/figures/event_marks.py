"""Vertical marks of a history: events, impacts, jumps of the curves, horizons."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.output.drawing.axes import format_short
from heuncli.output.drawing.figure import VerticalMark
from heuncli.output.figures.courses import FigureSource, NumberCourse, find_jumps
from heuncli.results.results import Array, Results

MAX_REPEATED_LABELS = 5  # more repetitions are labelled once
INSTANT_DIGITS = 4


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
