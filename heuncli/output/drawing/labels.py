"""Place labels near the places that they name: over no other words, over few lines, with a line to the place if it is
far.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from heuncli.base.text_safety import escape
from heuncli.output.drawing.figure import PlaceLabel
from heuncli.output.drawing.label_placement import WordBox, WordField
from heuncli.output.drawing.pens import find_colour, mix_with_white
from heuncli.output.drawing.scales import PanelBox
from heuncli.output.drawing.shapes import Line, Mark, Shape, Text
from heuncli.output.drawing.style import BASE_FACTOR, GHOST_LABEL, GREY, HEIGHT_FACTOR, SMALL_SIZE
from heuncli.output.drawing.words import estimate_width

N_DIRECTIONS = 16  # in which places are tried
DISTANCES = (9.0, 14.0, 20.0, 28.0, 38.0)  # pixels from the place to the words
MAX_UNLINKED_DISTANCE = 18.0  # pixels up to which there is no line to the place
DISTANCE_COST = 0.12  # cost of a pixel of distance, in cells of a curve
CIRCLE_SIZE = 8.5  # pixels, half the size of the circle around a number


def place_labels(labels: Sequence[PlaceLabel], box: PanelBox, field: WordField) -> tuple[list[Shape], list[str]]:
    """Return the words of labels with their lines, and the words for which there is no room in the field."""
    lines: list[Shape] = []
    texts: list[Shape] = []
    omitted: list[str] = []
    for label in labels:
        text, x, y = escape(label.number or label.text), box.to_pixel_x(label.x), box.to_pixel_y(label.y)
        width, height = estimate_width(text, SMALL_SIZE), HEIGHT_FACTOR * SMALL_SIZE
        if label.number:
            width = height = 2.0 * CIRCLE_SIZE
        place = field.occupy_best(_iter_candidate_boxes(x, y, width, height))
        if place is None:
            omitted += [] if label.is_optional else [label.text]
            continue
        nearest = min(max(x, place.left), place.right), min(max(y, place.top), place.bottom)
        if math.hypot(nearest[0] - x, nearest[1] - y) > MAX_UNLINKED_DISTANCE:
            lines.append(Line(((x, y), nearest), GREY, 0.6))
        colour, base = find_colour(label.pen), place.top + BASE_FACTOR * SMALL_SIZE
        if label.is_ghost:
            colour = mix_with_white(colour, GHOST_LABEL)
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
