"""Choose the axes of a cut: e1 as given, or a default that does not change abruptly with the slope of a bar.

The normal of a cut across a bar is nearest to one axis of its body, the bar's own, even if the bar is drawn slightly
inclined. Of the other two axes the first, x before y before z, becomes e1, made perpendicular to the normal. (With the
axis most nearly in the plane, y and z would be equal for a bar along x, and the smallest slope would decide between
them.)
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.results.results import Array


def find_nearest_axis(n: Array) -> int:
    """Return the body axis nearest to a unit normal, x before y before z."""
    components = np.abs(n)
    return int(np.flatnonzero(components >= components.max() - tolerances.EQUAL_COMPONENTS)[0])


def choose_default_axis(n: Array) -> int:
    """Return the body axis that e1 is made of by default: the first that is not the nearest to the unit normal."""
    return 1 if find_nearest_axis(n) == 0 else 0


def make_first_axis(n: Array, given_direction: Sequence[float] | None) -> Array:
    """Return e1: the given direction, or the default axis, made perpendicular to the unit normal."""
    a = np.eye(3)[choose_default_axis(n)]
    if given_direction is not None:
        a = np.array(given_direction, dtype=float)
        a = a / np.sqrt(a @ a)
    in_plane = a - (a @ n) * n
    e1: Array = in_plane / np.sqrt(in_plane @ in_plane)
    return e1
