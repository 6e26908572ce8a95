"""Published cases as text: a table with a line a case, or with every number of one, the same in markdown, and JSON."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from heuncli.analyses.published.cases import KINDS, PublishedCase
from heuncli.analyses.published.compared import AGREES, ComparedNumber, ComparedTable
from heuncli.app.commands.check.checked import Checked
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.snapshots.outcomes import Outcome
from heuncli.output.tables.export import dump
from heuncli.output.tables.plurals import count
from heuncli.output.tables.text_table import WIDTH, TextColumn, TextTable, labelled, markdown, plain

REFERENCE = "reference"
CASES = ("case", "what it is", "numbers", "which are", "digits", "last digits", "of the largest", "verdict")
NUMBERS = ("what", "at", "published", "heun", "difference", "last digits", "heun states", "verdict")
OF_NUMBERS = tuple(TextColumn(head, "left") for head in NUMBERS)
NEGLIGIBLE = 1e-12  # of the largest number of a table: what is farther off than that is told


class CheckedCase(NamedTuple):
    """A published case: its tables with heun's numbers, and what the check of a spec has for reports and exit codes."""

    case: PublishedCase
    tables: tuple[ComparedTable, ...]
    checked: Checked

    @property
    def exit_code(self) -> int:
        """What this case alone would leave with."""
        return self.checked.exit_code

    @property
    def numbers(self) -> list[ComparedNumber]:
        """All of its numbers."""
        return [number for table in self.tables for number in table.numbers]


def outcomes_of(tables: Sequence[ComparedTable]) -> Iterator[Outcome]:
    """The comparisons as those of a spec are, for reports of pipelines."""
    for table in tables:
        for one in table.numbers:
            failure = None if one.verdict == AGREES else f"{one.verdict}: off by {one.difference:.3g}"
            yield Outcome(
                REFERENCE, one.number.path, failure, one.number.line, case=table.table.case, when=_when(one),
                expected=one.printed.text, found=_found(one), allowed=f"{one.allowed:.3g}", block=_number_block(one),
            )  # fmt: skip


def table(checked: Sequence[CheckedCase], each: bool) -> str:
    """A line a case, or of `each` its source and all numbers; and the sum of it all."""
    if not each:
        return "".join(map(plain, _of_all(checked))) + summary(checked) + "\n"
    parts = [_head(one) + plain(_of_numbers(one), WIDTH) + "\n" for one in checked]
    return "".join(parts) + summary(checked) + "\n"


def in_markdown(checked: Sequence[CheckedCase], each: bool) -> str:
    """The same in markdown."""
    if not each:
        return "\n".join([*map(markdown, _of_all(checked)), f"{summary(checked)}\n"])
    parts = [f"### {one.case.about}\n\n{one.case.source}\n\n{markdown(_of_numbers(one))}\n" for one in checked]
    return "".join(parts) + summary(checked) + "\n"


def in_json(checked: Sequence[CheckedCase], each: bool) -> str:
    """Every number of every case."""
    numbers = [number for one in checked for number in one.numbers]
    passed = sum(number.verdict == AGREES for number in numbers)
    broken = sum(bool(one.checked.error) for one in checked)
    blocks = [_block(one) for one in checked]
    return dump({"passed": passed, "failed": len(numbers) - passed + broken, "cases": blocks})


def summary(checked: Sequence[CheckedCase]) -> str:
    """How many cases, how many numbers, how many of them agree."""
    numbers = [number for one in checked for number in one.numbers]
    agree = sum(number.verdict == AGREES for number in numbers)
    parts = [count(len(checked), "case"), count(len(numbers), "number"), f"{agree} agree"]
    parts += [f"{len(numbers) - agree} do not"] if agree < len(numbers) else []
    broken = sum(bool(one.checked.error) for one in checked)
    return ", ".join([*parts, *([f"{count(broken, 'case')} not solved"] if broken else [])])


def row_of(one: CheckedCase) -> tuple[str, ...]:
    """The line of a case."""
    if one.checked.error:
        return one.case.name, one.case.about, *[""] * 5, "not solved"
    wrong = sum(number.verdict != AGREES for number in one.numbers)
    return (
        one.case.name, one.case.about, str(len(one.numbers)), kinds_of(one.case), digits_of(one.numbers),
        *farthest(one.tables), f"{wrong} differ" if wrong else AGREES,
    )  # fmt: skip


def kinds_of(case: PublishedCase) -> str:
    """What its numbers are, in the words of `KINDS`."""
    return ", ".join(dict.fromkeys(table.kind for table in case.tables))


