"""Arrays as text in a page: base64 of their bytes, least significant first, which a browser reads without loss.

A column of one number throughout is that number: most of a plane motion's columns are 0.
"""

from __future__ import annotations

import base64
import math

import numpy as np

from heuncli.results.results import Array

Packed = str | float  # base64 of all numbers, or the one that all of them are


def packed(values: Array) -> Packed:
    """All digits of an array, flat: numbers that are read. nan, which stands for what is open, stays one."""
    flat = np.ascontiguousarray(values, dtype="<f8").ravel()
    first = float(flat[0]) if flat.size else 0.0
    if math.isfinite(first) and bool((flat == first).all()):
        return first + 0.0
    return base64.b64encode(flat.tobytes()).decode("ascii")


def drawn(values: Array) -> str:
    """Seven digits of an array, flat: places that are drawn."""
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode("ascii")
