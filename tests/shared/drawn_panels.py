"""What a picture's SVG shows, read back by its axes: the curves, bands and marks of its panels in the axes' units."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from heuncli.output.drawing.figure import Figure
from heuncli.output.drawing.layout import lay_out
from heuncli.output.drawing.shapes import to_svg
from heuncli.results.results import Array
from tests.shared.plotted import SVG, PlottedPanel, panels_of


class DrawnPanel(NamedTuple):
    """A panel as it is seen: what its axis tells; curves, closed areas (n, 2) by name; marks (n, 2); words with places.

    pixel: how much of the axis upwards a pixel is; across: of the axis across.
    """

    label: str
    curves: dict[str, list[Array]]
    areas: dict[str, Array]
    marks: Array
    words: list[tuple[float, float, str]]
    pixel: float
    across: float

    def curve(self, name: str) -> Array:
        """The one curve of that name."""
        (own,) = self.curves[name]
        return own

    def texts(self) -> list[str]:
        """All words in it."""
        return [text for _, _, text in self.words]


def panels(figure: Figure) -> list[DrawnPanel]:
    """The panels of a figure, read from its SVG."""
    return read(to_svg(lay_out(figure)))


def read(text: str) -> list[DrawnPanel]:
    """The panels of an SVG."""
    return [_seen(own) for own in panels_of(text)]


def _seen(own: PlottedPanel) -> DrawnPanel:
    """All that is in a panel, in the units of its axes."""
    assert own.x.even and own.y.even, "an axis is not divided evenly"
    curves: dict[str, list[Array]] = {}
    areas: dict[str, Array] = {}
    for name, points in own.named("polyline"):
        curves.setdefault(name, []).append(points)
    for name, points in own.named("polygon"):
        areas[name] = points
    marks = np.concatenate([own.spots(filled=filled) for filled in (True, False)])
    texts = [(float(e.get("x", 0)), float(e.get("y", 0)), e) for e in own.root.iter(f"{SVG}text")]
    inside = [(x, y, e.text or "") for x, y, e in texts if own.left <= x <= own.right and own.top <= y <= own.bottom]
    beside = [e.text or "" for x, y, e in texts if x < own.left and own.top <= y <= own.bottom and e.get("transform")]
    (label,) = beside or [""]
    return DrawnPanel(label, curves, areas, marks, inside, abs(own.y.step), abs(own.x.step))


def heights(curve: Array, s: Array) -> Array:
    """The height of a curve over places (n,), between the points that are drawn; not for places at which it jumps."""
    return np.interp(s, curve[:, 0], curve[:, 1])


def edges(area: Array, s: Array) -> tuple[Array, Array]:
    """The lower and the upper edge of a band (n, 2), drawn there and back, over places."""
    turn = int(np.argmax(area[:, 0]))
    beyond = turn + 1 + int(np.argmax(area[turn + 1 :, 0] >= area[turn, 0]))
    turn = beyond if area[beyond, 0] >= area[turn, 0] else turn + 1
    return heights(area[:turn], s), heights(area[turn:][::-1], s)


def upright_at(curve: Array, s: float, near: float) -> list[tuple[float, float]]:
    """The upright lines of a curve at a place: from which height to which."""
    steps = pairwise(curve)
    return [(float(a[1]), float(b[1])) for a, b in steps if abs(a[0] - s) <= near and abs(b[0] - a[0]) <= near]
