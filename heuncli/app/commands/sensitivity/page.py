"""Make the document of sensitivities and tolerance effects."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from heuncli.analyses.sensitivity import NoisyDerivative
from heuncli.analyses.tolerance_analysis import Contribution, SpreadSum
from heuncli.analyses.variants.measures import MeasureLabel, NoisyValue
from heuncli.analyses.variants.spec_numbers import SpecNumber
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.as_data import make_columns
from heuncli.output.documents.document import (
    Cell,
    NumberCell,
    OutputColumn,
    OutputDocument,
    OutputTable,
    append_unit,
    format_head,
)
from heuncli.output.tables.nouns import format_count
from heuncli.study.quantities.digits import format_error, format_with_error
from heuncli.study.quantities.table_units import Units

COLUMNS = (
    OutputColumn("parameter", "text"), OutputColumn("value"), OutputColumn("", "text"), OutputColumn("derivative"),
    OutputColumn("error"), OutputColumn("", "text"), OutputColumn("% per %"), OutputColumn("", "text"),
)  # fmt: skip
SPREAD_COLUMNS = (
    OutputColumn("parameter", "path"), OutputColumn("spread ±"), OutputColumn("", "text"),
    OutputColumn("contributes ±"), OutputColumn("error"), OutputColumn("at its lower end"),
    OutputColumn("at its upper end"), OutputColumn("", "text"),
)  # fmt: skip
CSV_COLUMNS = make_columns(
    "measure measure_unit kind name value unit derivative error relative relative_error spread contribution "
    "contribution_error code reason"
)
LINEARITY_TOLERANCE = 0.05  # of the worst case; corners that differ by more get a note
ALONE = "numbers without a unit are in SI"


class MeasureFindings(NamedTuple):
    """The sensitivities of one measure.

    base: its value
    slopes: its derivatives by the names of the numbers
    spread: the effect of the tolerances
    """

    base: NoisyValue
    slopes: Mapping[str, NoisyDerivative]
    spread: SpreadSum | None


class SensitivityPage(NamedTuple):
    """The content of the page.

    heads: the words and the SI unit of each measure
    runs: number of variants solved
    """

    title: str
    numbers: tuple[SpecNumber, ...]
    heads: tuple[MeasureLabel, ...]
    findings: tuple[MeasureFindings, ...]
    runs: int
    units: Units


def compute_elasticity(number: SpecNumber, findings: MeasureFindings) -> tuple[float, float] | None:
    """Return the change of the measure in per cent per per cent of the number, and its error; None if one is 0 or
    unknown.
    """
    slope, base = findings.slopes[number.name], findings.base
    if slope.value is None or not base.value or not number.value:
        return None
    factor = number.value / base.value
    value = slope.value * factor
    return value, abs(factor) * slope.error + abs(value / base.value) * base.error


def sort_numbers(page: SensitivityPage, findings: MeasureFindings) -> list[SpecNumber]:
    """Sort the numbers by their influence on the measure, the largest first, unknown ones last."""

    def make_sort_key(number: SpecNumber) -> tuple[bool, float]:
        """Return a sort key: unknown last, then by descending influence."""
        elasticity = compute_elasticity(number, findings)
        return elasticity is None, -abs(elasticity[0]) if elasticity else 0.0

    return sorted(page.numbers, key=make_sort_key)


def make_document(page: SensitivityPage) -> OutputDocument:
    """Make the document: a table per measure, and one of its tolerances."""
    tables: list[OutputTable] = []
    for (text, unit), findings in zip(page.heads, page.findings, strict=True):
        tables.append(_make_derivative_table(page, text, unit, findings))
        if findings.spread is not None:
            tables.append(_make_spread_table(page, text, unit, findings, findings.spread))
    facts = [("sensitivity", f"{format_count(page.runs, 'variant')}; {ALONE}")]
    return OutputDocument(
        page.title,
        facts,
        tables,
        lambda: to_block(page),
        lambda: OutputTable("", CSV_COLUMNS, list(iter_records(page))),
    )


def _make_derivative_table(page: SensitivityPage, text: str, unit: str, findings: MeasureFindings) -> OutputTable:
    """Make the table of the derivatives of one measure."""
    display_unit, size = page.units.find(unit)
    base = findings.base
    value = (
        f" = {append_unit(format_with_error(base.value * size, base.error * size), display_unit)}"
        if base.value is not None
        else ""
    )
    rows = [
        row for number in sort_numbers(page, findings) for row in _make_rows(page, number, findings, display_unit, size)
    ]
    return OutputTable(f"DERIVATIVES  of {text}{value}", COLUMNS, rows)


def _make_rows(
    page: SensitivityPage, number: SpecNumber, findings: MeasureFindings, unit: str, size: float
) -> Iterator[tuple[Cell, ...]]:
    """Yield the row of a number; two rows, one for each side, if the measure has a kink there."""
    slope, share = findings.slopes[number.name], compute_elasticity(number, findings)
    lead = (number.name, NumberCell(number.value), number.unit)
    per = f"{unit if unit not in ('', '1') else '1'}/{_format_denominator(number.unit)}"
    if slope.left is not None and slope.right is not None:
        bends = f"on the right: the slope changes within {format_error(slope.step)} of the value"
        for (value, error), side in ((slope.left, "on the left"), (slope.right, bends)):
            yield (*lead, *_make_pair(value * size, error * size), per, "", side)
        return
    if slope.value is None:
        yield (*lead, "", "", "", "", f"{slope.why[1]} [{slope.why[0]}]")
        return
    percent = NumberCell(share[0], max(share[1], 1e-6 * abs(share[0]))) if share else None
    yield (*lead, *_make_pair(slope.value * size, slope.error * size), per, percent, _make_remark(slope))


def _make_pair(value: float, error: float) -> tuple[NumberCell, NumberCell]:
    """Make the cells of a number and of its error."""
    return NumberCell(value, error), NumberCell(error, write=format_error)


def _make_remark(slope: NoisyDerivative) -> str:
    """Say what is special about a derivative; empty for a plain one."""
    if slope.kind == "nothing":
        return "no effect"
    if slope.kind == "one-sided":
        return f"from one side: {slope.why[1]} [{slope.why[0]}]"
    return "0 within its error" if abs(slope.value or 0.0) <= slope.error else ""


def _format_denominator(unit: str) -> str:
    """Format a unit below a fraction bar: in brackets if it is a product or has an exponent."""
    return f"({unit})" if set("*/· ") & set(unit) else unit or "1"


def _make_spread_table(
    page: SensitivityPage, text: str, unit: str, findings: MeasureFindings, total: SpreadSum
) -> OutputTable:
    """Make the table of the tolerances, and of their combined effect on one measure."""
    display_unit, size = page.units.find(unit)
    largest = sorted(total.contributions, key=lambda one: -(one.size or 0.0))
    rows = [_make_contribution_row(one, size) for one in largest]
    heading = format_head(f"SPREAD  of {text}", display_unit)
    return OutputTable(heading, SPREAD_COLUMNS, rows, list(_describe_sums(total, findings.base, display_unit, size)))


def _make_contribution_row(contribution: Contribution, size: float) -> tuple[Cell, ...]:
    """Make the row of the effect of one tolerance."""
    ends = tuple(
        None if end is None else NumberCell(end * size, write="{:+.6g}".format)
        for end in (contribution.below, contribution.above)
    )
    lead = (contribution.name, contribution.spread, contribution.unit)
    if contribution.size is None:
        return (*lead, "", "", *ends, "not known")
    return (
        *lead,
        *_make_pair(contribution.size * size, contribution.error * size),
        *ends,
        "searched" if contribution.is_nonlinear else "",
    )


def _describe_nonlinear(total: SpreadSum, size: float) -> Iterator[str]:
    """Describe the extremes found within tolerances that are not linear, and which part of them cannot be solved."""
    for contribution in total.contributions:
        if contribution.is_nonlinear and contribution.least is not None and contribution.greatest is not None:
            linear = (
                "there is no derivative"
                if contribution.linear is None
                else f"the derivative gives ± {contribution.linear * size:.4g}"
            )
            ends = " to ".join(
                f"{change * size:+.4g} (at {x:+.4g} {contribution.unit}".rstrip() + ")"
                for x, change in (contribution.least, contribution.greatest)
            )
            yield (
                f"{contribution.name} is not linear over its spread: {ends}, by "
                f"{format_count(contribution.variants, 'variant')}; {linear}"
            )
        if contribution.why[0]:
            code, reason = contribution.why
            yield f"{contribution.name}: a part of its spread cannot be solved: {reason} [{code}]"


def _describe_sums(total: SpreadSum, base: NoisyValue, unit: str, size: float) -> Iterator[str]:
    """Yield worst case, root of the sum of squares, and how the variants at the corners compare."""
    yield from _describe_nonlinear(total, size)
    if total.worst is None or total.square is None:
        yield "worst case: unknown, since a contribution is unknown"
        return
    partly = ", for the solvable part of the spreads" if any(one.why[0] for one in total.contributions) else ""
    shown_by = ", found by changing several parameters together" if total.by_variant else ""
    found_by = ", searched inside the spreads" if any(one.is_nonlinear for one in total.contributions) else ""
    words = (("worst case", total.worst, shown_by + found_by + partly), ("root sum square", total.square, ""))
    for word, (value, error), remark in words:
        text = append_unit(format_with_error(value * size, error * size), unit)
        yield f"{word}: ± {text} (error {format_error(error * size)}){remark}"
    low, high = total.corners
    if base.value is None or low.value is None or high.value is None:
        why = next((end.why for end in total.corners if end.value is None), ("", ""))
        yield f"the variants with all parameters at their ends: {why[1]} [{why[0]}]"
        return
    changes = low.value - base.value, high.value - base.value
    where = (
        "where each has the largest effect" if any(one.is_nonlinear for one in total.contributions) else "at their ends"
    )
    text = f"the variants with all parameters {where}: {changes[0] * size:+.6g} and {changes[1] * size:+.6g}"
    deviation = max(abs(abs(change) - total.worst.value) for change in changes)
    if deviation > LINEARITY_TOLERANCE * total.worst.value + total.worst.error + low.error + high.error:
        text += ": the spreads are too large for a linear sum"
    yield text


def to_block(page: SensitivityPage) -> dict[str, Any]:
    """Make the JSON block; measures in SI, derivatives per unit as written and per SI unit."""
    measures = [
        {
            "measure": text, "unit": unit, "value": findings.base.value, "error": findings.base.error,
            "derivatives": [_make_block(number, findings) for number in sort_numbers(page, findings)],
            **({"spread": _make_spread_block(findings.spread)} if findings.spread is not None else {}),
        }
        for (text, unit), findings in zip(page.heads, page.findings, strict=True)
    ]  # fmt: skip
    return {"heun": 1, "title": page.title, "runs": page.runs, "measures": measures}


def _make_block(number: SpecNumber, findings: MeasureFindings) -> dict[str, Any]:
    """Return a derivative as the JSON has it, in the number's unit and in SI."""
    slope, share = findings.slopes[number.name], compute_elasticity(number, findings)
    known = slope.value is not None
    block: dict[str, Any] = {
        "name": number.name, "value": number.value, "unit": number.unit, "si": number.value * number.size,
        "derivative": slope.value, "error": slope.error if known else None,
        "derivative_si": (slope.value or 0.0) / number.size if known else None,
        "error_si": slope.error / number.size if known else None,
        "relative": share[0] if share else None, "relative_error": share[1] if share else None,
        "kind": slope.kind, "step": slope.step,
    }  # fmt: skip
    if slope.why[0]:
        block |= {"code": slope.why[0], "reason": slope.why[1]}
    return block | {
        side: list(side_values) for side in ("left", "right") if (side_values := getattr(slope, side)) is not None
    }


