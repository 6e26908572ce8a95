"""Draw a figure in the cells of a terminal: curves in braille, eight dots a cell, or in letters if it has no braille.

The items are those of output/drawing/figure.py. Curves have the colour of their pen if colours are shown. Otherwise the
pen's letter marks some places of a curve; without braille the curve is drawn with this letter.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from heuncli.base.spelling import wrap_text
from heuncli.base.text_safety import escape
from heuncli.output.drawing.axes import MINUS, choose_ticks
from heuncli.output.drawing.canvas import NO_PEN, RESET, Canvas, TerminalStyle
from heuncli.output.drawing.figure import (
    Band,
    Figure,
    Item,
    LegendEntry,
    Panel,
    PlaceLabel,
    SpaceKey,
    Trace,
    VerticalMark,
)
from heuncli.output.drawing.labels import count_columns, make_omitted_note, order_items
from heuncli.output.drawing.letter_items import DRAW_FUNCTIONS, choose_mark
from heuncli.output.drawing.style import PANEL_HEIGHT, find_pen

ROWS, MIN_ROWS = 12, 5  # of a panel of default height, minimum
ASPECT = 2.0  # height of a cell in widths
LABEL_WIDTH = 10  # columns left of a panel
N_LETTERS = 3  # pen letters along a curve
ZERO_STRIDE = 4  # columns between dots of the zero line
ALONG_AXIS = 0.999  # component of a world axis along a side of the drawing, from which its direction is told


def draw_text(figure: Figure, style: TerminalStyle) -> str:
    """Draw the figure as lines of text; ends with a newline."""
    lines = [line for text in (figure.title, *figure.words) if text for line in wrap_text(escape(text), style.width, 0)]
    lines += _draw_legend([*((name, number, "") for name, number in figure.legend), *figure.marks], style)
    omitted: list[str] = []
    for panel in figure.panels:
        rows, without_words = _draw_panel(panel, style)
        lines += ["", *rows]
        omitted += without_words
    lines += [
        line
        for note in (*figure.notes, *make_omitted_note(omitted))
        for line in wrap_text(escape(note), style.width, 2)
    ]
    text = "\n".join(lines) + "\n"
    return text if style.has_braille else text.replace(MINUS, "-")


def _draw_legend(entries: Sequence[LegendEntry], style: TerminalStyle) -> list[str]:
    """Return the samples of curves and marks with their names, as many in a line as fit."""
    lines, width_left = [""], style.width
    for name, number, mark in entries:
        sample = (
            choose_mark(mark, style, number)
            if mark
            else "⠤⠤"
            if style.has_colours and style.has_braille
            else find_pen(number).letter
        )
        entry_width = count_columns(sample) + 1 + count_columns(escape(name))
        if lines[-1] and entry_width + 3 > width_left:
            lines.append("")
            width_left = style.width
        text = f"\x1b[{find_pen(number).code}m{sample}{RESET}" if style.has_colours else sample
        lines[-1] += f"{'   ' if lines[-1] else ''}{text} {escape(name)}"
        width_left -= entry_width + 3
    return lines if entries else []


def _draw_panel(panel: Panel, style: TerminalStyle) -> tuple[list[str], list[str]]:
    """Return the lines of a panel with its axes, legend and key, and the words that found no room."""
    canvas = _make_canvas(panel, style)
    _draw_items(panel, canvas)
    omitted_words = _write_words(panel.items, canvas)
    letter_labels = [item for item in panel.items if isinstance(item, PlaceLabel) and item.letter]
    label_key, omitted_labels = _write_labels(letter_labels, canvas)
    if style.uses_letters and style.has_braille:
        _mark_curves(panel.items, canvas)
    heads = wrap_text(escape(_find_head(panel)), style.width, 0)
    legend = _draw_legend([(name, number, "") for name, number in panel.legend], style)
    lines = [*(head for head in heads if head), *legend]
    lines += _frame_bare_canvas(panel, canvas) if panel.is_bare else _frame_canvas(panel, canvas)
    return lines + label_key, omitted_words + omitted_labels


def _make_canvas(panel: Panel, style: TerminalStyle) -> Canvas:
    """Make the empty canvas of a panel, as wide as the terminal or, with equal scales, as both sides allow."""
    columns = max(style.width - LABEL_WIDTH - 2, 10)
    rows = max(MIN_ROWS, round(ROWS * panel.height / PANEL_HEIGHT))
    if panel.has_equal_scales:
        x_span, y_span = panel.x.high - panel.x.low, panel.y.high - panel.y.low
        columns_per_unit = min(columns / x_span, ASPECT * rows / y_span)
        columns, rows = max(2, round(columns_per_unit * x_span)), max(2, round(columns_per_unit * y_span / ASPECT))
    return Canvas(columns, rows, panel.x, panel.y, style)


def _draw_items(panel: Panel, canvas: Canvas) -> None:
    """Draw the line of zero and the items of a panel; beside curves no bands, whose edges look like curves."""
    if not panel.is_bare and panel.y.low < 0.0 < panel.y.high and not panel.y.tick_texts:
        zero, width = canvas.to_dot_y(0.0), canvas.columns * canvas.per_x - 1.0
        canvas.draw_line(0.0, zero, width, zero, NO_PEN, ZERO_STRIDE * canvas.per_x)
    hides_bands = any(isinstance(item, Trace) for item in panel.items)
    for item in panel.items:
        if hides_bands and isinstance(item, Band):
            continue
        draw: Callable[[Any, Canvas], None] = DRAW_FUNCTIONS[type(item)]
        draw(item, canvas)


def _frame_bare_canvas(panel: Panel, canvas: Canvas) -> list[str]:
    """Return the lines of a canvas without axes, with the key of its space below."""
    scale = canvas.columns / (panel.x.high - panel.x.low)
    key = format_key(panel.key, scale, canvas.style) if panel.key is not None else []
    indent = "" if panel.has_equal_scales else " " * (LABEL_WIDTH + 2)  # as panels with axes on the same axis
    return [*(f"{indent}{line}".rstrip() for line in canvas.format_lines()), *key]


def _frame_canvas(panel: Panel, canvas: Canvas) -> list[str]:
    """Return the lines of a canvas between its axes, with the words above it."""
    words_above = {
        round(canvas.to_dot_x(item.x)) // canvas.per_x: item.text
        for item in panel.items
        if isinstance(item, VerticalMark) and item.is_above
    }
    ticks = choose_ticks(panel.y, max(2, canvas.rows // 3))
    tick_texts = {round(canvas.to_dot_y(value)) // canvas.per_y: text for value, text in ticks}
    bar = "│" if canvas.style.has_braille else "|"
    rows = [
        f"{escape(tick_texts.get(row, ''))[:LABEL_WIDTH]:>{LABEL_WIDTH}} {bar}{text}"
        for row, text in enumerate(canvas.format_lines())
    ]
    above = [_center_words(words_above, canvas)] if words_above else []
    return [*above, *rows, *_draw_x_axis(panel, canvas)]


def _write_words(items: Sequence[Item], canvas: Canvas) -> list[str]:
    """Write the words of spots and vertical marks where there is room; return the others."""
    omitted: list[str] = []
    for item in order_items(items):
        column = round(canvas.to_dot_x(item.x)) // canvas.per_x
        if isinstance(item, VerticalMark):
            has_room = canvas.write_at_top(escape(item.text), column)
        else:
            row = round(canvas.to_dot_y(item.y)) // canvas.per_y
            number = NO_PEN if item.pen is None else item.pen
            has_room = canvas.write_near(escape(item.text), column, row, number)
        if not has_room:
            omitted.append(item.note or item.text)
    return omitted


def _write_labels(items: Sequence[PlaceLabel], canvas: Canvas) -> tuple[list[str], list[str]]:
    """Write the letters of labels; return their explanations, and the labels that found no room."""
    explanations: dict[str, None] = {}
    omitted: list[str] = []
    for item in items:
        column, row = round(canvas.to_dot_x(item.x)) // canvas.per_x, round(canvas.to_dot_y(item.y)) // canvas.per_y
        if canvas.write_touching(escape(item.letter), column, row, NO_PEN if item.pen is None else item.pen):
            explanations |= {_explain_letter(item): None} if item.letter != item.text else {}
        elif not item.is_optional:
            omitted.append(item.text)
    return wrap_text(escape(", ".join(explanations)), canvas.style.width, 2) if explanations else [], omitted


def _explain_letter(label: PlaceLabel) -> str:
    """Return a letter with what it stands for; a name that begins with it is not repeated."""
    return label.text if label.text.startswith(f"{label.letter} ") else f"{label.letter} {label.text}"


def _mark_curves(items: Sequence[Item], canvas: Canvas) -> None:
    """Write the letter of its pen at some places of each curve where no other curve passes."""
    several = len({item.pen for item in items if isinstance(item, Trace)}) > 1
    for item in items if several else ():
        if not isinstance(item, Trace):
            continue
        is_known = np.isfinite(item.x) & np.isfinite(item.y)
        cells = [
            (round(canvas.to_dot_y(y)) // canvas.per_y, round(canvas.to_dot_x(x)) // canvas.per_x)
            for x, y in zip(item.x[is_known].tolist(), item.y[is_known].tolist(), strict=True)
        ]
        free_cells = [cell for cell in dict.fromkeys(cells) if _has_one_curve(canvas, cell, item.pen)]
        for k in range(N_LETTERS):
            if free_cells:
                row, column = free_cells[min(round((k + 0.5) / N_LETTERS * len(free_cells)), len(free_cells) - 1)]
                canvas.write(find_pen(item.pen).letter, column, row)


def _has_one_curve(canvas: Canvas, cell: tuple[int, int], number: int) -> bool:
    """Return whether only the curve of one pen passes a cell."""
    row, column = cell
    inside = 0 <= row < canvas.rows and 0 <= column < canvas.columns
    return inside and cell not in canvas.words and canvas.pens[row, column] == number


def _find_head(panel: Panel) -> str:
    """Return the title and the label of the vertical axis, which stand above the panel."""
    title, label = panel.title.replace("\n", "; "), "" if panel.is_bare else panel.y.label
    name, _, unit = label.partition(" [")
    if name and title.endswith(f" {name}"):  # the title names the quantity, too
        return f"{title} [{unit}"
    return " ".join(part for part in (title, label) if part)


def _draw_x_axis(panel: Panel, canvas: Canvas) -> list[str]:
    """Return the horizontal axis with its numbers and label."""
    places = {
        round(canvas.to_dot_x(v)) // canvas.per_x: text
        for v, text in choose_ticks(panel.x, max(2, canvas.columns // 12))
    }
    rule, cross = ("─", "┴") if canvas.style.has_braille else ("-", "+")
    axis = "".join(cross if k in places else rule for k in range(canvas.columns))
    corner = "└" if canvas.style.has_braille else "+"
    lines = [f"{'':{LABEL_WIDTH}} {corner}{axis}"]
    if not panel.x.shown_label:
        return lines
    middle = max(0, (canvas.columns - len(panel.x.shown_label)) // 2)
    return [*lines, _center_words(places, canvas), f"{'':{LABEL_WIDTH}}  {'':{middle}}{escape(panel.x.shown_label)}"]


def _center_words(places: Mapping[int, str], canvas: Canvas) -> str:
    """Return a line with words centred at columns of a panel, as many as do not touch, within the panel's edge."""
    width = canvas.columns + LABEL_WIDTH + 2
    line = [" "] * width
    for place, words in sorted(places.items()):
        text = escape(words)
        begin = min(max(place - len(text) // 2, 0) + LABEL_WIDTH + 2, width - len(text))
        if begin >= 0 and all(c == " " for c in line[max(begin - 1, 0) : begin + len(text) + 1]):
            line[begin : begin + len(text)] = text
    return "".join(line).rstrip()


def format_key(key: SpaceKey, columns_per_unit: float, style: TerminalStyle) -> list[str]:
    """Return the lines of a key; each arrow is as long as its value, to the column."""
    rule, ends, head = ("─", "├┤", "▶") if style.has_braille else ("-", "||", ">")
    bar = rule * max(0, round(columns_per_unit * key.bar[0]) - 2)
    lines = [f"{ends[0]}{bar}{ends[1]} {escape(key.bar[1])}"]
    sides = [f"{name} {side}" for name, a, b in key.axes if (side := _find_side(a, b))]
    lines[0] += f"   {', '.join(sides)}" if sides else ""
    for arrow in key.arrows:
        heads = head * (1 + arrow.is_double)
        shaft = rule * max(0, round(columns_per_unit * arrow.length) - len(heads)) + heads
        if style.has_colours and arrow.pen is not None:
            shaft = f"\x1b[{find_pen(arrow.pen).code}m{shaft}{RESET}"
        lines.append(f"{shaft} {escape(arrow.text)}")
    return lines


def _find_side(a: float, b: float) -> str:
    """Return the side of the drawing to which a world axis points; empty if it points to none."""
    if max(abs(a), abs(b)) < ALONG_AXIS:
        return ""
    return ("right" if a > 0.0 else "left") if abs(a) > abs(b) else "up" if b > 0.0 else "down"
