"""`heun diff`: compare two specs, golden files or results, and list what changed by more than their stated errors."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import PurePath
from types import MappingProxyType
from typing import Annotated, Any

from heuncli.app.cli import timeout
from heuncli.app.cli.documents import UNLIMITED, emit_document
from heuncli.app.cli.entry import UsageError, run_contained
from heuncli.app.cli.options import OUTPUT, QUIET, TIME_LIMIT_EACH, Option
from heuncli.app.cli.output import emit, print_stderr
from heuncli.app.cli.solving import format_warnings
from heuncli.app.cli.target import choose_format, require_other_file
from heuncli.base.errors import Finding, HeunError, Problem, SourceLocation
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.output.documents.document import OutputDocument, OutputTable, Part, Sentence, make_text_columns
from heuncli.output.snapshots.change import Change, format_difference, format_value
from heuncli.output.snapshots.changes import EXTRA, MISSING, THROUGHOUT, find_changes
from heuncli.output.snapshots.golden_file import RunSnapshot, is_text_cut_off, validate_golden_data
from heuncli.output.snapshots.json_results import find_common_instants, read_instants, read_run_snapshot
from heuncli.output.snapshots.outcomes import Annotation, iter_lines
from heuncli.output.snapshots.take_snapshot import take_run_snapshot
from heuncli.output.tables.nouns import format_count
from heuncli.output.tables.report_selection import find_default_reports
from heuncli.scene.file_format.load import load_with_cases
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes
from heuncli.study.model.options import Options
from heuncli.study.model.selection import Selection
from heuncli.study.workflow import solve

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
    """Pair the runs of both sides by their names; None where a side has none."""
    names = dict.fromkeys([*old.runs, *new.runs])
    return [(name, old.runs.get(name), new.runs.get(name)) for name in names]


def _compare_runs(old: RunSnapshot | None, new: RunSnapshot | None) -> list[Change]:
    """List what changed in a run; one change if only one side has it."""
    if old is None or new is None:
        return [Change("the case", "", "", None, None, reason=EXTRA if old is None else MISSING)]
    return find_changes(old, new)


HEADS = ("quantity", "at", "before", "after", "change", "allowed")
WORDS = {  # word of a change in JSON -> its text in tables
    EXTRA: "only in the second", MISSING: "only in the first", THROUGHOUT: "all times", "verdict": "status",
    "certain": "determinate",
}  # fmt: skip
MAX_ROWS = 200  # of a table; JSON holds all


class Difference(NamedTuple):
    """The difference of two files.

    old_path, new_path: their paths
    changes: each with its load case
    compared_count: how many numbers were compared
    notes: remarks for the user
    """

    old_path: str
    new_path: str
    changes: Sequence[tuple[str, Change]]
    compared_count: int
    notes: Sequence[str] = ()


def sort_changes(changes: Sequence[tuple[str, Change]]) -> list[tuple[str, Change]]:
    """Sort changes: verdicts and counts first, then numbers by their change relative to the larger of the two."""
    return sorted(changes, key=lambda pair: (-pair[1].relative, pair[0], pair[1].path, pair[1].what))


def make_document(difference: Difference, form: str) -> OutputDocument:
    """Make the document of a difference: a page that ends with its summary, or a comment in Markdown that begins with
    it.
    """
    notes = list(map(Sentence, difference.notes))
    table = _make_table(difference)
    if form == "markdown":
        paths = Sentence(f"{difference.old_path} → {difference.new_path}")
        return OutputDocument(f"heun diff: {format_summary(difference)}", parts=[paths, table, *notes], level=3)
    omitted = len(difference.changes) - MAX_ROWS
    more = [Sentence(f"{omitted} more: --format json")] if omitted > 0 else []
    parts: list[Part] = [table, *more, Sentence(format_summary(difference)), *notes]
    return OutputDocument(parts=parts, make_block=lambda: _make_difference_block(difference))


def _make_table(difference: Difference) -> OutputTable:
    """Make the table of the first changes."""
    rows = [_make_row(case, change) for case, change in difference.changes[:MAX_ROWS]]
    return OutputTable("CHANGED", make_text_columns(HEADS), rows)


def _make_row(case: str, change: Change) -> tuple[str, ...]:
    """Make the row of a change: both values, the difference, and how large it may be."""
    name = f"{case}: {change.path}" if case else change.path
    change_text = WORDS.get(change.reason, change.reason) or format_difference(change)
    change_text += f"; and {change.n_similar} more values" if change.n_similar else ""
    allowed = f"{change.tolerance:.2g}" if change.tolerance and not change.reason else ""
    values = (WORDS.get(text, text) for text in (format_value(x, change.unit) for x in (change.old, change.new)))
    at = "" if change.what in (EXTRA, MISSING) else WORDS.get(change.what, change.what)
    return (name, at, *values, change_text, allowed)


def format_summary(difference: Difference) -> str:
    """Format how many quantities changed, and how many were compared."""
    if not difference.changes:
        return f"no change exceeds both stated errors: {format_count(difference.compared_count, 'quantity')} compared"
    return (
        f"{format_count(len(difference.changes), 'change')}, "
        f"{format_count(difference.compared_count, 'quantity')} compared"
    )


def _make_difference_block(difference: Difference) -> dict[str, Any]:
    """Return every change as the JSON has it."""
    changed = [_make_block(case, change) for case, change in difference.changes]
    return {
        "before": difference.old_path,
        "after": difference.new_path,
        "compared": difference.compared_count,
        "notes": list(difference.notes),
        "changes": changed,
    }


def _make_block(case: str, change: Change) -> dict[str, Any]:
    """Return a change as the JSON has it."""
    relative = change.relative if change.difference is not None else None
    return {
        **({"case": case} if case else {}), "of": change.path, "at": change.what, "unit": change.unit,
        "before": change.old, "after": change.new, "difference": change.difference, "relative": relative,
        "allowed": change.tolerance, "why": change.reason, "alike": change.n_similar,
    }  # fmt: skip


def render_github(difference: Difference) -> str:
    """Render one workflow line per change, and the summary."""
    annotations = (
        Annotation("warning", f"heun: {' '.join(row[:2]).strip()}", _format_change(row), difference.new_path)
        for row in (_make_row(case, change) for case, change in difference.changes)
    )
    return "".join(iter_lines(annotations)) + format_summary(difference) + "\n"


def _format_change(row: Sequence[str]) -> str:
    """Format the values and the change of a row on two lines, for an annotation."""
    values = f"{row[2]} → {row[3]}" if row[2] or row[3] else ""
    return "\n".join(part for part in (values, row[4]) if part)


SPECS = frozenset({".yaml", ".yml"})
MAX_BYTES = 512_000_000
SPEC, GOLDEN, RESULT = "spec", "golden", "result"


NO_RESULTS: Mapping[str, Any] = MappingProxyType({})


class NotComparedError(HeunError):
    """A file that cannot be compared."""

    exit_code = 2


class Side(NamedTuple):
    """One side of a comparison.

    path: its file
    kind: spec, golden file or result
    runs: its runs by load case ("" is the scene as it is); empty for a spec that is not solved yet
    results: the JSON of a result, by load case
    digest: the digest of its spec, if known
    holds_courses: whether its runs hold means and the instants of extremes, with their errors
    """

    path: str
    kind: str
    runs: Mapping[str, RunSnapshot]
    results: Mapping[str, Mapping[str, Any]] = NO_RESULTS
    digest: str = ""
    holds_courses: bool = True


def read_side(path: str) -> Side:
    """Read what stands at a path; a spec is not read yet. Raises NotComparedError."""
    if path == STANDARD_INPUT or PurePath(path).suffix in SPECS:
        return Side(path, SPEC, {})
    try:
        data = _parse_json(bytes(read_bytes(path, MAX_BYTES)))
        if "format" in data:
            golden = validate_golden_data(data)
            runs = {"": golden.base, **golden.cases}
            return Side(path, GOLDEN, runs, digest=golden.spec.sha256, holds_courses=golden.has_courses)
        results = data["cases"] if isinstance(data.get("cases"), dict) else {"": data}
        runs = {name: read_run_snapshot(one) for name, one in results.items()}
        return Side(path, RESULT, runs, results, _find_digest(results))
    except Finding as finding:
        place = SourceLocation(path, 1, 1)
        raise NotComparedError(Problem(finding.code, finding.message, place, finding.hint)) from None


def _find_digest(results: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the digest of the spec that the results belong to, or an empty text if they do not name a single one."""
    specs = [one["spec"] for one in results.values() if isinstance(one.get("spec"), dict)]
    digests = {str(spec.get("sha256", "")) for spec in specs}
    return digests.pop() if len(digests) == 1 else ""


