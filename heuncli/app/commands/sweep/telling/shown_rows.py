"""The table of a sweep's rows: a line a variant, its extremes marked."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.analyses.sweep_store.columns import WORDS, ParameterColumn, parameters_of
from heuncli.analyses.sweep_store.rows import SweepHead, SweptRow
from heuncli.analyses.variants.asking import Measured
from heuncli.app.commands.sweep.telling.extremes import BestAndWorst
from heuncli.app.commands.sweep.telling.kept_rows import KeptRows
from heuncli.output.tables.plurals import count
from heuncli.output.tables.text_table import TextColumn, TextTable
from heuncli.study.quantities.digits import OPEN, OPEN_NOTE, UNKNOWN, largest, style, trim
from heuncli.study.quantities.table_units import Units

LEAST, GREATEST = "least", "greatest"
NOTES = {
    OPEN: OPEN_NOTE,
    UNKNOWN: "?: not known: beyond the horizon, beside a singular pose, or as small as its error",
    "-": "-: does not happen in this run",
}


def table_of_rows(head: SweepHead, shown: KeptRows, units: Units) -> TextTable:
    """The rows that are shown; marks stand behind what is least or greatest."""
    parameters = parameters_of(head.plan)
    numbered = len(parameters) > 1
    columns = [TextColumn("variant", "left")] * numbered + [parameter_column(one) for one in parameters]
    cells = [[str(row.number)] * numbered + parameter_cells(row, parameters) for row in shown.rows.values()]
    for measure in range(len(head.measures)):
        own, texts = _measure(head, shown, measure, units)
        columns += own
        for line, more in zip(cells, texts, strict=True):
            line += more
    if any(row.answer.code for row in shown.rows.values()):
        columns.append(TextColumn("not solved", "left"))
        for line, row in zip(cells, shown.rows.values(), strict=True):
            line.append(f"{row.answer.code}: {row.answer.reason}" if row.answer.code else "")
    notes = tuple(note for word, note in NOTES.items() if any(word in line for line in cells))
    size = f"{shown.size:,} of {head.plan.size:,} variants" if shown.size < head.plan.size else variants(shown.size)
    heading = f"SWEEP  {head.title or head.path}: {size}"
    return TextTable(heading, tuple(columns), tuple(with_gaps(list(shown.rows), cells, shown.size)), notes)


def variants(number: int) -> str:
    """So many variants, in words."""
    return f"{number:,} variants" if number >= 1000 else count(number, "variant")


def parameter_column(one: ParameterColumn) -> TextColumn:
    """The column of a parameter."""
    return TextColumn(one.head, "left" if one.unit is None else "point")


def parameter_cells(row: SweptRow, parameters: Sequence[ParameterColumn]) -> list[str]:
    """The values of a variant, to six digits."""
    return [parameter_text(one, row.values[one.name]) for one in parameters]


def parameter_text(one: ParameterColumn, text: str) -> str:
    """A value, without its unit."""
    value = one.value(text)
    return value if isinstance(value, str) else f"{value:.6g}"


def with_gaps(places: Sequence[int], cells: Sequence[Sequence[str]], size: int) -> Iterator[tuple[str, ...] | str]:
    """The lines, with a line across where rows are left out."""
    before = -1
    for place, line in zip(places, cells, strict=True):
        if place > before + 1:
            yield f"... {place - before - 1:,} more: --all"
        yield tuple(line)
        before = place
    if before < size - 1:
        yield f"... {size - 1 - before:,} more: --all"


def _measure(head: SweepHead, shown: KeptRows, k: int, units: Units) -> tuple[list[TextColumn], list[list[str]]]:
    """The columns of a measure, value, instant and mark, and their cells; without instants where all are the same."""
    measure, together = head.measures[k], f"measure {k}"
    unit, size = units.of(measure.unit)
    columns = [TextColumn(f"{measure.text} [{unit}]" if unit else measure.text, vector=together)]
    scale = size * largest(shown.gathered.values(k))
    of_rows = [row.answer.measures[k] if row.answer.measures else Measured(None) for row in shown.rows.values()]
    cells = [[text] for text in trim([value_text(one, size, scale) for one in of_rows])]
    instants = {one.at for one in of_rows if one.at is not None}
    if len(instants) > 1:
        columns.append(TextColumn("at [s]", vector=together))
        for line, one in zip(cells, of_rows, strict=True):
            line.append("" if one.at is None else f"{one.at:.5g}")
    best = shown.extremes[k]
    if best is not None and not best.flat:
        marks = words(["", *(mark(best, place) for place in shown.rows)])
        columns.append(TextColumn(marks[0], vector=together))
        for line, text in zip(cells, marks[1:], strict=True):
            line.append(text)
    return columns, cells


def words(cells: Sequence[str]) -> list[str]:
    """A column of words, its head first, each as wide as the others: they stand left, and yet do not lead a line.

    What leads a line is told again in every part of a table that is too wide (`page_width`).
    """
    width = max(map(len, cells))
    return [cell.ljust(width) for cell in cells]


def mark(best: BestAndWorst, place: int) -> str:
    """Whether a variant is the least or the greatest, or may be."""
    if best.least_too[place]:
        return LEAST
    return GREATEST if best.greatest_too[place] else ""


def value_text(one: Measured, size: float, scale: float) -> str:
    """A measure with the digits that its error supports; size: of its unit; scale: of the largest, in that unit.

    What is not above its error is 0 beside a larger one, and not known where there is none.
    """
    if one.value is None:
        return WORDS[one.word][0] if one.word else ""
    return number_text(size * one.value, size * (one.error or 0.0), scale)


def number_text(value: float, error: float, scale: float) -> str:
    """A number with the digits that its error supports, as `value_text` has it."""
    if value == 0.0 or not np.isfinite(value):
        return style(0.0, 0.0).write(value)
    return style(abs(value) if abs(value) > error else scale, error).write(value)
