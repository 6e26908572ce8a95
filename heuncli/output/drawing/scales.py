"""The field of a panel in pixels, and where the values of its axes stand in it."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import Scaling
from heuncli.results.results import Array


class PanelBox(NamedTuple):
    """The field of a panel in pixels, and its scales."""

    left: float
    top: float
    right: float
    bottom: float
    across: Scaling
    up: Scaling

    def x(self, value: float) -> float:
        """Where a place along the axis across stands."""
        return self.left + self.across.at(value) * (self.right - self.left)

    def y(self, value: float) -> float:
        """Where a place along the axis upwards stands."""
        return self.bottom - self.up.at(value) * (self.bottom - self.top)

    def points(self, x: Array, y: Array) -> Array:
        """Where points stand, (n, 2)."""
        return np.column_stack([_along(self.x, x, self.across), _along(self.y, y, self.up)])


def _along(at: Callable[[float], float], values: Array, scaling: Scaling) -> Array:
    """Many values at once on an axis."""
    values = np.asarray(values, dtype=np.float64)
    if scaling.logarithmic:
        with np.errstate(invalid="ignore", divide="ignore"):
            values = np.log(values)
        low, high = math.log(scaling.low), math.log(scaling.high)
    else:
        low, high = scaling.low, scaling.high
    first, last = at(scaling.low), at(scaling.high)
    return np.asarray(first + (values - low) / (high - low) * (last - first))
