"""Words beside the places that they name: where they hide least, not over each other, with a line to the place if far.

Each is tried around its place, near ones first; of those that lie within the field and on no other words the one is
taken that covers the fewest points of what is drawn.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np

from heuncli.drawing.pens import GREY, WHITE
from heuncli.drawing.picture import Area, Line, Mark, Shape, Text
from heuncli.named_tuples import NamedTuple
from heuncli.results import Array

NOT_NAMED = "without their names for want of room: {}"
WAYS = 16  # directions in which words are tried
REACHES = (9.0, 14.0, 20.0, 28.0, 38.0, 52.0, 70.0)  # pixels from the place to the words
NEAR = 18.0  # up to which they need no line
CELL = 3.0  # pixels of the grid in which covered points are counted
APART = 2.0  # pixels between two words
FAR = 0.12  # of a covered point, that a pixel of distance costs
HIGH, LOW = 0.78, 0.22  # of the size of letters: above their base line and below


class Wanted(NamedTuple):
    """Words for a place [pixels]; spare: nobody is told if there is no room for them."""

    x: float
    y: float
    text: str
    colour: str
    spare: bool


Frame = tuple[float, float, float, float]  # left, top, right, bottom


def beside(
    labels: Sequence[Wanted], drawn: Sequence[Shape], frame: Frame, size: float, letter: float
) -> tuple[list[Shape], list[str]]:
    """The words with their lines, and those for which there is no room; letter: mean width of one, of their size."""
    if not labels:
        return [], []
    covered = _covered(drawn, frame)
    taken: list[Frame] = [_room(text, size, letter) for text in drawn if isinstance(text, Text)]
    lines: list[Shape] = []
    words: list[Shape] = []
    left_out: list[str] = []
    for label in labels:
        width, height = letter * size * len(label.text) + 2.0, size * (HIGH + LOW)
        rooms = _tried(label.x, label.y, width, height)
        free = _free(rooms, taken, frame)
        if not free.any():
            left_out += [] if label.spare else [label.text]
            continue
        reach = np.repeat(REACHES, WAYS)
        cost = np.where(free, _points_in(rooms, covered, frame) + FAR * reach, math.inf)
        k = int(np.argmin(cost))
        left, top, right, bottom = map(float, rooms[k])
        taken.append((left - APART, top - APART, right + APART, bottom + APART))
        if reach[k] > NEAR:
            to = min(max(label.x, left), right), min(max(label.y, top), bottom)
            lines.append(Line(((label.x, label.y), to), GREY, 0.6))
        words.append(Area(((left, top), (right, top), (right, bottom), (left, bottom)), WHITE, 0.7))
        words.append(Text(left + 1.0, bottom - LOW * size, label.text, size, colour=label.colour))
    return [*lines, *words], left_out


def _room(text: Text, size: float, letter: float) -> Frame:
    """What a line of text that stands already takes."""
    width = letter * text.size * len(text.text)
    left = text.x - {"start": 0.0, "middle": 0.5, "end": 1.0}[text.anchor] * width
    return left, text.y - HIGH * text.size, left + width, text.y + LOW * text.size


def _tried(x: float, y: float, width: float, height: float) -> Array:
    """Rooms around a place, (n, 4), near ones first: left, top, right, bottom."""
    angle = 2.0 * np.pi * np.arange(WAYS) / WAYS - 0.25 * np.pi  # to the right above first
    a, b = np.cos(angle), np.sin(angle)
    # the room touches a circle about the place with the side or corner that lies nearest
    cx = np.array(REACHES)[:, None] * a + 0.5 * width * np.clip(1.6 * a, -1.0, 1.0)
    cy = np.array(REACHES)[:, None] * b + 0.5 * height * np.clip(1.6 * b, -1.0, 1.0)
    cx, cy = x + cx.ravel(), y + cy.ravel()
    return np.column_stack([cx - 0.5 * width, cy - 0.5 * height, cx + 0.5 * width, cy + 0.5 * height])


def _free(rooms: Array, taken: Iterable[Frame], frame: Frame) -> Array:
    """Which rooms lie within the field and on no words, (n,)."""
    left, top, right, bottom = rooms.T
    free = (left >= frame[0]) & (top >= frame[1]) & (right <= frame[2]) & (bottom <= frame[3])
    for a, b, c, d in taken:
        free &= (right <= a) | (left >= c) | (bottom <= b) | (top >= d)
    return np.asarray(free)


def _covered(drawn: Sequence[Shape], frame: Frame) -> Array:
    """How many points of what is drawn lie before each cell of the field in both directions, (n + 1, m + 1)."""
    columns, rows = (max(1, math.ceil((b - a) / CELL)) for a, b in ((frame[0], frame[2]), (frame[1], frame[3])))
    count = np.zeros((columns + 1, rows + 1))
    points = [point for shape in drawn for point in _marks(shape)]
    if points:
        cells = np.floor((np.concatenate(points) - frame[:2]) / CELL)
        inside = (cells >= 0).all(axis=1) & (cells < (columns, rows)).all(axis=1)
        i, j = cells[inside].astype(np.intp).T
        np.add.at(count, (i + 1, j + 1), 1.0)
    return np.asarray(np.minimum(count, 2.0).cumsum(axis=0).cumsum(axis=1))


def _marks(shape: Shape) -> Iterable[Array]:
    """Points along a shape, a cell apart."""
    if isinstance(shape, Mark):
        yield np.array([[shape.x, shape.y]]) + shape.size * np.array([[a, b] for a in (-1, 0, 1) for b in (-1, 0, 1)])
    elif isinstance(shape, Line):
        points = np.array(shape.points)
        steps = np.diff(points, axis=0)
        for start, step in zip(points, steps, strict=False):
            count = min(int(np.hypot(*step) / CELL), 1000) + 1
            yield start + np.linspace(0.0, 1.0, count + 1)[:, None] * step


def _points_in(rooms: Array, covered: Array, frame: Frame) -> Array:
    """How many covered cells each room has, (n,)."""
    most = np.array(covered.shape) - 1
    low = np.clip(np.floor((rooms[:, :2] - frame[:2]) / CELL), 0, most).astype(np.intp)
    high = np.clip(np.ceil((rooms[:, 2:] - frame[:2]) / CELL), 0, most).astype(np.intp)
    (a, b), (c, d) = low.T, high.T
    return np.asarray(covered[c, d] - covered[a, d] - covered[c, b] + covered[a, b])
