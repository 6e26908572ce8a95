"""Find the closure rows that constrain a speed and no pose: those of rolling wheels."""

from __future__ import annotations

import numpy as np

from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Mask

SPEEDS = (kernel.ROLLS, kernel.ROLLS_ASIDE, kernel.BALL_ROLLS)


def find_speed_rows(layout: Layout) -> Mask:
    """Return which rows constrain a speed, (rows,); a wheel's row is the sum of one part."""
    closures, parts = layout.tables["closures"], layout.tables["parts"]
    sums = closures["kind"] == kernel.SUM
    is_speed = np.zeros(len(closures), dtype=bool)
    is_speed[sums] = np.isin(parts["kind"][closures["part"][sums]], SPEEDS)
    return is_speed
