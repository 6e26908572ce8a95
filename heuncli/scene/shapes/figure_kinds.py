"""What planes that cut a shape meet of it: circles and rings, rectangles, other outlines, or what is not known."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from heuncli.base.records import record
from heuncli.results.results import Array

Flags = NDArray[np.bool_]


@record
class CuttingPlanes:
    """Planes n.x = d (k,) and e1 in them; beside (k,): a hair before or beyond each, which decides what it meets."""

    n: Array
    e1: Array
    d: Array
    beside: Array


@record
class Round:
    """Circles or rings, where planes meet a shape: centres (k, 3), radii (k,)."""

    met: Flags
    center: Array
    outer: Array
    inner: Array


@record
class Rectangle:
    """Rectangles of one size with sides along e1 (width) and e2 (height), centres (k, 3)."""

    met: Flags
    center: Array
    width: float
    height: float


@record
class Unknown:
    """Other figures, and what they are."""

    met: Flags
    why: str


@record
class Profile:
    """Figures of any outline: their properties (k,) by name, and why those of some are not known, by their numbers."""

    met: Flags
    values: Mapping[str, Array]
    missing: Mapping[int, str]


Figure = Round | Rectangle | Profile | Unknown
