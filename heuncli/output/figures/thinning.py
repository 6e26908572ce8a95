"""Long courses with as many points as can be seen: of each short stretch its least, its greatest, and its gaps."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heuncli.results.results import Array

STRETCHES = 1500  # two a pixel of a panel, nearly


def seen_places(values: Array, stretches: int = STRETCHES) -> NDArray[np.intp]:
    """The places (m,) of values (n,), ascending, that a picture shows; all of them where they are few."""
    count = len(values)
    if count <= 4 * stretches:
        return np.arange(count)
    of_each = -(-count // stretches)
    places = np.minimum(np.arange(stretches * of_each), count - 1).reshape(stretches, of_each)
    parts = values[places]
    unknown = np.isnan(parts)
    each = np.arange(stretches)
    kept = [
        places[each, np.where(unknown, np.inf, parts).argmin(axis=1)],
        places[each, np.where(unknown, -np.inf, parts).argmax(axis=1)],
        places[each, unknown.argmax(axis=1)],  # a gap, else the first
        places[-1:, -1],
    ]
    return np.unique(np.concatenate(kept))
