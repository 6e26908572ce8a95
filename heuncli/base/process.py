"""The process that runs heun: the memory left to it, and the listener to which its progress goes. Impure."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar

SHARE = 0.5  # of the available memory: sizes are estimated, steps are not, and other processes run
DEFAULT_AVAILABLE = 4e9  # bytes assumed where the system does not report them
KEPT_BLOCK = 1 << 24  # bytes: more than the arrays of a small scene take
EXPORT_FORMATS = ("json", "csv")
EXPORT, IN_TABLES = 20.0, 28.0  # bytes per number, with its temporaries; its text is made piece by piece


def result_memory(output_format: str) -> tuple[float, float]:
    """Return how many bytes the results may take, and how many bytes each of their numbers takes in an output
    format.
    """
    available = min(_iter_remaining_memory(), default=DEFAULT_AVAILABLE)
    return SHARE * available, EXPORT if output_format in EXPORT_FORMATS else IN_TABLES


def remaining_address_space() -> float | None:
    """Return what the limit on the address space (ulimit -v) leaves [bytes], or None if there is no limit."""
    with suppress(ImportError, OSError, ValueError):
        import resource

        soft, _ = resource.getrlimit(resource.RLIMIT_AS)
        if soft != resource.RLIM_INFINITY:
            return soft - float(_read_text("/proc/self/statm").split()[0]) * resource.getpagesize()
    return None


def keep_freed_memory() -> None:
    """Make the allocator keep the memory that is freed, for a process that solves many scenes one after the other.

    The C library of GNU returns freed memory to the system from a threshold on, which follows the largest block freed
    so far. Below it every scene would get its pages anew: a tenth of the time of a small one.
    """
    bytes(KEPT_BLOCK)  # freed at once; its pages are never touched


def _iter_remaining_memory() -> Iterator[float]:
    """Yield what the machine, its container and the limit on addresses (ulimit -v) leave [bytes]."""
    with suppress(OSError, ValueError, StopIteration):
        lines = _read_text("/proc/meminfo").splitlines()
        yield 1024.0 * next(float(line.split()[1]) for line in lines if line.startswith("MemAvailable:"))
    with suppress(OSError, ValueError):
        limit, used = (float(_read_text(f"/sys/fs/cgroup/memory.{word}")) for word in ("max", "current"))
        yield limit - used  # "max" where there is no limit: no number
    remaining = remaining_address_space()
    if remaining is not None:
        yield remaining


def _read_text(name: str) -> str:
    """Read a file of the system."""
    with open(name, encoding="utf-8") as file:  # noqa: PTH123 - pathlib takes 3 ms
        return file.read()


_LISTENER: ContextVar[Callable[[str], None] | None] = ContextVar("listener", default=None)


@contextmanager
def progress_listener(write: Callable[[str], None] | None) -> Iterator[None]:
    """Send progress messages to `write` inside the `with` block; None drops them."""
    token = _LISTENER.set(write)
    try:
        yield
    finally:
        _LISTENER.reset(token)


def current_listener() -> Callable[[str], None] | None:
    """Return the function that receives progress messages, or None."""
    return _LISTENER.get()
