"""The kinds of figures in which planes cut a shape: circles and rings, rectangles, other outlines, or unknown."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from heuncli.base.records import record
from heuncli.results.results import Array

Flags = NDArray[np.bool_]


@record
class CuttingPlanes:
    """Planes n.x = d (k,), with e1 in them.

    shifted_d: (k,) offsets slightly before or behind each plane, which decide what the plane meets
    """

    n: Array
    e1: Array
    d: Array
    shifted_d: Array


@record
class RoundFigure:
    """Circles or rings where planes meet a shape (is_met): centres (k, 3), outer and inner radii (k,) [m]."""

    is_met: Flags
    center: Array
    outer: Array
    inner: Array


@record
class RectangleFigure:
    """Rectangles of one size with sides along e1 (width) and e2 (height) [m], centres (k, 3)."""

    is_met: Flags
    center: Array
    width: float
    height: float


@record
class UnknownFigure:
    """Figures of no other kind, and the reason."""

    is_met: Flags
    reason: str


@record
class ProfileFigure:
    """Figures of any outline.

    values: their properties (k,) by name
    missing: by plane number, why the properties of a figure are not known
    """

    is_met: Flags
    values: Mapping[str, Array]
    missing: Mapping[int, str]


Figure = RoundFigure | RectangleFigure | ProfileFigure | UnknownFigure
