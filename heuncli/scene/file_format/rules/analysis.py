"""Rules about the analysis: output instants, a type that fits them, a tolerance that can be met, conditions.

A condition ends a motion or is monitored in it, on numbers that the results have. The codes of rules about the
integration method are those of scene/file_format/methods.py.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from heuncli.base.method_rows import SMOOTH_ONLY, find_method
from heuncli.results.results_schema import BLOCKS_KNOWN_AFTER_RUN, first_element_suffix, independent_axes
from heuncli.scene.expressions.discontinuities import find_jumps
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.format_couplings import RopeEntry
from heuncli.scene.file_format.format_joints import CurveJoint, RodJoint
from heuncli.scene.file_format.methods import find_tolerance_problem, iter_method_problems
from heuncli.scene.file_format.names import UNTIL, is_name, list_sticking_names, name_sticking_event
from heuncli.scene.file_format.rules.joints import iter_drives
from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule
from heuncli.scene.file_format.semantics import (
    DRIVEN_RATES,
    MAX_SAMPLES,
    find_analysis_type,
    find_driven_coordinate,
    run_duration,
)

if TYPE_CHECKING:
    from heuncli.scene.file_format.rules.outcome import PathTarget


def iter_conditions(draft: DraftDocument) -> Iterator[tuple[Path_, object]]:
    """Yield all conditions with their paths."""
    analysis = draft.document.analysis
    if analysis.until is not None:
        yield ("analysis", UNTIL), analysis.until
    for name, condition in analysis.events.items():
        yield ("analysis", "events", name), condition


def iter_result_conditions(draft: DraftDocument) -> Iterator[tuple[Path_, f.ResultConditionEntry, PathTarget]]:
    """Yield the conditions on results, with the targets of their paths; None where only the run can tell."""
    result_conditions = [
        (path, condition) for path, condition in iter_conditions(draft) if isinstance(condition, f.ResultConditionEntry)
    ]
    if result_conditions:
        from heuncli.scene.file_format.rules.outcome import find_path_target  # a run without any starts faster

        yield from ((path, condition, find_path_target(draft, condition.of)) for path, condition in result_conditions)


@rule("event-name")
def check_event_name(draft: DraftDocument) -> Iterator[Violation]:
    """Events have valid names of their own."""
    for name in draft.document.analysis.events:
        path = ("analysis", "events", name)
        if not is_name(name):
            yield Violation(
                path,
                f"'{name}' is not a valid name",
                "a name starts with a letter and contains only letters, digits and _",
                key=True,
            )
        elif name == UNTIL:
            message = f"'{name}' is reserved: in the results it is the event that ended the motion"
            yield Violation(path, message, f"call it {name}_1, for example", key=True)
    frictions = list_sticking_names(draft.names.entries)
    for k, name in enumerate(frictions):
        event = name_sticking_event(name)
        if event in draft.document.analysis.events:
            message = f"'{event}' is reserved: the friction's own event has this name"
            yield Violation(("analysis", "events", event), message, "give one of them another name", key=True)
        if name in frictions[:k]:
            message = f"{name} is also the name of a friction in forces; both would have the event {event}"
            yield Violation(("couplings", name), message, "give one of them another name", key=True)


@rule("event-motion")
def check_event_motion(draft: DraftDocument) -> Iterator[Violation]:
    """A condition needs a motion in which it can become true."""
    kind = find_analysis_type(draft.document)
    if kind == "motion" or "analysis" in draft.unread:
        return
    for path, _ in iter_conditions(draft):
        message = f"{path[-1]} needs a motion, but type: {kind} is one instant"
        yield Violation(path, message, "give analysis a duration: the maximum length of the run", key=True)


@rule("event-path")
def check_event_path(draft: DraftDocument) -> Iterator[Violation]:
    """`of` leads to one number per instant: of a vector the magnitude, of a series of cuts the whole run."""
    cut_series: dict[str, bool] | None = None
    for path, condition, target in iter_result_conditions(draft):
        from heuncli.scene.file_format.rules.outcome import NumberKind, find_cut_series, find_path_error

        of_path = (*path, "of")
        cut_series = cut_series if cut_series is not None else find_cut_series(draft)
        if (wrong := find_path_error(condition.of, draft.names, cut_series)) is not None:
            yield Violation(of_path, *wrong)
        elif (
            not isinstance(target, NumberKind)
            or not target.is_known
            or condition.of.split(".")[0] in BLOCKS_KNOWN_AFTER_RUN
        ):
            if condition.of.split(".")[0] not in draft.unread:
                message = f"'{condition.of}': this is known only after the run"
                yield Violation(of_path, message, "give a number of joints, sections, coordinates, energy, ...")
        elif not target.is_timed:
            yield Violation(of_path, f"'{condition.of}' does not change in time", "give a number that changes in time")
        elif independent_axes(target.axes):
            hint = f"give one of them, such as {condition.of}{first_element_suffix(target.axes)}"
            yield Violation(of_path, f"'{condition.of}' is several numbers", hint)


@rule("event-limit")
def check_event_limit(draft: DraftDocument) -> Iterator[Violation]:
    """A condition has either a lower or an upper limit, in the dimension of the result."""
    for path, condition, target in iter_result_conditions(draft):
        limits = [key for key in ("below", "above") if getattr(condition, key) is not None]
        if len(limits) != 1:
            message = "below and above are both given" if limits else "neither below nor above is given"
            hint = "write one event for each limit" if limits else "{of: joints.wall.force.x, below: 0}"
            yield Violation(path, message, hint)
        else:
            from heuncli.scene.file_format.rules.expect import check_dimensions
            from heuncli.scene.file_format.rules.outcome import NumberKind

            allowed = target.dimensions if isinstance(target, NumberKind) else ()
            yield from check_dimensions((*path, limits[0]), getattr(condition, limits[0]), allowed)


# Analysis

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
    if analysis.start is not None and find_analysis_type(draft.document) != "motion":
        message = f"start: {analysis.start} is for motions"
        hint = "add a duration; for the rest pose alone: analysis: {type: rest}"
        yield Violation(("analysis", "start"), message, hint, key=True)
    if analysis.type == "impulse" and not draft.names.entries["impulses"]:
        yield Violation(path, "type: impulse without impulses", "impulses: {hit: {on: body.point, vector: [1, 0, 0]}}")


@rule("rest-start")
def check_rest_start(draft: DraftDocument) -> Iterator[Violation]:
    """A search for a rest pose has no start velocities but those of its drives.

    A steady start goes on at the rates that joints have, one of each: it is held as a drive, and a joint takes one.
    """
    document = draft.document
    analysis = document.analysis
    if analysis.type != "rest" and analysis.start is None:
        return
    name_of_start = "type: rest" if analysis.type == "rest" else f"start: {analysis.start}"
    hint = "leave it out, or request a motion" if analysis.type == "rest" else "leave it out, or start as drawn"
    driven = {
        drive.joint: DRIVEN_RATES[coordinate.quantity]
        for drive in document.drives.values()
        if (coordinate := find_driven_coordinate(drive, draft.names.joints.get(drive.joint))) is not None
    }
    for name, joint in document.joints.items():
        initial = getattr(joint, "initial", None)
        keys = [key for key in ("rate", "speed") if driven.get(name) != key and getattr(initial, key, None)]
        path = ("joints", name, "initial")
        if analysis.start != "steady":
            for key in keys:
                yield Violation((*path, key), f"{name_of_start} takes no initial {key}", hint, key=True)
        elif len(keys) > (name not in driven):
            other = f"a {keys[0]}" if name not in driven else f"the {driven[name]} of its drive"
            message = f"start: steady goes on at one rate of a joint; this one has {other} and a {keys[-1]}"
            remedy = f"leave out the {keys[-1]}, or split the joint: a slide and a pin on a body between them"
            yield Violation((*path, keys[-1]), message, remedy, key=True)
    for name, body in document.bodies.items():
        for key in ("velocity", "angular_velocity"):
            value = getattr(body, key)
            if value is not None and any(getattr(value, "vector", value)):
                message = f"{name_of_start} takes no initial {key.replace('_', ' ')}"
                yield Violation(("bodies", name, key), message, hint, key=True)


@rule("tolerance")
def check_tolerance(draft: DraftDocument) -> Iterator[Violation]:
    """A tolerance lies between rounding error and 1."""
    value = draft.document.analysis.tolerance
    problem = find_tolerance_problem(value) if value is not None else None
    if problem is not None:
        yield Violation(("analysis", problem.key), problem.message, problem.hint)


# Methods


def iter_problems_of_code(draft: DraftDocument, code: str) -> Iterator[Violation]:
    """Yield the problems of method and step with one code; no missing step if the analysis could not be read."""
    if "analysis" in draft.unread and code == "fixed-step":
        return
    analysis = draft.document.analysis
    end_time = analysis.duration if analysis.times is None else max(analysis.times, default=None)
    for problem in iter_method_problems(analysis.method, analysis.step, end_time):
        if problem.code == code:
            yield Violation(("analysis", problem.key), problem.message, problem.hint)


@rule("unknown-method")
def check_unknown_method(draft: DraftDocument) -> Iterator[Violation]:
    """The method is one that `heun methods` lists."""
    yield from iter_problems_of_code(draft, "unknown-method")


@rule("fixed-step")
def check_fixed_step(draft: DraftDocument) -> Iterator[Violation]:
    """A method of fixed step has a step, no other method has one."""
    yield from iter_problems_of_code(draft, "fixed-step")


@rule("step")
def check_step(draft: DraftDocument) -> Iterator[Violation]:
    """A step is positive, no longer than the run, and not so short that it needs too many."""
    yield from iter_problems_of_code(draft, "step")


@rule("method-scene")
def check_smooth_for_scipy(draft: DraftDocument) -> Iterator[Violation]:
    """SciPy's methods need a smooth motion: impacts, ends and jumps that depend on the state are refused by name."""
    row = find_method(draft.document.analysis.method)
    if row is None or row.kind != "SciPy" or find_analysis_type(draft.document) != "motion":
        return
    for path, obstacle in iter_nonsmooth_parts(draft):
        yield Violation(path, f"{row.name} cannot handle {obstacle}", SMOOTH_ONLY, key=True)


