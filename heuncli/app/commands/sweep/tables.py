"""Make the tables of a sweep: its rows, with marks for extremes, and each measure with its extremes and course."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.analyses.sweep_rows import ParameterColumn, SweepHead, make_parameter_columns, to_cell
from heuncli.analyses.variants.measures import MISSING_KINDS, MeasureValue
from heuncli.analyses.variants.plans import Plan
from heuncli.app.commands.sweep.statistics import MeasureExtremes, ShownRows
from heuncli.output.documents.as_text import draw_histogram, draw_sparkline
from heuncli.output.documents.document import Cell, NumberCell, OutputColumn, OutputTable, format_cell, trim_cells
from heuncli.output.tables.nouns import format_count
from heuncli.results.results import Array
from heuncli.scene.file_format.quantity import NumberWithUnit, ParameterValue
from heuncli.study.quantities.digits import OPEN, OPEN_NOTE, UNKNOWN, Style, choose_style, largest_magnitude, trim_zeros
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
    columns = [OutputColumn("variant", "text")] * has_numbers + [
        make_parameter_column(parameter) for parameter in parameters
    ]
    cells: list[list[Cell]] = [
        [row.number] * has_numbers + [to_cell(row.values[parameter.name]) for parameter in parameters]
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


def make_parameter_column(parameter: ParameterColumn) -> OutputColumn:
    """Make the column of a parameter: of numbers with their unit, or of texts."""
    return OutputColumn(parameter.label, "text" if parameter.unit is None else "number", parameter.unit or "")


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
    instants = {value.time for value in results if value.time is not None}
    if len(instants) > 1:
        columns.append(OutputColumn("at", "instant", "s", vector=vector_name))
        for line, value in zip(cells, results, strict=True):
            line.append(None if value.time is None else NumberCell(value.time, write="{:.5g}".format))
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
    known = [(size * result.value, size * (result.error or 0.0)) for result in results if result.value is not None]
    numbers = iter(trim_cells([(value, error, choose_number_style(value, error, scale)) for value, error in known]))
    words = [MISSING_KINDS[result.word].mark if result.word else "" for result in results]
    return [next(numbers) if result.value is not None else word for result, word in zip(results, words, strict=True)]


def choose_number_style(value: float, error: float, scale: float) -> Style:
    """Choose the style of a number with the digits that its error supports.

    A value not above its error is 0 relative to a larger one, the `scale`, and unknown if there is none.
    """
    if value == 0.0 or not np.isfinite(value):
        return choose_style(0.0, 0.0)
    return choose_style(abs(value) if abs(value) > error else scale, error)


SPARK_WIDTH = 40  # letters of a line
MAX_COURSES = 12  # sparklines of a measure shown without --all
MAX_JUMPS = 4  # of a measure shown without --all
HEADING = "MEASURES  minimum and maximum, and their variants"


def make_summary_table(
    head: SweepHead, selection: ShownRows, units: Units, spark_letters: str, all_of_them: bool
) -> OutputTable:
    """Make the table with a row per measure; with several axes a row for each combination of those before the last."""
    rows: list[tuple[str, ...]] = [("measure", "min", "", "max", "", format_course_head(head.plan))]
    notes: list[str] = []
    for k, measure in enumerate(head.measures):
        unit, size = units.find(measure.unit)
        best = selection.extremes[k]
        ends = ["", "", "", ""]
        if best is not None:
            both_extremes = ((best.least, best.may_be_least), (best.greatest, best.may_be_greatest))
            ends = [
                text
                for place, candidates in both_extremes
                for text in _format_extreme(head, selection, k, place, candidates, size)
            ]
        letters, left_out = draw_courses(head.plan, selection, k, spark_letters, None if all_of_them else MAX_COURSES)
        rows.append((f"{measure.text} [{unit}]" if unit else measure.text, *ends, letters[0]))
        rows += [("", "", "", "", "", course) for course in letters[1:]]
        if left_out:
            notes.append(f"{measure.text}: {format_count(left_out, 'more line')}: --all")
        if best is not None and best.is_constant:
            notes.append(f"{measure.text}: the same in all variants within their errors")
        notes += list_jumps(head, selection, k, None if all_of_them else MAX_JUMPS)
    heads, *cells = zip(*(pad_words(column) for column in zip(*rows, strict=True)), strict=True)
    vectors = ("", "least", "least", "greatest", "greatest", "")
    columns = (OutputColumn(head, vector=vector) for head, vector in zip(heads[1:], vectors[1:], strict=True))
    return OutputTable(HEADING, (OutputColumn("measure", "text"), *columns), tuple(cells), tuple(notes))


def format_course_head(plan: Plan) -> str:
    """Return what the sparklines run over."""
    if plan.draws is not None:
        return "frequency, from min to max"
    if plan.together:
        return "over the variants"
    return f"over {plan.axes[-1].name}" if plan.axes else ""


def _format_extreme(
    head: SweepHead, selection: ShownRows, k: int, place: int, candidates: Array, size: float
) -> tuple[str, str]:
    """Format an extreme, and name the variant in which it occurs.

    candidates: which variants may have it as well
    """
    values, errors = selection.columns.values(k), selection.columns.errors(k)
    value, error = size * float(values[place]), size * float(errors[place])
    (text,) = trim_zeros([choose_number_style(value, error, size * largest_magnitude(values)).write(value)])
    variant_text = format_variant(head.plan, make_parameter_columns(head.plan), int(selection.columns.numbers[place]))
    others = int(np.count_nonzero(candidates)) - 1
    return text, f"{variant_text} or {others} more" if others else variant_text


def format_variant(plan: Plan, parameters: tuple[ParameterColumn, ...], number: int) -> str:
    """Return the name of a variant: its value if there is one parameter, else its number."""
    if len(parameters) != 1:
        return f"variant {number}"
    (parameter,) = parameters
    text = format_parameter(plan.find_values(number)[parameter.name])
    unit = f" {parameter.unit}" if parameter.unit else ""
    return f"{parameter.name} = {text}{unit}"


def draw_courses(
    plan: Plan, selection: ShownRows, k: int, spark_letters: str, limit: int | None
) -> tuple[list[str], int]:
    """Draw the sparklines of a measure, over the last axis or as a histogram of random draws, on one scale; also
    returns how many lines are left out.

    There is a line for each combination of the axes before, followed by the combination if there are several.
    """
    course_length = plan.course_length
    numbers, values = selection.columns.numbers, selection.columns.values(k)
    known = values[np.isfinite(values)]
    limits = (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)
    best = selection.extremes[k]
    if best is not None and best.is_constant:
        limits = limits[0], limits[0]
    combinations = numbers // course_length
    present = combinations[np.diff(combinations, prepend=-1) > 0]
    lines = []
    for combination in present[:limit].tolist():
        start = combination * course_length
        begin, end = np.searchsorted(numbers, (start, start + course_length)).tolist()
        if plan.draws is not None:
            line = draw_histogram(
                values[begin:end], limits, min(SPARK_WIDTH, max(8, (end - begin) // 8)), spark_letters
            )
        else:
            course = np.full(course_length, np.nan)
            course[numbers[begin:end] - start] = values[begin:end]
            line = draw_sparkline(course, SPARK_WIDTH, limits, spark_letters)
        lines.append(f"{line}  {format_combination(plan, start)}".rstrip() if len(present) > 1 else line)
    return lines or [""], max(len(present) - len(lines), 0)


def format_combination(plan: Plan, number: int) -> str:
    """Return the values that distinguish a sparkline from the others: `L = 0.1, case = warm`."""
    moving = {law.name for law in plan.draws.laws} if plan.draws is not None else {plan.axes[-1].name}
    values = plan.find_values(number)
    fixed = [parameter for parameter in make_parameter_columns(plan) if parameter.name not in moving]
    texts = ((parameter, format_parameter(values[parameter.name])) for parameter in fixed)
    return ", ".join(
        f"{parameter.name} = {text}{f' {parameter.unit}' if parameter.unit else ''}" for parameter, text in texts
    )


def list_jumps(head: SweepHead, selection: ShownRows, k: int, limit: int | None) -> list[str]:
    """Describe between which neighbours on the last axis a measure jumps."""
    jumps = [jump for jump in selection.jumps if jump.measure == k]
    lines = []
    for jump in jumps[:limit]:
        axis = head.plan.axes[-1]
        ends = " and ".join(format_parameter(NumberWithUnit(sample.x)) for sample in (jump.first, jump.second))
        place = f"{axis.name} = {ends} {axis.unit or ''}".rstrip()
        combination = format_combination(head.plan, jump.first.number)
        lines.append(f"{head.measures[k].text} jumps between {place}{combination and f', {combination}'}")
    if len(jumps) > len(lines):
        lines.append(f"{head.measures[k].text}: {format_count(len(jumps) - len(lines), 'more jump')}: --all")
    return lines
