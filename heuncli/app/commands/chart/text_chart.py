"""Draw a chart as text, for the terminal: error of the motion downwards, time to the right, both logarithmic."""

from __future__ import annotations

import string

from heuncli.analyses.work_precision.results import ChartResults
from heuncli.app.commands.chart.scale import choose_scales, format_power, format_seconds, list_failures, list_points
from heuncli.base.wrapping import wrap_text

WIDTH = 100  # columns of the field
ROWS = 2  # a decade of error
MAX_ROWS = 36
LABEL = 8
SEVERAL = "+"
FLOOR = "."


def assign_letters(chart: ChartResults) -> dict[str, str]:
    """Return a letter for each method."""
    names = string.ascii_lowercase + string.digits
    return {name: names[k % len(names)] for k, name in enumerate(chart.runs_by_method)}


def draw_text_chart(chart: ChartResults, width: int = WIDTH) -> str:
    """Draw the chart as lines of text, no wider than the field and its labels; ends with a newline."""
    time_scale, error_scale = choose_scales(chart)
    columns = width - LABEL - 3
    decades = round(error_scale.high - error_scale.low)
    rows = max(2, min(MAX_ROWS, decades * ROWS))
    field = [[" "] * columns for _ in range(rows + 1)]
    reference_error = chart.reference.error["motion"]
    if reference_error:
        field[_find_row(error_scale.locate(reference_error), rows)] = [FLOOR, " "] * (columns // 2) + [" "] * (
            columns % 2
        )
    letter, failed_line = assign_letters(chart), [" "] * columns
    cells: dict[tuple[int, int], str] = {}
    fronts: dict[tuple[int, int], str] = {}
    for name, runs in chart.runs_by_method.items():
        for point in list_points(runs):
            cell = (
                _find_row(error_scale.locate(point.error), rows),
                _find_column(time_scale.locate(point.seconds), columns),
            )
            if point.front:
                fronts[cell] = letter[name].upper()
            cells[cell] = letter[name] if cells.get(cell, letter[name]) == letter[name] else SEVERAL
        for run in list_failures(runs):
            place = _find_column(time_scale.locate(run.seconds) if run.seconds else 1.0, columns)
            failed_line[place] = letter[name] if failed_line[place] in (" ", letter[name]) else SEVERAL
    for (row, column), symbol in (cells | fronts).items():
        field[row][column] = symbol
    marks = {_find_row(error_scale.locate(v), rows): format_power(v) for v in error_scale.decades}
    lines = [f"{marks.get(k, ''):>{LABEL}} |{''.join(row).rstrip()}" for k, row in enumerate(field)]
    if any(mark != " " for mark in failed_line):
        lines.insert(0, f"{'failed':>{LABEL}} |{''.join(failed_line).rstrip()}")
    ticks = {
        _find_column(time_scale.locate(v), columns): format_seconds(v)
        for v in (*time_scale.decades, *time_scale.minor_ticks)
    }
    axis = "".join("+" if k in ticks else "-" for k in range(columns))
    lines += [f"{'':{LABEL}} +{axis}", f"{'':{LABEL}}  {_draw_tick_labels(ticks, columns)}"]
    return "\n".join([*lines, *make_legend(letter, bool(reference_error), width)]) + "\n"


def make_legend(letter: dict[str, str], floor: bool, width: int) -> list[str]:
    """Return the lines that say which letter is which method."""
    text = ", ".join(f"{mark} {name}" for name, mark in letter.items())
    about = f"error of the motion against time; capitals: Pareto front, {SEVERAL} several" + (
        f", {FLOOR} {FLOOR} {FLOOR} error of the reference" if floor else ""
    )
    return [line for part in (text, about) for line in wrap_text(f"{'':{LABEL}}  {part}", width, 0)]


def _find_row(share: float, rows: int) -> int:
    return round((1.0 - share) * rows)


def _find_column(share: float, columns: int) -> int:
    return round(share * (columns - 1))


def _draw_tick_labels(ticks: dict[int, str], columns: int) -> str:
    """Draw the labels of the ticks, each centred below its tick if there is space."""
    line = [" "] * (columns + LABEL)
    for place, text in sorted(ticks.items()):
        begin = max(place - len(text) // 2, 0)
        if all(c == " " for c in line[max(begin - 1, 0) : begin + len(text) + 1]):
            line[begin : begin + len(text)] = text
    return "".join(line).rstrip()
