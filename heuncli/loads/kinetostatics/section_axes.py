"""The axes of a cut: e1 as given, or by default one that does not turn over with the slope of a bar.

The normal of a cut across a bar lies nearest to one axis of its body, the bar's own, be the bar drawn somewhat askew or
not. Of the other two the first, x before y before z, is e1, made perpendicular to the normal. (Of the axes most nearly
in the plane y and z are equal for a bar along x, and the least slope decides between them.)
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.results.results import Array


def nearest_axis(n: Array) -> int:
    """The body axis nearest to a unit normal, x before y before z."""
    along = np.abs(n)
    return int(np.flatnonzero(along >= along.max() - tolerances.EQUAL_COMPONENTS)[0])


def default_axis(n: Array) -> int:
    """The body axis that e1 is made of where none is given: the first that is not the nearest to the unit normal."""
    return 1 if nearest_axis(n) == 0 else 0


def first_axis(n: Array, given: Sequence[float] | None) -> Array:
    """e1: the given direction, or the default axis, made perpendicular to the unit normal."""
    a = np.eye(3)[default_axis(n)]
    if given is not None:
        a = np.array(given, dtype=float)
        a = a / np.sqrt(a @ a)
    in_plane = a - (a @ n) * n
    e1: Array = in_plane / np.sqrt(in_plane @ in_plane)
    return e1
