"""Make the table below a sweep's rows: each measure with its extremes, their variants, and a sparkline."""

from __future__ import annotations

import numpy as np

from heuncli.analyses.sweep_rows import ParameterColumn, SweepHead, make_parameter_columns
from heuncli.analyses.variants.plans import Plan
from heuncli.app.commands.sweep.output.shown_rows import choose_number_style, format_parameter, pad_words
from heuncli.app.commands.sweep.output.top_k import ShownRows
from heuncli.output.documents.document import OutputColumn, OutputTable
from heuncli.output.tables.plurals import format_count
from heuncli.output.tables.sparkline import draw_histogram, draw_sparkline
from heuncli.results.results import Array
from heuncli.scene.file_format.quantity import NumberWithUnit
from heuncli.study.quantities.digits import largest_magnitude, trim_zeros
from heuncli.study.quantities.table_units import Units

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
    (one,) = parameters
    return f"{one.name} = {format_parameter(plan.find_values(number)[one.name])}{f' {one.unit}' if one.unit else ''}"


def draw_courses(
    plan: Plan, selection: ShownRows, k: int, spark_letters: str, limit: int | None
) -> tuple[list[str], int]:
    """Draw the sparklines of a measure, over the last axis or as a histogram of random draws, on one scale; also
    returns how many lines are left out.

    There is a line for each combination of the axes before, followed by the combination if there are several.
    """
    course_length = len(plan.draws.values) if plan.draws is not None else last_axis_length(plan)
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
    fixed = [one for one in make_parameter_columns(plan) if one.name not in moving]
    texts = ((one, format_parameter(values[one.name])) for one in fixed)
    return ", ".join(f"{one.name} = {text}{f' {one.unit}' if one.unit else ''}" for one, text in texts)


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


def last_axis_length(plan: Plan) -> int:
    """Return how many successive variants differ only in the last axis, or in all axes if they vary together."""
    return plan.size if plan.together or not plan.axes else len(plan.axes[-1].values)
