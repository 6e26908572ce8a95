"""What of a plane a picture of a machine shows: all of it, or, if something reaches far, the joints' part.

Outlines and lines that leave the window are cut at its sides (Sutherland and Hodgman, 1974; Liang and Barsky, 1984).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import Arrow, Item, Polygon, Strokes
from heuncli.output.figures.machine_items import Stood
from heuncli.results.results import Array
from heuncli.scene.file_format.names import GROUND

FAR = 12.0  # times as far as all joints and centres reach: what is drawn in part
ROUNDING = 1e-9  # of what is seen: joints and centres that are no farther apart stand in one place
BESIDE = 0.8  # of these, shown around them then
SPARE = 0.07  # of the larger side, around all
NARROW = np.array([0.8, 0.35])  # of the larger side: the smaller one at least, across for the words of the key


class Window(NamedTuple):
    """Its corners (2,), in the unit of the picture, and what it does not show."""

    low: Array
    high: Array
    notes: Sequence[str] = ()

    @property
    def side(self) -> float:
        """The larger one."""
        return float((self.high - self.low).max())

    def with_arrows(self, arrows: Sequence[Arrow]) -> Window:
        """One that has room for arrows, too."""
        tips = [(a.x + a.by_x, a.y + a.by_y) for a in arrows]
        spare = SPARE * self.side
        low = np.min([self.low, *(np.array(tip) - 0.5 * spare for tip in tips)], axis=0)
        high = np.max([self.high, *(np.array(tip) + 0.5 * spare for tip in tips)], axis=0)
        return self._replace(low=low, high=high)


def window_of(stood: Stood, ways: Sequence[Array]) -> Window:
    """A window on a machine at all its instants, and on the ways (n, 2) of points."""
    core, full, far = _reaches(stood, ways)
    low, high = full.min(axis=0), full.max(axis=0)
    notes: list[str] = []
    inner = core.min(axis=0), core.max(axis=0)
    reach = float((inner[1] - inner[0]).max())
    across = float((high - low).max())
    if reach > ROUNDING * across and across > FAR * reach:
        low, high = np.maximum(low, inner[0] - BESIDE * reach), np.minimum(high, inner[1] + BESIDE * reach)
        beyond = [name for name, own in far.items() if (own.min(axis=0) < low).any() or (own.max(axis=0) > high).any()]
        notes.append(f"drawn in part, reaching farther: {', '.join(beyond)}")
    side = float((high - low).max()) or 1.0
    lacking = np.maximum(NARROW * side - (high - low), 0.0)
    room = 0.5 * lacking + SPARE * side
    return Window(low - room, high + room, notes)


def _reaches(stood: Stood, ways: Sequence[Array]) -> tuple[Array, Array, dict[str, Array]]:
    """Points (n, 2) that are to be seen: joints, centres, ends, ways; these and all of the bodies; of each body."""
    machine = stood.machine
    core: list[Array] = []
    far: dict[str, list[Array]] = {body.name: [] for body in machine.bodies}
    for k in range(len(stood.poses.times)):
        core += [stood.seen(body.name, stood.centers[body.name], k) for body in machine.bodies]
        core += [stood.seen(name, place, k) for name, own in stood.masses.items() for place in own]
        ends = [(own.a, own.p) for own in machine.joints] + [(own.b, own.q) for own in machine.joints]
        ends += [(own.a, own.p) for own in machine.lines] + [(own.b, own.q) for own in machine.lines]
        core += [stood.seen(body, point, k) for body, point in ends]
        for body in machine.bodies:
            for part in (*(solid.surface.corners for solid in stood.solids[body.name]), *body.strokes):
                far[body.name] += list(stood.seen(body.name, part, k))
    for path in machine.paths:
        core += list(stood.seen(GROUND, path, 0))
    for way in ways:
        core += list(way)
    reached = {name: np.array(points) for name, points in far.items() if points}
    inner = np.array(core)
    return inner, np.concatenate([inner, *reached.values()]), reached


def clipped(items: Sequence[Item], window: Window) -> Iterator[Item]:
    """What of outlines and strokes lies within a window; all else as it is."""
    for item in items:
        if isinstance(item, Polygon):
            corners = polygon_within(item.corners, window.low, window.high)
            if len(corners) > 1:
                yield item if corners is item.corners else item._replace(corners=corners)
        elif isinstance(item, Strokes):
            ends = strokes_within(item.ends, window.low, window.high)
            if len(ends):
                yield item._replace(ends=ends)
        else:
            yield item


def polygon_within(corners: Array, low: Array, high: Array) -> Array:
    """The part of a convex polygon (n, 2) within a window; the same array where all of it is."""
    if (corners >= low).all() and (corners <= high).all():
        return corners
    for axis in (0, 1):
        for sign, limit in ((1.0, float(low[axis])), (-1.0, float(high[axis]))):
            inside: list[Array] = []
            for p, q in zip(corners, np.roll(corners, -1, axis=0), strict=True):
                a, b = sign * (p[axis] - limit), sign * (q[axis] - limit)
                if a >= 0.0:
                    inside.append(p)
                if (a >= 0.0) != (b >= 0.0):
                    inside.append(p + (q - p) * (a / (a - b)))
            corners = np.array(inside).reshape(-1, 2)
    return corners


def strokes_within(ends: Array, low: Array, high: Array) -> Array:
    """The parts of strokes (n, 2, 2) within a window."""
    if (ends >= low).all() and (ends <= high).all():
        return ends
    start, way = ends[:, 0], ends[:, 1] - ends[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (low - start) / way, (high - start) / way
    level = way == 0.0
    outside = (level & ((start < low) | (start > high))).any(axis=1)
    first = np.where(level, 0.0, np.minimum(a, b)).max(axis=1, initial=0.0)
    last = np.where(level, 1.0, np.maximum(a, b)).min(axis=1, initial=1.0)
    kept = ~outside & (first < last)
    parts = np.stack([start + first[:, None] * way, start + last[:, None] * way], axis=1)
    return np.asarray(parts[kept])
