"""Processes take signals as on a terminal, whatever the caller of the tests ignores (`nohup`, a `&` in a script)."""

from __future__ import annotations

import contextlib
import signal
from collections.abc import Iterator

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
