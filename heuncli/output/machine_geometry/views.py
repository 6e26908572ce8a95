"""From where a machine is seen: parallel projection onto a picture whose axes are r to the right, u up, d to the eye.

    right = r . x,   up = u . x,   depth = d . x (larger is nearer);   r, u, d orthonormal, r x u = d
Up is against gravity where there is one, else z. At azimuth and elevation 0 x points to the right (y where x is up);
from there the eye goes to the right by the azimuth and up by the elevation, as MATLAB's `view` counts them.
"""

from __future__ import annotations

import math
from itertools import islice

import numpy as np

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.reduction.plane.departures import departures
from heuncli.multibody.reduction.plane.frame import candidates
from heuncli.multibody.reduction.plane.view import neighbours
from heuncli.multibody.reduction.plane.view import view as seen_from_plane
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array

AZIMUTH, ELEVATION = 30.0, 20.0  # degrees, from where what moves in space is seen
UPRIGHT = 0.1  # of gravity that must be seen across the line of sight to tell what is up
SAME = 1e-12  # of unit vectors: components that are rounding
SLENDER = 0.6  # of the extent within its plane: what is longer across it is seen from aside
KNOWN = "x, y, z, or azimuth and elevation in degrees"
SUCH = "such as --view z or --view 30,20"


class SceneView(NamedTuple):
    """Directions (3,) of unit length: to the right, up, and to the eye; words: from where that is."""

    right: Array
    up: Array
    toward: Array
    words: str

    def flat(self, points: Array) -> Array:
        """Where points or vectors (..., 3) are seen, (..., 2)."""
        return np.asarray(np.stack([points @ self.right, points @ self.up], axis=-1))

    def depth(self, points: Array) -> Array:
        """How near to the eye points (..., 3) are, (...,)."""
        return np.asarray(points @ self.toward)

    @property
    def along_axes(self) -> bool:
        """Whether the picture shows a plane of two world axes."""
        return all(np.count_nonzero(axis) == 1 for axis in (self.right, self.up))

    def names(self) -> tuple[str, str]:
        """What its axes tell: to the right, up."""
        return named(self.right), named(self.up)


def named(direction: Array) -> str:
    """A direction in the world's axes: `x`, `-y`, `0.87 x - 0.5 y`."""
    found = ""
    for size, axis in zip(direction.tolist(), "xyz", strict=True):
        text = f"{abs(size):.2g}"
        if float(text) >= 0.01:
            sign = ("- " if size < 0.0 else "+ ") if found else "-" if size < 0.0 else ""
            found += f" {sign}" if found else sign
            found += axis if text == "1" else f"{text} {axis}"
    return found


def along(direction: Array, gravity: Array) -> SceneView:
    """Seen along a line; the other world axes go to the right and up rather than to the left and down."""
    d = _clean(direction)
    up = _across(-gravity, d)
    if float(np.linalg.norm(up)) < UPRIGHT * float(np.linalg.norm(gravity)) or not gravity.any():
        up = next(e for e in (_across(axis, d) for axis in np.eye(3)[[2, 1]]) if e @ e > UPRIGHT)
    up = _clean(up)
    right = _clean(np.cross(up, d))
    if right[int(np.argmax(np.abs(right)))] < 0.0:
        d, right = -d, -right
    told = named(d)
    return SceneView(right, up, d, told if told.startswith("-") else f"+{told}")


def turned(azimuth: float, elevation: float, gravity: Array) -> SceneView:
    """Seen from an azimuth and an elevation [degrees]."""
    up = _clean(-gravity) if gravity.any() else np.array([0.0, 0.0, 1.0])
    right = np.eye(3)[1 if int(np.argmax(np.abs(up))) == 0 else 0]
    right = _clean(_across(right, up))
    ahead = np.cross(up, right)
    a, e = math.radians(azimuth), math.radians(elevation)
    level = math.sin(a) * right - math.cos(a) * ahead
    d = _clean(math.cos(e) * level + math.sin(e) * up)
    r = _clean(math.cos(a) * right + math.sin(a) * ahead)
    return SceneView(r, _clean(np.cross(d, r)), d, f"azimuth {azimuth:.6g}, elevation {elevation:.6g} degrees")


def view_of(words: str, gravity: Array) -> SceneView:
    """The view that `--view` asks for. Raises Finding."""
    text = words.strip().lower()
    if text in ("x", "y", "z"):
        return along(np.eye(3)["xyz".index(text)], gravity)
    try:
        azimuth, elevation = map(float, text.split(","))
    except ValueError:
        raise Finding("bad-option", f"expected {KNOWN}", SUCH) from None
    if not (abs(azimuth) <= 360.0 and abs(elevation) <= 90.0):
        raise Finding("bad-option", "expected an azimuth up to 360 and an elevation up to 90 degrees", SUCH)
    return turned(azimuth, elevation, gravity)


def usual(scene: PreparedScene, extent: Array) -> SceneView:
    """What stays in a plane along its normal, unless it is long across it; all else from aside.

    extent: points (n, 3) that the picture is of.
    """
    gravity = scene.mechanism.gravity
    n = plane_of(scene)
    if n is not None:
        seen = along(n, gravity)
        low, high = (f(np.column_stack([seen.flat(extent), seen.depth(extent)]), axis=0) for f in (np.min, np.max))
        across = high - low
        if across[2] <= SLENDER * max(across[0], across[1]):
            return seen
    return turned(AZIMUTH, ELEVATION, gravity)


def plane_of(scene: PreparedScene) -> Array | None:
    """The normal of the plane that a scene stays in, (3,); None of a scene in space."""
    near = neighbours(scene)
    for n in candidates(scene):
        if not list(islice(departures(seen_from_plane(scene, n, near)), 1)):
            return n
    return None


def _across(vector: Array, direction: Array) -> Array:
    """The part of a vector across a unit direction."""
    return np.asarray(vector - (vector @ direction) * direction)


def _clean(vector: Array) -> Array:
    """Of unit length, without components that are rounding."""
    unit = vector / np.linalg.norm(vector)
    unit = np.where(np.abs(unit) < SAME, 0.0, unit)
    return np.asarray(unit / np.linalg.norm(unit))
