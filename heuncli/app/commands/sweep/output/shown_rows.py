"""Make the table of a sweep's rows, one per variant, with marks for the extremes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.analyses.sweep_rows import ParameterColumn, SweepHead, make_parameter_columns, to_cell
from heuncli.analyses.variants.measures import MISSING_KINDS, MeasureValue
from heuncli.app.commands.sweep.output.top_k import MeasureExtremes, ShownRows
from heuncli.output.documents.document import Cell, NumberCell, OutputColumn, OutputTable, format_cell, trim_cells
from heuncli.output.tables.plurals import format_count
from heuncli.scene.file_format.quantity import ParameterValue
from heuncli.study.quantities.digits import OPEN, OPEN_NOTE, UNKNOWN, Style, choose_style, largest_magnitude
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
    cells: list[list[Cell]] = [
        [row.number] * has_numbers + [to_cell(row.values[one.name]) for one in parameters]
        for row in selection.rows.values()
    ]
    for measure in range(len(head.measures)):
        measure_columns, cells_of_measure = _make_measure_columns(head, selection, measure, units)
        columns += measure_columns
        for line, measure_cells in zip(cells, cells_of_measure, strict=True):
            line += measure_cells
    if any(row.result.code for row in selection.rows.values()):
        columns.append(OutputColumn("not solved", "text"))
        for line, row in zip(cells, selection.rows.values(), strict=True):
            line.append(f"{row.result.code}: {row.result.reason}" if row.result.code else "")
    texts = {format_cell(cell) for line in cells for cell in line}
    notes = tuple(note for word, note in NOTES.items() if word in texts)
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
    return OutputColumn(one.label, "text" if one.unit is None else "number", one.unit or "")


def format_parameter(value: ParameterValue) -> str:
    """Format a value to six digits, without its unit."""
    return format_cell(to_cell(value))


def insert_gaps(places: Sequence[int], cells: Sequence[Sequence[Cell]], size: int) -> Iterator[tuple[Cell, ...] | str]:
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
) -> tuple[list[OutputColumn], list[list[Cell]]]:
    """Make the columns of a measure (value, instant and mark) and their cells; no instants if all are the same."""
    measure, vector_name = head.measures[k], f"measure {k}"
    unit, size = units.find(measure.unit)
    heading = f"{measure.text} [{unit}]" if unit else measure.text  # also of a plain number, whose unit is 1
    columns = [OutputColumn(heading, vector=vector_name)]
    scale = size * largest_magnitude(selection.columns.values(k))
    results = [row.result.get_measure(k) for row in selection.rows.values()]
    cells: list[list[Cell]] = [[cell] for cell in _make_measure_cells(results, size, scale)]
    instants = {one.time for one in results if one.time is not None}
    if len(instants) > 1:
        columns.append(OutputColumn("at", "instant", "s", vector=vector_name))
        for line, one in zip(cells, results, strict=True):
            line.append(None if one.time is None else NumberCell(one.time, write="{:.5g}".format))
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


def _make_measure_cells(results: Sequence[MeasureValue], size: float, scale: float) -> list[Cell]:
    """Make the cells of a measure with the digits that their errors support; a word where there is no value.

    size: factor to the display unit
    scale: the largest value, in that unit
    """
    known = [(size * one.value, size * (one.error or 0.0)) for one in results if one.value is not None]
    numbers = iter(trim_cells([(value, error, choose_number_style(value, error, scale)) for value, error in known]))
    words = [MISSING_KINDS[one.word].mark if one.word else "" for one in results]
    return [next(numbers) if one.value is not None else word for one, word in zip(results, words, strict=True)]


def choose_number_style(value: float, error: float, scale: float) -> Style:
    """Choose the style of a number with the digits that its error supports.

    A value not above its error is 0 relative to a larger one, the `scale`, and unknown if there is none.
    """
    if value == 0.0 or not np.isfinite(value):
        return choose_style(0.0, 0.0)
    return choose_style(abs(value) if abs(value) > error else scale, error)