def _make_spread_block(total: SpreadSum) -> dict[str, Any]:
    """Return the effect of the tolerances as the JSON has it."""
    low, high = total.corners
    return {
        "worst": total.worst.value if total.worst else None, "worst_error": total.worst.error if total.worst else None,
        "root_sum_square": total.square.value if total.square else None,
        "root_sum_square_error": total.square.error if total.square else None,
        "corners": [low.value, high.value], "worst_by_variant": total.by_variant,
        "largest": total.largest.value if total.largest else None,
        "contributions": [
            {
                **{key: value for key, value in contribution._asdict().items() if key not in ("is_nonlinear", "why")},
                "by_variants": contribution.is_nonlinear,
                "code": contribution.why[0] or None, "reason": contribution.why[1] or None,
            }
            for contribution in total.contributions
        ],
    }  # fmt: skip


def iter_records(page: SensitivityPage) -> Iterator[tuple[Cell, ...]]:
    """Yield the rows of the CSV: one per measure and number, and one per sum of tolerances."""
    for (words, unit), findings in zip(page.heads, page.findings, strict=True):
        shares = {one.name: one for one in findings.spread.contributions} if findings.spread else {}
        for number in sort_numbers(page, findings):
            slope, share = findings.slopes[number.name], compute_elasticity(number, findings)
            one = shares.get(number.name)
            spread = (one.spread, one.size, one.error) if one is not None else (None,) * 3
            error = slope.error if slope.value is not None else None
            lead = (words, unit, slope.kind or "derivative", number.name, number.value, number.unit, slope.value, error)
            yield (*lead, *(share or (None, None)), *spread, *slope.why)
        sums = (
            (("worst", findings.spread.worst), ("root_sum_square", findings.spread.square)) if findings.spread else ()
        )
        for word, total in sums:
            yield (words, unit, word, *[None] * 8, *(total or (None, None)), None, None)
