"""How the process ends. By a signal: one line at most, no half of a file left behind, and 128 + the signal's number.

The handler does not raise: what a signal raises while something is imported, or while an object is destroyed, Python
turns into a traceback or forgets. Nothing is imported here that takes time, for a signal may come while it does; of
`signal` only the C part, without its enumerations. Impure: the process's signals, and its end.
"""

from __future__ import annotations

import _signal  # type: ignore[import-not-found]
import os
import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType
    from typing import Any

LINES = {"SIGINT": b"heun: interrupted\n", "SIGTERM": b"heun: terminated\n", "SIGHUP": b""}  # whose terminal is gone
_undone: list[Callable[[], None]] = []  # what a signal has to do away with


def listen() -> None:
    """End by these signals as told above, but for those that whoever started the process wants ignored (nohup, &)."""
    for name in LINES:
        number = getattr(_signal, name, None)  # there is no SIGHUP on Windows
        if number is not None and _signal.getsignal(number) not in (_signal.SIG_IGN, None):
            _signal.signal(number, _leave)


def deafen() -> None:
    """No signal interrupts what is left to do."""
    for name in (*LINES, "SIGALRM"):
        if hasattr(_signal, name):
            _signal.signal(getattr(_signal, name), _signal.SIG_IGN)


class Undoing:
    """While this is under way a signal that ends the process calls `undo`, which must bear it at any instant."""

    def __init__(self, undo: Callable[[], None]) -> None:
        self.undo = undo

    def __enter__(self) -> None:
        _undone.append(self.undo)

    def __exit__(self, *_: object) -> None:
        _undone.remove(self.undo)


def undo_nothing() -> None:
    """In a process that was forked: what its parent has under way is its parent's to undo."""
    _undone.clear()


class Stopping:
    """While this is under way the first signal to end is only taken down; from `descriptor` something can be read then.

    Whoever is at work ends it in good order, and leaves with 128 + `number`. A second signal ends the process at once.
    """

    def __init__(self) -> None:
        self.number = 0
        self.heard: list[int] = []

    def __enter__(self) -> Stopping:
        self.descriptor, self.written = os.pipe()
        for name in ("SIGINT", "SIGTERM"):
            number = getattr(_signal, name)
            if _signal.getsignal(number) is _leave:
                self.heard.append(number)
                _signal.signal(number, self._stop)
        return self

    def __exit__(self, *_: object) -> None:
        for number in self.heard:
            _signal.signal(number, _leave)
        os.close(self.descriptor)
        os.close(self.written)

    def _stop(self, number: int, frame: FrameType | None) -> None:
        if self.number:
            _leave(number, frame)
        self.number = number
        os.write(self.written, b".")

    @property
    def word(self) -> str:
        """How it ended, as the line says it that a signal leaves."""
        return next(LINES[name] for name in LINES if getattr(_signal, name, None) == self.number).decode().strip()


def end(code: int) -> None:
    """End the process at once where nothing waits for that; else return, and Python ends it.

    Python would clear away all modules and what they hold first, 10 ms and more; all of it goes with the process.
    """
    import atexit

    try:
        for stream in (sys.stdout, sys.stderr):
            if stream is not None:
                stream.flush()
    except (OSError, ValueError):
        return
    if not atexit._ncallbacks() and not _watched():
        os._exit(code)


def _watched() -> bool:
    """Whether somebody profiles or traces the process, who is yet to tell what was seen."""
    monitoring: Any = getattr(sys, "monitoring", None)  # from Python 3.12 on
    tools = [monitoring.get_tool(number) for number in range(6)] if monitoring is not None else []
    return any(who is not None for who in (sys.getprofile(), sys.gettrace(), *tools))


def leave(code: int, line: bytes) -> None:
    """End the process at once: nothing half written is left behind, and standard error gets the line."""
    try:
        for undo in reversed(_undone):
            undo()
        if line and sys.stderr is not None:  # else its number may have become that of another file
            os.write(2, line)
    finally:
        os._exit(code)


def _leave(number: int, frame: FrameType | None) -> None:
    deafen()
    leave(128 + number, next(LINES[name] for name in LINES if getattr(_signal, name, None) == number))
