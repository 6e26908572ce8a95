"""`heun diff`: compare two specs, golden files or results, and list what changed by more than their stated errors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from heuncli.app.cli.documents import UNLIMITED, emit_document
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.output import emit, print_stderr
from heuncli.app.cli.target import choose_format
from heuncli.app.commands.diff.page import Difference, make_document, render_github, sort_changes
from heuncli.app.commands.diff.request import FORMATS, DiffRequest
from heuncli.app.commands.diff.sides import (
    RESULT,
    Side,
    read_side,
    require_same_kind,
    restrict_to_common_instants,
    solve_side,
)
from heuncli.base.text_safety import escape
from heuncli.output.snapshots.change import Change
from heuncli.output.snapshots.changes import EXTRA, MISSING, find_changes
from heuncli.output.snapshots.golden_file import RunSnapshot

CHANGED = 1
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
    changed = [(case, change) for case, one, other in _pair_runs(before, after) for change in _compare_runs(one, other)]
    compared = sum(len(run.numbers) + len(run.certain_sums) + len(run.open) for run in after.runs.values())
    notes += [OTHER_SPEC] if not changed and before.digest and after.digest and before.digest != after.digest else []
    notes += [HOLDS_LESS.format(escape(side.path)) for side in (before, after) if not side.holds_courses]
    difference = Difference(request.before, request.after, sort_changes(changed), compared, notes)
    if form == "github":
        emit(render_github(difference), request.output)
    else:
        emit_document(make_document(difference, form), form, request.output, style=UNLIMITED)
    return CHANGED if changed and request.exit_code else 0


def _list_even_instants(side: Side) -> Mapping[str, Sequence[float]]:
    """Return the instants at equal steps of a side, by load case."""
    return {case: run.even_at for case, run in side.runs.items()}


def _pair_runs(old: Side, new: Side) -> list[tuple[str, RunSnapshot | None, RunSnapshot | None]]:
    names = dict.fromkeys([*old.runs, *new.runs])
    return [(name, old.runs.get(name), new.runs.get(name)) for name in names]


def _compare_runs(old: RunSnapshot | None, new: RunSnapshot | None) -> list[Change]:
    if old is None or new is None:
        return [Change("the case", "", "", None, None, reason=EXTRA if old is None else MISSING)]
    return find_changes(old, new)
