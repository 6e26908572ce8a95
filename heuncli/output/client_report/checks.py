"""The checks of the spec's expected values against the results, as made by `heun check`."""

from __future__ import annotations

from heuncli.output.client_report.report_data import AS_IT_STANDS, ReportData
from heuncli.output.documents.document import OutputColumn, OutputTable, Part, TextCell
from heuncli.output.snapshots.outcomes import Outcome
from heuncli.study.quantities.captions import describe_path
from heuncli.study.queries.measure_uncertainty import find_unit

WORDED = ("joints.", "forces.", "couplings.", "sections.", "stops.", "foundation.")  # paths with words
HOLDS, FAILS = "passed", "FAILED"
HEADS = ("line", "case", "quantity", "unit", "at", "expected", "found", "allowed", "verdict")
NUMBERS = frozenset({"line", "expected", "found", "allowed"})


def make_check_parts(data: ReportData) -> list[Part]:
    """Make the table of checks, one row per expected value."""
    if not data.outcomes:
        return []
    with_cases = any(outcome.case for outcome in data.outcomes)
    heads = [head for head in HEADS if with_cases or head != "case"]
    columns = [OutputColumn(head, "number" if head in NUMBERS else "text") for head in heads]
    rows = [_make_row(data, outcome, with_cases=with_cases) for outcome in data.outcomes]
    failed = [f"{outcome.name}: {outcome.failure}" for outcome in data.outcomes if outcome.failure is not None]
    changed = ", with the command-line options given" if data.options else ""
    return [OutputTable(f"CHECKS  as in heun check{changed}; SI units", columns, rows, failed, "page")]


def _make_row(data: ReportData, outcome: Outcome, *, with_cases: bool) -> list[TextCell]:
    """Make the cells of one check; a failed verdict is bold."""
    verdict = TextCell(HOLDS if outcome.has_passed else FAILS, not outcome.has_passed)
    case = [TextCell(outcome.case or AS_IT_STANDS)] if with_cases else []
    texts = (
        describe_path(outcome.subject, data.labels) if outcome.subject.startswith(WORDED) else outcome.subject,
        find_unit(outcome.subject, data.spec),
        outcome.when,
        outcome.expected_text,
        outcome.found_text,
        outcome.tolerance_text,
    )
    return [TextCell(str(outcome.line)), *case, *map(TextCell, texts), verdict]