def iter_nonsmooth_parts(draft: DraftDocument) -> Iterator[tuple[Path_, str]]:
    """Yield what makes a motion non-smooth: stops, ropes, impulses, conditions, drives with jumping rates, loads that
    jump with a coordinate.
    """
    document = draft.document
    for name in document.stops:
        yield ("stops", name), f"the stop {name}"
    for name in document.latches:
        yield ("latches", name), f"the latch {name}"
    for name, joint in document.joints.items():
        if isinstance(joint, RodJoint) and joint.tension_only:
            yield ("joints", name), f"the rope {name}, which may go slack"
        if isinstance(joint, CurveJoint) and joint.one_sided:
            yield ("joints", name), f"the curve {name}, which may lift off"
    for name, coupling in document.couplings.items():
        if isinstance(coupling, RopeEntry) and coupling.tension_only:
            yield ("couplings", name), f"the rope {name}, which may go slack"
    for name in document.impulses:
        yield ("impulses", name), f"the impulse {name}"
    for path, condition in iter_conditions(draft):
        if isinstance(condition, Expression):
            yield path, f"the condition {path[-1]}"
    end = run_duration(document.analysis)
    for name, _, driven in iter_drives(draft):
        if find_jumps(driven.value, end, order=0 if driven.by_rate else 1):
            yield ("drives", name), f"the drive {name}, whose rate jumps"
    for block, entries in (("drives", document.drives), ("forces", document.forces)):
        for name, entry in entries.items():
            for field, value in vars(entry).items():
                for expression in value if isinstance(value, tuple) else (value,):
                    if isinstance(expression, Expression) and expression.uses and expression.held_branches:
                        source = expression.source.strip()
                        yield (block, name, field), f"'{source}', which jumps or bends with a coordinate"
