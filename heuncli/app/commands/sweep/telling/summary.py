"""The table below a sweep's rows: of each measure its least and greatest value, where, and its course in letters."""

from __future__ import annotations

import numpy as np

from heuncli.analyses.sweep_store.columns import ParameterColumn, parameters_of
from heuncli.analyses.sweep_store.rows import SweepHead
from heuncli.analyses.variants.plans import Plan
from heuncli.app.commands.sweep.telling.kept_rows import KeptRows
from heuncli.app.commands.sweep.telling.shown_rows import number_text, parameter_text, words
from heuncli.output.tables.plurals import count
from heuncli.output.tables.sparkline import histogram, sparkline
from heuncli.output.tables.text_table import TextColumn, TextTable
from heuncli.results.results import Array
from heuncli.study.quantities.digits import largest, trim
from heuncli.study.quantities.table_units import Units

SPARK = 40  # letters of a line
MOST_COURSES = 12  # lines of letters of a measure that are shown without --all
HEADING = "MEASURES  least and greatest, and the variants that have them"


def summary(head: SweepHead, shown: KeptRows, units: Units, by: str, all_of_them: bool) -> TextTable:
    """A line a measure; where there is more than one axis, a line for each combination of those before the last."""
    rows: list[tuple[str, ...]] = [("measure", "least", "", "greatest", "", course_head(head.plan))]
    notes: list[str] = []
    for k, measure in enumerate(head.measures):
        unit, size = units.of(measure.unit)
        best = shown.extremes[k]
        ends = ["", "", "", ""]
        if best is not None:
            of_both = ((best.least, best.least_too), (best.greatest, best.greatest_too))
            ends = [text for place, too in of_both for text in _end(head, shown, k, place, too, size)]
        letters, left_out = courses(head.plan, shown, k, by, None if all_of_them else MOST_COURSES)
        rows.append((f"{measure.text} [{unit}]" if unit else measure.text, *ends, letters[0]))
        rows += [("", "", "", "", "", course) for course in letters[1:]]
        if left_out:
            notes.append(f"{measure.text}: {count(left_out, 'line')} of letters more: --all")
        if best is not None and best.flat:
            notes.append(f"{measure.text}: the same in all variants, as far as their errors tell")
    heads, *cells = zip(*(words(column) for column in zip(*rows, strict=True)), strict=True)
    vectors = ("", "least", "least", "greatest", "greatest", "")
    columns = (TextColumn(head, vector=vector) for head, vector in zip(heads[1:], vectors[1:], strict=True))
    return TextTable(HEADING, (TextColumn("measure", "left"), *columns), tuple(cells), tuple(notes))


def course_head(plan: Plan) -> str:
    """What the letters run over."""
    if plan.draws is not None:
        return "how often, from least to greatest"
    if plan.together:
        return "over the variants"
    return f"over {plan.axes[-1].name}" if plan.axes else ""


def _end(head: SweepHead, shown: KeptRows, k: int, place: int, too: Array, size: float) -> tuple[str, str]:
    """An extreme, and the variant that has it; too: which may have it as well."""
    values, errors = shown.gathered.values(k), shown.gathered.errors(k)
    (text,) = trim([number_text(size * float(values[place]), size * float(errors[place]), size * largest(values))])
    at = where(head.plan, parameters_of(head.plan), int(shown.gathered.numbers[place]))
    others = int(np.count_nonzero(too)) - 1
    return text, f"{at} or {others} more" if others else at


def where(plan: Plan, parameters: tuple[ParameterColumn, ...], number: int) -> str:
    """A variant in words: its value if there is one parameter, else its number."""
    if len(parameters) != 1:
        return f"variant {number}"
    (one,) = parameters
    return f"{one.name} = {parameter_text(one, plan.values(number)[one.name])}{f' {one.unit}' if one.unit else ''}"


def courses(plan: Plan, shown: KeptRows, k: int, by: str, most: int | None) -> tuple[list[str], int]:
    """A measure in letters, over the last axis or of what is drawn, on one scale; how many lines are left out.

    A line for each combination of the axes before, which stands behind it where there are several.
    """
    of_one = len(plan.draws.values) if plan.draws is not None else last_axis(plan)
    numbers, values = shown.gathered.numbers, shown.gathered.values(k)
    known = values[np.isfinite(values)]
    limits = (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)
    best = shown.extremes[k]
    if best is not None and best.flat:
        limits = limits[0], limits[0]
    combinations = numbers // of_one
    present = combinations[np.diff(combinations, prepend=-1) > 0]
    lines = []
    for combination in present[:most].tolist():
        start = combination * of_one
        begin, end = np.searchsorted(numbers, (start, start + of_one)).tolist()
        if plan.draws is not None:
            line = histogram(values[begin:end], limits, min(SPARK, max(8, (end - begin) // 8)), by)
        else:
            course = np.full(of_one, np.nan)
            course[numbers[begin:end] - start] = values[begin:end]
            line = sparkline(course, SPARK, limits, by)
        lines.append(f"{line}  {combination_text(plan, start)}".rstrip() if len(present) > 1 else line)
    return lines or [""], max(len(present) - len(lines), 0)


def combination_text(plan: Plan, number: int) -> str:
    """The values by which a line of letters differs from the others: `L = 0.1, case = warm`."""
    moving = {law.name for law in plan.draws.laws} if plan.draws is not None else {plan.axes[-1].name}
    values = plan.values(number)
    fixed = [one for one in parameters_of(plan) if one.name not in moving]
    texts = ((one, parameter_text(one, values[one.name])) for one in fixed)
    return ", ".join(f"{one.name} = {text}{f' {one.unit}' if one.unit else ''}" for one, text in texts)


def last_axis(plan: Plan) -> int:
    """How many variants in a row differ in the last axis alone, or in all together."""
    return plan.size if plan.together or not plan.axes else len(plan.axes[-1].texts)
