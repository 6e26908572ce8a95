"""The document of published cases: a row for each case, or every number of those that are named."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from heuncli.analyses.published.cases import KINDS, PublishedCase
from heuncli.analyses.published.comparison import AGREES, NumberComparison, TableComparison
from heuncli.app.commands.check.results import CheckResult
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.document import (
    Cell,
    Facts,
    NumberCell,
    OutputColumn,
    OutputDocument,
    OutputTable,
    Part,
    Sentence,
    make_text_columns,
)
from heuncli.output.snapshots.outcomes import Outcome
from heuncli.output.tables.nouns import format_count

REFERENCE = "reference"
CASES = ("case", "description", "numbers", "kind", "digits", "in last digits", "relative", "verdict")
NUMBER_COLUMNS = (
    OutputColumn("quantity", "path"),
    *make_text_columns(("at", "published", "heun", "difference", "in last digits", "heun error")),
    OutputColumn("verdict", "verdict"),
)
NEGLIGIBLE = 1e-12  # of the largest number of a table; larger differences are shown


class ReferenceResult(NamedTuple):
    """The result of a published case: its tables with heun's numbers, and a check result for reports and exit codes."""

    case: PublishedCase
    tables: tuple[TableComparison, ...]
    check: CheckResult

    @property
    def exit_code(self) -> int:
        """The exit code that this case alone would give."""
        return self.check.exit_code

    @property
    def numbers(self) -> list[NumberComparison]:
        """All numbers of the case."""
        return [number for table in self.tables for number in table.numbers]


def iter_outcomes(tables: Sequence[TableComparison]) -> Iterator[Outcome]:
    """Convert the comparisons to outcomes of a spec, for the reports of pipelines."""
    for table in tables:
        for comparison in table.numbers:
            verdict = comparison.verdict
            failure = None if verdict == AGREES else f"{verdict}: off by {comparison.difference:.3g}"
            yield Outcome(
                REFERENCE,
                comparison.number.path,
                failure,
                comparison.number.line,
                case=table.table.case,
                when=_format_instant(comparison),
                expected_text=comparison.published.text,
                found_text=_format_number(comparison),
                tolerance_text=f"{comparison.tolerance:.3g}",
                block=_make_number_block(comparison),
            )


def make_document(results: Sequence[ReferenceResult], form: str, *, show_numbers: bool) -> OutputDocument:
    """Make the document: a row per case, or with `show_numbers` the source and all numbers of each, and a summary."""
    parts: list[Part] = []
    if not show_numbers:
        parts += _make_case_tables(results)
    for result in results if show_numbers else ():
        if form != "markdown":
            what = [("case", result.case.name), ("what", result.case.description), ("source", result.case.source)]
            parts.append(Facts([*what, ("spec", f"heun new {result.case.name}")]))
        heading = f"{result.case.description}  {result.case.source}" if form == "markdown" else ""
        parts.append(OutputTable(heading, NUMBER_COLUMNS, list(_iter_number_rows(result))))
    return OutputDocument(
        parts=[*parts, Sentence(format_summary(results))], make_block=lambda: _make_results_block(results)
    )


def _make_results_block(results: Sequence[ReferenceResult]) -> dict[str, Any]:
    """Return every number of every case as the JSON has it."""
    numbers = [number for result in results for number in result.numbers]
    passed = sum(number.verdict == AGREES for number in numbers)
    broken = sum(bool(result.check.error) for result in results)
    blocks = [_make_block(result) for result in results]
    return {"passed": passed, "failed": len(numbers) - passed + broken, "cases": blocks}


def format_summary(results: Sequence[ReferenceResult]) -> str:
    """Format how many cases and numbers there are, and how many agree."""
    numbers = [number for result in results for number in result.numbers]
    agree = sum(number.verdict == AGREES for number in numbers)
    parts = [format_count(len(results), "case"), format_count(len(numbers), "number"), f"{agree} agree"]
    parts += [f"{len(numbers) - agree} do not"] if agree < len(numbers) else []
    broken = sum(bool(result.check.error) for result in results)
    return ", ".join([*parts, *([f"{format_count(broken, 'case')} not solved"] if broken else [])])


def make_case_row(result: ReferenceResult) -> tuple[Cell, ...]:
    """Make the row of a case: how many numbers it has, how well they agree, or that it was not solved."""
    if result.check.error:
        return result.case.name, result.case.description, *[""] * 5, "not solved"
    wrong = sum(number.verdict != AGREES for number in result.numbers)
    lead = (result.case.name, result.case.description, len(result.numbers), list_kinds(result.case))
    return (
        *lead, format_digits(result.numbers),
        *format_largest_difference(result.tables), f"{wrong} differ{'s' * (wrong == 1)}" if wrong else AGREES,
    )  # fmt: skip


def list_kinds(case: PublishedCase) -> str:
    """List what kinds of numbers a case has, in the words of `KINDS`."""
    return ", ".join(dict.fromkeys(table.kind for table in case.tables))


