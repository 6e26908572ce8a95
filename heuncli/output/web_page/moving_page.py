"""Render a solved scene as one animated page: the geometry, the numbers, and notes about them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePath
from typing import Any, Literal

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.base.text_safety import escape
from heuncli.output.machine_geometry.poses import extract_poses
from heuncli.output.machine_geometry.views import find_motion_plane
from heuncli.output.tables.run_description import make_heading
from heuncli.output.tables.table_plans import SECTIONS
from heuncli.output.web_page.drawn_loads import make_acting_loads, make_sections
from heuncli.output.web_page.frames import MAX_PAGE_FRAMES, PageFrames, choose_frames, find_peaks, resample_at_frames
from heuncli.output.web_page.geometry import make_page_machine, make_page_scene
from heuncli.output.web_page.number_rows import make_blocks, make_impact_page_tables, split_heading
from heuncli.output.web_page.packing import pack_exact
from heuncli.output.web_page.page_assembly import FILM_SCRIPT, assemble_page
from heuncli.results.results import Array, Results
from heuncli.study.quantities.digits import StatedErrors, find_stated_errors
from heuncli.study.quantities.labels import Labels, make_labels
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.study import Study

MAX_TIME_MARKS = 400  # events and impacts on the time line
PEAKS_NOTE = "Too many loads to search for maxima between output times: loads may be larger there."
DIGEST_DIGITS = 12
MAX_IMPACTS = 12  # whose tables are included
HEADING_NOTES = ("stiff", "split", "status", "warning")  # lines of the heading that are shown as notes


class Film(NamedTuple):
    """What is drawn of the machine: one picture (png) or gif, or the pictures (frames) of a video.

    width, height: [pixels]; rate: pictures a second; instant: of one picture [s], None: of the greatest load
    """

    kind: Literal["png", "gif", "frames"]
    width: int
    height: int
    rate: float
    instant: float | None = None


def render_moving_page(studies: Mapping[str, Study], units: Units, max_frames: int = MAX_PAGE_FRAMES) -> str:
    """Render the page of studies that are solved for motion and loads, by the names of their load cases.

    max_frames: instants that the page holds of each case
    """
    runs = [make_page_data(study, units, max_frames, case) for case, study in studies.items()]
    title = next(iter(studies.values())).results.title
    return assemble_page(title, runs[0] if len(runs) == 1 else {"runs": runs})


def render_film_page(study: Study, units: Units, film: Film, case: str = "") -> str:
    """Render the page that draws the pictures of a film, or one picture, and leaves them as text."""
    instants = () if film.instant is None else (film.instant,)
    data = {**make_page_data(study, units, case=case, instants=instants), "film": film._asdict()}
    return assemble_page(study.results.title, data, FILM_SCRIPT)


def make_page_data(
    study: Study, units: Units, max_frames: int = MAX_PAGE_FRAMES, case: str = "", instants: Sequence[float] = ()
) -> dict[str, Any]:
    """Make all data of a case: plain dictionaries and lists, with arrays packed.

    instants: [s], beside those of the run, at which a frame is needed
    """
    original, spec, scene = study.results, study.spec, study.setup.scene
    labels = replace(make_labels(spec), units=units)
    certain = find_stated_errors(original, labels, study.magnitudes)
    peaks = find_peaks(study, labels, certain)
    frames = choose_frames(study, np.sort([*peaks.times, *instants]), max_frames)
    results = resample_at_frames(study, frames.times)
    horizon = original.horizon
    return {
        "title": escape(original.title),
        "about": [
            [label, escape(text)]
            for label, text in (*make_heading(original), ("spec", _format_spec_digest(original)))
            if text
        ],
        "version": original.version,
        "file": escape(_find_file_name(original)),
        "case": escape(case),
        "alerts": sum(1 for _ in _iter_notes(original, horizon)),
        "worst": _find_worst_frame(results),
        "told": [*frames.notes, *[PEAKS_NOTE] * (not peaks.is_searched), *_iter_notes(original, horizon)],
        "horizon": horizon,
        "count": len(frames.times),
        "time": pack_exact(frames.times),
        "marks": list(_iter_time_marks(original, frames)),
        "length": list(units.find("m")),
        "scene": make_page_scene(
            make_page_machine(spec, scene), spec, results, extract_poses(results), labels, find_motion_plane(scene)
        ),
        "acting": make_acting_loads(study, frames.times, labels, certain),
        "blocks": make_blocks(results, labels, certain),
        "blows": list(_iter_impacts(original, frames, labels, certain)),
        "sections": make_sections(spec, results, labels, certain),
        "cutting": split_heading(SECTIONS.heading(results, labels)),
        "foundation": _find_moment_center(results),
    }


def _format_spec_digest(results: Results) -> str:
    """Format the name and the first digits of the digest of the spec that was solved."""
    digest = results.spec.get("sha256")
    return f"{_find_file_name(results)}, sha256 {digest[:DIGEST_DIGITS]}" if digest else ""


def _find_file_name(results: Results) -> str:
    """Return the name of the spec's file, without its folder."""
    return PurePath(str(results.spec.get("path", ""))).name


