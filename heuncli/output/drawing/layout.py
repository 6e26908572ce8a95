"""Lay out a figure in pixels: its heading, its panels in rows and columns, their axes, legends and notes."""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.base.spelling import wrap_text
from heuncli.base.text_safety import escape
from heuncli.output.drawing import style
from heuncli.output.drawing.axes import PanelBox, lay_out_axes
from heuncli.output.drawing.figure import BAR, Bars, Figure, LegendEntry, Panel, PlaceLabel, VerticalMark
from heuncli.output.drawing.item_shapes import draw_item
from heuncli.output.drawing.label_placement import WordBox, make_omitted_note
from heuncli.output.drawing.labels import (
    drop_close_marks,
    drop_covered_words,
    estimate_width,
    make_field,
    place_labels,
    place_words,
)
from heuncli.output.drawing.shapes import Area, Line, Mark, Shape, Text, VectorDrawing
from heuncli.output.drawing.space_key import choose_sheet_width, lay_out_key
from heuncli.output.drawing.style import find_pen

MARGIN = style.INDENT  # pixels at the edge of a row of panels
MIN_MARK_DISTANCE = 2.0  # pixels between vertical marks
GAP = 14.0  # pixels between panels of a row
SAMPLE = 28.0  # pixels of the stroke before a name in a legend
BAR_SAMPLE = ((-6.0, -5.0), (6.0, -5.0), (6.0, 5.0), (-6.0, 5.0))  # corners of the piece of a bar there
BOLD = 1.08  # width of bold letters
DRAWING_ORDER = {Area: 0, Line: 1, Mark: 2, Text: 3}  # later ones cover earlier ones
LAYERED_ORDER = {Area: 0, Line: 0, Mark: 0, Text: 1}


def lay_out(figure: Figure, width: float = style.WIDTH) -> VectorDrawing:
    """Lay out a figure; width: of the sheet, which is narrower if all that it shows is narrow."""
    width = choose_sheet_width(figure, width)
    shapes, y = _lay_out_heading(figure, width)
    entries = [*((name, number, "") for name, number in figure.legend), *figure.marks]
    shapes += (legend := _lay_out_legend(entries, style.INDENT, y + 4.0, width))[0]
    y = legend[1] + 8.0 if entries else y
    omitted: list[str] = []
    for first in range(0, len(figure.panels), figure.n_columns):
        row = figure.panels[first : first + figure.n_columns]
        y, row_shapes, without_words = _lay_out_row(row, figure.n_columns, y, width)
        shapes += row_shapes
        omitted += without_words
    notes = [*figure.notes, *make_omitted_note(omitted)]
    y += 6.0 if notes else 0.0
    for note in notes:
        for text in _wrap(note, style.SMALL_SIZE, width - 2.0 * style.INDENT):
            shapes.append(Text(style.INDENT, y + 6.0, text, style.SMALL_SIZE, colour=style.GREY))
            y += style.LINE_HEIGHT
    y += style.BOTTOM if figure.title else 0.0
    return VectorDrawing(width, y, escape(figure.title), "; ".join(map(escape, figure.words)), shapes)


def _lay_out_heading(figure: Figure, width: float) -> tuple[list[Shape], float]:
    """Return the title and the description of the figure, and the y below them."""
    shapes: list[Shape] = []
    y = style.TOP if figure.title or figure.words else style.BARE_TOP
    for text in _wrap(figure.title, style.TITLE_SIZE * BOLD, width - 2.0 * style.INDENT):
        shapes.append(Text(style.INDENT, y, text, style.TITLE_SIZE, is_bold=True))
        y += style.TITLE_HEIGHT
    for sentence in figure.words:
        for text in _wrap(sentence, style.SMALL_SIZE, width - 2.0 * style.INDENT):
            shapes.append(Text(style.INDENT, y, text, style.SMALL_SIZE, colour=style.GREY))
            y += style.LINE_HEIGHT
    return shapes, y


def _wrap(text: str, size: float, width: float) -> list[str]:
    """Wrap a text to lines that fit into a width."""
    return wrap_text(escape(text), int(width / (style.LETTER_WIDTH * size)), 0) if text else []


def _lay_out_legend(entries: Sequence[LegendEntry], left: float, y: float, width: float) -> tuple[list[Shape], float]:
    """Return a stroke or mark of each pen with its name, as many in a line as fit, and the base of the last line."""
    shapes: list[Shape] = []
    x = left
    for name, number, mark in entries:
        text = escape(name)
        entry_width = SAMPLE + 6.0 + estimate_width(text, style.SMALL_SIZE) + 14.0
        if x > left and x + entry_width > width - style.INDENT:
            x, y = left, y + style.LINE_HEIGHT
        pen = find_pen(number)
        if mark == BAR:
            corners = [(x + 0.5 * SAMPLE + a, y - 4.5 + b) for a, b in BAR_SAMPLE]
            shapes.append(Area(tuple(corners), pen.colour, style.BAR_OPACITY))
        elif mark:
            shapes.append(Mark(x + 0.5 * SAMPLE, y - 4.5, mark, pen.colour, False, style.MARK_SIZE))
        else:
            shapes.append(Line(((x, y - 4.5), (x + SAMPLE, y - 4.5)), pen.colour, style.CURVE_WIDTH, pen.dash))
        shapes.append(Text(x + SAMPLE + 6.0, y, text, style.SMALL_SIZE))
        x += entry_width
    return shapes, y