def format_largest_difference(tables: Sequence[TableComparison]) -> tuple[str, str]:
    """Format the largest difference: in last digits, and as a share of the largest number if the source has an error of
    its own.

    Numbers that are exact are also given as a share of the largest.
    """
    digits = [abs(one.in_last_digits) for part in tables if part.is_limited_by_digits for one in part.numbers]
    shares = [
        abs(one.difference) / part.largest for part in tables if not part.is_limited_by_digits for one in part.numbers
    ]
    share = max(shares, default=0.0)
    share_text = f"{share:.0e}" if share > NEGLIGIBLE else f"< {NEGLIGIBLE:g}"
    digit = max(digits, default=0.0)
    return f"{digit:.{1 if digit < 1.0 else 0}f}" if digits else "", share_text if shares else ""


def format_digits(numbers: Sequence[NumberComparison]) -> str:
    """Format how many digits were printed, for the shortest and the longest number; empty if they are exact."""
    known = [one.published.digit_count for one in numbers if one.published.digit_count]
    if not known:
        return ""
    return f"{min(known)} to {max(known)}" if min(known) < max(known) else f"{min(known)}"


def _make_case_tables(results: Sequence[ReferenceResult]) -> Iterator[OutputTable]:
    """Yield a table with one row per case, and for each case the numbers that do not agree."""
    columns = tuple(OutputColumn(head, "number" if head == "numbers" else "text") for head in CASES)
    yield OutputTable("", columns, tuple(map(make_case_row, results)))
    for result in results:
        wrong = [number for number in result.numbers if number.verdict != AGREES]
        if wrong:
            yield OutputTable(f"DIFFERS  {result.case.name}", NUMBER_COLUMNS, tuple(map(_make_number_row, wrong)))


def _iter_number_rows(result: ReferenceResult) -> Iterator[tuple[Cell, ...] | str]:
    """Yield a line for each table of a case, and a row for each of its numbers."""
    for part in result.tables:
        yield _describe_table(part)
        yield from map(_make_number_row, part.numbers)


def _describe_table(part: TableComparison) -> str:
    """Describe where the numbers were printed, what they are, and how well the source knows them."""
    table = part.table
    case = f"; case {table.case}" if table.case else ""
    axes = f"; --axes {table.axes}" if table.axes != "world" else ""
    let = "".join(f"; {name} = {text}" for name, text in table.let)
    error = f"; error of the source {table.error:g} of the largest: {table.because}" if table.error else ""
    return f"{table.where} ({KINDS[table.kind]}){case}{axes}{let}{error}"


def _make_number_row(comparison: NumberComparison) -> tuple[Cell, ...]:
    """Make the row of a number: published, computed, their difference, and the verdict."""
    last = f"{comparison.in_last_digits:.2g}" if comparison.published.last_digit else ""
    return (
        comparison.number.path,
        _format_instant(comparison),
        comparison.published.text,
        _format_number(comparison),
        NumberCell(comparison.difference, write="{:.1e}".format),
        last,
        NumberCell(comparison.stated_error, write="{:.0e}".format),
        comparison.verdict,
    )


def _format_instant(comparison: NumberComparison) -> str:
    """Format the instant of a number; empty if it has none."""
    return "" if comparison.number.time is None else f"{comparison.number.time:.6g} s"


def _format_number(comparison: NumberComparison) -> str:
    """Format heun's number with two digits more than were printed."""
    if math.isnan(comparison.computed):
        return "open"
    digits = comparison.published.digit_count + 2 if comparison.published.digit_count else 17
    return f"{comparison.computed:.{min(digits, 17)}g}"


def _make_block(result: ReferenceResult) -> dict[str, Any]:
    """Return a case as the JSON has it: its tables, or why it was not solved."""
    case = {"case": result.case.name, "about": result.case.description, "source": result.case.source}
    if result.check.error:
        message = "\n".join(map(str, result.check.problems))
        return case | {"exit": result.check.error, "message": message, "tables": []}
    return case | {"tables": [_make_table_block(part) for part in result.tables]}


def _make_table_block(part: TableComparison) -> dict[str, Any]:
    """Return a table as the JSON has it."""
    table = part.table
    block = {
        "where": table.where,
        "kind": table.kind,
        "case": table.case,
        "axes": table.axes,
        "error": table.error,
        "because": table.because,
    }
    return block | {"numbers": [_make_number_block(comparison) for comparison in part.numbers]}


def _make_number_block(comparison: NumberComparison) -> dict[str, Any]:
    """Return a comparison as the JSON has it, in SI."""
    return {
        "of": comparison.number.path,
        "at": comparison.number.time,
        "published": comparison.published.text,
        "value": comparison.published.value,
        "found": comparison.computed,
        "difference": comparison.difference,
        "last_digits": comparison.in_last_digits,
        "stated": comparison.stated_error,
        "allowed": comparison.tolerance,
        "verdict": comparison.verdict,
    }
