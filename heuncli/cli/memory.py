"""How much memory the machine has left for results: half of what is available, within what limits allow. Impure."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress

from heuncli.errors import LimitError, Problem

SHARE = 0.5  # of what is available: sizes are estimated, steps are not, and others are at work beside
UNKNOWN = 4e9  # bytes that are taken to be there where the system does not tell
EXPORTED = ("json", "csv")
EXPORT, IN_TABLES = 20.0, 28.0  # bytes of a number, and of what it is made of; its text is made piece by piece
LEAST = 160e6  # bytes of addresses that Python's modules, NumPy's and the kernel's take
UNMAPPED = ("failed to map segment", "cannot allocate memory", "Cannot allocate memory")  # as loaders say it


def room(form: str) -> tuple[float, float]:
    """How many bytes the results may take, and how many each of their numbers takes in a format."""
    return SHARE * min(_left(), default=UNKNOWN), EXPORT if form in EXPORTED else IN_TABLES


def require_some() -> None:
    """Raise LimitError [out-of-memory] where a limit on addresses leaves too little to begin with."""
    left = _within_limit()
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


def _within_limit() -> float | None:
    """What a limit on addresses leaves (ulimit -v) [bytes]; None where there is none."""
    with suppress(ImportError, OSError, ValueError):
        import resource

        soft, _ = resource.getrlimit(resource.RLIMIT_AS)
        if soft != resource.RLIM_INFINITY:
            return soft - float(_text("/proc/self/statm").split()[0]) * resource.getpagesize()
    return None


def _left() -> Iterator[float]:
    """What is left by the machine, by its container, and by the limit on addresses (ulimit -v) [bytes]."""
    with suppress(OSError, ValueError, StopIteration):
        lines = _text("/proc/meminfo").splitlines()
        yield 1024.0 * next(float(line.split()[1]) for line in lines if line.startswith("MemAvailable:"))
    with suppress(OSError, ValueError):
        most, taken = (float(_text(f"/sys/fs/cgroup/memory.{word}")) for word in ("max", "current"))
        yield most - taken  # "max" where there is no limit: no number
    limited = _within_limit()
    if limited is not None:
        yield limited


def _text(name: str) -> str:
    with open(name, encoding="utf-8") as file:  # noqa: PTH123 - pathlib takes 3 ms
        return file.read()
