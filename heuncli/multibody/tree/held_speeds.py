"""Which closure rows hold a speed and no pose: those of wheels that roll."""

from __future__ import annotations

import numpy as np

from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Mask

SPEEDS = (kernel.ROLLS, kernel.ROLLS_ASIDE, kernel.BALL_ROLLS)


def holds_speed(layout: Layout) -> Mask:
    """(rows,): a wheel's row is the sum of one part."""
    closures, parts = layout.tables["closures"], layout.tables["parts"]
    sums = closures["kind"] == kernel.SUM
    found = np.zeros(len(closures), dtype=bool)
    found[sums] = np.isin(parts["kind"][closures["part"][sums]], SPEEDS)
    return found