def farthest(tables: Sequence[ComparedTable]) -> tuple[str, str]:
    """How near heun comes: in last digits, and as a share of the largest where the source has an error of its own.

    Numbers that are exact, too, are told as a share of the largest.
    """
    digits = [abs(one.in_last_digits) for part in tables if part.is_to_the_digit for one in part.numbers]
    shares = [abs(one.difference) / part.largest for part in tables if not part.is_to_the_digit for one in part.numbers]
    share = max(shares, default=0.0)
    told = f"{share:.0e}" if share > NEGLIGIBLE else f"< {NEGLIGIBLE:g}"
    digit = max(digits, default=0.0)
    return f"{digit:.{1 if digit < 1.0 else 0}f}" if digits else "", told if shares else ""


def digits_of(numbers: Sequence[ComparedNumber]) -> str:
    """How many digits were printed, of the shortest and of the longest number; nothing where they are exact."""
    known = [one.printed.digits for one in numbers if one.printed.digits]
    if not known:
        return ""
    return f"{min(known)} to {max(known)}" if min(known) < max(known) else f"{min(known)}"


def _of_all(checked: Sequence[CheckedCase]) -> Iterator[TextTable]:
    """A line a case; and of each case the numbers that do not agree."""
    columns = tuple(TextColumn(head, "point" if head == "numbers" else "left") for head in CASES)
    yield TextTable("", columns, tuple(map(row_of, checked)))
    for one in checked:
        wrong = [number for number in one.numbers if number.verdict != AGREES]
        if wrong:
            yield TextTable(f"DIFFERS  {one.case.name}", OF_NUMBERS, tuple(map(_number_row, wrong)))


def _of_numbers(one: CheckedCase) -> TextTable:
    rows: list[tuple[str, ...] | str] = []
    for part in one.tables:
        rows.append(_told(part))
        rows += map(_number_row, part.numbers)
    return TextTable("", OF_NUMBERS, tuple(rows))


def _told(part: ComparedTable) -> str:
    """Where numbers stand, what they are, and how well the source itself knows them."""
    own = part.table
    case = f"; case {own.case}" if own.case else ""
    axes = f"; --axes {own.axes}" if own.axes != "world" else ""
    let = "".join(f"; {name} = {text}" for name, text in own.let)
    error = f"; known to {own.error:g} of the largest: {own.because}" if own.error else ""
    return f"{own.where} ({KINDS[own.kind]}){case}{axes}{let}{error}"


def _number_row(one: ComparedNumber) -> tuple[str, ...]:
    last = f"{one.in_last_digits:.2g}" if one.printed.last else ""
    return (
        one.number.path, _when(one), one.printed.text, _found(one), f"{one.difference:.1e}", last, f"{one.stated:.0e}",
        one.verdict,
    )  # fmt: skip


def _when(one: ComparedNumber) -> str:
    return "" if one.number.at is None else f"{one.number.at:.6g} s"


def _found(one: ComparedNumber) -> str:
    """Heun's number with two digits more than were printed."""
    if math.isnan(one.found):
        return "open"
    digits = one.printed.digits + 2 if one.printed.digits else 17
    return f"{one.found:.{min(digits, 17)}g}"


def _head(one: CheckedCase) -> str:
    what = (("case", one.case.name), ("what", one.case.about), ("source", one.case.source))
    return labelled([*what, ("spec", f"heun new {one.case.name}")], WIDTH) + "\n"


def _block(one: CheckedCase) -> dict[str, Any]:
    case = {"case": one.case.name, "about": one.case.about, "source": one.case.source}
    if one.checked.error:
        message = "\n".join(map(str, one.checked.problems))
        return case | {"exit": one.checked.error, "message": message, "tables": []}
    return case | {"tables": [_table_block(part) for part in one.tables]}


def _table_block(part: ComparedTable) -> dict[str, Any]:
    own = part.table
    given = {"where": own.where, "kind": own.kind, "case": own.case, "axes": own.axes, "error": own.error,
             "because": own.because}  # fmt: skip
    return given | {"numbers": [_number_block(one) for one in part.numbers]}


def _number_block(one: ComparedNumber) -> dict[str, Any]:
    return {
        "of": one.number.path, "at": one.number.at, "published": one.printed.text, "value": one.printed.value,
        "found": one.found, "difference": one.difference, "last_digits": one.in_last_digits, "stated": one.stated,
        "allowed": one.allowed, "verdict": one.verdict,
    }  # fmt: skip


FORMS = {"table": table, "markdown": in_markdown, "json": in_json}
