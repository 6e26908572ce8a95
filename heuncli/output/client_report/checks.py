"""The checks of the spec's expected values against the results, as made by `heun check`, in numbers for a reader."""

from __future__ import annotations

import math

import numpy as np

from heuncli.output.client_report.extremes import format_power
from heuncli.output.client_report.report_data import AS_IT_STANDS, ReportData
from heuncli.output.documents.document import OutputColumn, OutputTable, Part, TextCell
from heuncli.output.snapshots.outcomes import Outcome
from heuncli.study.quantities.captions import describe_path, parse_path
from heuncli.study.quantities.digits import OPEN, ReaderStyle, choose_reader_style
from heuncli.study.queries.measure_uncertainty import find_unit

HOLDS, FAILS = "passed", "FAILED"
HEADS = ("line", "case", "quantity", "unit", "at", "expected", "found", "allowed", "verdict")
NUMBERS = frozenset({"line", "expected", "found", "allowed"})
MAX_NUMBERS = 6  # of a list


def make_check_parts(data: ReportData) -> list[Part]:
    """Make the table of checks, one row per expected value."""
    if not data.outcomes:
        return []
    with_cases = any(outcome.case for outcome in data.outcomes)
    heads = [head for head in HEADS if with_cases or head != "case"]
    columns = [OutputColumn(head, "number" if head in NUMBERS else "text") for head in heads]
    rows = [_make_row(data, outcome, with_cases=with_cases) for outcome in data.outcomes]
    failed = [f"{name_check(data, each)}: {each.failure}" for each in data.outcomes if each.failure is not None]
    changed = ", with the command-line options given" if data.options else ""
    return [OutputTable(f"CHECKS  as in heun check{changed}", columns, rows, failed, "page")]


def name_check(data: ReportData, outcome: Outcome) -> str:
    """Name what is checked in words: case, quantity, instant."""
    case = f"{outcome.case}: " if outcome.case else ""
    return f"{case}{_describe_subject(data, outcome)} {outcome.when}".strip()


def _describe_subject(data: ReportData, outcome: Outcome) -> str:
    subject = outcome.subject
    return describe_path(subject, data.labels) if parse_path(subject) is not None else subject


def _make_row(data: ReportData, outcome: Outcome, *, with_cases: bool) -> list[TextCell]:
    """Make the cells of one check; a failed verdict is bold."""
    verdict = TextCell(HOLDS if outcome.has_passed else FAILS, not outcome.has_passed)
    case = [TextCell(outcome.case or AS_IT_STANDS)] if with_cases else []
    unit, *numbers = _format_check(data, outcome)
    texts = _describe_subject(data, outcome), unit, outcome.when, *numbers
    return [TextCell(str(outcome.line)), *case, *map(TextCell, texts), verdict]


def _format_check(data: ReportData, outcome: Outcome) -> tuple[str, str, str, str]:
    """Format unit, expected, found and allowed numbers.

    The largest expected number has four digits, and so many more that a failure is seen. What is found below the last
    of them is 0.
    """
    block = outcome.block
    expected, found = _read_numbers(block.get("expected")), _read_numbers(block.get("found"))
    bounds = [(word, float(block[word])) for word in ("above", "below") if block.get(word) is not None]
    tolerance = float(block.get("tolerance") or 0.0)
    scale = max((abs(x) for x in (*expected, *(b for _, b in bounds)) if math.isfinite(x)), default=0.0)
    is_expected_zero = scale == 0.0
    scale = scale or max([tolerance, *(abs(x) for x in found if abs(x) > tolerance)])
    style = choose_reader_style(find_unit(outcome.subject, data.spec), scale, data.units)
    if outcome.failure is not None and found:
        while style.decimals < 9 and _write(style, found) == _write(style, expected or [b for _, b in bounds]):
            style = style._replace(decimals=style.decimals + 1)
    wanted = ", ".join(f"{word} {style.write(bound)}" for word, bound in bounds) or _write(style, expected)
    if is_expected_zero and tolerance:
        found = [0.0 if abs(x) <= tolerance else x for x in found]
    allowed = "" if bounds or not expected else _format_allowed(style, tolerance, 0.0 if is_expected_zero else scale)
    return "" if style.unit == "1" else style.unit, wanted, _write(style, found), allowed


def _read_numbers(value: object) -> list[float]:
    """Return the numbers of an outcome's block; nan stands for an indeterminate one."""
    return [] if value is None else [float(x) for x in np.ravel(np.asarray(value, dtype=np.float64))]


def _write(style: ReaderStyle, values: list[float]) -> str:
    texts = [OPEN if math.isnan(value) else style.write(value) for value in values[:MAX_NUMBERS]]
    if len(values) <= 1:
        return "".join(texts)
    return f"[{', '.join(texts)}{', ...' * (len(values) > len(texts))}]"


def _format_allowed(style: ReaderStyle, tolerance: float, scale: float) -> str:
    """Format the allowed deviation: relative to the expected number, or absolute where 0 is expected."""
    if tolerance <= 0.0:
        return "0"
    return f"{format_power(100.0 * tolerance / scale, 2)} %" if scale else format_power(style.size * tolerance, 2)
