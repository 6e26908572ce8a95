"""What was checked as text: a table of failures, JSON, markdown for a summary, lines for a GitHub workflow."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from heuncli.app.commands.check.checked import Checked
from heuncli.app.commands.check.folders import PassedBy
from heuncli.base.foreign_text import shown
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.snapshots.outcomes import KEPT, Outcome
from heuncli.output.tables.export import dump
from heuncli.output.tables.markdown_text import escape_line, fence_text
from heuncli.output.tables.plurals import count
from heuncli.output.tables.text_table import TextColumn, TextTable, markdown, plain
from heuncli.output.tables.workflow_lines import Annotation, lines

HEADS = ("file", "of", "at", "expected", "found", "why it fails")
CHANGED = ("file", "of", "at", "kept", "found", "what is written anew")


class AllChecked(NamedTuple):
    """All that is told: the files, the folders passed by, golden files without a spec, whether these fail."""

    checked: Sequence[Checked]
    skipped: Sequence[PassedBy] = ()
    orphans: Sequence[str] = ()
    strict: bool = False


def table(told: AllChecked) -> str:
    """The failures as a table, what is written anew as another, and a line that sums it up."""
    parts = [plain(part) + "\n" for part in _tables(told)]
    return "".join(parts) + summary(told) + "\n"


def in_markdown(told: AllChecked) -> str:
    """The same for the summary of a job."""
    failed = any(one.exit_code for one in told.checked) or (told.strict and bool(told.orphans))
    notes = [f"{one.path}: {outcome.note}" for one, outcome in _all(told) if outcome.note]
    head = f"### heun check: {'failed' if failed else 'passed'}\n\n{escape_line(summary(told))}\n"
    head += "".join(f"\n{escape_line(note)}\n" for note in notes)
    tables = "".join("\n" + markdown(part) for part in _tables(told))
    errors = [str(problem) for one in told.checked for problem in one.problems]
    return head + tables + "".join(f"\n{fence_text(text)}\n" for text in errors)


def _tables(told: AllChecked) -> list[TextTable]:
    failed = [_row(one, outcome) for one, outcome in _all(told) if not outcome.passed]
    anew = [_row(one, outcome) for one, outcome in _all(told) if _is_written(outcome)]
    made = (("FAILED", HEADS, failed), ("CHANGED", CHANGED, anew))
    return [_table(name, heads, rows) for name, heads, rows in made if rows]


def _table(name: str, heads: Sequence[str], rows: Sequence[tuple[str, ...]]) -> TextTable:
    return TextTable(name, tuple(TextColumn(head, "left") for head in heads), tuple(rows))


def _is_written(outcome: Outcome) -> bool:
    return outcome.kind == KEPT and outcome.warned and bool(outcome.block.get("written"))


def _all(told: AllChecked) -> Iterator[tuple[Checked, Outcome]]:
    for one in told.checked:
        for outcome in one.outcomes:
            yield one, outcome


def _row(one: Checked, outcome: Outcome) -> tuple[str, ...]:
    place = f"{one.path}:{outcome.line}"
    of = f"{outcome.case}: {outcome.of}" if outcome.case else outcome.of
    return tuple(map(shown, (place, of, outcome.when, outcome.expected, outcome.found, outcome.failure or "")))


def summary(told: AllChecked) -> str:
    """How many passed, failed, were not solved or ran with nothing expected."""
    outcomes = [outcome for _, outcome in _all(told) if not outcome.skipped]
    held = [outcome for outcome in outcomes if outcome.failure is None]
    failed = [outcome for outcome in outcomes if not outcome.passed]
    errors = sum(bool(one.error) for one in told.checked)
    silent = sum(not one.outcomes and not one.error for one in told.checked)
    parts = [count(len(told.checked), "spec"), f"{len(held)} passed", f"{len(failed)} failed"]
    parts += [f"{count(errors, 'spec')} not solved"] if errors else []
    parts += [f"{count(silent, 'spec')} ran with nothing expected"] if silent else []
    bare = sum(outcome.kind == KEPT and outcome.warned and not _is_written(outcome) for outcome in outcomes)
    parts += [f"{count(bare, 'spec')} without a golden file"] if bare else []
    parts += [f"{shown(folder.path)} passed by" for folder in told.skipped]
    return ", ".join(parts)


def in_json(told: AllChecked) -> str:
    """Every case; of a spec that was not solved its error."""
    cases: list[dict[str, Any]] = []
    for one in told.checked:
        if one.error:
            message = "\n".join(map(str, one.problems))
            cases.append({"file": one.path, "passed": False, "exit": one.error, "message": message})
        elif not one.outcomes:
            cases.append({"file": one.path, "passed": True, "message": "ran; nothing expected"})
        cases += [{"file": one.path} | dict(outcome.block) for outcome in one.outcomes if not outcome.skipped]
    cases += [
        {"golden": path, "passed": not told.strict, "message": "a golden file without a spec"} for path in told.orphans
    ]
    passed = sum(bool(case["passed"]) for case in cases)
    return dump({"passed": passed, "failed": len(cases) - passed, "cases": cases})


def for_github(told: AllChecked) -> str:
    """A line for each failure and each problem, and the sum of it all."""
    return "".join(lines(_annotations(told))) + summary(told) + "\n"


def _annotations(told: AllChecked) -> Iterator[Annotation]:
    for one in told.checked:
        for problem in one.problems:
            where = problem.location
            place = (where.file, where.line, where.column) if where is not None else (one.path, 1, 1)
            hint = f"\nhint: {problem.hint}" if problem.hint else ""
            yield Annotation("error", f"heun: {problem.code}", f"{problem.message}{hint}", *place)
        for outcome in one.outcomes:
            if outcome.note:
                yield Annotation("notice", "heun: golden", outcome.note, one.path)
            if outcome.failure is None or outcome.skipped:
                continue
            kind = "warning" if outcome.warned else "error"
            yield Annotation(kind, f"heun: {outcome.name}", words(outcome), one.path, outcome.line, outcome.column)
    for path in told.orphans:
        yield Annotation("error" if told.strict else "warning", "heun: golden", "a golden file without a spec", path)


def words(outcome: Outcome) -> str:
    """Found, expected, allowed and why it fails, a line each."""
    given = (("expected", outcome.expected), ("found", outcome.found), ("allowed", outcome.allowed))
    parts = [f"{name} {value}" for name, value in given if value]
    return "\n".join([outcome.failure or "", *parts])


FORMS = {"table": table, "json": in_json, "markdown": in_markdown, "github": for_github}
