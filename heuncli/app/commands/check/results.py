"""The results of checks as plain values, their document, a table of failures first, and lines for a GitHub workflow."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from heuncli.app.commands.check.golden import GoldenUpdate
from heuncli.app.commands.check.spec_files import SkippedFolder
from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.output.documents.document import OutputDocument, OutputTable, Sentence, Verbatim, make_text_columns
from heuncli.output.snapshots.outcomes import GOLDEN, Annotation, Outcome, iter_lines
from heuncli.output.tables.nouns import format_count

FAILED = 1


class CheckResult(NamedTuple):
    """The result of one file: its outcomes, or the problems that kept it from being solved, with their exit code.

    messages: lines for standard error
    is_usage_error: the command line itself is wrong; the command ends with a usage error
    """

    path: str
    outcomes: tuple[Outcome, ...] = ()
    problems: tuple[Problem, ...] = ()
    error: int = 0
    seconds: float = 0.0
    messages: tuple[str, ...] = ()
    golden: GoldenUpdate | None = None
    is_usage_error: bool = False

    @property
    def exit_code(self) -> int:
        """The exit code that this file alone would give."""
        return self.error or (0 if all(outcome.has_passed for outcome in self.outcomes) else FAILED)


HEADS = ("file", "of", "at", "expected", "found", "why it fails")
CHANGED = ("file", "of", "at", "golden", "found", "what is rewritten")


class CheckSummary(NamedTuple):
    """All results of the command.

    results: one result per file
    skipped_folders: folders that were not searched
    orphans: golden files without a spec
    strict: whether orphans fail
    """

    results: Sequence[CheckResult]
    skipped_folders: Sequence[SkippedFolder] = ()
    orphans: Sequence[str] = ()
    strict: bool = False


def make_document(check_summary: CheckSummary, form: str) -> OutputDocument:
    """Make the document of the results: a page of failures and of golden files written that ends with its summary, or
    the summary of a job in Markdown that begins with it.
    """
    tables, summary = _make_tables(check_summary), Sentence(format_summary(check_summary))
    if form != "markdown":
        return OutputDocument(parts=[*tables, summary], make_block=lambda: _make_summary_block(check_summary))
    failed = any(result.exit_code for result in check_summary.results) or (
        check_summary.strict and bool(check_summary.orphans)
    )
    notes = [
        Sentence(f"{result.path}: {outcome.note}") for result, outcome in _iter_outcomes(check_summary) if outcome.note
    ]
    errors = [Verbatim(str(problem)) for result in check_summary.results for problem in result.problems]
    title = f"heun check: {'failed' if failed else 'passed'}"
    return OutputDocument(title, parts=[summary, *notes, *tables, *errors], level=3)


def _make_tables(check_summary: CheckSummary) -> list[OutputTable]:
    """Make the tables of failures and of golden files written; those that have rows."""
    failed = [_make_row(result, outcome) for result, outcome in _iter_outcomes(check_summary) if not outcome.has_passed]
    written_rows = [
        _make_row(result, outcome) for result, outcome in _iter_outcomes(check_summary) if _is_written(outcome)
    ]
    tables = (("FAILED", HEADS, failed), ("CHANGED", CHANGED, written_rows))
    return [OutputTable(name, make_text_columns(heads), rows) for name, heads, rows in tables if rows]


def _is_written(outcome: Outcome) -> bool:
    """Return whether --update writes a golden file because of an outcome."""
    return outcome.kind == GOLDEN and outcome.is_warning and bool(outcome.block.get("written"))


def _iter_outcomes(check_summary: CheckSummary) -> Iterator[tuple[CheckResult, Outcome]]:
    """Yield every outcome with the result of its file."""
    for result in check_summary.results:
        for outcome in result.outcomes:
            yield result, outcome


def _make_row(result: CheckResult, outcome: Outcome) -> tuple[str, ...]:
    """Make the row of an outcome: where it is expected, what was found, and why it fails."""
    place = f"{result.path}:{outcome.line}"
    name = f"{outcome.case}: {outcome.subject}" if outcome.case else outcome.subject
    return (place, name, outcome.when, outcome.expected_text, outcome.found_text, outcome.failure or "")


def format_summary(check_summary: CheckSummary) -> str:
    """Format how many expectations passed and failed, and how many specs were not solved or have no checks."""
    outcomes = [outcome for _, outcome in _iter_outcomes(check_summary) if not outcome.is_skipped]
    met = [outcome for outcome in outcomes if outcome.failure is None]
    failed = [outcome for outcome in outcomes if not outcome.has_passed]
    errors = sum(bool(result.error) for result in check_summary.results)
    unchecked = sum(not result.outcomes and not result.error for result in check_summary.results)
    parts = [
        format_count(len(check_summary.results), "spec"),
        f"{format_count(len(met), 'check')} passed",
        f"{len(failed)} failed",
    ]
    parts += [f"{format_count(errors, 'spec')} not solved"] if errors else []
    parts += [f"{format_count(unchecked, 'spec')} {'has' if unchecked == 1 else 'have'} no checks"] if unchecked else []
    without_golden = sum(
        outcome.kind == GOLDEN and outcome.is_warning and not _is_written(outcome) for outcome in outcomes
    )
    parts += [f"{format_count(without_golden, 'spec')} without a golden file"] if without_golden else []
    parts += [f"{escape(folder.path)} skipped" for folder in check_summary.skipped_folders]
    return ", ".join(parts)


def _make_summary_block(check_summary: CheckSummary) -> dict[str, Any]:
    """Return every outcome as the JSON has it, and the error of each spec that was not solved."""
    cases: list[dict[str, Any]] = []
    for result in check_summary.results:
        if result.error:
            message = "\n".join(map(str, result.problems))
            cases.append({"file": result.path, "passed": False, "exit": result.error, "message": message})
        elif not result.outcomes:
            cases.append({"file": result.path, "passed": True, "message": "no acceptance checks are defined"})
        cases += [{"file": result.path} | dict(outcome.block) for outcome in result.outcomes if not outcome.is_skipped]
    cases += [
        {"golden": path, "passed": not check_summary.strict, "message": "a golden file without a spec"}
        for path in check_summary.orphans
    ]
    passed = sum(bool(case["passed"]) for case in cases)
    return {"passed": passed, "failed": len(cases) - passed, "cases": cases}


def render_github(check_summary: CheckSummary) -> str:
    """Render one workflow line per failure and per problem, and the summary."""
    return "".join(iter_lines(_iter_annotations(check_summary))) + format_summary(check_summary) + "\n"


def _iter_annotations(check_summary: CheckSummary) -> Iterator[Annotation]:
    """Yield the lines of a GitHub workflow: a problem, a note, a failure or an orphan each."""
    for result in check_summary.results:
        for problem in result.problems:
            where = problem.location
            place = (where.file, where.line, where.column) if where is not None else (result.path, 1, 1)
            hint = f"\nhint: {problem.hint}" if problem.hint else ""
            yield Annotation("error", f"heun: {problem.code}", f"{problem.message}{hint}", *place)
        for outcome in result.outcomes:
            if outcome.note:
                yield Annotation("notice", "heun: golden", outcome.note, result.path)
            if outcome.failure is None or outcome.is_skipped:
                continue
            kind = "warning" if outcome.is_warning else "error"
            yield Annotation(
                kind, f"heun: {outcome.name}", format_failure(outcome), result.path, outcome.line, outcome.column
            )
    for path in check_summary.orphans:
        yield Annotation(
            "error" if check_summary.strict else "warning", "heun: golden", "a golden file without a spec", path
        )


def format_failure(outcome: Outcome) -> str:
    """Format an outcome: why it fails, the expected, the found and the allowed value, one per line."""
    values = (("expected", outcome.expected_text), ("found", outcome.found_text), ("allowed", outcome.tolerance_text))
    parts = [f"{name} {value}" for name, value in values if value]
    return "\n".join([outcome.failure or "", *parts])
