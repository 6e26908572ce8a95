"""The process that runs heun: the memory left to it, and the listener to which its progress goes; and other programs.

A program, such as a browser that draws a page, is found on PATH and runs in a folder of its own, with a time limit. It
and all that it begins end together. A browser resolves no names, so that a page reaches no network. Impure.
"""

from __future__ import annotations

import os
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


MAX_MESSAGE = 300  # characters of a program's message
BROWSERS = (
    "chromium", "chromium-browser", "chromium-headless-shell", "google-chrome", "google-chrome-stable", "chrome",
    "msedge", "microsoft-edge",
)  # fmt: skip
BROWSER_OPTIONS = (
    "--headless", "--disable-gpu", "--no-first-run", "--disable-extensions", "--disable-background-networking",
    "--disable-sync", "--disable-component-update", "--disable-dev-shm-usage", "--hide-scrollbars",
    "--host-resolver-rules=MAP * ~NOTFOUND", "--proxy-server=127.0.0.1:9", "--user-data-dir={folder}/profile",
)  # fmt: skip


def find_program(names: tuple[str, ...]) -> str | None:
    """Return the path of the first of these programs on PATH, or None."""
    import shutil  # 2 ms that few commands need

    return next((path for path in map(shutil.which, names) if path is not None), None)


def list_browser_options() -> tuple[str, ...]:
    """List the options of every browser; {folder} stands for its temporary folder. As root it has no sandbox."""
    is_root = hasattr(os, "geteuid") and os.geteuid() == 0
    return (*(("--no-sandbox",) if is_root else ()), *BROWSER_OPTIONS)


def run_program(command: list[str], folder: str, limit: float) -> tuple[bytes, str]:
    """Run a program for at most `limit` [s]; return its output, and why it failed, empty if it did not."""
    import signal
    import subprocess
    import sys

    has_group, is_finished = sys.platform != "win32", False
    try:
        process = subprocess.Popen(
            command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            env={**os.environ, "HOME": folder}, start_new_session=has_group,
        )  # fmt: skip
    except OSError as reason:
        return b"", str(reason)
    try:
        output, message = process.communicate(timeout=limit)
        is_finished = True
    except subprocess.TimeoutExpired:
        return b"", f"it took longer than {limit:.3g} s"
    finally:
        if not is_finished:  # even if the program ended: what it began may still hold its output
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL) if has_group else process.kill()
            process.communicate()
    if not process.returncode:
        return output, ""
    lines = message.decode("utf-8", "replace").strip().splitlines()
    return output, lines[-1][:MAX_MESSAGE] if lines else f"it ended with exit code {process.returncode}"
