"""How much memory the machine has left for results: half of what is available, within what limits allow. Impure."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress

SHARE = 0.5  # of what is available: sizes are estimated, steps are not, and others are at work beside
UNKNOWN = 4e9  # bytes that are taken to be there where the system does not tell
EXPORTED = ("json", "csv")
EXPORT, IN_TABLES = 20.0, 28.0  # bytes of a number, and of what it is made of; its text is made piece by piece


def room(form: str) -> tuple[float, float]:
    """How many bytes the results may take, and how many each of their numbers takes in a format."""
    return SHARE * min(_left(), default=UNKNOWN), EXPORT if form in EXPORTED else IN_TABLES


def within_limit() -> float | None:
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
    limited = within_limit()
    if limited is not None:
        yield limited


def _text(name: str) -> str:
    with open(name, encoding="utf-8") as file:  # noqa: PTH123 - pathlib takes 3 ms
        return file.read()
