"""Where the stated error of what is drawn can be seen: a band about a curve that is wider than the curve's own line."""

from __future__ import annotations

import math

from heuncli.output.drawing.figure import HEIGHT, Scaling

VISIBLE = 0.5  # pixels: half of a band, below which it is not seen


def is_seen(error: float, y: Scaling, height: float = HEIGHT) -> bool:
    """Whether an error shows on an axis upwards of a height [pixels], both in the unit of the axis."""
    return math.isfinite(error) and error * height > VISIBLE * (y.high - y.low)
