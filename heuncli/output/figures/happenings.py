"""What happens at an instant, as vertical marks of a history: events, blows, jumps of what is drawn, horizons."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.output.drawing.figure import Upright
from heuncli.output.drawing.ticks import short
from heuncli.output.figures.courses import NumberCourse, Pictured, jumps_of
from heuncli.results.results import Array, Results

OFTEN = 5  # times
INSTANT_DIGITS = 6  # as tables show at most


def marks_of(sources: Sequence[Pictured], courses: Sequence[NumberCourse]) -> tuple[list[Upright], list[str]]:
    """The marks, ascending, each instant once, and notes; of several runs what happens in any of them.

    What happens again and again has its words where it does so first.
    """
    names: dict[float, dict[str, None]] = {}  # of one instant, what happens then in any order of the runs
    for source in sources:
        results = source.study.results
        claimed = _claimed_to(results)
        for at, words in (*_blows(results), *_events(results)):
            if at < claimed:
                names.setdefault(at, {})[words] = None
    if len(sources) > 1:  # the end of one of several curves is told where it is; of all of them the panel is hatched
        for source in sources:
            if (horizon := _claimed_to(source.study.results)) < np.inf:
                names.setdefault(horizon, {})[f"horizon of {source.name}"] = None
    found = {at: ", ".join(own) for at, own in names.items()}
    known = np.sort(np.array(list(found)))
    for at in (at for course in courses for at in jumps_of(course).tolist()):
        if not _near(known, at):
            found.setdefault(at, "")
    often: dict[str, list[float]] = {}
    for at, words in sorted(found.items()):
        often.setdefault(words, []).append(at)
    marks = [
        Upright(at, words if at == often[words][0] or len(often[words]) <= OFTEN else "", told(words, at))
        for at, words in sorted(found.items())
    ]
    return marks, [
        f"{words}: {len(ats)} times, first at {instant(ats[0])}, last at {instant(ats[-1])}"
        for words, ats in often.items() if words and len(ats) > OFTEN
    ]  # fmt: skip


def _claimed_to(results: Results) -> float:
    """The horizon of a run, or without end."""
    horizon = results.horizon
    return np.inf if horizon is None else float(horizon)


def told(words: str, at: float) -> str:
    """A happening with its instant."""
    return f"{words} at {instant(at)}" if words else ""


def instant(at: float) -> str:
    """An instant in words."""
    return f"{short(at, INSTANT_DIGITS)} s"


def _near(known: Array, at: float) -> bool:
    """Whether one of the known instants, ascending, is that one, but for rounding."""
    if not known.size:
        return False
    k = int(np.searchsorted(known, at))
    return bool(np.abs(known[max(k - 1, 0) : k + 1] - at).min() <= tolerances.SAME_INSTANT * max(1.0, abs(at)))


def _blows(results: Results) -> Iterator[tuple[float, str]]:
    """The instants of blows with the names of what strikes."""
    for blow in results.impulses:
        yield float(blow["time"]), ", ".join(blow["names"]) or "blow"


def _events(results: Results) -> Iterator[tuple[float, str]]:
    """The instants at which conditions change, with their names."""
    for name, event in results.events.items():
        for at in np.asarray(event["time"]).tolist():
            yield float(at), name
