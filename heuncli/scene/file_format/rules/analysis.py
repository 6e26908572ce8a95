"""Rules about the analysis: output instants, a type that fits them, a tolerance that can be met."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.scene.file_format.methods import find_tolerance_problem
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule
from heuncli.scene.file_format.semantics import MAX_SAMPLES

START_HINT = "shift all times, and t in the loads with them"
FEWEST_SAMPLES_HINT = "2 are the start and the end; for the start alone: {type: state}"
MAX_DURATION = 1e15  # [s] thirty million years
ASCENDING_HINT = "sort them, and give each once"


@rule("times")
def check_times(draft: DraftDocument) -> Iterator[Violation]:
    """Output instants are given in one way, ascend, and do not lie before the start."""
    analysis = draft.document.analysis
    path = ("analysis",)
    if analysis.times is not None:
        for key in ("duration", "samples"):
            if getattr(analysis, key) is not None:
                yield Violation(
                    (*path, key),
                    f"{key} and times are both given",
                    "the last of the times is the end of the run",
                    key=True,
                )
        if not analysis.times:
            yield Violation((*path, "times"), "times is an empty list", "list the output times: [0, 0.5, 1]")
        for i, t in enumerate(analysis.times):
            if t < 0.0:
                yield Violation((*path, "times", i), f"the run starts at 0; {t:g} s is before it", START_HINT)
            elif i and t <= analysis.times[i - 1]:
                message = f"times must increase, but {t:g} follows {analysis.times[i - 1]:g}"
                yield Violation((*path, "times", i), message, ASCENDING_HINT)
        if analysis.times == [0.0] and analysis.type in (None, "motion"):
            yield Violation((*path, "times"), "the motion ends at its start",
                            "for the start alone: analysis: {type: state}")  # fmt: skip
    elif analysis.samples is not None:
        if analysis.duration is None and "analysis" not in draft.unread:
            yield Violation(
                (*path, "samples"), "samples without a duration", "analysis: {duration: 2, samples: 201}", key=True
            )
        if not 2 <= analysis.samples <= MAX_SAMPLES:
            message = f"samples must be 2 to {MAX_SAMPLES}, both ends included, not {analysis.samples}"
            hint = "extremes are also searched between the samples" if analysis.samples > 2 else FEWEST_SAMPLES_HINT
            yield Violation((*path, "samples"), message, hint)
    last = max([analysis.duration or 0.0, *(analysis.times or [])])
    if last > MAX_DURATION:
        key = "duration" if analysis.times is None else "times"
        message = f"a run of {last:g} s is too long; the limit is {MAX_DURATION:g} s"
        yield Violation((*path, key), message, "is its unit right? For a single instant use type: state")


@rule("analysis-type")
def check_analysis_type(draft: DraftDocument) -> Iterator[Violation]:
    """The type fits the other keys of the spec."""
    analysis = draft.document.analysis
    path = ("analysis", "type")
    has_duration = analysis.duration is not None or analysis.times is not None
    if analysis.type == "motion" and not has_duration:
        yield Violation(path, "a motion needs a duration or times", "analysis: {duration: 2, samples: 201}")
    if analysis.type in ("state", "impulse", "rest") and has_duration:
        yield Violation(
            path,
            f"type: {analysis.type} is one instant and takes no duration or times",
            "leave the type out for a motion",
        )
    if analysis.type in ("state", "rest") and draft.names.entries["impulses"]:
        hint = "type: impulse for the jump at time 0, a duration for a motion with impulses"
        yield Violation(path, f"type: {analysis.type} takes no impulses, but the spec has impulses", hint)
    if analysis.type == "impulse" and not draft.names.entries["impulses"]:
        yield Violation(path, "type: impulse without impulses", "impulses: {hit: {on: body.point, vector: [1, 0, 0]}}")


@rule("rest-start")
def check_rest_start(draft: DraftDocument) -> Iterator[Violation]:
    """A search for a rest pose has no start velocities; driven joints take theirs from the drives."""
    document = draft.document
    if document.analysis.type != "rest":
        return
    hint = "leave it out, or request a motion"
    driven = {drive.joint for drive in document.drives.values()}
    for name, joint in document.joints.items():
        initial = getattr(joint, "initial", None)
        for key in ("rate", "speed"):
            if name not in driven and getattr(initial, key, None):
                yield Violation(("joints", name, "initial", key), f"type: rest takes no initial {key}", hint, key=True)
    for name, body in document.bodies.items():
        for key in ("velocity", "angular_velocity"):
            value = getattr(body, key)
            if value is not None and any(getattr(value, "vector", value)):
                quantity = key.replace("_", " ")
                yield Violation(("bodies", name, key), f"type: rest takes no initial {quantity}", hint, key=True)


@rule("tolerance")
def check_tolerance(draft: DraftDocument) -> Iterator[Violation]:
    """A tolerance lies between rounding error and 1."""
    value = draft.document.analysis.tolerance
    problem = find_tolerance_problem(value) if value is not None else None
    if problem is not None:
        yield Violation(("analysis", problem.key), problem.message, problem.hint)
