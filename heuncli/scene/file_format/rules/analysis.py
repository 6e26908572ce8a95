"""What is asked: instants in order, a type that fits them, a tolerance that can be met."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.scene.file_format.methods import unfit_tolerance
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule
from heuncli.scene.file_format.semantics import MOST_SAMPLES

START = "shift all times, and t in loads with them"
SMALLEST = "2 are the start and the end; for the start alone: {type: state}"
LONGEST = 1e15  # seconds: thirty million years, in which no run counts a second any more
ASCEND = "sort them, and give each once"


@rule("times")
def times(draft: DraftDocument) -> Iterator[Violation]:
    """Instants are given once, ascend, and do not lie before the start."""
    analysis = draft.document.analysis
    path = ("analysis",)
    if analysis.times is not None:
        for key in ("duration", "samples"):
            if getattr(analysis, key) is not None:
                yield Violation((*path, key), f"{key} beside times", "the last of the times is the end", key=True)
        if not analysis.times:
            yield Violation((*path, "times"), "times is an empty list", "list the instants: [0, 0.5, 1]")
        for i, t in enumerate(analysis.times):
            if t < 0.0:
                yield Violation((*path, "times", i), f"the run starts at 0; {t:g} s lies before it", START)
            elif i and t <= analysis.times[i - 1]:
                message = f"times ascend, but {t:g} follows {analysis.times[i - 1]:g}"
                yield Violation((*path, "times", i), message, ASCEND)
        if analysis.times == [0.0] and analysis.type in (None, "motion"):
            yield Violation((*path, "times"), "a motion that ends when it starts",
                            "for the start alone: analysis: {type: state}")  # fmt: skip
    elif analysis.samples is not None:
        if analysis.duration is None and "analysis" not in draft.unread:
            yield Violation(
                (*path, "samples"), "samples without a duration", "analysis: {duration: 2, samples: 201}", key=True
            )
        if not 2 <= analysis.samples <= MOST_SAMPLES:
            message = f"samples counts both ends: 2 to {MOST_SAMPLES}, not {analysis.samples}"
            hint = "extremes are searched between the samples, too" if analysis.samples > 2 else SMALLEST
            yield Violation((*path, "samples"), message, hint)
    last = max([analysis.duration or 0.0, *(analysis.times or [])])
    if last > LONGEST:
        key = "duration" if analysis.times is None else "times"
        message = f"a run of {last:g} s; at most {LONGEST:g} s are run"
        yield Violation((*path, key), message, "is its unit right? what goes on as it is needs no run: type: state")


@rule("analysis-type")
def analysis_type(draft: DraftDocument) -> Iterator[Violation]:
    """The type fits the rest."""
    analysis = draft.document.analysis
    path = ("analysis", "type")
    timed = analysis.duration is not None or analysis.times is not None
    if analysis.type == "motion" and not timed:
        yield Violation(path, "a motion needs a duration or times", "analysis: {duration: 2, samples: 201}")
    if analysis.type in ("state", "impulse", "rest") and timed:
        yield Violation(
            path,
            f"type: {analysis.type} is one instant and takes no duration or times",
            "leave the type out for a motion",
        )
    if analysis.type in ("state", "rest") and draft.names.entries["impulses"]:
        hint = "type: impulse for the jump at time 0, a duration for a motion with blows"
        yield Violation(path, f"a {analysis.type} has no blows, but there are impulses", hint)
    if analysis.type == "impulse" and not draft.names.entries["impulses"]:
        yield Violation(path, "type: impulse without impulses", "impulses: {blow: {on: body.point, vector: [1, 0, 0]}}")


@rule("rest-start")
def rest_start(draft: DraftDocument) -> Iterator[Violation]:
    """What is looked for at rest has no start velocities; those of what is driven are the drives' own."""
    document = draft.document
    if document.analysis.type != "rest":
        return
    hint = "leave it out, or ask for a motion"
    driven = {drive.joint for drive in document.drives.values()}
    for name, joint in document.joints.items():
        given = getattr(joint, "initial", None)
        for key in ("rate", "speed"):
            if name not in driven and getattr(given, key, None):
                yield Violation(("joints", name, "initial", key), f"a rest has no start {key}", hint, key=True)
    for name, body in document.bodies.items():
        for key in ("velocity", "angular_velocity"):
            value = getattr(body, key)
            if value is not None and any(getattr(value, "vector", value)):
                what = key.replace("_", " ")
                yield Violation(("bodies", name, key), f"a rest has no start {what}", hint, key=True)


@rule("tolerance")
def tolerance(draft: DraftDocument) -> Iterator[Violation]:
    """A tolerance is between rounding and the whole."""
    value = draft.document.analysis.tolerance
    found = unfit_tolerance(value) if value is not None else None
    if found is not None:
        yield Violation(("analysis", found.key), found.message, found.hint)
