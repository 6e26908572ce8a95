"""The field of a panel in pixels, and the places of values of its axes in it."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import Scaling
from heuncli.results.results import Array


class PanelBox(NamedTuple):
    """The field of a panel in pixels, and its axes."""

    left: float
    top: float
    right: float
    bottom: float
    x_scaling: Scaling
    y_scaling: Scaling

    def to_pixel_x(self, value: float) -> float:
        """Return the pixel of a value on the horizontal axis."""
        return self.left + self.x_scaling.to_share(value) * (self.right - self.left)

    def to_pixel_y(self, value: float) -> float:
        """Return the pixel of a value on the vertical axis."""
        return self.bottom - self.y_scaling.to_share(value) * (self.bottom - self.top)

    def to_pixels(self, x: Array, y: Array) -> Array:
        """Return the pixels of points, (n, 2)."""
        return np.column_stack(
            [_scale_values(self.to_pixel_x, x, self.x_scaling), _scale_values(self.to_pixel_y, y, self.y_scaling)]
        )


def _scale_values(to_pixel: Callable[[float], float], values: Array, scaling: Scaling) -> Array:
    """Return the pixels of many values on an axis."""
    values = np.asarray(values, dtype=np.float64)
    if scaling.is_logarithmic:
        with np.errstate(invalid="ignore", divide="ignore"):
            values = np.log(values)
        low, high = math.log(scaling.low), math.log(scaling.high)
    else:
        low, high = scaling.low, scaling.high
    first, last = to_pixel(scaling.low), to_pixel(scaling.high)
    return np.asarray(first + (values - low) / (high - low) * (last - first))
