"""What a drawing shows, read back from its SVG: panels by their axes, these by the numbers along them."""

from __future__ import annotations

import xml.etree.ElementTree as tree
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from heuncli.output.drawing.style import FAINT
from heuncli.results.results import Array

PlaceOf = Callable[[float, float], tuple[float, bool]]  # of a number at x, y: where on the axis, whether on it
SVG = "{http://www.w3.org/2000/svg}"
SCALE_BAR, ABOVE_BAR = "scale bar: ", 17.0  # title of a scale bar; pixels from it up to the view
METRES = {"mm": 1e-3, "m": 1.0, "km": 1e3, "in": 0.0254}
BELOW, BESIDE, BASE = 18.0, 7.0, 4.0  # pixels: from a frame to the numbers under it, to those at its left; their base


class PlottedAxis(NamedTuple):
    """Numbers along an axis: a value is `begin + step * pixel`; even: whether all numbers stand so."""

    begin: float
    step: float
    even: bool = True

    def values(self, pixels: Array) -> Array:
        """What stands at some pixels."""
        return np.asarray(self.begin + self.step * pixels)


class PlottedPanel(NamedTuple):
    """A panel: its axes, and all that is drawn in its frame."""

    left: float
    top: float
    right: float
    bottom: float
    x: PlottedAxis
    y: PlottedAxis
    root: tree.Element

    def named(self, tag: str) -> Iterator[tuple[str, Array]]:
        """The polylines or polygons in the frame that have a name, each with its points (n, 2), in the axes' units."""
        for element in self.root.iter(f"{SVG}{tag}"):
            name = element.findtext(f"{SVG}title")
            if name and self.holds(points := points_of(element)):
                yield name, self.in_units(points)

    def lines(self, name: str) -> list[Array]:
        """The polylines of a name, (n, 2) each, in the units of the axes."""
        return [points for own, points in self.named("polyline") if own == name]

    def areas(self, name: str) -> list[Array]:
        """The filled polygons of a name, (n, 2) each, in the units of the axes."""
        return [points for own, points in self.named("polygon") if own == name]

    def spots(self, *, filled: bool) -> Array:
        """The middles of round marks, (n, 2), in the units of the axes."""
        circles = (e for e in self.root.iter(f"{SVG}circle") if (e.get("fill") != "#ffffff") == filled)
        places = [(float(e.get("cx", "nan")), float(e.get("cy", "nan"))) for e in circles]
        return self.in_units(np.array([p for p in places if self.holds(np.array([p]))]).reshape(-1, 2))

    def in_units(self, points: Array) -> Array:
        """Pixels (n, 2) in the units of the axes."""
        return np.column_stack([self.x.values(points[:, 0]), self.y.values(points[:, 1])])

    def holds(self, points: Array) -> bool:
        """Whether points (n, 2) lie in the frame."""
        low, high = points.min(axis=0), points.max(axis=0)
        edge = 1.0
        across = self.left - edge <= low[0] and high[0] <= self.right + edge
        return bool(across and self.top - edge <= low[1] and high[1] <= self.bottom + edge)

    @property
    def pixel(self) -> float:
        """The larger of the two units that a pixel is."""
        return max(abs(self.x.step), abs(self.y.step))


def points_of(element: tree.Element) -> Array:
    """The points of a polyline or polygon, (n, 2) [pixels]."""
    return np.array([[float(x) for x in pair.split(",")] for pair in element.get("points", "").split()])


def panels_of(svg: str, *, equal: bool = False) -> list[PlottedPanel]:
    """The panels of a drawing, from above; equal: of both axes alike, so that one number tells the one across."""
    root = tree.fromstring(svg.encode())
    frames = [points for e in root.iter(f"{SVG}polyline") if not len(e) and is_frame(points := points_of(e))]
    found = []
    for points in frames:
        (left, top), (right, bottom) = points.min(axis=0), points.max(axis=0)
        under = numbers(root, "middle", lambda x, y, at=bottom: (x, abs(y - at - BELOW) < 0.1))
        beside = numbers(root, "end", lambda x, y, at=left: (y - BASE, abs(x - at + BESIDE) < 0.1))
        upward = {place: value for place, value in beside.items() if top - 1.0 <= place <= bottom + 1.0}
        y = axis(upward)
        x = axis(under) if not equal or len(under) > 1 else through(under, -y.step)
        found.append(PlottedPanel(left, top, right, bottom, x, y, root))
    named = next((panel.x for panel in reversed(found) if np.isfinite(panel.x.step)), None)
    return [panel._replace(x=named) if named and not np.isfinite(panel.x.step) else panel for panel in found]


