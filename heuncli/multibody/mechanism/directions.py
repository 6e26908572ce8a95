"""Directions as they are computed with: of length 1, however they were written."""

from __future__ import annotations

import numpy as np

from heuncli.results.results import Array
from heuncli.scene.file_format.models import Vec


def unit(vector: Vec) -> Array:
    """The direction of a vector that the spec layer found not to be zero."""
    v = np.array(vector, dtype=float)
    v = v / np.abs(v).max()
    along: Array = v / np.sqrt(v @ v)
    return along
