"""Make the document of published cases: a table with one row per case, or with every number of some."""

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
    result: CheckResult

    @property
    def exit_code(self) -> int:
        """The exit code that this case alone would give."""
        return self.result.exit_code

    @property
    def numbers(self) -> list[NumberComparison]:
        """All numbers of the case."""
        return [number for table in self.tables for number in table.numbers]


def iter_outcomes(tables: Sequence[TableComparison]) -> Iterator[Outcome]:
    """Convert the comparisons to outcomes of a spec, for the reports of pipelines."""
    for table in tables:
        for one in table.numbers:
            failure = None if one.verdict == AGREES else f"{one.verdict}: off by {one.difference:.3g}"
            yield Outcome(
                REFERENCE,
                one.number.path,
                failure,
                one.number.line,
                case=table.table.case,
                when=_format_instant(one),
                expected_text=one.published.text,
                found_text=_format_number(one),
                tolerance_text=f"{one.tolerance:.3g}",
                block=_make_number_block(one),
            )


def make_document(results: Sequence[ReferenceResult], form: str, *, show_numbers: bool) -> OutputDocument:
    """Make the document: a row per case, or with `show_numbers` the source and all numbers of each, and a summary."""
    parts: list[Part] = []
    if not show_numbers:
        parts += _make_case_tables(results)
    for one in results if show_numbers else ():
        if form != "markdown":
            what = [("case", one.case.name), ("what", one.case.description), ("source", one.case.source)]
            parts.append(Facts([*what, ("spec", f"heun new {one.case.name}")]))
        heading = f"{one.case.description}  {one.case.source}" if form == "markdown" else ""
        parts.append(OutputTable(heading, NUMBER_COLUMNS, list(_iter_number_rows(one))))
    return OutputDocument(
        parts=[*parts, Sentence(format_summary(results))], make_block=lambda: _make_results_block(results)
    )


def _make_results_block(results: Sequence[ReferenceResult]) -> dict[str, Any]:
    """Return every number of every case as the JSON has it."""
    numbers = [number for one in results for number in one.numbers]
    passed = sum(number.verdict == AGREES for number in numbers)
    broken = sum(bool(one.result.error) for one in results)
    blocks = [_make_block(one) for one in results]
    return {"passed": passed, "failed": len(numbers) - passed + broken, "cases": blocks}


def format_summary(results: Sequence[ReferenceResult]) -> str:
    """Format how many cases and numbers there are, and how many agree."""
    numbers = [number for one in results for number in one.numbers]
    agree = sum(number.verdict == AGREES for number in numbers)
    parts = [format_count(len(results), "case"), format_count(len(numbers), "number"), f"{agree} agree"]
    parts += [f"{len(numbers) - agree} do not"] if agree < len(numbers) else []
    broken = sum(bool(one.result.error) for one in results)
    return ", ".join([*parts, *([f"{format_count(broken, 'case')} not solved"] if broken else [])])


def make_case_row(one: ReferenceResult) -> tuple[Cell, ...]:
    """Make the row of a case."""
    if one.result.error:
        return one.case.name, one.case.description, *[""] * 5, "not solved"
    wrong = sum(number.verdict != AGREES for number in one.numbers)
    return (
        one.case.name, one.case.description, len(one.numbers), list_kinds(one.case), format_digits(one.numbers),
        *format_largest_difference(one.tables), f"{wrong} differ{'s' * (wrong == 1)}" if wrong else AGREES,
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
    for one in results:
        wrong = [number for number in one.numbers if number.verdict != AGREES]
        if wrong:
            yield OutputTable(f"DIFFERS  {one.case.name}", NUMBER_COLUMNS, tuple(map(_make_number_row, wrong)))


def _iter_number_rows(one: ReferenceResult) -> Iterator[tuple[Cell, ...] | str]:
    for part in one.tables:
        yield _describe_table(part)
        yield from map(_make_number_row, part.numbers)


def _describe_table(part: TableComparison) -> str:
    """Describe where the numbers were printed, what they are, and how well the source knows them."""
    table_ = part.table
    case = f"; case {table_.case}" if table_.case else ""
    axes = f"; --axes {table_.axes}" if table_.axes != "world" else ""
    let = "".join(f"; {name} = {text}" for name, text in table_.let)
    error = f"; error of the source {table_.error:g} of the largest: {table_.because}" if table_.error else ""
    return f"{table_.where} ({KINDS[table_.kind]}){case}{axes}{let}{error}"


def _make_number_row(one: NumberComparison) -> tuple[Cell, ...]:
    last = f"{one.in_last_digits:.2g}" if one.published.last_digit else ""
    return (
        one.number.path,
        _format_instant(one),
        one.published.text,
        _format_number(one),
        NumberCell(one.difference, write="{:.1e}".format),
        last,
        NumberCell(one.stated_error, write="{:.0e}".format),
        one.verdict,
    )


def _format_instant(one: NumberComparison) -> str:
    return "" if one.number.time is None else f"{one.number.time:.6g} s"


def _format_number(one: NumberComparison) -> str:
    """Format heun's number with two digits more than were printed."""
    if math.isnan(one.computed):
        return "open"
    digits = one.published.digit_count + 2 if one.published.digit_count else 17
    return f"{one.computed:.{min(digits, 17)}g}"


def _make_block(one: ReferenceResult) -> dict[str, Any]:
    case = {"case": one.case.name, "about": one.case.description, "source": one.case.source}
    if one.result.error:
        message = "\n".join(map(str, one.result.problems))
        return case | {"exit": one.result.error, "message": message, "tables": []}
    return case | {"tables": [_make_table_block(part) for part in one.tables]}


def _make_table_block(part: TableComparison) -> dict[str, Any]:
    table_ = part.table
    block = {
        "where": table_.where,
        "kind": table_.kind,
        "case": table_.case,
        "axes": table_.axes,
        "error": table_.error,
        "because": table_.because,
    }
    return block | {"numbers": [_make_number_block(one) for one in part.numbers]}


def _make_number_block(one: NumberComparison) -> dict[str, Any]:
    return {
        "of": one.number.path,
        "at": one.number.time,
        "published": one.published.text,
        "value": one.published.value,
        "found": one.computed,
        "difference": one.difference,
        "last_digits": one.in_last_digits,
        "stated": one.stated_error,
        "allowed": one.tolerance,
        "verdict": one.verdict,
    }
