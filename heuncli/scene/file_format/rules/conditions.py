"""Conditions that end a motion or are watched in it: of motions alone, on numbers that the results will have."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from heuncli.results.results_schema import AFTER_THE_RUN, beside_magnitudes, spelled_first
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.names import UNTIL, is_name
from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule
from heuncli.scene.file_format.semantics import type_of

if TYPE_CHECKING:
    from heuncli.scene.file_format.rules.outcome import Result


def conditions(draft: DraftDocument) -> Iterator[tuple[Path_, object]]:
    """All conditions with their paths."""
    analysis = draft.document.analysis
    if analysis.until is not None:
        yield ("analysis", UNTIL), analysis.until
    for name, given in analysis.events.items():
        yield ("analysis", "events", name), given


def on_results(draft: DraftDocument) -> Iterator[tuple[Path_, f.ResultConditionEntry, Result]]:
    """Those on numbers of the results, with what their paths lead to; None where only the run can tell."""
    on_paths = [(path, given) for path, given in conditions(draft) if isinstance(given, f.ResultConditionEntry)]
    if on_paths:
        from heuncli.scene.file_format.rules.outcome import reached_in  # a run without any starts faster

        yield from ((path, given, reached_in(draft, given.of)) for path, given in on_paths)


@rule("event-name")
def event_name(draft: DraftDocument) -> Iterator[Violation]:
    """Events have names of their own."""
    for name in draft.document.analysis.events:
        path = ("analysis", "events", name)
        if not is_name(name):
            yield Violation(path, f"'{name}' is not a name", "a name is a letter, then letters, digits and _", key=True)
        elif name == UNTIL:
            message = f"'{name}' is taken: by it results tell what ended the motion"
            yield Violation(path, message, f"call it {name}_1, say", key=True)


@rule("event-motion")
def event_motion(draft: DraftDocument) -> Iterator[Violation]:
    """Only in a motion does anything become true."""
    kind = type_of(draft.document)
    if kind == "motion" or "analysis" in draft.unread:
        return
    for path, _ in conditions(draft):
        message = f"{path[-1]}: type: {kind} is one instant, at which nothing changes"
        yield Violation(path, message, "give analysis a duration, the longest that is to be waited", key=True)


@rule("event-path")
def event_path(draft: DraftDocument) -> Iterator[Violation]:
    """`of` leads to a number at each instant: of a vector its magnitude counts, of a run of cuts its whole stretch."""
    runs: dict[str, bool] | None = None
    for path, given, found in on_results(draft):
        from heuncli.scene.file_format.rules.outcome import NumberKind, runs_of, wrong_path

        where = (*path, "of")
        runs = runs if runs is not None else runs_of(draft)
        if (wrong := wrong_path(given.of, draft.names, runs)) is not None:
            yield Violation(where, *wrong)
        elif not isinstance(found, NumberKind) or not found.known or given.of.split(".")[0] in AFTER_THE_RUN:
            if given.of.split(".")[0] not in draft.unread:
                message = f"'{given.of}': only the run can tell what that is"
                yield Violation(where, message, "name a number of joints, sections, coordinates, energy, ...")
        elif not found.timed:
            yield Violation(where, f"'{given.of}' does not run over the instants", "name a number that changes in time")
        elif beside_magnitudes(found.axes):
            hint = f"name one of them, as {given.of}{spelled_first(found.axes)}"
            yield Violation(where, f"'{given.of}' is several numbers", hint)


@rule("event-limit")
def event_limit(draft: DraftDocument) -> Iterator[Violation]:
    """A number is below one limit or above one, in its dimension."""
    for path, given, found in on_results(draft):
        limits = [key for key in ("below", "above") if getattr(given, key) is not None]
        if len(limits) != 1:
            message = "both below and above" if limits else "neither below nor above"
            hint = "one event a limit" if limits else "{of: joints.wall.force.x, below: 0}"
            yield Violation(path, message, hint)
        else:
            from heuncli.scene.file_format.rules.expect import dimensions
            from heuncli.scene.file_format.rules.outcome import NumberKind

            known = found.dimensions if isinstance(found, NumberKind) else ()
            yield from dimensions((*path, limits[0]), getattr(given, limits[0]), known)
