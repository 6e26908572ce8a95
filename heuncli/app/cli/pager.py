"""Show a long text on a terminal through a pager; otherwise write it directly. Impure: processes, signals.

While the pager runs, the terminal's keys belong to it: heun ignores interrupts and waits until it ends. If heun is
ended (SIGTERM, SIGHUP) it ends the pager first and restores the terminal.
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
from heuncli.base.signals import CleanupOnSignal

DEFAULT = ("less", "-FRX")
SHELL_CHARACTERS = frozenset("|&;<>()$`\\\"'*?[]#~=%\n")  # PAGER with none of them is run without a shell
PATIENCE = 2.0  # seconds from the request to end until the pager is killed
KEYS = ("SIGINT", "SIGQUIT")  # signals that a terminal sends for a key, to heun and to the pager


def write_paged(text: str, output: str | None, use_pager: bool = True, contents: str = "") -> None:
    """Write a text to a file or a pipe as it is, and to a terminal through the pager if it has more lines than the
    screen; there the list of its contents comes first.
    """
    command = _find_pager() if output is None and use_pager and terminal.is_terminal() else None
    if command is None or text.count("\n") < shutil.get_terminal_size().lines:
        emit(text, output)
        return
    try:
        with _ignore_key_signals():
            _run_pager(command, (f"{contents}\n{text}" if contents else text).encode())
    except OSError:
        emit(text)


def _find_pager() -> Sequence[str] | None:
    """Return the command of PAGER, else less; None if there is none, or no terminal to read keys from."""
    pager = os.environ.get("PAGER")
    if sys.stdin is None or not sys.stdin.isatty() or pager in ("", "cat"):
        return None
    if not pager:
        return DEFAULT if shutil.which(DEFAULT[0]) else None
    return ("/bin/sh", "-c", pager) if SHELL_CHARACTERS.intersection(pager) else shlex.split(pager) or None


def _run_pager(command: Sequence[str], text: bytes) -> None:
    """Run the pager to its end. Raises OSError if it cannot be started."""
    terminal_state = _read_terminal_state()
    process = subprocess.Popen(command, stdin=subprocess.PIPE)
    with CleanupOnSignal(lambda: _end_pager(process, terminal_state)):
        try:
            with suppress(BrokenPipeError):  # it ended before it had read all
                process.communicate(text)
        finally:
            process.wait()


def _end_pager(process: subprocess.Popen[bytes], terminal_state: list[Any] | None) -> None:
    """End the pager, wait for it, and restore the terminal. May be called at any instant."""
    process.terminate()
    deadline = time.monotonic() + PATIENCE
    while not _has_ended(process) and time.monotonic() < deadline:
        time.sleep(0.005)
    process.kill()
    if terminal_state is not None:
        import termios

        _signal.signal(_signal.SIGTTOU, _signal.SIG_IGN)  # otherwise setting it from the background stops heun
        with suppress(termios.error):  # the terminal is gone
            termios.tcsetattr(sys.stdin.fileno(), termios.TCSANOW, terminal_state)


def _has_ended(process: subprocess.Popen[bytes]) -> bool:
    """Return whether a process ended, by asking the system: `poll` would need a lock that an interrupted wait still
    holds.
    """
    try:
        return process.returncode is not None or os.waitpid(process.pid, os.WNOHANG)[0] != 0
    except ChildProcessError:
        return True


def _read_terminal_state() -> list[Any] | None:
    """Return the settings of the terminal that keys are read from, or None if there is none."""
    try:
        import termios

        assert sys.stdin is not None
        return termios.tcgetattr(sys.stdin.fileno())
    except (ImportError, OSError, termios.error):
        return None


@contextmanager
def _ignore_key_signals() -> Iterator[None]:
    """Ignore the signals of keys, by an empty handler: SIG_IGN would be inherited by the pager."""
    previous_handlers: dict[int, Any] = {}
    try:
        for name in KEYS:
            number = getattr(_signal, name, None)
            if number is not None and _signal.getsignal(number) != _signal.SIG_IGN:
                with suppress(ValueError):  # not the main thread
                    previous_handlers[number] = _signal.signal(number, lambda *_: None)
        yield
    finally:
        for number, handler in previous_handlers.items():
            _signal.signal(number, handler)