def _lay_out_row(
    row: Sequence[Panel], n_columns: int, top: float, width: float
) -> tuple[float, list[Shape], list[str]]:
    """Return the y below a row of panels, their shapes, and the words that find no room."""
    side = (width - 2.0 * MARGIN - GAP * (n_columns - 1)) / n_columns
    cells = [(MARGIN + k * (side + GAP), MARGIN + k * (side + GAP) + side) for k in range(len(row))]
    shapes: list[Shape] = []
    y = top
    for panel, (left, right) in zip(row, cells, strict=True):
        begin = left if n_columns > 1 else style.LEFT if panel.key is None else style.INDENT
        head_shapes, below = _lay_out_head(panel, begin, top, right)
        shapes += head_shapes
        y = max(y, below)
    bottom, omitted = y, list[str]()
    for panel, (left, right) in zip(row, cells, strict=True):
        edges = (left, right) if n_columns > 1 else (style.LEFT, width - style.RIGHT)
        if panel.key is not None:
            edges = (style.INDENT, width - style.INDENT)
        box = _make_box(panel, y, *edges)
        panel_shapes, without_words = _lay_out_panel(panel, box, WordBox(left, box.top, right, box.bottom))
        shapes += panel_shapes
        omitted += without_words
        below = box.bottom + (style.AXIS_SPACE if panel.x.shown_label and not panel.is_bare else style.PANEL_SPACE)
        if panel.key is not None:
            scale = (box.right - box.left) / (panel.x.high - panel.x.low)
            key_shapes, below = lay_out_key(panel.key, scale, box.bottom, width)
            shapes += key_shapes
        bottom = max(bottom, below)
    return bottom, shapes, omitted


def _lay_out_head(panel: Panel, left: float, top: float, right: float) -> tuple[list[Shape], float]:
    """Return the title and the legend of a panel, wrapped to its width, and the y where its field begins."""
    shapes: list[Shape] = []
    y = top + 6.0
    for k, line in enumerate(panel.title.split("\n") if panel.title else ()):
        size = style.SMALL_SIZE if k else style.NAME_SIZE
        for text in _wrap(line, size if k else size * BOLD, right - left):
            y += style.LINE_HEIGHT
            shapes.append(Text(left, y - 4.0, text, size, is_bold=not k))
    if panel.legend:
        mark = BAR if any(isinstance(item, Bars) for item in panel.items) else ""
        entries = [(name, number, mark) for name, number in panel.legend]
        legend, base = _lay_out_legend(entries, left, y + style.LINE_HEIGHT - 4.0, right + style.INDENT)
        shapes += legend
        y = base + 4.0
    y += 4.0 if shapes else 0.0
    has_words_above = any(isinstance(item, VerticalMark) and item.is_above for item in panel.items)
    return shapes, y + (style.LINE_HEIGHT if has_words_above else 0.0)


def _make_box(panel: Panel, top: float, left: float, right: float) -> PanelBox:
    """Return the field of a panel below a height; with equal scales it is as wide as needed, in the middle."""
    height = panel.height
    if panel.has_equal_scales:
        x_span, y_span = panel.x.high - panel.x.low, panel.y.high - panel.y.low
        scale = min((right - left) / x_span, height / y_span)
        middle = (left + right) / 2.0
        left, right, height = middle - scale * x_span / 2.0, middle + scale * x_span / 2.0, scale * y_span
    return PanelBox(left, top, right, top + height, panel.x, panel.y)


def _lay_out_panel(panel: Panel, box: PanelBox, cell: WordBox) -> tuple[list[Shape], list[str]]:
    """Return the axes and items of a panel, filled areas first and words last, and the words without room.

    cell: the area for words of a panel without axes
    """
    items = drop_covered_words(drop_close_marks(panel.items, box, MIN_MARK_DISTANCE), box)
    drawn_shapes = [shape for item in items for shape in draw_item(item, box)]
    order = LAYERED_ORDER if panel.is_layered else DRAWING_ORDER
    drawn_shapes.sort(key=lambda shape: order[type(shape)])
    n_filled = 0 if panel.is_layered else sum(isinstance(shape, Area) for shape in drawn_shapes)
    field = make_field(drawn_shapes, cell if panel.is_bare else WordBox(box.left, box.top, box.right, box.bottom))
    texts, omitted = place_words(items, box, field)
    labels, without_names = place_labels([item for item in items if isinstance(item, PlaceLabel)], box, field)
    grid, axes = ([], []) if panel.is_bare else lay_out_axes(box)
    return [*grid, *drawn_shapes[:n_filled], *axes, *drawn_shapes[n_filled:], *texts, *labels], omitted + without_names
