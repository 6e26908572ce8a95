"""Render a solved scene as one animated page: the geometry, the numbers, and notes about them, in one file.

The page is assembled from the files in this folder: template, style, scripts, and the data, encoded so that no name in
a spec can end the data block. The scripts are browser modules. Here they are bundled into one script: each becomes a
function that returns what it exports, after those that it imports from. The page's security policy permits only this
style and this script, by their digests.
"""

from __future__ import annotations

import base64
import hashlib
import html
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path, PurePath
from typing import Any, Literal

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.base.text_safety import escape
from heuncli.output.machine_geometry.poses import extract_poses
from heuncli.output.machine_geometry.views import find_motion_plane
from heuncli.output.tables.run_description import make_heading
from heuncli.output.tables.table_plans import SECTIONS
from heuncli.output.web_page.frames import MAX_PAGE_FRAMES, PageFrames, choose_frames, find_peaks, resample_at_frames
from heuncli.output.web_page.geometry import make_page_machine, make_page_scene
from heuncli.output.web_page.packing import encode_data, pack_exact
from heuncli.output.web_page.page_numbers import (
    make_acting_loads,
    make_blocks,
    make_impact_page_tables,
    make_sections,
    split_heading,
)
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
FOLDER = Path(__file__).parent
STYLE = "style.css"
TEMPLATES = {"main": "machine.html", "film": "film.html"}  # main script -> its page
MAIN_SCRIPT, FILM_SCRIPT = TEMPLATES
IMPORT = re.compile(r'^import (\{[^}]*\}) from "\./(\w+)\.js";$', re.MULTILINE)
EXPORT = re.compile(r"^export ((?:function|class|const) (\w+))", re.MULTILINE)
PLACEHOLDER = re.compile(r"\{\{(\w+)\}\}")
COMMENT = re.compile(r"^ */\*\*.*?\*/\n", re.MULTILINE | re.DOTALL)  # those of the scripts stay in their files
INDENT = re.compile(r"^ +", re.MULTILINE)


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
    stated_errors = find_stated_errors(original, labels, study.magnitudes)
    peaks = find_peaks(study, labels, stated_errors)
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
        "notes": [*frames.notes, *[PEAKS_NOTE] * (not peaks.is_searched), *_iter_notes(original, horizon)],
        "horizon": horizon,
        "count": len(frames.times),
        "time": pack_exact(frames.times),
        "marks": list(_iter_time_marks(original, frames)),
        "length": list(units.find("m")),
        "scene": make_page_scene(
            make_page_machine(spec, scene), spec, results, extract_poses(results), labels, find_motion_plane(scene)
        ),
        "acting": make_acting_loads(study, frames.times, labels, stated_errors),
        "blocks": make_blocks(results, labels, stated_errors),
        "impulses": list(_iter_impacts(original, frames, labels, stated_errors)),
        "sections": make_sections(spec, results, labels, stated_errors),
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
    results: Results, frames: PageFrames, labels: Labels, stated_errors: StatedErrors
) -> Iterator[dict[str, Any]]:
    """Yield the impacts within the frames, each with the first frame at or after it and its tables."""
    for number, impact in enumerate(results.impulses[:MAX_IMPACTS]):
        time = float(impact["time"])
        if frames.times[0] <= time <= frames.times[-1]:
            caption = f"{', '.join(impact['names']) or 'impulse'}, {time:.6g} s"
            tables = make_impact_page_tables(number, impact, results, labels, stated_errors)
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
    found = [(float(impact["time"]), ", ".join(impact["names"]) or "impulse") for impact in results.impulses]
    for name, event in results.events.items():
        words = event.get("to", ())
        for k, time in enumerate(np.asarray(event["time"]).tolist()):
            found.append((float(time), name + ("" if k >= len(words) or words[k] else " ends")))
    first, last = float(frames.times[0]), float(frames.times[-1])
    for time, words in sorted(found)[:MAX_TIME_MARKS]:
        if first <= time <= last:
            yield {"frame": _find_frame(frames, time), "time": time, "words": escape(str(words))}


def assemble_page(title: str, data: dict[str, Any], main_script: str = MAIN_SCRIPT) -> str:
    """Assemble the page of a main script as text. Raises ValueError if the data hold nan or infinity."""
    parts = {
        "title": html.escape(escape(title)),
        "style": read_page_file(STYLE),
        "script": bundle_scripts(main_script),
        "data": encode_data(data),
        "policy": make_security_policy(main_script),
    }
    return PLACEHOLDER.sub(lambda place: parts[place[1]], read_page_file(TEMPLATES[main_script]))


@cache
def make_security_policy(main_script: str = MAIN_SCRIPT) -> str:
    """Make the page's content security policy: only its own style and script are permitted, by their digests."""
    return (
        f"default-src 'none'; script-src '{_compute_digest(bundle_scripts(main_script))}'; style-src "
        f"'{_compute_digest(read_page_file(STYLE))}'; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )


def _compute_digest(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode("ascii")


@cache
def bundle_scripts(main_script: str = MAIN_SCRIPT) -> str:
    """Bundle a main script and all that it needs into one, inside a function, so that none of their names is global."""
    return '(() => {\n"use strict";\n' + "".join(map(_wrap_module, sort_scripts(main_script))) + "})();\n"


def _wrap_module(name: str) -> str:
    """Wrap one script in a function that returns what the script exports."""
    text = read_page_file(f"{name}.js")
    exported = ", ".join(found[2] for found in EXPORT.finditer(text))
    body = INDENT.sub("", COMMENT.sub("", EXPORT.sub(r"\1", IMPORT.sub(r"const \1 = \2_js;", text))))
    return f"const {name}_js = (() => {{\n{body}return {{ {exported} }};\n}})();\n"


def sort_scripts(main_script: str = MAIN_SCRIPT) -> list[str]:
    """Sort the names of a main script and all that it needs so that each follows those that it imports from."""
    found: dict[str, None] = {}

    def add(name: str) -> None:
        for needed in IMPORT.finditer(read_page_file(f"{name}.js")):
            if needed[2] not in found:
                add(needed[2])
        found[name] = None

    add(main_script)
    return list(found)


@cache
def read_page_file(name: str) -> str:
    """Read one of the files in this folder, as text."""
    return (FOLDER / name).read_text(encoding="utf-8")