def restrict_to_common_instants(old: Side, new: Side) -> tuple[Side, Side, list[str]]:
    """Restrict two results to the instants that both have; returns them and notes about that. Raises UsageError if
    there are none.
    """
    notes: list[str] = []
    sides = [dict(side.runs) for side in (old, new)]
    for name in old.results.keys() & new.results.keys():
        both = old.results[name], new.results[name]
        common = find_common_instants(*both)
        n = [len(read_instants(one)) for one in both]
        if len(common[0]) == n[0] == n[1]:
            continue
        prefix = f"case {name}: " if name else ""
        if not common[0]:
            hint = (
                "run both with the same analysis.samples; heun diff of the two specs compares the full time histories"
            )
            message = f"{prefix}{old.path} and {new.path} have no instant in common and are not compared"
            raise UsageError(Problem("bad-option", message, hint=hint))
        for runs, one, indices in zip(sides, both, common, strict=True):
            runs[name] = read_run_snapshot(one, indices)
        text = f"{prefix}the results have different instants: {len(common[0])} of {n[0]} and {n[1]} are common"
        notes.append(f"{text}, and only these are compared")
    return old._replace(runs=sides[0]), new._replace(runs=sides[1]), notes


def _parse_json(content: bytes) -> dict[str, Any]:
    """Parse the JSON object of a file. Raises Finding [not-a-result]."""
    hint = "a spec ends in .yaml; a golden file or a result is JSON"
    try:
        data = json.loads(content)
    except (ValueError, RecursionError) as error:
        text = content.decode("utf-8", "replace")
        whole = "it is incomplete; " * is_text_cut_off(text, error)
        raise Finding("not-a-result", f"this is not JSON: {whole}{error!s:.100}", hint) from None
    if not isinstance(data, dict):
        raise Finding("not-a-result", "this is JSON, but neither a result nor a golden file", hint)
    return data


