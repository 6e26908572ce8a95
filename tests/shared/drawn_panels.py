"""What a picture's SVG shows, read back by its axes: the curves, bands and marks of its panels in the axes' units."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from heuncli.drawing.figure import Figure
from heuncli.drawing.layout import laid_out
from heuncli.drawing.picture import svg
from heuncli.results import Array

SPACE = "{http://www.w3.org/2000/svg}"
TICK = "middle"


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
    return read(svg(laid_out(figure)))


def read(text: str) -> list[DrawnPanel]:
    """The panels of an SVG: fields in a frame, axes by the numbers beside their ticks."""
    shapes = list(ElementTree.fromstring(text))
    frames = [points(s) for s in shapes if s.tag == f"{SPACE}polyline" and is_frame(s)]
    across = scale([(float(s.get("x", 0)), s.text or "") for s in shapes if is_tick_across(s, frames)])
    return [panel(shapes, frame, across) for frame in frames]


def panel(shapes: Sequence[ElementTree.Element], frame: Array, across: tuple[float, float]) -> DrawnPanel:
    """The panel in a frame."""
    (left, top), (right, bottom) = frame.min(axis=0), frame.max(axis=0)
    texts = [(float(s.get("x", 0)), float(s.get("y", 0)), s.text or "", s) for s in shapes if s.tag == f"{SPACE}text"]
    beside = [(x, y, text, s) for x, y, text, s in texts if x < left and top - 5 <= y <= bottom + 5]
    up = scale([(y - 4.0, text) for _, y, text, s in beside if s.get("anchor", s.get("text-anchor")) == "end"])
    (label,) = [text for _, _, text, s in beside if s.get("transform")] or [""]

    def turned(at: Array) -> Array:
        return np.column_stack([across[0] + across[1] * at[:, 0], up[0] + up[1] * at[:, 1]])

    curves: dict[str, list[Array]] = {}
    areas: dict[str, Array] = {}
    for shape in shapes:
        name = shape.findtext(f"{SPACE}title") or ""
        if shape.tag not in (f"{SPACE}polyline", f"{SPACE}polygon"):
            continue
        at = points(shape)
        if not (top - 1 <= at[:, 1].min() and at[:, 1].max() <= bottom + 1 and left - 1 <= at[:, 0].min()):
            continue
        if shape.tag == f"{SPACE}polygon" and name:
            areas[name] = turned(at)
        elif name:
            curves.setdefault(name, []).append(turned(at))
    circles = [s for s in shapes if s.tag == f"{SPACE}circle" and top <= float(s.get("cy", 0)) <= bottom]
    marks = np.array([[float(s.get("cx", 0)), float(s.get("cy", 0))] for s in circles]).reshape(-1, 2)
    inside = [(x, y, text) for x, y, text, _ in texts if left <= x <= right and top <= y <= bottom]
    return DrawnPanel(label, curves, areas, turned(marks), inside, abs(up[1]), abs(across[1]))


def points(shape: ElementTree.Element) -> Array:
    """The points of a line or an outline in pixels, (n, 2)."""
    return np.array([[float(x) for x in pair.split(",")] for pair in shape.get("points", "").split()])


def is_frame(shape: ElementTree.Element) -> bool:
    """Whether a line is the frame of a panel: a closed rectangle without a name."""
    at = points(shape)
    return len(at) == 5 and bool((at[0] == at[-1]).all()) and not len(shape)


def is_tick_across(shape: ElementTree.Element, frames: Sequence[Array]) -> bool:
    """Whether a text is a number below the last panel."""
    below = max(float(frame[:, 1].max()) for frame in frames)
    own = shape.tag == f"{SPACE}text" and shape.get("text-anchor") == TICK
    return own and abs(float(shape.get("y", 0)) - below - 16.0) < 1.0 and is_number(shape.text or "")


def scale(ticks: Sequence[tuple[float, str]]) -> tuple[float, float]:
    """The line a + b p through what ticks at pixels p say; of one alone it is taken as 1 a pixel."""
    told = [(at, float(text)) for at, text in ticks if is_number(text)]
    if len(told) < 2:
        at, value = told[0] if told else (0.0, 0.0)
        return value + at, -1.0
    b, a = np.polyfit([at for at, _ in told], [value for _, value in told], 1)
    for at, value in told:
        assert abs(a + b * at - value) <= 0.05 * abs(b), "an axis is not divided evenly"
    return float(a), float(b)


def is_number(text: str) -> bool:
    """Whether a tick's text is a number."""
    return re.fullmatch(r"-?\d+(\.\d+)?(e-?\d+)?", text) is not None


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
