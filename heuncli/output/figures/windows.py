"""The part of the plane that a figure of a machine shows: all of it, or if something extends far, the part of the
joints.

Outlines and lines that leave the window are cut at its sides (Sutherland and Hodgman, 1974; Liang and Barsky, 1984).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import Arrow, Item, Polygon, Strokes
from heuncli.output.figures.posed_machine import PosedMachine
from heuncli.output.machine_geometry.machine import JointGeometry
from heuncli.output.machine_geometry.marks import find_scene_joint_kind
from heuncli.results.results import Array
from heuncli.scene.file_format.names import GROUND

MAX_EXTENT_RATIO = 12.0  # times the extent of joints and centres: a larger machine is drawn in part
ROUNDING = 1e-9  # share of the figure: joints and centres that are closer coincide
CORE_MARGIN = 0.8  # of the extent of joints and centres, around them in a partial figure
NEAR_DISTANCE = 0.4  # of the larger side: a reaction that acts farther away is not shown
MARGIN = 0.05  # share of the larger side, around all
MIN_SIDES = np.array([0.4, 0.25])  # minimum sides as shares of the larger one, for labels


class Window(NamedTuple):
    """A cut-out of a figure: its corners (2,) in the figure's unit, and notes on parts outside it."""

    low: Array
    high: Array
    notes: Sequence[str] = ()

    @property
    def side(self) -> float:
        """Its larger side."""
        return float((self.high - self.low).max())

    def is_near(self, place: Array) -> bool:
        """Return whether a place (2,) lies in the window, or not far from it."""
        distances = np.maximum(self.low - place, place - self.high)
        return bool((distances <= NEAR_DISTANCE * self.side).all())

    def extend_to_arrows(self, arrows: Sequence[Arrow]) -> Window:
        """Extend the window so that it contains the arrows, with room for two lines of words at their tips."""
        tips = [(a.x + a.by_x, a.y + a.by_y) for a in arrows]
        margin = MARGIN * self.side
        low = np.min([self.low, *(np.array(tip) - margin for tip in tips)], axis=0)
        high = np.max([self.high, *(np.array(tip) + margin for tip in tips)], axis=0)
        return self._replace(low=low, high=high)


def choose_window(posed_machine: PosedMachine, paths: Sequence[Array]) -> Window:
    """Choose the window for a machine at all its instants, and for the paths (n, 2) of points."""
    core_points, all_points, points_of_body = _collect_points(posed_machine, paths)
    low, high = all_points.min(axis=0), all_points.max(axis=0)
    notes: list[str] = []
    inner = core_points.min(axis=0), core_points.max(axis=0)
    reach = float((inner[1] - inner[0]).max())
    across = float((high - low).max())
    if reach > ROUNDING * across and across > MAX_EXTENT_RATIO * reach:
        low, high = np.maximum(low, inner[0] - CORE_MARGIN * reach), np.minimum(high, inner[1] + CORE_MARGIN * reach)
        cut_names = [
            name
            for name, body_points in points_of_body.items()
            if (body_points.min(axis=0) < low).any() or (body_points.max(axis=0) > high).any()
        ]
        notes.append(f"only partly drawn, extending further: {', '.join(cut_names)}")
    side = float((high - low).max()) or 1.0
    lacking = np.maximum(MIN_SIDES * side - (high - low), 0.0)
    margins = 0.5 * lacking + MARGIN * side
    return Window(low - margins, high + margins, notes)


def _collect_points(posed_machine: PosedMachine, point_paths: Sequence[Array]) -> tuple[Array, Array, dict[str, Array]]:
    """Collect points (n, 2): of joints, centres, ends and paths; these and all of the bodies; of each body."""
    machine = posed_machine.machine
    core_points: list[Array] = []
    points_of_body: dict[str, list[Array]] = {body.name: [] for body in machine.bodies}
    for k in range(len(posed_machine.poses.times)):
        core_points += [
            posed_machine.project(body.name, posed_machine.centers[body.name], k) for body in machine.bodies
        ]
        core_points += [
            posed_machine.project(name, place, k) for name, own in posed_machine.masses.items() for place in own
        ]
        ends = [(own.a, own.p) for own in machine.joints if not _slides(posed_machine, own)]  # a slider is drawn at q
        ends += [(own.b, own.q) for own in machine.joints]
        lines = [own for own in machine.lines if own.name not in posed_machine.guided_actuators]
        ends += [(own.a, own.p) for own in lines] + [(own.b, own.q) for own in lines]
        core_points += [posed_machine.project(body, point, k) for body, point in ends]
        for body in machine.bodies:
            for part in (*(solid.surface.corners for solid in posed_machine.solids[body.name]), *body.strokes):
                points_of_body[body.name] += list(posed_machine.project(body.name, part, k))
    for path in machine.paths:
        core_points += list(posed_machine.project(GROUND, path, 0))
    for point_path in point_paths:
        core_points += list(point_path)
    arrays_of_body = {name: np.array(points) for name, points in points_of_body.items() if points}
    inner = np.array(core_points)
    return inner, np.concatenate([inner, *arrays_of_body.values()]), arrays_of_body


def _slides(posed_machine: PosedMachine, joint: JointGeometry) -> bool:
    """Return whether the two points of a joint part along a line or plane, so that nothing is drawn at the first."""
    return bool(find_scene_joint_kind(posed_machine.spec, joint.kind).shifts)


def clip_items(items: Sequence[Item], window: Window) -> Iterator[Item]:
    """Yield the parts of outlines and strokes within a window, and all other items as they are."""
    for item in items:
        if isinstance(item, Polygon):
            corners = clip_polygon(item.corners, window.low, window.high)
            if len(corners) > 1:
                yield item if corners is item.corners else item._replace(corners=corners)
        elif isinstance(item, Strokes):
            ends = clip_strokes(item.ends, window.low, window.high)
            if len(ends):
                yield item._replace(ends=ends)
        else:
            yield item


def clip_polygon(corners: Array, low: Array, high: Array) -> Array:
    """Return the part of a convex polygon (n, 2) within a window; the same array if all of it is."""
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


def clip_strokes(ends: Array, low: Array, high: Array) -> Array:
    """Return the parts of strokes (n, 2, 2) within a window."""
    if (ends >= low).all() and (ends <= high).all():
        return ends
    start, directions = ends[:, 0], ends[:, 1] - ends[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (low - start) / directions, (high - start) / directions
    is_parallel = directions == 0.0
    outside = (is_parallel & ((start < low) | (start > high))).any(axis=1)
    first = np.where(is_parallel, 0.0, np.minimum(a, b)).max(axis=1, initial=0.0)
    last = np.where(is_parallel, 1.0, np.maximum(a, b)).min(axis=1, initial=1.0)
    is_inside = ~outside & (first < last)
    parts = np.stack([start + first[:, None] * directions, start + last[:, None] * directions], axis=1)
    return np.asarray(parts[is_inside])
