"""Write results to standard output, or to a file that is written whole or not at all. Impure: writes.

Whatever keeps output from arriving is an OutputError (exit 5), except a reader that closed the pipe: ReaderGone (exit
141).
"""

from __future__ import annotations

import codecs
import contextlib
import sys
from collections.abc import Iterable, Iterator
from typing import TextIO

from heuncli.app.cli import timeout
from heuncli.base import files
from heuncli.base.errors import OutputError, Problem
from heuncli.base.files import ReaderGoneError
from heuncli.base.text_safety import escape_all, escape_lines

DESCRIPTOR = 1  # of standard output
ESCAPED = "heun.escaped"
BLOCK = 1 << 18  # characters that are written together


def emit(text: str | Iterable[str], target: str | None = None, *, late: bool = False) -> None:
    """Write the text, or its pieces as they are made, to a file, or to standard output for None and `-`.

    The time limit never interrupts writing. It applies until the first byte goes out, and for a file that is written
    whole or not at all until the last piece is made.

    late: write even after the time limit; otherwise LimitError is raised then, and nothing is written
    """
    pieces = [text] if isinstance(text, str) else text
    to_stdout = target is None or target == files.STDOUT
    if target is None or to_stdout or (place := files.find_target(target)).descriptor == DESCRIPTOR:  # /dev/stdout
        timeout.disarm(late=late)
        _write_stdout(pieces)
    elif place.is_replaceable:
        files.write(_disarm_after(encode_blocks(pieces), late), target)
    else:
        timeout.disarm(late=late)
        files.write(encode_blocks(pieces), target)


def _disarm_after(content: Iterable[bytes], late: bool) -> Iterator[bytes]:
    """Yield the content, then end the time limit. Raises LimitError if it has passed, unless `late`."""
    yield from content
    timeout.disarm(late=late)


def encode_blocks(pieces: Iterable[str], encoding: str = "utf-8") -> Iterator[bytes]:
    """Encode the pieces as bytes, and join short ones, because each system call costs time."""
    buffer: list[str] = []
    length = 0
    for piece in pieces:
        buffer.append(piece)
        length += len(piece)
        if length >= BLOCK:
            yield encode_text("".join(buffer), encoding)
            buffer, length = [], 0
    yield encode_text("".join(buffer), encoding)


def encode_text(text: str, encoding: str = "utf-8") -> bytes:
    """Encode the text in UTF-8 for programs, whatever the locale says, so that two different names stay different.

    On a terminal with another encoding, characters that it lacks are escaped as in JSON. Lone surrogates (of file names
    that are not UTF-8) are escaped everywhere.
    """
    codecs.register_error(ESCAPED, _escape)
    return text.encode(encoding, ESCAPED)


def _escape(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return escape_all(error.object[error.start : error.end]), error.end


def save(content: bytes, target: str) -> None:
    """Write bytes to a file, even after the time limit."""
    timeout.disarm(late=True)
    files.write(content, target)


def print_stderr(text: str) -> None:
    """Print a line to standard error, if it is open."""
    with contextlib.suppress(OSError, ValueError):
        if sys.stderr is not None:
            print(escape_lines(text), file=sys.stderr, flush=True)


def _write_stdout(pieces: Iterable[str]) -> None:
    if sys.stdout is None:
        raise OutputError(Problem("output-closed", "standard output is closed", hint="write to a file: -o FILE"))
    try:
        content = encode_blocks(pieces, sys.stdout.encoding if sys.stdout.isatty() else "utf-8")
        number = _find_descriptor(sys.stdout)
        if number is None:
            sys.stdout.buffer.writelines(content)
        else:  # bypasses Python's buffer, which would report an error again at exit
            sys.stdout.flush()
            files.write_pieces(number, content)
    except BrokenPipeError:
        raise ReaderGoneError from None
    except OSError as reason:
        raise OutputError(files.write_problem("standard output", reason)) from None


def _find_descriptor(stream: TextIO) -> int | None:
    """Return the file descriptor of a stream, or None."""
    try:
        return stream.fileno()
    except (OSError, ValueError):
        return None
