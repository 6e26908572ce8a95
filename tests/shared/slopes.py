"""The order that errors show over counts of steps."""

from __future__ import annotations

import numpy as np

from heuncli.results.results import Array


def fitted(counts: Array, errors: Array) -> float:
    """The slope of log error over log count."""
    return -float(np.polyfit(np.log(counts), np.log(errors), 1)[0])
