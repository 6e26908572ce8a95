"""Words beside the places that they name: over no other words, over few lines, with a line to the place if far."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from heuncli.base.foreign_text import shown
from heuncli.output.drawing.figure import PlaceLabel
from heuncli.output.drawing.pens import GREY, ink
from heuncli.output.drawing.picture import Line, Shape, Text
from heuncli.output.drawing.room import WordBox, WordField
from heuncli.output.drawing.scales import PanelBox
from heuncli.output.drawing.words import BASE, HIGH, SMALL, wide

WAYS = 16  # directions in which words are tried
REACHES = (9.0, 14.0, 20.0, 28.0, 38.0, 52.0, 70.0)  # pixels from the place to the words
NEAR = 18.0  # up to which they need no line
FAR = 0.12  # what a pixel of distance costs, in cells of a curve


def labelled(labels: Sequence[PlaceLabel], box: PanelBox, field: WordField) -> tuple[list[Shape], list[str]]:
    """The words of labels with their lines, and those for which there is no room in the field."""
    lines: list[Shape] = []
    texts: list[Shape] = []
    told: list[str] = []
    for label in labels:
        text, x, y = shown(label.text), box.x(label.x), box.y(label.y)
        found = field.best(_around(x, y, wide(text, SMALL), HIGH * SMALL))
        if found is None:
            told += [] if label.spare else [label.text]
            continue
        to = min(max(x, found.left), found.right), min(max(y, found.top), found.bottom)
        if math.hypot(to[0] - x, to[1] - y) > NEAR:
            lines.append(Line(((x, y), to), GREY, 0.6))
        texts.append(Text(found.left, found.top + BASE * SMALL, text, SMALL, colour=ink(label.pen), halo=True))
    return [*lines, *texts], told


def _around(x: float, y: float, width: float, height: float) -> Iterator[tuple[float, WordBox]]:
    """Boxes that touch circles about a place with their nearest side or corner, and what each costs."""
    for reach in REACHES:
        for k in range(WAYS):
            angle = 2.0 * math.pi * k / WAYS - 0.25 * math.pi  # to the right above first
            a, b = math.cos(angle), math.sin(angle)
            left = x + reach * a + 0.5 * width * (min(max(1.6 * a, -1.0), 1.0) - 1.0)
            top = y + reach * b + 0.5 * height * (min(max(1.6 * b, -1.0), 1.0) - 1.0)
            yield FAR * reach, WordBox(left, top, left + width, top + height)
