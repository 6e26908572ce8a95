"""Where results go: standard output, or a file that is written whole or not at all. Impure: writes.

Whatever keeps output from arriving is an OutputError (exit 5), but for a reader that went away: ReaderGone (exit 141).
"""

from __future__ import annotations

import codecs
import contextlib
import os
import stat
import sys
from pathlib import Path

from heuncli.cli import alarm
from heuncli.errors import HeunError, OutputError, Problem
from heuncli.foreign_text import escaped, shown_lines

NEW_FILE_MODE = 0o666
TO_FILE = "write to a file: -o FILE"
TO_OTHER = "make room there, or name a file that can be written: -o FILE"
ESCAPED = "heun.escaped"


class ReaderGone(HeunError):
    """Nobody reads standard output any more; nothing needs saying."""

    exit_code = 141


def emit(text: str, target: str | None = None, *, late: bool = False) -> None:
    """Write the text to a file, or to standard output for None and `-`; no time limit interrupts that.

    late: also where the time limit is past; else LimitError is raised, and nothing is written.
    """
    alarm.off(late=late)
    if target is None or target == "-":
        _to_standard_output(text)
    else:
        _to_file(as_bytes(text), Path(target))


def as_bytes(text: str, encoding: str = "utf-8") -> bytes:
    """The text in UTF-8 wherever programs read it, whatever the locale says: two names never become one.

    On a terminal that shows another encoding, what that lacks is escaped as in JSON, and so are halves of pairs
    everywhere (of file names that are not UTF-8).
    """
    codecs.register_error(ESCAPED, _escape)
    return text.encode(encoding, ESCAPED)


def _escape(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return escaped(error.object[error.start : error.end]), error.end


def save(content: bytes, target: str) -> None:
    """Write what is no text to a file, however late."""
    alarm.off(late=True)
    _to_file(content, Path(target))


def say(text: str) -> None:
    """A line to standard error, if anybody can read it."""
    with contextlib.suppress(OSError, ValueError):
        if sys.stderr is not None:
            print(shown_lines(text), file=sys.stderr, flush=True)


def _to_standard_output(text: str) -> None:
    if sys.stdout is None:
        raise OutputError(Problem("output-closed", "standard output is closed", hint=TO_FILE))
    try:
        left = memoryview(as_bytes(text, sys.stdout.encoding if sys.stdout.isatty() else "utf-8"))
        while left:  # unbuffered (PYTHONUNBUFFERED) a write may take a part only
            left = left[sys.stdout.buffer.write(left) or 0 :]
        sys.stdout.buffer.flush()
    except BrokenPipeError:
        _silence()
        raise ReaderGone from None
    except OSError as reason:
        _silence()
        message = f"standard output: {reason.strerror or reason}"
        raise OutputError(Problem("output-failed", message, hint=TO_FILE)) from reason


def _silence() -> None:
    """Send what Python would still flush at exit to nowhere, so that it does not complain once more."""
    with contextlib.suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)


def _to_file(content: bytes, path: Path) -> None:
    try:
        target = path.resolve()
        if target.exists() and not target.is_file():
            target.write_bytes(content)  # a pipe or a device has no "whole"
        else:
            _replace(content, target)
    except OSError as reason:
        raise OutputError(Problem("output-failed", f"{path}: {reason.strerror or reason}", hint=TO_OTHER)) from reason


def _replace(content: bytes, target: Path) -> None:
    """Write beside the target, then rename over it: at every moment the old content or the new one stands there."""
    import tempfile  # 4 ms that only files need

    mode = stat.S_IMODE(target.stat().st_mode) if target.exists() else NEW_FILE_MODE & ~_umask()
    handle, name = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        Path(name).chmod(mode)
        Path(name).replace(target)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
