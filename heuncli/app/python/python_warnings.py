"""Emit the warnings of a run as Python warnings, which users can silence, show, or turn into errors. Impure."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable

OWN_FRAMES = (__name__.partition(".")[0], "contextlib")  # frames that are heun's own


class HeunWarning(UserWarning):
    """A warning of a run: `warnings.simplefilter("error", heuncli.HeunWarning)` turns it into an error."""


def emit_warnings(texts: Iterable[str]) -> None:
    """Emit each text as a Python warning, at the line of the first caller outside heun."""
    messages = list(texts)
    if not messages:
        return
    depth, frame = 1, sys._getframe()
    while frame.f_back is not None and str(frame.f_globals.get("__name__", "")).partition(".")[0] in OWN_FRAMES:
        depth, frame = depth + 1, frame.f_back
    for text in messages:
        warnings.warn(text, HeunWarning, stacklevel=depth)
