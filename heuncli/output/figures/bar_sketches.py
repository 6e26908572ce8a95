"""Sketch a bar above its section diagrams: supports, joints, loads, their names, and a dimension line."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.output.drawing.figure import Arrow, Item, Panel, PlaceLabel, Polygon, Scaling, Strokes, Symbol, Words
from heuncli.output.drawing.ticks import format_short
from heuncli.study.queries.bar_curves import BarAttachment

HEIGHT = 104.0  # pixels; the axis of the sketch is in pixels, too, with the bar about 0
UPPER, LOWER = 44.0, 60.0  # pixels above and below the bar's axis
HALF_DEPTH = 5.0  # of the bar
ARROW_LENGTH = 24.0
DIMENSION, TICK = 48.0, 4.0  # of the dimension line below the axis, and half of its ticks
SYMBOLS = {"support": "foot", "clamp": "clamp", "joint": "circle", "mass": "mass"}  # other kinds are arrows
DOWN = (0.0, -1.0)


def make_sketch(
    attachments: Sequence[BarAttachment], x: Scaling, length: float, size: float, unit: str, title: str = ""
) -> Panel:
    """Make the sketch of a bar on the horizontal axis of its diagrams.

    length: of the bar [m]; size: display units in a metre
    """
    items = tuple(_iter_items(attachments, length, size, unit))
    return Panel(x._replace(hides_label=True), Scaling("", -LOWER, UPPER), items, HEIGHT, is_bare=True, title=title)


def _iter_items(attachments: Sequence[BarAttachment], length: float, size: float, unit: str) -> Iterator[Item]:
    """Yield the bar, what acts on it, and the dimension line."""
    end = size * length
    corners = np.array([[0.0, -HALF_DEPTH], [end, -HALF_DEPTH], [end, HALF_DEPTH], [0.0, HALF_DEPTH]])
    yield Polygon("bar", corners, is_filled=True)
    for attachment in attachments:
        s = size * attachment.s
        symbol = SYMBOLS.get(attachment.kind)
        if symbol is None:
            yield Arrow(s, HALF_DEPTH + ARROW_LENGTH, 0.0, -ARROW_LENGTH, None)
        elif symbol == "foot":
            yield Symbol(s, -HALF_DEPTH, symbol, DOWN)
        elif symbol == "clamp":  # outwards at the ends of the bar
            yield Symbol(s, 0.0, symbol, (-1.0, 0.0) if attachment.s < 0.5 * length else (1.0, 0.0))
        else:
            yield Symbol(s, 0.0, symbol)
    texts: dict[float, list[str]] = {}
    for attachment in attachments:
        texts.setdefault(attachment.s, []).append(attachment.name.replace("_", " "))
    for s, names in texts.items():
        yield PlaceLabel(size * s, HALF_DEPTH, ", ".join(names), ", ".join(names))
    ticks = sorted({0.0, end, *(size * attachment.s for attachment in attachments)})
    strokes = [[(0.0, -DIMENSION), (end, -DIMENSION)]]
    strokes += [[(s, -DIMENSION - TICK), (s, -DIMENSION + TICK)] for s in ticks]
    yield Strokes(np.array(strokes))
    yield Words(0.5 * end, -DIMENSION + 9.0, f"{format_short(end, 4)} {unit}")
