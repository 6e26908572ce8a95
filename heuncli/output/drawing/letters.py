"""A figure in the cells of a terminal: curves in braille, eight dots a cell, or in letters where it shows no braille.

The items are those of output/drawing/figure.py. Curves keep the colour of their pen where colours are shown; else the
pen's letter stands at some places of a curve, and where there is no braille it is drawn with it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from heuncli.base.foreign_text import shown
from heuncli.base.wrapping import wrapped
from heuncli.output.drawing.canvas import NOBODY, RESET, Canvas, Look
from heuncli.output.drawing.figure import HEIGHT, Figure, Item, Panel, PlaceLabel, Trace, Upright
from heuncli.output.drawing.letter_items import DRAWN, mark_of
from heuncli.output.drawing.pens import pen
from heuncli.output.drawing.room import columns_of, left_out
from heuncli.output.drawing.ticks import ticks
from heuncli.output.drawing.words import in_turn

ROWS, LEAST_ROWS = 12, 5  # of a panel as high as most, and of any
ASPECT = 2.0  # how much higher than wide a cell is
LABEL = 10  # columns left of a panel
LETTERS = 3  # of its pen along a curve
ZERO = 4  # columns from dot to dot of the line at zero


def drawn(figure: Figure, look: Look) -> str:
    """The figure as lines of text; ends with a newline."""
    lines = [line for text in (figure.title, *figure.words) if text for line in wrapped(shown(text), look.width, 0)]
    lines += _legend(figure, look)
    told: list[str] = []
    for panel in figure.panels:
        rows, without_words = _panel(panel, look)
        lines += ["", *rows]
        told += without_words
    lines += [line for note in (*figure.notes, *left_out(told)) for line in wrapped(shown(note), look.width, 2)]
    return "\n".join(lines) + "\n"


def _legend(figure: Figure, look: Look) -> list[str]:
    """How each curve and mark is told, as many in a line as fit."""
    lines, room = [""], look.width
    entries = [*((name, number, "") for name, number in figure.legend), *figure.marks]
    for name, number, mark in entries:
        sample = mark_of(mark, look, number) if mark else "⠤⠤" if look.colours and look.braille else pen(number).letter
        wide = columns_of(sample) + 1 + columns_of(shown(name))
        if lines[-1] and wide + 3 > room:
            lines.append("")
            room = look.width
        text = f"\x1b[{pen(number).code}m{sample}{RESET}" if look.colours else sample
        lines[-1] += f"{'   ' if lines[-1] else ''}{text} {shown(name)}"
        room -= wide + 3
    return lines if entries else []


def _panel(panel: Panel, look: Look) -> tuple[list[str], list[str]]:
    """A panel with its axes, and what is told of words that found no room."""
    room = max(look.width - LABEL - 2, 10)
    rows = max(LEAST_ROWS, round(ROWS * panel.height / HEIGHT))
    columns = room
    if panel.equal:
        across, up = panel.x.high - panel.x.low, panel.y.high - panel.y.low
        unit = min(room / across, ASPECT * rows / up)  # columns a unit
        columns, rows = max(2, round(unit * across)), max(2, round(unit * up / ASPECT))
    canvas = Canvas(columns, rows, panel.x, panel.y, look)
    if not panel.bare and panel.y.low < 0.0 < panel.y.high and not panel.y.named:
        canvas.line(0.0, canvas.y(0.0), columns * canvas.per_x - 1.0, canvas.y(0.0), NOBODY, ZERO * canvas.per_x)
    for item in panel.items:
        draw: Callable[[Any, Canvas], None] = DRAWN[type(item)]
        draw(item, canvas)
    told = _spoken(panel.items, canvas)
    key, unnamed = _labels([item for item in panel.items if isinstance(item, PlaceLabel) and item.letter], canvas)
    told += unnamed
    if look.letters and look.braille:
        _named(panel.items, canvas)
    heads = wrapped(shown(" ".join(part for part in (panel.title, _upward(panel)) if part)), look.width, 0)
    lines = [*(head for head in heads if head)]
    if panel.bare:
        return lines + canvas.lines() + key, told
    above = {round(canvas.x(i.x)) // canvas.per_x: i.text for i in panel.items if isinstance(i, Upright) and i.above}
    lines += [_placed(above, canvas)] if above else []
    marks = {round(canvas.y(v)) // canvas.per_y: text for v, text in ticks(panel.y, max(2, rows // 3))}
    for row, text in enumerate(canvas.lines()):
        lines.append(
            f"{shown(marks.get(row, ''))[:LABEL]:>{LABEL}} │{text}"
            if look.braille
            else f"{shown(marks.get(row, ''))[:LABEL]:>{LABEL}} |{text}"
        )
    return lines + _below(panel, canvas) + key, told


def _spoken(items: Sequence[Item], canvas: Canvas) -> list[str]:
    """The words of spots and vertical marks where they find room; what is told of the others."""
    told: list[str] = []
    for item in in_turn(items):
        column = round(canvas.x(item.x)) // canvas.per_x
        if isinstance(item, Upright):
            has_room = canvas.along(shown(item.text), column)
        else:
            row = round(canvas.y(item.y)) // canvas.per_y
            number = NOBODY if item.pen is None else item.pen
            has_room = canvas.beside(shown(item.text), column, row, number)
        if not has_room:
            told.append(item.note or item.text)
    return told


def _labels(items: Sequence[PlaceLabel], canvas: Canvas) -> tuple[list[str], list[str]]:
    """The letters of labels, and what they stand for; what is told of those that found no room."""
    known: dict[str, None] = {}
    told: list[str] = []
    for item in items:
        column, row = round(canvas.x(item.x)) // canvas.per_x, round(canvas.y(item.y)) // canvas.per_y
        if canvas.at(shown(item.letter), column, row, NOBODY if item.pen is None else item.pen):
            known |= {_meant(item): None} if item.letter != item.text else {}
        elif not item.spare:
            told.append(item.text)
    return wrapped(shown(", ".join(known)), canvas.look.width, 2) if known else [], told


def _meant(label: PlaceLabel) -> str:
    """What a letter stands for, with it; a name is not told twice."""
    return label.text if label.text.startswith(f"{label.letter} ") else f"{label.letter} {label.text}"


def _named(items: Sequence[Item], canvas: Canvas) -> None:
    """The letter of its pen at some places of each curve, where no other one passes."""
    several = len({item.pen for item in items if isinstance(item, Trace)}) > 1
    for item in items if several else ():
        if not isinstance(item, Trace):
            continue
        known = np.isfinite(item.x) & np.isfinite(item.y)
        cells = [
            (round(canvas.y(y)) // canvas.per_y, round(canvas.x(x)) // canvas.per_x)
            for x, y in zip(item.x[known].tolist(), item.y[known].tolist(), strict=True)
        ]
        own = [cell for cell in dict.fromkeys(cells) if _is_own(canvas, cell, item.pen)]
        for k in range(LETTERS):
            if own:
                row, column = own[min(round((k + 0.5) / LETTERS * len(own)), len(own) - 1)]
                canvas.write(pen(item.pen).letter, column, row)


def _is_own(canvas: Canvas, cell: tuple[int, int], number: int) -> bool:
    """Whether one curve alone passes a cell."""
    row, column = cell
    inside = 0 <= row < canvas.rows and 0 <= column < canvas.columns
    return inside and cell not in canvas.words and canvas.pens[row, column] == number


def _upward(panel: Panel) -> str:
    """What the axis upwards tells, above the panel."""
    return "" if panel.bare else panel.y.label


def _below(panel: Panel, canvas: Canvas) -> list[str]:
    """The axis across with its numbers and what it tells."""
    places = {round(canvas.x(v)) // canvas.per_x: text for v, text in ticks(panel.x, max(2, canvas.columns // 12))}
    rule, cross = ("─", "┴") if canvas.look.braille else ("-", "+")
    axis = "".join(cross if k in places else rule for k in range(canvas.columns))
    corner = "└" if canvas.look.braille else "+"
    lines = [f"{'':{LABEL}} {corner}{axis}"]
    if not panel.x.shown_label:
        return lines
    middle = max(0, (canvas.columns - len(panel.x.shown_label)) // 2)
    return [*lines, _placed(places, canvas), f"{'':{LABEL}}  {'':{middle}}{shown(panel.x.shown_label)}"]


def _placed(places: Mapping[int, str], canvas: Canvas) -> str:
    """A line with words about columns of a panel, as many as do not touch; none goes farther than the panel's edge."""
    most = canvas.columns + LABEL + 2
    line = [" "] * most
    for place, words in sorted(places.items()):
        text = shown(words)
        begin = min(max(place - len(text) // 2, 0) + LABEL + 2, most - len(text))
        if begin >= 0 and all(c == " " for c in line[max(begin - 1, 0) : begin + len(text) + 1]):
            line[begin : begin + len(text)] = text
    return "".join(line).rstrip()
