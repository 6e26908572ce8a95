"""Joints along paths: which way the path goes on at the place of it that is nearest to their point.

    (x - r(s)) . r'(s) = 0           x the `to` point, axes of `from`: a roller's centre lies across the path, as well
    u = x' . r' / (r' . r' - (x - r) . r'')       how fast s changes, by the derivative of that
Force is across t = r'/|r'| alone. The path is SciPy's spline through the points of the tables.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from tests.oracle.turns import Array, across, cross

LOOKED_AT = 2000
NEWTON = 8


class Track(NamedTuple):
    """A path, its spline (3 columns)."""

    spline: CubicSpline

    def stand(self, x: Array) -> float:
        """Where along it the place nearest to a point is."""
        s = np.linspace(self.spline.x[0], self.spline.x[-1], LOOKED_AT)
        found = float(s[np.argmin(np.sum((self.spline(s) - x) ** 2, axis=1))])
        for _ in range(NEWTON):
            off, slope, bend = x - self.spline(found), self.spline(found, 1), self.spline(found, 2)
            found += float(off @ slope) / float(slope @ slope - off @ bend)
        return found

    def across(self, x: Array, v: Array) -> list[tuple[Array, Array]]:
        """Two directions across it where a point is, and their rates as it moves with v."""
        s = self.stand(x)
        off, slope, bend = x - self.spline(s), self.spline(s, 1), self.spline(s, 2)
        u = float(v @ slope) / float(slope @ slope - off @ bend)
        size = float(np.linalg.norm(slope))
        t = slope / size
        turning = u * (bend - t * float(t @ bend)) / size
        return [(e, -float(turning @ e) * t) for e in across(t)]


def track(scene: Any, spec: Any) -> Track | None:
    """That of a joint's entry, whose tables share their points, what has none staying at 0; None of other kinds."""
    if spec["type"] != "curve":
        return None
    tables = {axis: scene["tables"][spec[axis]] for axis in "xyz" if axis in spec}
    s = next(iter(tables.values()))["x"]
    r = [tables[axis]["y"] if axis in tables else [0.0] * len(s) for axis in "xyz"]
    return Track(CubicSpline(s, np.array(r).T))


def seen(A: Any, a: Array, point: Array, speed: Array) -> tuple[Array, Array]:
    """A point from a body's point a on, and its velocity, as that body sees them, its axes."""
    x = A.rotation.T @ (point - A.point(a))
    carried = A.velocity + cross(A.angular_velocity, point - A.position)
    return x, A.rotation.T @ (speed - carried)
