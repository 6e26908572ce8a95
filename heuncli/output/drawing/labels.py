"""Place the words of a panel where there is room: labels, the words of marked places and of vertical marks.

Words stand over no other words, and over as few lines as possible. A label avoids places that are nearer to what
another label names; where it finds no other, or is far from its own place, a line leads to it. A field is a grid of
small cells, each with the cost of writing there: zero if it is empty, CURVE_COST if a curve passes. It serves pixels
and the cells of a terminal.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.output.drawing import style
from heuncli.output.drawing.axes import PanelBox
from heuncli.output.drawing.figure import Item, PlaceLabel, Spot, VerticalMark, Words
from heuncli.output.drawing.shapes import Area, Line, Mark, Shape, Text
from heuncli.output.drawing.style import (
    BASE_FACTOR,
    GHOST_LABEL,
    HEIGHT_FACTOR,
    SMALL_SIZE,
    find_colour,
    mix_with_white,
)
from heuncli.results.results import Array

MAX_LINES = 5  # maximum distance of words, in lines of text
ROUNDING = 1e-6  # of a coordinate
COST_PER_LINE = 7.0  # cost of a line of distance
CURVE_COST = 3.0  # cost of a cell of a curve
ARROW_COST = 9.0  # cost of a cell of an arrow, which words would cut in two, or whose head they would hide
ARROW_HEAD_CORNERS = 3
N_SAMPLES = 25  # places along a line that may strike words
Place = tuple[float, float]
CELL_SIZE = 3.0  # pixels of a cell of the word field
MARK_DISTANCE = 2.0  # pixels from a mark to its words
MIN_LINE_WIDTH = style.ENVELOPE_WIDTH  # of a line without a name that words avoid, as they avoid hatches
MAX_UNLINKED_DISTANCE = 17.0  # pixels from a place to its words up to which no line connects them
N_DIRECTIONS = 16  # in which places are tried
DISTANCES = (9.0, 14.0, 20.0, 28.0, 38.0)  # pixels from the place to the words
DISTANCE_COST = 0.12  # cost of a pixel of distance, in cells of a curve
AMBIGUITY_COST = 25.0  # cost of a place nearer to another label's place than to its own: eight cells of a curve
MIN_DIFFERENCE = 1.5  # pixels by which it must be nearer
CIRCLE_SIZE, CIRCLE_GAP = 9.5, 3.0  # pixels: half the size of the circle around a number, between two of them


class WordBox(NamedTuple):
    """A rectangle, y downwards."""

    left: float
    top: float
    right: float
    bottom: float

    def overlaps(self, other: WordBox) -> bool:
        """Return whether two boxes overlap; boxes that only touch do not."""
        return (
            self.left < other.right - ROUNDING and other.left < self.right - ROUNDING
            and self.top < other.bottom - ROUNDING and other.top < self.bottom - ROUNDING
        )  # fmt: skip

    def measure_distance(self, x: float, y: float) -> float:
        """Measure the distance of a place from the box, 0 within it."""
        return math.hypot(max(self.left - x, 0.0, x - self.right), max(self.top - y, 0.0, y - self.bottom))

    def contains(self, other: WordBox) -> bool:
        """Return whether another box lies within this one."""
        return (
            self.left <= other.left + ROUNDING and other.right <= self.right + ROUNDING
            and self.top <= other.top + ROUNDING and other.bottom <= self.bottom + ROUNDING
        )  # fmt: skip


class WordField:
    """The cells of a rectangle with their costs; cell_size: width and height of one."""

    def __init__(self, box: WordBox, cell_size: tuple[float, float]) -> None:
        self.box, self.cell_size = box, cell_size
        rows, columns = (max(1, math.ceil(length / f)) for length, f in
                         ((box.bottom - box.top, cell_size[1]), (box.right - box.left, cell_size[0])))  # fmt: skip
        self.cost = np.zeros((rows, columns))
        self.occupied: list[WordBox] = []

    def add_curve(self, points: Array, cell_cost: float = CURVE_COST) -> None:
        """Add the cost of a line through points (n, 2)."""
        if len(points) < 2 or not np.isfinite(points).all():
            return
        cell_places = (points - (self.box.left, self.box.top)) / self.cell_size
        length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(cell_places, axis=0)).max(axis=1))])
        samples = np.linspace(0.0, length[-1], min(math.ceil(2.0 * length[-1]) + 1, 100_000))
        column, row = (np.floor(np.interp(samples, length, cell_places[:, k])).astype(np.intp) for k in (0, 1))
        rows, columns = self.cost.shape
        inside = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
        row, column = row[inside], column[inside]
        self.cost[row, column] = np.maximum(self.cost[row, column], cell_cost)

    def add_area(self, corners: Array) -> None:
        """Add the cost of an upright rectangle with corners (n, 2)."""
        (left, top), (right, bottom) = corners.min(axis=0), corners.max(axis=0)
        self._select_cells(WordBox(left, top, right, bottom))[:] = CURVE_COST

    def is_struck(self, begin: Place, end: Place, except_boxes: Sequence[WordBox]) -> bool:
        """Return whether a line between two places crosses words or marks other than `except_boxes`."""
        x, y = (np.linspace(a, b, N_SAMPLES) for a, b in zip(begin, end, strict=True))
        others = [box for box in self.occupied if box not in except_boxes and not box.contains(WordBox(*begin, *begin))]
        return any(bool(((x > box.left) & (x < box.right) & (y > box.top) & (y < box.bottom)).any()) for box in others)

    def occupy(self, box: WordBox) -> None:
        """Occupy a box with words or a mark."""
        self.occupied.append(box)

    def occupy_best(self, candidates: Iterable[tuple[float, WordBox]]) -> WordBox | None:
        """Occupy the candidate box with the lowest total cost and return it; None if there is no room.

        candidates: each with its own cost
        """
        best_box, lowest_cost = None, math.inf
        for own_cost, box in candidates:
            if (
                own_cost >= lowest_cost
                or not self.box.contains(box)
                or any(box.overlaps(other) for other in self.occupied)
            ):
                continue
            cost = own_cost + float(self._select_cells(box).sum())
            if cost < lowest_cost:
                best_box, lowest_cost = box, cost
        if best_box is not None:
            self.occupy(best_box)
        return best_box

    def occupy_near(self, mark: WordBox, width: float, height: float, *, is_centred: bool = False) -> WordBox | None:
        """Occupy a box of a size near a mark and return it; None if there is no room.

        is_centred: whether a place in the middle above it is better than one beside it, as for a bar
        """
        return self.occupy_best(self._iter_boxes_around(mark, width, height, is_centred))

    def _iter_boxes_around(
        self, mark: WordBox, width: float, height: float, is_centred: bool
    ) -> Iterator[tuple[float, WordBox]]:
        """Yield boxes about a mark after their costs: above, below, to its right and left, then farther away."""
        middle = 0.5 * (mark.top + mark.bottom - height)
        centred = 0.5 * (mark.left + mark.right - width)
        centred = max(min(centred, self.box.right - width), self.box.left)
        sides = (centred, mark.right, mark.left - width) if is_centred else (mark.right, mark.left - width, centred)
        for line in range(MAX_LINES):
            cost = COST_PER_LINE * line
            for top in (mark.top - height * (line + 1), mark.bottom + height * line):
                for left in sides:
                    yield cost, WordBox(left, top, left + width, top + height)
            if not line:
                for left in (mark.right, mark.left - width):
                    yield cost, WordBox(left, middle, left + width, middle + height)

    def _select_cells(self, box: WordBox) -> Array:
        (left, right), (top, bottom) = (
            (max(0, math.floor((low - origin) / f + 1e-9)), max(0, math.ceil((high - origin) / f - 1e-9)))
            for low, high, origin, f in (
                (box.left, box.right, self.box.left, self.cell_size[0]),
                (box.top, box.bottom, self.box.top, self.cell_size[1]),
            )
        )
        return self.cost[top:bottom, left:right]


def count_columns(text: str) -> int:
    """Return the number of cells that a text takes in a terminal: two for a wide letter, none for a combining one."""
    if text.isascii():
        return len(text)
    import unicodedata  # rarely needed

    return sum(0 if unicodedata.combining(c) else 2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in text)


def make_omitted_note(omitted: Iterable[str], max_texts: int = 12) -> list[str]:
    """Return a note on the words that found no room, if there are any."""
    distinct = list(dict.fromkeys(omitted))
    if not distinct:
        return []
    hidden_text = f"; and {len(distinct) - max_texts} more" if len(distinct) > max_texts else ""
    return [f"labels omitted for lack of space: {'; '.join(distinct[:max_texts])}{hidden_text}"]


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
                is_arrow = bool(shape.name) and shape.width == style.ARROW_WIDTH
                field.add_curve(np.array(shape.points), ARROW_COST if is_arrow else CURVE_COST)
        elif isinstance(shape, Area):
            if shape.opacity == style.BAR_OPACITY:
                field.add_area(np.array(shape.points))
            elif shape.name and len(shape.points) == ARROW_HEAD_CORNERS:
                field.add_curve(np.array([*shape.points, shape.points[0]]), ARROW_COST)
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


def _connect(
    x: float, y: float, place: WordBox, field: WordField, colour: str, *own_boxes: WordBox, is_ambiguous: bool = False
) -> Iterator[Shape]:
    """Draw a line from a place to its words if these are far from it or seem to belong to another place.

    No line is drawn across other words or marks.
    """
    end = min(max(x, place.left), place.right), min(max(y, place.top), place.bottom)
    is_far = place.measure_distance(x, y) > MAX_UNLINKED_DISTANCE
    if (is_far or is_ambiguous) and not field.is_struck((x, y), end, except_boxes=(place, *own_boxes)):
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
    places = [(box.to_pixel_x(label.x), box.to_pixel_y(label.y)) for label in labels]
    for k, label in enumerate(labels):
        text, (x, y), others = escape(label.number or label.text), places[k], places[:k] + places[k + 1 :]
        width, height = estimate_width(text, SMALL_SIZE), HEIGHT_FACTOR * SMALL_SIZE
        if label.number:
            width = height = 2.0 * CIRCLE_SIZE + CIRCLE_GAP
        place = field.occupy_best(
            (cost + AMBIGUITY_COST * _is_ambiguous(candidate, (x, y), others), candidate)
            for cost, candidate in _iter_boxes_on_circles(x, y, width, height)
        )
        if place is None:
            omitted += [] if label.is_optional else [label.text]
            continue
        colour, base = find_colour(label.pen), place.top + BASE_FACTOR * SMALL_SIZE
        if label.is_ghost:
            colour = mix_with_white(colour, GHOST_LABEL)
        lines += _connect(x, y, place, field, colour, is_ambiguous=_is_ambiguous(place, (x, y), others))
        if label.number:
            middle = 0.5 * (place.left + place.right), 0.5 * (place.top + place.bottom)
            texts.append(Mark(*middle, "circle", colour, False, CIRCLE_SIZE))
            texts.append(
                Text(middle[0], middle[1] + 0.35 * SMALL_SIZE, text, SMALL_SIZE, "middle", colour, has_halo=True)
            )
        else:
            texts.append(Text(place.left, base, text, SMALL_SIZE, colour=colour, has_halo=True))
    return [*lines, *texts], omitted


def _is_ambiguous(box: WordBox, place: Place, others: Sequence[Place]) -> bool:
    """Return whether words in a box are nearer to another label's place than to their own."""
    limit = box.measure_distance(*place) - MIN_DIFFERENCE
    return any(box.measure_distance(*other) < limit for other in others)


def _iter_boxes_on_circles(x: float, y: float, width: float, height: float) -> Iterator[tuple[float, WordBox]]:
    """Yield boxes that touch circles about a place with their nearest side or corner, each after its cost."""
    for distance in DISTANCES:
        for k in range(N_DIRECTIONS):
            angle = 2.0 * math.pi * k / N_DIRECTIONS - 0.25 * math.pi  # begins at the upper right
            a, b = math.cos(angle), math.sin(angle)
            left = x + distance * a + 0.5 * width * (min(max(1.6 * a, -1.0), 1.0) - 1.0)
            top = y + distance * b + 0.5 * height * (min(max(1.6 * b, -1.0), 1.0) - 1.0)
            yield DISTANCE_COST * distance, WordBox(left, top, left + width, top + height)
