"""What the spec expects of its own results, and whether it holds: the verdicts of `heun check`."""

from __future__ import annotations

from heuncli.output.client_report.parts import Part, ReportCell, ReportTable, Sentence
from heuncli.output.client_report.reported import AS_IT_STANDS, Reported
from heuncli.output.snapshots.outcomes import Outcome
from heuncli.output.tables.text_table import TextColumn
from heuncli.study.quantities.stated import unit_of

NONE, NOT_HERE = "The spec expects nothing.", "The spec expects nothing of what is reported."
HOLDS, FAILS = "holds", "FAILS"
HEADS = ("line", "case", "of", "unit", "at", "expected", "found", "allowed", "verdict")
NUMBERS = frozenset({"line", "expected", "found", "allowed"})


def check_parts(of: Reported) -> list[Part]:
    """A line for each expectation."""
    if not of.outcomes:
        return [Sentence(NOT_HERE if of.unchecked else NONE)]
    cases = any(outcome.case for outcome in of.outcomes)
    heads = [head for head in HEADS if cases or head != "case"]
    columns = [TextColumn(head, "point" if head in NUMBERS else "left") for head in heads]
    rows = [_row(of, outcome, cases=cases) for outcome in of.outcomes]
    failed = [f"{outcome.name}: {outcome.failure}" for outcome in of.outcomes if outcome.failure is not None]
    changed = ", with what was given on the command line" if of.given else ""
    return [ReportTable(f"CHECKS  as heun check makes them{changed}; in SI units", columns, rows, failed)]


def _row(of: Reported, outcome: Outcome, *, cases: bool) -> list[ReportCell]:
    """The cells of one; what fails stands out."""
    verdict = ReportCell(HOLDS if outcome.passed else FAILS, not outcome.passed)
    case = [ReportCell(outcome.case or AS_IT_STANDS)] if cases else []
    words = (outcome.of, unit_of(outcome.of, of.spec), outcome.when, outcome.expected, outcome.found, outcome.allowed)
    return [ReportCell(str(outcome.line)), *case, *map(ReportCell, words), verdict]
