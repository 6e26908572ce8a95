"""Make the table of a sweep's rows, one per variant, with marks for the extremes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.analyses.sweep_rows import ParameterColumn, SweepHead, SweptRow, make_parameter_columns, to_cell
from heuncli.analyses.variants.measures import MISSING_KINDS, MeasureValue
from heuncli.app.commands.sweep.output.top_k import MeasureExtremes, ShownRows
from heuncli.output.documents.document import OutputColumn, OutputTable
from heuncli.output.tables.plurals import format_count
from heuncli.scene.file_format.quantity import ParameterValue
from heuncli.study.quantities.digits import OPEN, OPEN_NOTE, UNKNOWN, choose_style, largest_magnitude, trim_zeros
from heuncli.study.quantities.table_units import Units

LEAST, GREATEST = "min", "max"
NOTES = {
    OPEN: OPEN_NOTE,
    UNKNOWN: "?: unknown: past the horizon, next to a singular position, or as small as its error",
    "-": "-: does not occur in this run",
}


def make_row_table(head: SweepHead, selection: ShownRows, units: Units) -> OutputTable:
    """Make the table of the selected rows; marks stand after the least and the greatest value."""
    parameters = make_parameter_columns(head.plan)
    has_numbers = len(parameters) > 1
    columns = [OutputColumn("variant", "text")] * has_numbers + [make_parameter_column(one) for one in parameters]
    cells = [[str(row.number)] * has_numbers + make_parameter_cells(row, parameters) for row in selection.rows.values()]
    for measure in range(len(head.measures)):
        measure_columns, texts = _make_measure_columns(head, selection, measure, units)
        columns += measure_columns
        for line, measure_cells in zip(cells, texts, strict=True):
            line += measure_cells
    if any(row.result.code for row in selection.rows.values()):
        columns.append(OutputColumn("not solved", "text"))
        for line, row in zip(cells, selection.rows.values(), strict=True):
            line.append(f"{row.result.code}: {row.result.reason}" if row.result.code else "")
    notes = tuple(note for word, note in NOTES.items() if any(word in line for line in cells))
    size = (
        f"{selection.size:,} of {head.plan.size:,} variants"
        if selection.size < head.plan.size
        else format_variant_count(selection.size)
    )
    heading = f"SWEEP  {head.title or head.path}: {size}"
    return OutputTable(heading, tuple(columns), tuple(insert_gaps(list(selection.rows), cells, selection.size)), notes)


def format_variant_count(number: int) -> str:
    """Format a number of variants in words."""
    return f"{number:,} variants" if number >= 1000 else format_count(number, "variant")


def make_parameter_column(one: ParameterColumn) -> OutputColumn:
    """Make the column of a parameter."""
    return OutputColumn(one.heading, "text" if one.unit is None else "number")


def make_parameter_cells(row: SweptRow, parameters: Sequence[ParameterColumn]) -> list[str]:
    """Format the values of a variant to six digits."""
    return [format_parameter(row.values[one.name]) for one in parameters]


def format_parameter(value: ParameterValue) -> str:
    """Format a value without its unit."""
    cell = to_cell(value)
    return cell if isinstance(cell, str) else f"{cell:.6g}"


def insert_gaps(places: Sequence[int], cells: Sequence[Sequence[str]], size: int) -> Iterator[tuple[str, ...] | str]:
    """Yield the rows, with a line across where rows are left out."""
    previous = -1
    for place, line in zip(places, cells, strict=True):
        if place > previous + 1:
            yield f"... {place - previous - 1:,} more: --all"
        yield tuple(line)
        previous = place
    if previous < size - 1:
        yield f"... {size - 1 - previous:,} more: --all"


def _make_measure_columns(
    head: SweepHead, selection: ShownRows, k: int, units: Units
) -> tuple[list[OutputColumn], list[list[str]]]:
    """Make the columns of a measure (value, instant and mark) and their cells; no instants if all are the same."""
    measure, vector_name = head.measures[k], f"measure {k}"
    unit, size = units.find(measure.unit)
    columns = [OutputColumn(f"{measure.text} [{unit}]" if unit else measure.text, vector=vector_name)]
    scale = size * largest_magnitude(selection.columns.values(k))
    results = [row.result.get_measure(k) for row in selection.rows.values()]
    cells = [[text] for text in trim_zeros([format_measure(one, size, scale) for one in results])]
    instants = {one.time for one in results if one.time is not None}
    if len(instants) > 1:
        columns.append(OutputColumn("at [s]", vector=vector_name))
        for line, one in zip(cells, results, strict=True):
            line.append("" if one.time is None else f"{one.time:.5g}")
    best = selection.extremes[k]
    if best is not None and not best.is_constant:
        marks = pad_words(["", *(choose_mark(best, place) for place in selection.rows)])
        columns.append(OutputColumn(marks[0], vector=vector_name))
        for line, text in zip(cells, marks[1:], strict=True):
            line.append(text)
    return columns, cells


def pad_words(cells: Sequence[str]) -> list[str]:
    """Pad a column of words, head first, to equal width, so that they look left-aligned although the column is not.

    A left-aligned column would be repeated in every part of a table that is too wide (`text_table`).
    """
    width = max(map(len, cells))
    return [cell.ljust(width) for cell in cells]


def choose_mark(best: MeasureExtremes, place: int) -> str:
    """Return the mark of a variant that is, or may be, the least or the greatest."""
    if best.may_be_least[place]:
        return LEAST
    return GREATEST if best.may_be_greatest[place] else ""


def format_measure(one: MeasureValue, size: float, scale: float) -> str:
    """Format a measure with the digits that its error supports.

    size: factor to the display unit
    scale: the largest value, in that unit

    A value not above its error is 0 relative to a larger one, and unknown if there is none.
    """
    if one.value is None:
        return MISSING_KINDS[one.word].mark if one.word else ""
    return format_number(size * one.value, size * (one.error or 0.0), scale)


def format_number(value: float, error: float, scale: float) -> str:
    """Format a number with the digits that its error supports, as in `format_measure`."""
    if value == 0.0 or not np.isfinite(value):
        return choose_style(0.0, 0.0).write(value)
    return choose_style(abs(value) if abs(value) > error else scale, error).write(value)
