"""Directions as unit vectors."""

from __future__ import annotations

import numpy as np

from heuncli.results.results import Array
from heuncli.scene.file_format.models import Vec


def unit_vector(vector: Vec) -> Array:
    """Normalize a vector; the spec layer has checked that it is not zero."""
    v = np.array(vector, dtype=float)
    v = v / np.abs(v).max()
    along: Array = v / np.sqrt(v @ v)
    return along
