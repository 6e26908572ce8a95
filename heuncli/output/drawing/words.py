"""The words at marked places and at vertical marks of a panel, in pixels, each where it finds room."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base.foreign_text import shown
from heuncli.output.drawing.figure import Item, Spot, Upright
from heuncli.output.drawing.pens import BLACK, GREY, pen
from heuncli.output.drawing.picture import Line, Mark, Shape, Text
from heuncli.output.drawing.room import WordBox, WordField, columns_of
from heuncli.output.drawing.scales import PanelBox

SMALL = 11.0  # the size of letters
WIDE, HIGH = 0.6, 1.2  # of the size of letters: at most the mean width of digits and letters, and the height of a line
BASE = 0.92  # of the size: from the top of a line to its base
FINE = 3.0  # pixels of a cell in which room is looked for
SPOT = 3.0  # pixels, half the size of a mark
NEAR = 2.0  # from a mark to its words
LEAST_WIDTH = 1.0  # of an unnamed line that is no hatch


def words(items: Sequence[Item], box: PanelBox, field: WordField) -> tuple[list[Shape], list[str]]:
    """The words of spots and vertical marks, and what is told of those that find no room in the field."""
    texts: list[Shape] = []
    told: list[str] = []
    for item in in_turn(items):
        text = _upright(item, box, field) if isinstance(item, Upright) else _spot(item, box, field)
        if text is None:
            told.append(item.note or item.text)
        else:
            texts.append(text)
    return texts, told


def in_turn(items: Sequence[Item]) -> list[Spot | Upright]:
    """What has words in the panel, in the order in which these look for room: numbers at marks first."""
    spots = [item for item in items if isinstance(item, Spot) and item.text]
    return [*spots, *(item for item in items if isinstance(item, Upright) and item.text and not item.above)]


def wide(text: str, size: float) -> float:
    """How wide a text is, at most."""
    return WIDE * size * columns_of(text)


def field_of(drawn: Sequence[Shape], room: WordBox) -> WordField:
    """The room of a panel with its curves, marks and words: what stands there."""
    field = WordField(room, (FINE, FINE))
    for shape in drawn:
        if isinstance(shape, Line):
            if shape.name or shape.width >= LEAST_WIDTH:
                field.curve(np.array(shape.points))
        elif isinstance(shape, Mark):
            field.take(_about(shape))
        elif isinstance(shape, Text):
            field.take(_of_text(shape))
    return field


def _about(mark: Mark) -> WordBox:
    return WordBox(mark.x - mark.size, mark.y - mark.size, mark.x + mark.size, mark.y + mark.size)


def _of_text(text: Text) -> WordBox:
    """The box of a text that does not stand turned."""
    width = wide(text.text, text.size)
    left = text.x - {"start": 0.0, "middle": 0.5, "end": 1.0}[text.anchor] * width
    top = text.y - BASE * text.size
    return WordBox(left, top, left + width, top + HIGH * text.size)


def _spot(item: Spot, box: PanelBox, field: WordField) -> Text | None:
    """The words beside a mark."""
    text = shown(item.text)
    mark = Mark(box.x(item.x), box.y(item.y), item.shape, BLACK, item.filled, SPOT + NEAR)
    found = field.beside(_about(mark), wide(text, SMALL), HIGH * SMALL)
    if found is None:
        return None
    colour = BLACK if item.pen is None else pen(item.pen).colour
    return Text(found.left, found.top + BASE * SMALL, text, SMALL, colour=colour, halo=True)


def _upright(item: Upright, box: PanelBox, field: WordField) -> Text | None:
    """The words along a vertical mark, read from below: at its left or right, at its upper end or its lower."""
    text, x = shown(item.text), box.x(item.x)
    long, high = wide(text, SMALL), HIGH * SMALL
    tops = (box.top + 4.0, box.bottom - 4.0 - long)
    found = field.best(
        (price, WordBox(left, top, left + high, top + long))
        for price, top in zip((0.0, 8.0), tops, strict=True)
        for left in (x - 2.0 - high, x + 2.0)
    )
    if found is None:
        return None
    return Text(found.left + BASE * SMALL, found.bottom, text, SMALL, colour=GREY, turned=True, halo=True)


def apart(items: Sequence[Item], box: PanelBox, least: float) -> list[Item]:
    """The items without those vertical marks that have no words and stand closer than so many pixels to another."""
    last, kept = -np.inf, []
    for item in items:
        if isinstance(item, Upright):
            x = box.x(item.x)
            if not item.text and abs(x - last) < least:
                continue
            last = x
        kept.append(item)
    return kept
