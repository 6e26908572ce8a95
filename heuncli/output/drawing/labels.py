"""Place the words of a panel where there is room, in pixels: of marked places, of vertical marks, and labels.

Words stand over no other words, and over as few lines as possible; those far from their place have a line to it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base.text_safety import escape
from heuncli.output.drawing import style
from heuncli.output.drawing.axes import PanelBox
from heuncli.output.drawing.figure import Item, PlaceLabel, Spot, VerticalMark, Words
from heuncli.output.drawing.label_placement import WordBox, WordField, count_columns
from heuncli.output.drawing.shapes import Area, Line, Mark, Shape, Text
from heuncli.output.drawing.style import (
    BASE_FACTOR,
    GHOST_LABEL,
    HEIGHT_FACTOR,
    SMALL_SIZE,
    find_colour,
    mix_with_white,
)

CELL_SIZE = 3.0  # pixels of a cell of the word field
MARK_DISTANCE = 2.0  # pixels from a mark to its words
MIN_LINE_WIDTH = style.ENVELOPE_WIDTH  # of a line without a name that words avoid, as they avoid hatches
MAX_UNLINKED_DISTANCE = 17.0  # pixels from a place to its words up to which no line connects them
N_DIRECTIONS = 16  # in which places are tried
DISTANCES = (9.0, 14.0, 20.0, 28.0, 38.0)  # pixels from the place to the words
DISTANCE_COST = 0.12  # cost of a pixel of distance, in cells of a curve
CIRCLE_SIZE, CIRCLE_GAP = 9.5, 3.0  # pixels: half the size of the circle around a number, between two of them


def place_words(items: Sequence[Item], box: PanelBox, field: WordField) -> tuple[list[Shape], list[str]]:
    """Place the words of spots and vertical marks; return them, and the words that find no room in the field."""
    texts: list[Shape] = []
    omitted: list[str] = []
    for item in order_items(items):
        text = (
            _place_mark_words(item, box, field)
            if isinstance(item, VerticalMark)
            else _place_spot_words(item, box, field)
        )
        if text is None:
            omitted.append(item.note or item.text)
        else:
            texts += text
    return texts, omitted


def order_items(items: Sequence[Item]) -> list[Spot | VerticalMark]:
    """Return the items with words in the order in which these look for room: numbers at marks first."""
    spots = [item for item in items if isinstance(item, Spot) and item.text]
    return [*spots, *(item for item in items if isinstance(item, VerticalMark) and item.text and not item.is_above)]


def estimate_width(text: str, size: float) -> float:
    """Return the maximum width of a text."""
    return style.WIDTH_FACTOR * size * count_columns(text)


def make_field(shapes: Sequence[Shape], area: WordBox) -> WordField:
    """Make the word field of a panel, with its curves, marks and texts."""
    field = WordField(area, (CELL_SIZE, CELL_SIZE))
    for shape in shapes:
        if isinstance(shape, Line):
            if shape.name or shape.width >= MIN_LINE_WIDTH or shape.width == style.HATCH_WIDTH:
                field.add_curve(np.array(shape.points))
        elif isinstance(shape, Area):
            if shape.opacity == style.BAR_OPACITY:
                field.add_area(np.array(shape.points))
        elif isinstance(shape, Mark):
            field.occupy(_make_mark_box(shape))
        elif isinstance(shape, Text):
            field.occupy(_make_text_box(shape))
    return field


def _make_mark_box(mark: Mark) -> WordBox:
    return WordBox(mark.x - mark.size, mark.y - mark.size, mark.x + mark.size, mark.y + mark.size)


def _make_text_box(text: Text) -> WordBox:
    """Return the box of a horizontal text."""
    width = estimate_width(text.text, text.size)
    left = text.x - {"start": 0.0, "middle": 0.5, "end": 1.0}[text.anchor] * width
    top = text.y - style.BASE_FACTOR * text.size
    return WordBox(left, top, left + width, top + style.HEIGHT_FACTOR * text.size)


def _place_spot_words(item: Spot, box: PanelBox, field: WordField) -> list[Shape] | None:
    """Place the words of a mark, with a leader line if they are far from it; None if there is no room."""
    text = escape(item.text)
    mark = Mark(
        box.to_pixel_x(item.x),
        box.to_pixel_y(item.y),
        item.shape,
        style.BLACK,
        item.is_filled,
        style.MARK_SIZE + MARK_DISTANCE,
    )
    place = field.occupy_near(
        _make_mark_box(mark),
        estimate_width(text, style.SMALL_SIZE),
        style.HEIGHT_FACTOR * style.SMALL_SIZE,
        is_centred=not item.shape,
    )
    if place is None:
        return None
    colour = find_colour(item.pen)
    words = Text(
        place.left,
        place.top + style.BASE_FACTOR * style.SMALL_SIZE,
        text,
        style.SMALL_SIZE,
        colour=colour,
        has_halo=True,
    )
    return [*_connect(mark.x, mark.y, place, field, colour, _make_mark_box(mark)), words]


def _connect(x: float, y: float, place: WordBox, field: WordField, colour: str, *own_boxes: WordBox) -> Iterator[Shape]:
    """Draw a line from a place to its words if these are far from it and no other words or marks are between."""
    end = min(max(x, place.left), place.right), min(max(y, place.top), place.bottom)
    is_far = math.hypot(end[0] - x, end[1] - y) > MAX_UNLINKED_DISTANCE
    if is_far and not field.is_struck((x, y), end, except_boxes=(place, *own_boxes)):
        yield Line(((x, y), end), colour, style.GRID_WIDTH)


def _place_mark_words(item: VerticalMark, box: PanelBox, field: WordField) -> list[Shape] | None:
    """Place the words along a vertical mark, read from below: at its left or right, at its upper or lower end."""
    text, x = escape(item.text), box.to_pixel_x(item.x)
    length, height = estimate_width(text, style.SMALL_SIZE), style.HEIGHT_FACTOR * style.SMALL_SIZE
    tops = (box.top + 4.0, box.bottom - 4.0 - length)
    place = field.occupy_best(
        (cost, WordBox(left, top, left + height, top + length))
        for cost, top in zip((0.0, 8.0), tops, strict=True)
        for left in (x - 2.0 - height, x + 2.0)
    )
    if place is None:
        return None
    words = Text(
        place.left + style.BASE_FACTOR * style.SMALL_SIZE,
        place.bottom,
        text,
        style.SMALL_SIZE,
        colour=style.GREY,
        is_vertical=True,
        has_halo=True,
    )
    return [words]


def drop_covered_words(items: Sequence[Item], box: PanelBox) -> list[Item]:
    """Drop the optional words that would stand over other words without a mark."""
    shown_boxes, shown_items = list[WordBox](), list[Item]()
    for item in items:
        if isinstance(item, Words):
            half = 0.5 * estimate_width(escape(item.text), style.SMALL_SIZE), 0.5 * style.SMALL_SIZE
            x, y = box.to_pixel_x(item.x), box.to_pixel_y(item.y)
            own = WordBox(x - half[0], y - half[1], x + half[0], y + half[1])
            if item.is_optional and any(own.overlaps(other) for other in shown_boxes):
                continue
            shown_boxes.append(own)
        shown_items.append(item)
    return shown_items


def drop_close_marks(items: Sequence[Item], box: PanelBox, min_distance: float) -> list[Item]:
    """Drop the vertical marks without words that are closer to another one than `min_distance` pixels."""
    last, shown_items = -np.inf, []
    for item in items:
        if isinstance(item, VerticalMark):
            x = box.to_pixel_x(item.x)
            if not item.text and abs(x - last) < min_distance:
                continue
            last = x
        shown_items.append(item)
    return shown_items


def place_labels(labels: Sequence[PlaceLabel], box: PanelBox, field: WordField) -> tuple[list[Shape], list[str]]:
    """Return the words of labels with their lines, and the words for which there is no room in the field."""
    lines: list[Shape] = []
    texts: list[Shape] = []
    omitted: list[str] = []
    for label in labels:
        text, x, y = escape(label.number or label.text), box.to_pixel_x(label.x), box.to_pixel_y(label.y)
        width, height = estimate_width(text, SMALL_SIZE), HEIGHT_FACTOR * SMALL_SIZE
        if label.number:
            width = height = 2.0 * CIRCLE_SIZE + CIRCLE_GAP
        place = field.occupy_best(_iter_candidate_boxes(x, y, width, height))
        if place is None:
            omitted += [] if label.is_optional else [label.text]
            continue
        colour, base = find_colour(label.pen), place.top + BASE_FACTOR * SMALL_SIZE
        if label.is_ghost:
            colour = mix_with_white(colour, GHOST_LABEL)
        lines += _connect(x, y, place, field, colour)
        if label.number:
            middle = 0.5 * (place.left + place.right), 0.5 * (place.top + place.bottom)
            texts.append(Mark(*middle, "circle", colour, False, CIRCLE_SIZE))
            texts.append(
                Text(middle[0], middle[1] + 0.35 * SMALL_SIZE, text, SMALL_SIZE, "middle", colour, has_halo=True)
            )
        else:
            texts.append(Text(place.left, base, text, SMALL_SIZE, colour=colour, has_halo=True))
    return [*lines, *texts], omitted


def _iter_candidate_boxes(x: float, y: float, width: float, height: float) -> Iterator[tuple[float, WordBox]]:
    """Yield boxes that touch circles about a place with their nearest side or corner, each after its cost."""
    for distance in DISTANCES:
        for k in range(N_DIRECTIONS):
            angle = 2.0 * math.pi * k / N_DIRECTIONS - 0.25 * math.pi  # begins at the upper right
            a, b = math.cos(angle), math.sin(angle)
            left = x + distance * a + 0.5 * width * (min(max(1.6 * a, -1.0), 1.0) - 1.0)
            top = y + distance * b + 0.5 * height * (min(max(1.6 * b, -1.0), 1.0) - 1.0)
            yield DISTANCE_COST * distance, WordBox(left, top, left + width, top + height)