def views_of(svg: str) -> list[PlottedPanel]:
    """The views of machines in a drawing, from above: each ends at its key, whose scale bar tells how long a metre is.

    Where the origin stands is not told: places are right but for a shift that is the same for all of a view.
    """
    root = tree.fromstring(svg.encode())
    found, top = [], 0.0
    for e in root.iter(f"{SVG}polyline"):
        words = e.findtext(f"{SVG}title") or ""
        if words.startswith(SCALE_BAR):
            (left, y), (right, _) = points_of(e)
            value, unit = words.removeprefix(SCALE_BAR).split(" ")
            step = float(value) * METRES[unit] / (right - left)
            axes = PlottedAxis(0.0, step), PlottedAxis(0.0, -step)
            found.append(PlottedPanel(-np.inf, top, np.inf, float(y) - ABOVE_BAR, *axes, root))
            top = float(y) + ABOVE_BAR
    return found


def key_arrows(svg: str) -> dict[str, float]:
    """The arrows of a key by their words: how long each is [pixels]."""
    root = tree.fromstring(svg.encode())
    written = {e.text for e in root.iter(f"{SVG}text")}
    lines = {name: points_of(e) for e in root.iter(f"{SVG}polyline") if (name := e.findtext(f"{SVG}title")) in written}
    tips = {name: points_of(e) for e in root.iter(f"{SVG}polygon") if (name := e.findtext(f"{SVG}title")) in lines}
    return {name: float(tip[0, 0] - lines[name][0, 0]) for name, tip in tips.items()}


def polar_panel_of(svg: str) -> PlottedPanel:
    """The one polar panel of a drawing, by the arcs of its rings, which have their values as names."""
    root = tree.fromstring(svg.encode())
    rings = [
        (float(name.partition(" ")[0].replace("−", "-")), points_of(e))
        for e in root.iter(f"{SVG}polyline")
        if e.get("stroke") == FAINT and (name := e.findtext(f"{SVG}title"))
    ]
    value, points = max(rings, key=lambda ring: len(ring[1]))
    # |p - c|² = r²: linear in the centre and in r² - |c|²
    rows = np.column_stack([2.0 * points, np.ones(len(points))])
    x, y, rest = np.linalg.lstsq(rows, (points**2).sum(axis=1), rcond=None)[0]
    step = value / np.sqrt(rest + x**2 + y**2)
    width, height = float(root.get("width", "nan")), float(root.get("height", "nan"))
    return PlottedPanel(0.0, 0.0, width, height, PlottedAxis(-step * x, step), PlottedAxis(step * y, -step), root)


def is_frame(points: Array) -> bool:
    """Whether a line is the two axes of a panel: down at its left, then to the right below it."""
    if len(points) != 3:
        return False
    down, across = np.diff(points, axis=0)
    return bool(down[0] == 0.0 and down[1] > 10.0 and across[1] == 0.0 and across[0] > 10.0)


def numbers(root: tree.Element, anchor: str, place_of: PlaceOf) -> dict[float, float]:
    """The numbers written along an axis by their places [pixels]."""
    found = {}
    for e in root.iter(f"{SVG}text"):
        if e.get("text-anchor") != anchor or e.get("transform"):
            continue
        place, own = place_of(float(e.get("x", "nan")), float(e.get("y", "nan")))
        try:
            if own:
                found[place] = float((e.text or "").replace("−", "-"))
        except ValueError:
            continue
    return found


def axis(found: dict[float, float]) -> PlottedAxis:
    """The axis through numbers at their places; without numbers where there are fewer than two."""
    if len(found) < 2:
        return PlottedAxis(float("nan"), float("nan"))
    places, values = np.array(list(found)), np.array(list(found.values()))
    step, begin = np.polyfit(places, values, 1)
    even = np.abs(begin + step * places - values).max() <= 0.05 * abs(step)
    return PlottedAxis(float(begin), float(step), bool(even))


def through(found: dict[float, float], step: float) -> PlottedAxis:
    """The axis of a known step through one number at its place."""
    ((place, value),) = found.items()
    return PlottedAxis(value - step * place, step)


def texts_of(svg: str) -> list[str]:
    """All that is written in a drawing."""
    return [e.text or "" for e in tree.fromstring(svg.encode()).iter(f"{SVG}text")]


def far_from(points: Array, line: Array) -> float:
    """How far the farthest of points (n, 2) is from a polyline (m, 2)."""
    a, b = line[:-1], line[1:]
    along = b - a
    length = np.maximum((along**2).sum(axis=1), 1e-300)
    share = np.clip(((points[:, None] - a) * along).sum(axis=2) / length, 0.0, 1.0)
    near = a + share[:, :, None] * along
    return float(np.sqrt(((points[:, None] - near) ** 2).sum(axis=2)).min(axis=1).max())
