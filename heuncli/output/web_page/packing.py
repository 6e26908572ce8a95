"""Pack arrays as text for a page: base64 of their little-endian bytes, which a browser reads without loss.

A constant column is packed as one number, because most columns of a planar motion are 0.
"""

from __future__ import annotations

import base64
import math

import numpy as np

from heuncli.results.results import Array

Packed = str | float  # base64 of all numbers, or the number itself if all are equal


def pack_values(values: Array) -> Packed:
    """Pack an array, flattened, with all its digits. A nan, which stands for an indeterminate value, is kept."""
    flat = np.ascontiguousarray(values, dtype="<f8").ravel()
    first = float(flat[0]) if flat.size else 0.0
    if math.isfinite(first) and bool((flat == first).all()):
        return first + 0.0
    return base64.b64encode(flat.tobytes()).decode("ascii")


def pack_points(values: Array) -> str:
    """Pack an array, flattened, as float32 (seven digits), for points that are drawn."""
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode("ascii")
