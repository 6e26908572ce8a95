"""What measures hang on, as tables, JSON and CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from heuncli.analyses.sensitivity.results import Contribution, NoisyDerivative, NoisyValue, SpreadSum
from heuncli.analyses.variants.written import WrittenNumber
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.tables.export import dump
from heuncli.output.tables.page_width import fit
from heuncli.output.tables.plurals import count
from heuncli.output.tables.text_table import WIDTH, TextColumn, TextTable, labelled, plain
from heuncli.study.quantities.digits import rough
from heuncli.study.quantities.error_digits import with_digits
from heuncli.study.quantities.table_units import Units
from heuncli.version import VERSION

COLUMNS = (
    TextColumn("by", "left"), TextColumn("value"), TextColumn("", "left"), TextColumn("derivative"),
    TextColumn("error"), TextColumn("", "left"), TextColumn("% per %"), TextColumn("", "left"),
)  # fmt: skip
SPREAD_COLUMNS = (
    TextColumn("by", "left"), TextColumn("spread ±"), TextColumn("", "left"), TextColumn("contributes ±"),
    TextColumn("error"), TextColumn("at its lower end"), TextColumn("at its upper end"), TextColumn("", "left"),
)  # fmt: skip
CSV_COLUMNS = (
    "measure", "measure_unit", "kind", "name", "value", "unit", "derivative", "error", "relative", "relative_error",
    "spread", "contribution", "contribution_error", "code", "reason",
)  # fmt: skip
LINEAR = 0.05  # of the worst case: corners further off it are told
ALONE = "a number without a unit counts in SI"


class MeasureFindings(NamedTuple):
    """What one measure hangs on: its value, its derivatives by the names of numbers, and what spreads make of it."""

    base: NoisyValue
    slopes: Mapping[str, NoisyDerivative]
    spread: SpreadSum | None


class SensitivityPage(NamedTuple):
    """What is told; heads: the words and the SI unit of each measure; runs: variants that were solved."""

    title: str
    numbers: tuple[WrittenNumber, ...]
    heads: tuple[tuple[str, str], ...]
    found: tuple[MeasureFindings, ...]
    runs: int
    units: Units


def relative(number: WrittenNumber, found: MeasureFindings) -> tuple[float, float] | None:
    """Per cent of the measure per per cent of the number, and its error; None where either is 0 or not known."""
    slope, base = found.slopes[number.name], found.base
    if slope.value is None or not base.value or not number.value:
        return None
    factor = number.value / base.value
    value = slope.value * factor
    return value, abs(factor) * slope.error + abs(value / base.value) * base.error


def ordered(page: SensitivityPage, found: MeasureFindings) -> list[WrittenNumber]:
    """The numbers, what the measure hangs on most of all first; then those of which that is not known."""

    def weight(number: WrittenNumber) -> tuple[bool, float]:
        told = relative(number, found)
        return told is None, -abs(told[0]) if told else 0.0

    return sorted(page.numbers, key=weight)


def table(page: SensitivityPage) -> str:
    """All measures, a table each, and one of its spreads."""
    head = [("heun", f"{VERSION}  {page.title}"), ("sensitivity", f"{count(page.runs, 'variant')}; {ALONE}")]
    tables: list[TextTable] = []
    for (text, unit), found in zip(page.heads, page.found, strict=True):
        tables.append(_derivatives(page, text, unit, found))
        if found.spread is not None:
            tables.append(_spread(page, text, unit, found, found.spread))
    return "\n".join([labelled(head), *("".join(plain(part, WIDTH) for part in fit(one, WIDTH)) for one in tables)])


def _derivatives(page: SensitivityPage, text: str, unit: str, found: MeasureFindings) -> TextTable:
    shown, size = page.units.of(unit)
    base = found.base
    value = (
        f" = {_with_unit(with_digits(base.value * size, base.error * size), shown)}" if base.value is not None else ""
    )
    rows = tuple(row for number in ordered(page, found) for row in _rows(page, number, found, shown, size))
    return TextTable(f"DERIVATIVES  of {text}{value}", COLUMNS, rows)


def _rows(
    page: SensitivityPage, number: WrittenNumber, found: MeasureFindings, unit: str, size: float
) -> Iterator[tuple[str, ...]]:
    """The row of a number; of one at which the measure bends a row for each side."""
    slope, share = found.slopes[number.name], relative(number, found)
    lead = (number.name, with_digits(number.value, 0.0), number.unit)
    per = f"{unit if unit not in ('', '1') else '1'}/{_denominator(number.unit)}"
    if slope.left is not None and slope.right is not None:
        bends = f"on the right: it bends within {rough(slope.step)} of the value"
        for (value, error), side in ((slope.left, "on the left"), (slope.right, bends)):
            yield (*lead, with_digits(value * size, error * size), rough(error * size), per, "", side)
        return
    if slope.value is None:
        yield (*lead, "", "", "", "", f"{slope.why[1]} [{slope.why[0]}]")
        return
    percent = with_digits(share[0], max(share[1], 1e-6 * abs(share[0]))) if share else ""
    value, error = slope.value * size, slope.error * size
    yield (*lead, with_digits(value, error), rough(error), per, percent, _note(slope))


def _note(slope: NoisyDerivative) -> str:
    if slope.kind == "nothing":
        return "nothing hangs on it"
    if slope.kind == "one-sided":
        return f"from one side: {slope.why[1]} [{slope.why[0]}]"
    return "not told from 0" if abs(slope.value or 0.0) <= slope.error else ""


def _denominator(unit: str) -> str:
    return f"({unit})" if set("*/· ") & set(unit) else unit or "1"


def _with_unit(text: str, unit: str) -> str:
    return f"{text} {unit}".rstrip() if unit != "1" else text


def _spread(page: SensitivityPage, text: str, unit: str, found: MeasureFindings, total: SpreadSum) -> TextTable:
    shown, size = page.units.of(unit)
    largest = sorted(total.contributions, key=lambda one: -(one.size or 0.0))
    rows = tuple(_contribution(one, size) for one in largest)
    return TextTable(f"SPREAD  of {text}{f' [{shown}]' if shown not in ('', '1') else ''}", SPREAD_COLUMNS, rows,
                     tuple(_sums(total, found.base, shown, size)))  # fmt: skip


def _contribution(one: Contribution, size: float) -> tuple[str, ...]:
    ends = tuple("" if end is None else f"{end * size:+.6g}" for end in (one.below, one.above))
    lead = (one.name, f"{one.spread:.6g}", one.unit)
    if one.size is None:
        return (*lead, "", "", *ends, "not known")
    return (*lead, with_digits(one.size * size, one.error * size), rough(one.error * size), *ends,
            "searched" if one.bent else "")  # fmt: skip


def _searches(total: SpreadSum, size: float) -> Iterator[str]:
    """What was found within spreads that are not linear, and what cannot be solved of them."""
    for one in total.contributions:
        if one.bent and one.least is not None and one.greatest is not None:
            linear = (
                "there is no derivative" if one.linear is None else f"the derivative says ± {one.linear * size:.4g}"
            )
            ends = " to ".join(
                f"{change * size:+.4g} (at {x:+.4g} {one.unit}".rstrip() + ")"
                for x, change in (one.least, one.greatest)
            )
            yield f"{one.name} is not linear over its spread: {ends}, by {count(one.variants, 'variant')}; {linear}"
        if one.why[0]:
            yield f"{one.name}: a part of its spread cannot be solved: {one.why[1]} [{one.why[0]}]"


def _sums(total: SpreadSum, base: NoisyValue, unit: str, size: float) -> Iterator[str]:
    """Worst case, root of squares, and what the variants at the corners say of it."""
    yield from _searches(total, size)
    if total.worst is None or total.square is None:
        yield "worst case: not known, since a contribution is not"
        return
    partly = ", of what can be solved of the spreads" if any(one.why[0] for one in total.contributions) else ""
    shown_by = ", shown by a variant of several numbers" if total.by_variant else ""
    found_by = ", searched inside the spreads" if any(one.bent for one in total.contributions) else ""
    words = (("worst case", total.worst, shown_by + found_by + partly), ("root sum square", total.square, ""))
    for word, (value, error), how in words:
        text = _with_unit(with_digits(value * size, error * size), unit)
        yield f"{word}: ± {text} (error {rough(error * size)}){how}"
    low, high = total.corners
    if base.value is None or low.value is None or high.value is None:
        why = next((end.why for end in total.corners if end.value is None), ("", ""))
        yield f"the variants with all numbers at their ends: {why[1]} [{why[0]}]"
        return
    changes = low.value - base.value, high.value - base.value
    where = "where each does most" if any(one.bent for one in total.contributions) else "at their ends"
    text = f"the variants with all numbers {where}: {changes[0] * size:+.6g} and {changes[1] * size:+.6g}"
    off = max(abs(abs(change) - total.worst[0]) for change in changes)
    if off > LINEAR * total.worst[0] + total.worst[1] + low.error + high.error:
        text += ": the spreads are too large for the sum"
    yield text


def to_json(page: SensitivityPage) -> str:
    """All of it; measures in SI, derivatives per unit as it is written and per SI unit."""
    measures = [
        {
            "measure": text, "unit": unit, "value": found.base.value, "error": found.base.error,
            "derivatives": [_block(number, found) for number in ordered(page, found)],
            **({"spread": _spread_block(found.spread)} if found.spread is not None else {}),
        }
        for (text, unit), found in zip(page.heads, page.found, strict=True)
    ]  # fmt: skip
    return dump({"heun": 1, "title": page.title, "runs": page.runs, "measures": measures})


def _block(number: WrittenNumber, found: MeasureFindings) -> dict[str, Any]:
    slope, share = found.slopes[number.name], relative(number, found)
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
    return block | {side: list(told) for side in ("left", "right") if (told := getattr(slope, side)) is not None}


def _spread_block(total: SpreadSum) -> dict[str, Any]:
    low, high = total.corners
    return {
        "worst": total.worst[0] if total.worst else None, "worst_error": total.worst[1] if total.worst else None,
        "root_sum_square": total.square[0] if total.square else None,
        "root_sum_square_error": total.square[1] if total.square else None,
        "corners": [low.value, high.value], "worst_by_variant": total.by_variant,
        "largest": total.largest[0] if total.largest else None,
        "contributions": [
            {
                **{key: value for key, value in one._asdict().items() if key not in ("bent", "why")},
                "by_variants": one.bent, "code": one.why[0] or None, "reason": one.why[1] or None,
            }
            for one in total.contributions
        ],
    }  # fmt: skip


def to_csv(page: SensitivityPage) -> str:
    """A line a measure and number, and a line each for the sums of spreads."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(CSV_COLUMNS)
    for (words, unit), found in zip(page.heads, page.found, strict=True):
        shares = {one.name: one for one in found.spread.contributions} if found.spread else {}
        for number in ordered(page, found):
            slope, share, one = found.slopes[number.name], relative(number, found), shares.get(number.name)
            spread = (one.spread, one.size, one.error) if one is not None else ("", "", "")
            error = slope.error if slope.value is not None else ""
            lead = (words, unit, slope.kind or "derivative", number.name, number.value, number.unit, slope.value, error)
            writer.writerow([*lead, *(share or ("", "")), *spread, *slope.why])
        sums = (("worst", found.spread.worst), ("root_sum_square", found.spread.square)) if found.spread else ()
        for word, told in sums:
            writer.writerow([words, unit, word, *[""] * 8, *(told or ("", "")), "", ""])
    return text.getvalue()


FORMS: dict[str, Callable[[SensitivityPage], str]] = {"table": table, "json": to_json, "csv": to_csv}
