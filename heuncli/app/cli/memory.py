"""Check that enough memory is left to start a command, and whether an error came from lack of memory. Impure."""

from __future__ import annotations

from heuncli.base.errors import LimitError, Problem
from heuncli.base.process import remaining_address_space
from heuncli.base.process import result_memory as result_memory  # re-exported for the commands

MIN_MEMORY = 160e6  # bytes of address space for the modules of Python, NumPy and the kernel
UNMAPPED = ("failed to map segment", "cannot allocate memory", "Cannot allocate memory")  # messages of system loaders


def require_minimum() -> None:
    """Raise LimitError [out-of-memory] if a limit on the address space leaves too little to start."""
    available = remaining_address_space()
    if available is None:
        return
    if available < MIN_MEMORY:
        message = f"the memory limit leaves {available / 1e6:.0f} MB; heun needs {MIN_MEMORY / 1e6:.0f} MB to start"
        raise LimitError(Problem("out-of-memory", message, hint="raise the limit (ulimit -v)"))
    import numpy as np

    np.ones((64, 64)) @ np.ones((64, 64))  # BLAS allocates its memory now; it would end the process without any


def is_memory_error(error: Exception) -> bool:
    """Return whether a library could not be loaded for lack of memory."""
    return isinstance(error, ImportError) and any(words in str(error) for words in UNMAPPED)
