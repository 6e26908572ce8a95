"""Lay out a figure in pixels: its heading, its panels in rows and columns, their axes, legends and notes.

Below a view of a machine stand axes, a scale bar, gravity, the arrows of loads and the names of numbers.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from heuncli.base.spelling import wrap_text
from heuncli.base.text_safety import escape
from heuncli.output.drawing import style
from heuncli.output.drawing.axes import PanelBox, lay_out_axes
from heuncli.output.drawing.figure import (
    BAR,
    Bars,
    Figure,
    KeyArrow,
    LegendEntry,
    Panel,
    PlaceLabel,
    SpaceKey,
    VerticalMark,
)
from heuncli.output.drawing.item_shapes import draw_item
from heuncli.output.drawing.labels import (
    WordBox,
    drop_close_marks,
    drop_covered_words,
    estimate_width,
    make_field,
    make_omitted_note,
    place_labels,
    place_words,
)
from heuncli.output.drawing.shapes import Area, Line, Mark, Shape, Text, VectorDrawing, draw_arrow
from heuncli.output.drawing.style import (
    BLACK,
    GREY,
    INDENT,
    LINE_HEIGHT,
    SMALL_SIZE,
    SYMBOL_WIDTH,
    find_colour,
    find_pen,
)

MARGIN = style.INDENT  # pixels at the edge of a row of panels
MIN_MARK_DISTANCE = 2.0  # pixels between vertical marks
GAP = 14.0  # pixels between panels of a row
SAMPLE = 28.0  # pixels of the stroke before a name in a legend
BAR_SAMPLE = ((-6.0, -5.0), (6.0, -5.0), (6.0, 5.0), (-6.0, 5.0))  # corners of the piece of a bar there
BOLD = 1.08  # width of bold letters
DRAWING_ORDER = {Area: 0, Line: 1, Mark: 2, Text: 3}  # later ones cover earlier ones
LAYERED_ORDER = {Area: 0, Line: 0, Mark: 0, Text: 1}
MIN_WIDTH = 420.0  # pixels of a sheet, for its title and key
AXES_LENGTH, GRAVITY_LENGTH = 20.0, 26.0  # pixels of a unit vector
AXES_WIDTH, GRAVITY_WIDTH = 64.0, 42.0  # pixels of their places in the key
KEY_HEIGHT = 56.0  # pixels
KEY_GAP = 22.0  # pixels between the entries of the key
MAX_COLUMNS = 4  # of the names of numbers


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


def choose_sheet_width(figure: Figure, width: float) -> float:
    """Choose the width of the sheet: `width`, or, if a figure shows views of machines alone, what these need of it."""
    if not all(panel.key is not None for panel in figure.panels):
        return width
    needed = max(compute_view_width(panel, width) for panel in figure.panels) + 2.0 * INDENT
    return min(width, max(MIN_WIDTH, needed))


def compute_view_width(panel: Panel, width: float) -> float:
    """Compute the width of a view on a sheet of some width at most."""
    x_span, y_span = panel.x.high - panel.x.low, panel.y.high - panel.y.low
    return x_span * min((width - 2.0 * INDENT) / x_span, panel.height / y_span)


def lay_out_key(key: SpaceKey, pixels_per_unit: float, top: float, width: float) -> tuple[list[Shape], float]:
    """Return the shapes of a key below a height, and the y below them."""
    shapes, x = list(_draw_axes(key, INDENT, top)), INDENT + AXES_WIDTH
    if key.gravity is not None:
        a, b = (GRAVITY_LENGTH * part for part in key.gravity)
        middle_x, middle_y = x + 0.4 * GRAVITY_WIDTH, top + 0.5 * KEY_HEIGHT
        shapes += draw_arrow(middle_x - 0.5 * a, middle_y + 0.5 * b, a, -b, GREY, "gravity")
        shapes.append(Text(middle_x + 7.0, middle_y + 4.5, "g", SMALL_SIZE, colour=GREY))
        x += GRAVITY_WIDTH
    left, y = x, top + LINE_HEIGHT
    length, words = pixels_per_unit * key.bar[0], key.bar[1]
    shapes += _draw_bar(x, y, length, words)
    x += length + 6.0 + estimate_width(words, SMALL_SIZE) + KEY_GAP
    for arrow in key.arrows:
        own_length, text = pixels_per_unit * arrow.length, escape(arrow.text)
        own_width = own_length + 6.0 + estimate_width(text, SMALL_SIZE)
        if x > left and x + own_width > width - INDENT:
            x, y = left, y + LINE_HEIGHT
        shapes += _draw_key_arrow(arrow, x, y, own_length, text)
        x += own_width + KEY_GAP
    y = max(top + KEY_HEIGHT, y + LINE_HEIGHT)
    names = [f"{number}  {escape(text)}" for number, text in key.names]
    if not names:
        return shapes, y
    column_width = max(estimate_width(name, SMALL_SIZE) for name in names) + 0.5 * KEY_GAP
    columns = max(1, min(MAX_COLUMNS, int((width - 2.0 * INDENT + 0.5 * KEY_GAP) / column_width)))
    rows = math.ceil(len(names) / columns)
    step = (width - 2.0 * INDENT) / columns
    y += 0.5 * LINE_HEIGHT
    for k, name in enumerate(names):
        shapes.append(Text(INDENT + k // rows * step, y + k % rows * LINE_HEIGHT, name, SMALL_SIZE))
    return shapes, y + rows * LINE_HEIGHT


def _draw_axes(key: SpaceKey, left: float, top: float) -> Iterator[Shape]:
    """Draw the world's axes, those towards the viewer last; one along the line of sight has no arrow."""
    ends = [(AXES_LENGTH * a, -AXES_LENGTH * b, name) for name, a, b in key.axes]
    low_x, high_x = (f(0.0, *(a for a, _, _ in ends)) for f in (min, max))
    low_y, high_y = (f(0.0, *(b for _, b, _ in ends)) for f in (min, max))
    x = left + 0.5 * (AXES_WIDTH - 16.0) - 0.5 * (low_x + high_x)
    y = top + 0.5 * KEY_HEIGHT - 0.5 * (low_y + high_y)
    for a, b, name in ends:
        length = math.hypot(a, b)
        if length < 1.0:
            continue
        yield from draw_arrow(x, y, a, b, BLACK, f"axis: {name}")
        off = 7.0 / length
        yield Text(x + a * (1.0 + off), y + b * (1.0 + off) + 4.5, name, SMALL_SIZE, "middle")


def _draw_bar(x: float, y: float, length: float, words: str) -> Iterator[Shape]:
    """Draw a scale bar between two strokes, with its words."""
    for end in (x, x + length):
        yield Line(((end, y - 4.0), (end, y + 4.0)), BLACK, SYMBOL_WIDTH)
    yield Line(((x, y), (x + length, y)), BLACK, SYMBOL_WIDTH, name=f"scale bar: {words}")
    yield Text(x + length + 6.0, y + 4.5, words, SMALL_SIZE)


def _draw_key_arrow(arrow: KeyArrow, x: float, y: float, length: float, text: str) -> Iterator[Shape]:
    """Draw an arrow of a key with its words."""
    colour = find_colour(arrow.pen)
    yield from draw_arrow(x, y, length, 0.0, colour, text, is_double=arrow.is_double)
    yield Text(x + length + 6.0, y + 4.5, text, SMALL_SIZE, colour=colour)
