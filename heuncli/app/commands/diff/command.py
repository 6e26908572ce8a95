"""`heun diff`: compare two specs, golden files or results, and list what changed by more than their stated errors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated

from heuncli.app.cli.documents import UNLIMITED, emit_document
from heuncli.app.cli.options import OUTPUT, QUIET, TIME_LIMIT_EACH, Option
from heuncli.app.cli.output import emit, print_stderr
from heuncli.app.cli.target import choose_format, require_other_file
from heuncli.app.commands.diff.page import CaseChange, Difference, make_document, render_github, sort_changes
from heuncli.app.commands.diff.sides import (
    RESULT,
    Side,
    read_side,
    require_same_kind,
    restrict_to_common_instants,
    solve_side,
)
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.output.snapshots.change import Change
from heuncli.output.snapshots.changes import EXTRA, MISSING, find_changes
from heuncli.output.snapshots.golden_file import RunSnapshot

FORMATS = ("table", "json", "markdown", "github")


class DiffRequest(NamedTuple):
    """The options and arguments of `heun diff`."""

    before: Annotated[
        str, Option((), "A spec, a golden file, or a result of heun run --format json.", "A", completes="spec")
    ]
    after: Annotated[str, Option((), "The changed version, likewise.", "B", completes="spec")]
    format: Annotated[str | None, Option(("--format",), "Output format. Default: table.", "|".join(FORMATS))] = None
    output: Annotated[str | None, OUTPUT] = None
    exit_code: Annotated[bool, Option(("--exit-code",), "Exit with 1 if anything changed.")] = False
    time_limit_each: Annotated[float | None, TIME_LIMIT_EACH] = None
    quiet: Annotated[bool, QUIET] = False


CHANGED = 1  # exit code of --exit-code
SAMPLED = "JSON results hold samples only: values between samples are not compared"
OTHER_SPEC = "the spec files differ"
HOLDS_LESS = (
    "{} was written by an earlier version without mean values, so less is compared; heun check --update renews it"
)


def main(request: DiffRequest) -> int:
    """Run the command; returns the exit code."""
    form = choose_format(request.format, request.output, FORMATS)
    require_other_file(request.output, [request.before, request.after])
    before, after = read_side(request.before), read_side(request.after)
    require_same_kind(before, after)
    notes: list[str] = []
    if before.kind == RESULT:
        before, after, notes = restrict_to_common_instants(before, after)
        notes.append(SAMPLED)
    before, warnings = solve_side(before, _list_even_instants(after), request.time_limit_each)
    after, other_warnings = solve_side(after, _list_even_instants(before), request.time_limit_each)
    for line in [] if request.quiet else dict.fromkeys([*warnings, *other_warnings]):
        print_stderr(line)
    require_other_file(request.output, [request.before, request.after])  # the tables of specs, too
    difference = _compare_sides(before, after, notes)
    if form == "github":
        emit(render_github(difference), request.output)
    else:
        emit_document(make_document(difference, form), form, request.output, style=UNLIMITED)
    return CHANGED if difference.changes and request.exit_code else 0


def _compare_sides(old: Side, new: Side, notes: Sequence[str]) -> Difference:
    """Compare all runs of two sides; adds remarks about the files to the notes."""
    changes = [
        CaseChange(case, change)
        for case, old_run, new_run in _pair_runs(old, new)
        for change in _compare_runs(old_run, new_run)
    ]
    compared_count = sum(len(run.numbers) + len(run.certain_sums) + len(run.open) for run in new.runs.values())
    is_other_spec = bool(old.digest and new.digest) and old.digest != new.digest
    file_notes = [OTHER_SPEC] if is_other_spec and not changes else []
    file_notes += [HOLDS_LESS.format(escape(side.path)) for side in (old, new) if not side.holds_courses]
    return Difference(old.path, new.path, sort_changes(changes), compared_count, [*notes, *file_notes])


def _list_even_instants(side: Side) -> Mapping[str, Sequence[float]]:
    """Return the instants at equal steps of a side, by load case."""
    return {case: run.even_at for case, run in side.runs.items()}


def _pair_runs(old: Side, new: Side) -> list[tuple[str, RunSnapshot | None, RunSnapshot | None]]:
    """Pair the runs of both sides by their names; None where a side has none."""
    names = dict.fromkeys([*old.runs, *new.runs])
    return [(name, old.runs.get(name), new.runs.get(name)) for name in names]


def _compare_runs(old: RunSnapshot | None, new: RunSnapshot | None) -> list[Change]:
    """List what changed in a run; one change if only one side has it."""
    if old is None or new is None:
        return [Change("the case", "", "", None, None, reason=EXTRA if old is None else MISSING)]
    return find_changes(old, new)
