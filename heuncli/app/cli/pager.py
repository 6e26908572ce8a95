"""A long text on a terminal goes through a pager; everywhere else it goes straight through. Impure: processes, signals.

While a pager runs the keys of the terminal are its own: an interrupt is for it, and heun waits until it ends. Where
heun is ended (SIGTERM, SIGHUP) it ends the pager first, and gives the terminal back as it was.
"""

from __future__ import annotations

import _signal  # type: ignore[import-not-found]
import os
import shlex
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any

from heuncli.app.cli import terminal
from heuncli.app.cli.output import emit
from heuncli.base.signals import Undoing

DEFAULT = ("less", "-FRX")
SHELL_CHARACTERS = frozenset("|&;<>()$`\\\"'*?[]#~=%\n")  # PAGER with none of them is run without a shell
PATIENCE = 2.0  # seconds for the pager to end when it is told to; then it is killed
KEYS = ("SIGINT", "SIGQUIT")  # signals that a terminal sends for a key, to heun and to the pager


def show(text: str, output: str | None, paged: bool = True) -> None:
    """Write a text: to a file, to a pipe as it is, to a terminal page by page where it has more lines than that."""
    command = _command() if output is None and paged and terminal.present() else None
    if command is None or text.count("\n") < shutil.get_terminal_size().lines:
        emit(text, output)
        return
    try:
        with _keys_left_to_pager():
            _run(command, text.encode())
    except OSError:
        emit(text)


def _command() -> Sequence[str] | None:
    """What PAGER says, else less; None where there is none, or no terminal to read keys from."""
    asked = os.environ.get("PAGER")
    if sys.stdin is None or not sys.stdin.isatty() or asked in ("", "cat"):
        return None
    if not asked:
        return DEFAULT if shutil.which(DEFAULT[0]) else None
    return ("/bin/sh", "-c", asked) if SHELL_CHARACTERS.intersection(asked) else shlex.split(asked) or None


def _run(command: Sequence[str], text: bytes) -> None:
    """Run the pager to its end. Raises OSError where it cannot be started."""
    own_state = _terminal_state()
    process = subprocess.Popen(command, stdin=subprocess.PIPE)
    with Undoing(lambda: _end(process, own_state)):
        try:
            with suppress(BrokenPipeError):  # it ended before it had read all
                process.communicate(text)
        finally:
            process.wait()


def _end(process: subprocess.Popen[bytes], own_state: list[Any] | None) -> None:
    """End the pager, wait for it, and set the terminal as it was before. Bears to be called at any instant."""
    process.terminate()
    until = time.monotonic() + PATIENCE
    while not _has_ended(process) and time.monotonic() < until:
        time.sleep(0.005)
    process.kill()
    if own_state is not None:
        import termios

        _signal.signal(_signal.SIGTTOU, _signal.SIG_IGN)  # else who sets a terminal from its background is stopped
        with suppress(termios.error):  # which is gone
            termios.tcsetattr(sys.stdin.fileno(), termios.TCSANOW, own_state)


def _has_ended(process: subprocess.Popen[bytes]) -> bool:
    """Whether a process ended; asked of the system, for a wait that was interrupted holds the lock of `poll`."""
    try:
        return process.returncode is not None or os.waitpid(process.pid, os.WNOHANG)[0] != 0
    except ChildProcessError:
        return True


def _terminal_state() -> list[Any] | None:
    """How the terminal is set that keys are read from; None where it cannot be asked."""
    try:
        import termios

        assert sys.stdin is not None
        return termios.tcgetattr(sys.stdin.fileno())
    except (ImportError, OSError, termios.error):
        return None


@contextmanager
def _keys_left_to_pager() -> Iterator[None]:
    """Do nothing on signals that keys send. Not SIG_IGN, which the pager would inherit."""
    before: dict[int, Any] = {}
    try:
        for name in KEYS:
            number = getattr(_signal, name, None)
            if number is not None and _signal.getsignal(number) != _signal.SIG_IGN:
                with suppress(ValueError):  # not the thread that signals go to
                    before[number] = _signal.signal(number, lambda *_: None)
        yield
    finally:
        for number, handler in before.items():
            _signal.signal(number, handler)
