"""A solved scene as one page that moves: what is drawn, the numbers beside it, and what is said of them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from heuncli.base.foreign_text import shown
from heuncli.base.records import replace
from heuncli.output.machine_geometry.poses import poses_in
from heuncli.output.machine_geometry.views import plane_of
from heuncli.output.tables.heading import heading
from heuncli.output.tables.table_plans import SECTIONS
from heuncli.output.web_page.cuts import sections_of
from heuncli.output.web_page.frames import MOST, PageFrames, frames_of, results_at
from heuncli.output.web_page.geometry import looks_of, scene_of
from heuncli.output.web_page.inlined import whole_page
from heuncli.output.web_page.number_rows import blocks_of, blow_tables
from heuncli.output.web_page.packing import packed
from heuncli.output.web_page.peaks import peak_times
from heuncli.results.results import Array, Results
from heuncli.study.ask.study import Study
from heuncli.study.quantities.digits import Certainty, certainty
from heuncli.study.quantities.labels import Labels, labels_of
from heuncli.study.quantities.table_units import Units

MOST_MARKS = 400  # events and blows on the time line
NOT_SOUGHT = "There are too many loads to seek the largest between the instants of the run: they may be larger there."
MOST_BLOWS = 12  # whose numbers are listed
TELLING = ("stiff", "split", "status", "warning")  # lines of a heading that are told at once


def moving_page(study: Study, units: Units, most: int = MOST) -> str:
    """The page of a study solved for motion and loads; most: of its frames."""
    return whole_page(study.results.title, page_data(study, units, most))


def page_data(study: Study, units: Units, most: int = MOST) -> dict[str, Any]:
    """All that a page knows: plain data, arrays packed."""
    own, spec, scene = study.results, study.spec, study.setup.scene
    labels = replace(labels_of(spec), units=units)
    certain = certainty(own, labels, study.magnitudes)
    peaks = peak_times(study, labels, certain)
    frames = frames_of(study, peaks.times, most)
    results = results_at(study, frames.times)
    horizon = own.horizon
    return {
        "title": shown(own.title),
        "about": [[label, shown(text)] for label, text in (*heading(own)[1:], ("spec", _digest(own))) if text],
        "version": own.version,
        "file": shown(str(own.spec.get("path", ""))),
        "told": [*frames.told, *[NOT_SOUGHT] * (not peaks.sought), *_told(own, horizon)],
        "horizon": horizon,
        "count": len(frames.times),
        "time": packed(frames.times),
        "marks": list(_marks(own, frames)),
        "length": list(units.of("m")),
        "scene": scene_of(looks_of(spec, scene), spec, results, poses_in(results), plane_of(scene)),
        "blocks": blocks_of(results, labels, certain),
        "blows": list(_blows(own, frames, labels, certain)),
        "sections": sections_of(spec, results, labels, certain),
        "cutting": SECTIONS.heading(results, labels),
        "foundation": _about(results),
    }


def _digest(results: Results) -> str:
    """The spec that was solved, by its digest."""
    digest = results.spec.get("sha256")
    return f"{results.spec.get('path', '')}, sha256 {digest}" if digest else ""


def _told(results: Results, horizon: float | None) -> Iterator[str]:
    """What is to be known before the numbers are read."""
    yield from (shown(f"{label}: {text}") for label, text in heading(results) if label in TELLING)
    if horizon is not None:
        yield f"The motion is known up to t = {horizon:.6g} s: nothing beyond is claimed, and nothing of it is here."
    if len(results.impulses) > MOST_BLOWS:
        yield f"There are {len(results.impulses)} blows; the numbers of the first {MOST_BLOWS} are listed."
    if any(joint.get("open") for joint in results.joints.values()):
        yield "Open: redundant supports leave some numbers open; they are told as such, and have no arrow."


def _blows(results: Results, frames: PageFrames, labels: Labels, certain: Certainty) -> Iterator[dict[str, Any]]:
    """The blows within the frames, each with the frame just after it and its tables."""
    for number, blow in enumerate(results.impulses[:MOST_BLOWS]):
        at = float(blow["time"])
        if frames.times[0] <= at <= frames.times[-1]:
            words = f"{', '.join(blow['names']) or 'blow'}, {at:.6g} s"
            tables = blow_tables(number, blow, results, labels, certain)
            yield {"number": number, "frame": _frame(frames, at), "words": shown(words), "blocks": tables}


def _frame(frames: PageFrames, at: float) -> int:
    """The frame that is at an instant, or next after it."""
    return min(int(np.searchsorted(frames.times, at)), len(frames.times) - 1)


def _about(results: Results) -> list[float] | None:
    """The point about which the foundation's moment is told [m]."""
    about: Array | None = results.foundation.get("about")
    return None if about is None else [float(component) for component in np.asarray(about)]


def _marks(results: Results, frames: PageFrames) -> Iterator[dict[str, Any]]:
    """Blows and events within the frames: what, when, at which frame."""
    found = [(float(blow["time"]), ", ".join(blow["names"]) or "blow") for blow in results.impulses]
    for name, event in results.events.items():
        words = event.get("to", ())
        for k, at in enumerate(np.asarray(event["time"]).tolist()):
            found.append((float(at), name + ("" if k >= len(words) or words[k] else " ends")))
    first, last = float(frames.times[0]), float(frames.times[-1])
    for at, words in sorted(found)[:MOST_MARKS]:
        if first <= at <= last:
            yield {"frame": _frame(frames, at), "time": at, "words": shown(str(words))}