def _find_worst_frame(results: Results) -> int:
    """Find the frame at which the sum of all joint forces, each relative to its own largest, is greatest."""
    sums = np.zeros(len(results.time))
    for joint in results.joints.values():
        sizes = np.nan_to_num(np.sqrt((np.asarray(joint["force"]) ** 2).sum(axis=1))) if "force" in joint else sums
        sums = sums + sizes
    return int(np.argmax(sums))


def _iter_notes(results: Results, horizon: float | None) -> Iterator[str]:
    """Yield the notes that a reader needs before reading the numbers."""
    yield from (escape(f"{label}: {text}") for label, text in make_heading(results) if label in HEADING_NOTES)
    if horizon is not None:
        yield f"The motion is known up to t = {horizon:.6g} s; later results are not claimed and not shown."
    if len(results.impulses) > MAX_IMPACTS:
        yield f"{len(results.impulses)} impulses; values are listed for the first {MAX_IMPACTS}."
    if any(joint.get("open") for joint in results.joints.values()):
        yield "Open: some values are statically indeterminate (they depend on stiffness) and have no arrow."


def _iter_impacts(
    results: Results, frames: PageFrames, labels: Labels, certain: StatedErrors
) -> Iterator[dict[str, Any]]:
    """Yield the impacts within the frames, each with the first frame at or after it and its tables."""
    for number, impact in enumerate(results.impulses[:MAX_IMPACTS]):
        time = float(impact["time"])
        if frames.times[0] <= time <= frames.times[-1]:
            caption = f"{', '.join(impact['names']) or 'impulse'}, {time:.6g} s"
            tables = make_impact_page_tables(number, impact, results, labels, certain)
            yield {"number": number, "frame": _find_frame(frames, time), "words": escape(caption), "blocks": tables}


def _find_frame(frames: PageFrames, time: float) -> int:
    """Find the number of the frame at an instant, or of the next one after it."""
    return min(int(np.searchsorted(frames.times, time)), len(frames.times) - 1)


def _find_moment_center(results: Results) -> list[float] | None:
    """Return the reference point of the foundation's moment [m], or None."""
    about: Array | None = results.foundation.get("about")
    return None if about is None else [float(component) for component in np.asarray(about)]


def _iter_time_marks(results: Results, frames: PageFrames) -> Iterator[dict[str, Any]]:
    """Yield the impacts and events within the frames: name, time and frame."""
    found = [(float(impact["time"]), ", ".join(impact["names"]) or "blow") for impact in results.impulses]
    for name, event in results.events.items():
        words = event.get("to", ())
        for k, time in enumerate(np.asarray(event["time"]).tolist()):
            found.append((float(time), name + ("" if k >= len(words) or words[k] else " ends")))
    first, last = float(frames.times[0]), float(frames.times[-1])
    for time, words in sorted(found)[:MAX_TIME_MARKS]:
        if first <= time <= last:
            yield {"frame": _find_frame(frames, time), "time": time, "words": escape(str(words))}
