"""Whether a stated error is visible: whether a band about a curve is wider than the curve's own line."""

from __future__ import annotations

import math

from heuncli.output.drawing.figure import Scaling
from heuncli.output.drawing.style import PANEL_HEIGHT

MIN_HALF_WIDTH = 0.5  # pixels: half width of a band


def is_visible(error: float, y: Scaling, height: float = PANEL_HEIGHT) -> bool:
    """Return whether an error is visible on a vertical axis of a height [pixels]; error and axis have the same unit."""
    return math.isfinite(error) and error * height > MIN_HALF_WIDTH * (y.high - y.low)
