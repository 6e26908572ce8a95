"""Rules about conditions that end a motion or are monitored in it: only in motions, on numbers that the results
have.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from heuncli.results.results_schema import BLOCKS_KNOWN_AFTER_RUN, first_element_suffix, independent_axes
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.names import UNTIL, is_name
from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule
from heuncli.scene.file_format.semantics import find_analysis_type

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
    runs: dict[str, bool] | None = None
    for path, condition, target in iter_result_conditions(draft):
        from heuncli.scene.file_format.rules.outcome import NumberKind, find_cut_runs, find_path_error

        of_path = (*path, "of")
        runs = runs if runs is not None else find_cut_runs(draft)
        if (wrong := find_path_error(condition.of, draft.names, runs)) is not None:
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
