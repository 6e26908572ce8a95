"""Processes take signals as on a terminal, whatever the caller of the tests ignores (`nohup`, a `&` in a script)."""

from __future__ import annotations

import contextlib
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path

TAKEN = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT")


def hand_down_signals() -> None:
    """Let processes that tests start take signals that this one ignores: what is ignored stays so in them, too.

    Here nothing comes of these signals still: a handler that does nothing is not handed down.
    """
    for name in TAKEN:
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) == signal.SIG_IGN:
            with contextlib.suppress(ValueError):  # not in the first thread
                signal.signal(number, lambda *_: None)


@contextlib.contextmanager
def interruptible() -> Iterator[None]:
    """While this is under way an interrupt raises KeyboardInterrupt in this process."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def wait_until_solving(pid: int, is_solving: Callable[[int], bool] | None = None) -> None:
    """Wait until a process of heun is at work on a scene: by default, until it has loaded NumPy."""
    if not Path("/proc/self/maps").exists():
        time.sleep(2.0)  # nobody tells
        return
    until = time.monotonic() + 60.0
    while not (is_solving or _has_numpy)(pid) and time.monotonic() < until:
        time.sleep(0.02)


def _has_numpy(pid: int) -> bool:
    with contextlib.suppress(OSError):
        return "_multiarray_umath" in Path(f"/proc/{pid}/maps").read_text()
    return False
