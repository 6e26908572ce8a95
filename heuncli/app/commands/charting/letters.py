"""A chart in letters, for the terminal: error of the motion downwards, time to the right, both logarithmic."""

from __future__ import annotations

import string

from heuncli.analyses.charting.results import ChartResults
from heuncli.app.commands.charting.scale import failures, points, power, scales, seconds
from heuncli.base.wrapping import wrapped

WIDTH = 100  # columns of the field
ROWS = 2  # a decade of error
MOST_ROWS = 36
LABEL = 8
SEVERAL = "+"
FLOOR = "."


def letters(chart: ChartResults) -> dict[str, str]:
    """A letter for each method."""
    names = string.ascii_lowercase + string.digits
    return {name: names[k % len(names)] for k, name in enumerate(chart.by_method)}


def draw(chart: ChartResults, width: int = WIDTH) -> str:
    """The chart as lines of text, no wider than the field and its labels; ends with a newline."""
    across, up = scales(chart)
    room = width - LABEL - 3
    decades = round(up.high - up.low)
    rows = max(2, min(MOST_ROWS, decades * ROWS))
    field = [[" "] * room for _ in range(rows + 1)]
    own = chart.reference.own["motion"]
    if own:
        field[_row(up.at(own), rows)] = [FLOOR, " "] * (room // 2) + [" "] * (room % 2)
    letter, lost = letters(chart), [" "] * room
    taken: dict[tuple[int, int], str] = {}
    fronts: dict[tuple[int, int], str] = {}
    for name, runs in chart.by_method.items():
        for point in points(runs):
            cell = _row(up.at(point.error), rows), _column(across.at(point.seconds), room)
            if point.front:
                fronts[cell] = letter[name].upper()
            taken[cell] = letter[name] if taken.get(cell, letter[name]) == letter[name] else SEVERAL
        for run in failures(runs):
            place = _column(across.at(run.seconds) if run.seconds else 1.0, room)
            lost[place] = letter[name] if lost[place] in (" ", letter[name]) else SEVERAL
    for (row, column), shown in (taken | fronts).items():
        field[row][column] = shown
    marks = {_row(up.at(v), rows): power(v) for v in up.decades}
    lines = [f"{marks.get(k, ''):>{LABEL}} |{''.join(row).rstrip()}" for k, row in enumerate(field)]
    if any(mark != " " for mark in lost):
        lines.insert(0, f"{'failed':>{LABEL}} |{''.join(lost).rstrip()}")
    ticks = {_column(across.at(v), room): seconds(v) for v in (*across.decades, *across.between)}
    axis = "".join("+" if k in ticks else "-" for k in range(room))
    lines += [f"{'':{LABEL}} +{axis}", f"{'':{LABEL}}  {_under(ticks, room)}"]
    return "\n".join([*lines, *legend(letter, bool(own), width)]) + "\n"


def legend(letter: dict[str, str], floor: bool, width: int) -> list[str]:
    """Which letter is which method."""
    text = ", ".join(f"{mark} {name}" for name, mark in letter.items())
    about = f"error of the motion against time; capitals: the front, {SEVERAL} several" + (
        f", {FLOOR} {FLOOR} {FLOOR} what the reference may err by" if floor else ""
    )
    return [line for part in (text, about) for line in wrapped(f"{'':{LABEL}}  {part}", width, 0)]


def _row(share: float, rows: int) -> int:
    return round((1.0 - share) * rows)


def _column(share: float, room: int) -> int:
    return round(share * (room - 1))


def _under(ticks: dict[int, str], room: int) -> str:
    """The names of the ticks, each begun under its own where there is room."""
    line = [" "] * (room + LABEL)
    for place, text in sorted(ticks.items()):
        begin = max(place - len(text) // 2, 0)
        if all(c == " " for c in line[max(begin - 1, 0) : begin + len(text) + 1]):
            line[begin : begin + len(text)] = text
    return "".join(line).rstrip()
