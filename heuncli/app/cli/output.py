"""Where results go: standard output, or a file that is written whole or not at all. Impure: writes.

Whatever keeps output from arriving is an OutputError (exit 5), but for a reader that went away: ReaderGone (exit 141).
"""

from __future__ import annotations

import codecs
import contextlib
import sys
from collections.abc import Iterable, Iterator
from typing import TextIO

from heuncli.app.cli import alarm
from heuncli.base import files
from heuncli.base.errors import OutputError, Problem
from heuncli.base.files import ReaderGone
from heuncli.base.foreign_text import escaped, shown_lines

DESCRIPTOR = 1  # of standard output
ESCAPED = "heun.escaped"
BLOCK = 1 << 18  # characters that are written together


def emit(text: str | Iterable[str], target: str | None = None, *, late: bool = False) -> None:
    """Write the text, or its pieces as they are made, to a file, or to standard output for None and `-`.

    No time limit interrupts what is written: it holds until the first byte goes out, and of a file that is written
    whole or not at all until the last piece is made. late: also where the time limit is past; else LimitError is
    raised, and nothing is written.
    """
    pieces = [text] if isinstance(text, str) else text
    to_stdout = target is None or target == files.STDOUT
    if target is None or to_stdout or (place := files.place_of(target)).descriptor == DESCRIPTOR:  # /dev/stdout
        alarm.disarm(late=late)
        _to_standard_output(pieces)
    elif place.ordinary:
        files.write(_within_limit(as_blocks(pieces), late), target)
    else:
        alarm.disarm(late=late)
        files.write(as_blocks(pieces), target)


def _within_limit(content: Iterable[bytes], late: bool) -> Iterator[bytes]:
    yield from content
    alarm.disarm(late=late)


def as_blocks(pieces: Iterable[str], encoding: str = "utf-8") -> Iterator[bytes]:
    """The pieces as bytes, short ones together: each call of the system has its price."""
    gathered: list[str] = []
    length = 0
    for piece in pieces:
        gathered.append(piece)
        length += len(piece)
        if length >= BLOCK:
            yield as_bytes("".join(gathered), encoding)
            gathered, length = [], 0
    yield as_bytes("".join(gathered), encoding)


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
    alarm.disarm(late=True)
    files.write(content, target)


def say(text: str) -> None:
    """A line to standard error, if anybody can read it."""
    with contextlib.suppress(OSError, ValueError):
        if sys.stderr is not None:
            print(shown_lines(text), file=sys.stderr, flush=True)


def _to_standard_output(pieces: Iterable[str]) -> None:
    if sys.stdout is None:
        raise OutputError(Problem("output-closed", "standard output is closed", hint="write to a file: -o FILE"))
    try:
        content = as_blocks(pieces, sys.stdout.encoding if sys.stdout.isatty() else "utf-8")
        number = _number(sys.stdout)
        if number is None:
            sys.stdout.buffer.writelines(content)
        else:  # past Python's buffer, which would complain at its end once more
            sys.stdout.flush()
            files.write_pieces(number, content)
    except BrokenPipeError:
        raise ReaderGone from None
    except OSError as reason:
        raise OutputError(files.failed("standard output", reason)) from None


def _number(stream: TextIO) -> int | None:
    """The descriptor of a stream, if it has one of the system's."""
    try:
        return stream.fileno()
    except (OSError, ValueError):
        return None
