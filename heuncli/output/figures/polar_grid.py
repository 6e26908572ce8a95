"""The grid of a polar diagram: rings at round values, rays every 30 degrees, clipped to the window of the panel."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.output.drawing.figure import Item, Scaling, Strokes, Words
from heuncli.output.drawing.ticks import choose_ticks
from heuncli.output.figures.windows import clip_strokes
from heuncli.results.results import Array

RAY_STEP, ARC_STEP = 30, 3  # degrees
N_RINGS = 5  # the largest number up to the farther side of the window
RIM = 0.94  # share of a ray at which its angle stands
LABEL_SPACE = np.array([0.08, 0.05])  # smallest distance of angles, in sides of the window


def make_polar_grid(
    sides: tuple[Scaling, Scaling], curves: Sequence[Array], names: tuple[str, str], unit: str
) -> list[Item]:
    """Make the grid about the origin.

    sides: the window; curves (n, 2): drawn in it, which the numbers of the rings avoid
    names: of the axes to the right and upwards
    """
    low, high = (np.array([getattr(side, end) for side in sides]) for end in ("low", "high"))
    reach = float(np.max(np.abs([low, high])))
    rings = [(value, text) for value, text in choose_ticks(Scaling("", 0.0, reach), N_RINGS) if value > 0.0]
    items: list[Item] = []
    angles = np.radians(np.arange(0, 360 + ARC_STEP, ARC_STEP))
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    for value, text in rings:
        arcs = np.stack([value * circle[:-1], value * circle[1:]], axis=1)
        items.append(Strokes(clip_strokes(arcs, low, high), is_faint=True, name=f"{text} {unit}"))
    places: list[tuple[float, float]] = []
    for degrees in sorted(range(0, 360, RAY_STEP), key=lambda angle: angle % 90):  # those of the axes first
        direction = _make_direction(degrees)
        ray = clip_strokes(np.array([[(0.0, 0.0), tuple(2.0 * reach * direction)]]), low, high)
        if len(ray):
            items.append(Strokes(ray, is_faint=True))
            axis = {0: f"{names[0]} ", 90: f"{names[1]} "}.get(degrees, "")
            x, y = (RIM * ray[0, 1]).tolist()
            if all(np.any(np.abs(np.array([x, y]) - place) > LABEL_SPACE * (high - low)) for place in places):
                items.append(Words(x, y, f"{axis}{degrees}°"))
                places.append((x, y))
    return [*items, *_label_rings(rings, low, high, curves, unit)]


def _make_direction(degrees: float) -> Array:
    return np.array([math.cos(math.radians(degrees)), math.sin(math.radians(degrees))])


def _label_rings(
    rings: Sequence[tuple[float, str]], low: Array, high: Array, curves: Sequence[Array], unit: str
) -> Iterator[Words]:
    """Label the rings along the direction between two rays in which most of them are seen and the curves are far."""
    points = np.concatenate(curves)
    points = points[np.isfinite(points).all(axis=1)]

    def find_room(degrees: int) -> tuple[int, float]:
        places = [value * _make_direction(degrees) for value, _ in rings]
        seen = [place for place in places if (place > low).all() and (place < high).all()]
        distances = [float(np.hypot(*(points - place).T).min(initial=np.inf)) for place in seen]
        return len(seen), min(distances, default=0.0)

    best = max(range(RAY_STEP // 2, 360, RAY_STEP), key=find_room)
    for value, text in rings:
        place = value * _make_direction(best)
        if (place > low).all() and (place < high).all():
            yield Words(float(place[0]), float(place[1]), f"{text} {unit}")
