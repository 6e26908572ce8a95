"""What a run is warned of: as sentences, and as Python's warnings, which users turn off, on, or into errors. Impure."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable

PASSED = (__name__.partition(".")[0], "contextlib")  # frames that are heun's own


class HeunWarning(UserWarning):
    """What a run is warned of: `warnings.simplefilter("error", heuncli.HeunWarning)` makes errors of it."""


def warn(texts: Iterable[str]) -> None:
    """Warn in Python's way, at the line of the caller outside of heun."""
    told = list(texts)
    if not told:
        return
    depth, frame = 1, sys._getframe()
    while frame.f_back is not None and str(frame.f_globals.get("__name__", "")).partition(".")[0] in PASSED:
        depth, frame = depth + 1, frame.f_back
    for text in told:
        warnings.warn(text, HeunWarning, stacklevel=depth)
