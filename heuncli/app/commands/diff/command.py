"""`heun diff`: what changed between two specs, golden files or results by more than both state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.output import emit, say
from heuncli.app.cli.target import format_of
from heuncli.app.commands.diff.request import FORMATS, DiffRequest
from heuncli.app.commands.diff.sides import RESULT, Side, at_common_instants, require_alike, side_of, solved
from heuncli.app.commands.diff.told import FORMS, Difference, ordered
from heuncli.base.foreign_text import shown
from heuncli.output.snapshots.change import Change
from heuncli.output.snapshots.changes import EXTRA, MISSING, changes
from heuncli.output.snapshots.kept import KeptRun

CHANGED = 1
SAMPLED = "results in JSON hold samples: what lies between these is not compared"
OTHER_SPEC = "the specs are not the same text"
HOLDS_LESS = "{} was kept by an earlier version without means, so less is compared; heun check --update renews it"


def main(request: DiffRequest) -> int:
    """Run the command; returns the exit code."""
    form = format_of(request.format, request.output, FORMATS)
    require_other_file(request.output, [request.before, request.after])
    before, after = side_of(request.before), side_of(request.after)
    require_alike(before, after)
    notes: list[str] = []
    if before.kind == RESULT:
        before, after, notes = at_common_instants(before, after)
        notes.append(SAMPLED)
    before, said = solved(before, _even(after), request.time_limit_each)
    after, more = solved(after, _even(before), request.time_limit_each)
    for line in [] if request.quiet else dict.fromkeys([*said, *more]):
        say(line)
    require_other_file(request.output, [request.before, request.after])  # the tables of specs, too
    found = [(case, change) for case, one, other in _pairs(before, after) for change in _changes(one, other)]
    compared = sum(len(run.numbers) + len(run.certain_sums) + len(run.open) for run in after.runs.values())
    notes += [OTHER_SPEC] if not found and before.digest and after.digest and before.digest != after.digest else []
    notes += [HOLDS_LESS.format(shown(side.path)) for side in (before, after) if not side.holds_courses]
    emit(FORMS[form](Difference(request.before, request.after, ordered(found), compared, notes)), request.output)
    return CHANGED if found and request.exit_code else 0


def _even(side: Side) -> Mapping[str, Sequence[float]]:
    """The even instants at which a side is known, by load case."""
    return {case: run.even_at for case, run in side.runs.items()}


def _pairs(before: Side, after: Side) -> list[tuple[str, KeptRun | None, KeptRun | None]]:
    names = dict.fromkeys([*before.runs, *after.runs])
    return [(name, before.runs.get(name), after.runs.get(name)) for name in names]


def _changes(before: KeptRun | None, after: KeptRun | None) -> list[Change]:
    if before is None or after is None:
        return [Change("the case", "", "", None, None, why=EXTRA if before is None else MISSING)]
    return changes(before, after)