def solve_side(side: Side, even_at: Mapping[str, Sequence[float]], limit: float | None) -> tuple[Side, list[str]]:
    """Solve a side that is a spec; returns it with its numbers, and its warnings.

    even_at: instants at equal steps of the other side, by load case
    """
    if side.kind != SPEC:
        return side, []
    work = partial(timeout.run_with_limit, partial(_solve_spec, side.path, even_at), limit, subject=side.path)
    runs, warnings, digest = run_contained(work, ("diff", side.path))
    return side._replace(runs=runs, digest=digest), warnings


def _solve_spec(path: str, even_at: Mapping[str, Sequence[float]]) -> tuple[dict[str, RunSnapshot], list[str], str]:
    """Solve a spec and its cases; returns their snapshots by name, the warnings, and the spec's digest."""
    spec, cases = load_with_cases(path, checking=False)
    runs: dict[str, RunSnapshot] = {}
    warnings: list[str] = []
    for name, one in {"": spec, **cases}.items():
        reports = find_default_reports(one)
        study = solve(one, Options(requested_reports=Selection(reports).reports, time_limit=timeout.remaining_time()))
        runs[name] = take_run_snapshot(study, reports, even_at.get(name, ()))
        place = f"heun: {path}: case {name}" if name else f"heun: {path}"
        warnings += format_warnings(one, study.results, place, study.later_warnings)
    timeout.disarm()
    return runs, warnings, spec.sha256


def require_same_kind(old: Side, new: Side) -> None:
    """Raise UsageError if only one side is a result: its extremes are those of its samples."""
    if (old.kind == RESULT) != (new.kind == RESULT):
        other, result = (old, new) if new.kind == RESULT else (new, old)
        hint = f"use heun run SPEC --format json for both; {result.path} holds samples only"
        message = f"{result.path} is a result, {other.path} a {other.kind}: these cannot be compared"
        raise UsageError(Problem("bad-option", message, hint=hint))
