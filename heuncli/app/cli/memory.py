"""Whether there is memory enough for a command to begin with, and whether it ended for want of it. Impure."""

from __future__ import annotations

from heuncli.base.errors import LimitError, Problem
from heuncli.base.memory_left import room as room  # for the commands, beside what is here
from heuncli.base.memory_left import within_limit

LEAST = 160e6  # bytes of addresses that Python's modules, NumPy's and the kernel's take
UNMAPPED = ("failed to map segment", "cannot allocate memory", "Cannot allocate memory")  # as loaders say it


def require_some() -> None:
    """Raise LimitError [out-of-memory] where a limit on addresses leaves too little to begin with."""
    left = within_limit()
    if left is None:
        return
    if left < LEAST:
        message = f"the limit on memory leaves {left / 1e6:.0f} MB; heun takes {LEAST / 1e6:.0f} MB to begin with"
        raise LimitError(Problem("out-of-memory", message, hint="a higher limit (ulimit -v)"))
    import numpy as np

    np.ones((64, 64)) @ np.ones((64, 64))  # BLAS takes its memory now: where it finds none it ends the process itself


def ended(error: Exception) -> bool:
    """Whether a library could not be loaded for want of memory."""
    return isinstance(error, ImportError) and any(words in str(error) for words in UNMAPPED)
