"""How the process ends after a signal: at most one line, no partial file left behind, exit code 128 + the signal's
number.

The handler does not raise: Python turns an exception raised during an import, or while an object is destroyed, into a
traceback, or drops it. Only quick modules are imported here, for a signal may come during the import; of `signal` only
the C part, without its enumerations. Impure: the process's signals, and its end.
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
_cleanups: list[Callable[[], None]] = []  # what a signal has to do away with


def install_handlers() -> None:
    """Let these signals end the process as described above, except those its parent process ignores (nohup, &)."""
    for name in LINES:
        number = getattr(_signal, name, None)  # there is no SIGHUP on Windows
        if number is not None and _signal.getsignal(number) not in (_signal.SIG_IGN, None):
            _signal.signal(number, _handle_signal)


def ignore_signals() -> None:
    """Ignore all further signals."""
    for name in (*LINES, "SIGALRM"):
        if hasattr(_signal, name):
            _signal.signal(getattr(_signal, name), _signal.SIG_IGN)


class CleanupOnSignal:
    """Call `undo` if a signal ends the process inside the `with` block; `undo` must be safe at any instant."""

    def __init__(self, undo: Callable[[], None]) -> None:
        self.undo = undo

    def __enter__(self) -> None:
        _cleanups.append(self.undo)

    def __exit__(self, *_: object) -> None:
        _cleanups.remove(self.undo)


def clear_cleanups() -> None:
    """Forget the cleanups in a forked process: they belong to its parent."""
    _cleanups.clear()


class GracefulStop:
    """Record the first signal inside the `with` block instead of ending; `descriptor` then becomes readable.

    The code in the block ends its work in good order and exits with 128 + `number`. A second signal ends the process at
    once.
    """

    def __init__(self) -> None:
        self.number = 0
        self.heard: list[int] = []

    def __enter__(self) -> GracefulStop:
        self.descriptor, self.written = os.pipe()
        for name in ("SIGINT", "SIGTERM"):
            number = getattr(_signal, name)
            if _signal.getsignal(number) is _handle_signal:
                self.heard.append(number)
                _signal.signal(number, self._stop)
        return self

    def __exit__(self, *_: object) -> None:
        for number in self.heard:
            _signal.signal(number, _handle_signal)
        os.close(self.descriptor)
        os.close(self.written)

    def _stop(self, number: int, frame: FrameType | None) -> None:
        """Note the first signal; end the process at the second."""
        if self.number:
            _handle_signal(number, frame)
        self.number = number
        os.write(self.written, b".")

    @property
    def reason(self) -> str:
        """How the process ended, in the words printed for the signal."""
        return next(LINES[name] for name in LINES if getattr(_signal, name, None) == self.number).decode().strip()


def exit_quickly(code: int) -> None:
    """End the process at once if no exit handlers wait; otherwise return and let Python end it.

    Python would first clear all modules and what they hold, 10 ms and more; the system frees all of it with the
    process.
    """
    import atexit

    try:
        for stream in (sys.stdout, sys.stderr):
            if stream is not None:
                stream.flush()
    except (OSError, ValueError):
        return
    if not atexit._ncallbacks() and not _is_monitored():
        os._exit(code)


def _is_monitored() -> bool:
    """Whether a profiler or tracer watches the process and has yet to report."""
    monitoring: Any = getattr(sys, "monitoring", None)  # from Python 3.12 on
    tools = [monitoring.get_tool(number) for number in range(6)] if monitoring is not None else []
    return any(tool is not None for tool in (sys.getprofile(), sys.gettrace(), *tools))


def exit_after_cleanup(code: int, line: bytes) -> None:
    """End the process at once: run the cleanups and write a line to standard error."""
    try:
        for undo in reversed(_cleanups):
            try:  # noqa: SIM105 - contextlib may not be loaded yet
                undo()
            except Exception:
                pass  # the other cleanups and the line have their turn
        if line and sys.stderr is not None:  # else its number may have become that of another file
            os.write(2, line)
    finally:
        os._exit(code)


def _handle_signal(number: int, frame: FrameType | None) -> None:
    """Clean up, and end the process as the signal asks."""
    ignore_signals()
    exit_after_cleanup(128 + number, next(LINES[name] for name in LINES if getattr(_signal, name, None) == number))
