"""Write results to standard output, or to a file that is written whole or not at all. Impure: writes.

Whatever keeps output from arriving is an OutputError (exit 5), except a reader that closed the pipe: ReaderGone (exit
141).
"""

from __future__ import annotations

import codecs
import contextlib
import sys
from collections.abc import Iterable, Iterator
from typing import IO, TextIO

from heuncli.app.cli import timeout
from heuncli.base import files
from heuncli.base.errors import OutputError, Problem
from heuncli.base.files import ReaderGoneError
from heuncli.base.text_safety import escape_all, escape_lines

DESCRIPTOR = 1  # of standard output
ESCAPED = "heun.escaped"
BLOCK = 1 << 18  # characters that are written together
MEMORY = 1 << 24  # bytes of output that stay in memory while a time limit runs


def emit(text: str | Iterable[str], target: str | None = None, *, late: bool = False) -> None:
    """Write the text, or its pieces as they are made, to a file, or to standard output for None and `-`.

    The time limit covers the making of the text and never interrupts its writing: while a limit runs, pieces for a
    pipe, a terminal or a device are collected first and written when all of them are made.

    late: write even after the time limit; otherwise LimitError is raised then, and nothing is written
    """
    pieces = [text] if isinstance(text, str) else text
    to_stdout = target is None or target == files.STDOUT
    if target is None or to_stdout or (place := files.find_target(target)).descriptor == DESCRIPTOR:  # /dev/stdout
        _write_stdout(_end_limit(pieces, late))
    elif place.is_replaceable:
        files.write(_disarm_after(encode_blocks(pieces), late), target)
    else:
        files.write(encode_blocks(_end_limit(pieces, late)), target)


def _disarm_after(content: Iterable[bytes], late: bool) -> Iterator[bytes]:
    """Yield the content, then end the time limit. Raises LimitError if it has passed, unless `late`."""
    yield from content
    timeout.disarm(late=late)


def _end_limit(pieces: Iterable[str], late: bool) -> Iterable[str]:
    """End the time limit and return the pieces; while a limit runs, all pieces are made first.

    Raises LimitError if the limit has passed, unless `late`; OutputError if the pieces cannot be stored.
    """
    if timeout.remaining_time() is not None and not isinstance(pieces, list):
        pieces = _collect(pieces)
    timeout.disarm(late=late)
    return pieces


def _collect(pieces: Iterable[str]) -> Iterator[str]:
    """Make all pieces, keep them in memory or, if they are long, in a temporary file, and return them in blocks."""
    import tempfile  # 4 ms that only long output under a time limit needs

    store = tempfile.SpooledTemporaryFile(MEMORY, "w+", encoding="utf-8", errors="surrogatepass", newline="")  # noqa: SIM115 - _read_blocks closes it
    try:
        for block in _join_blocks(pieces):
            store.write(block)
        store.seek(0)
    except OSError as reason:
        store.close()
        raise OutputError(files.write_problem("temporary file", reason)) from None
    except BaseException:
        store.close()
        raise
    blocks = _read_blocks(store)
    next(blocks)  # once begun it closes the file, even if nobody reads on because the limit has passed
    return blocks


def _read_blocks(store: IO[str]) -> Iterator[str]:
    """Yield the content of a temporary file, and close it."""
    with store:
        yield ""
        while block := store.read(BLOCK):
            yield block


def encode_blocks(pieces: Iterable[str], encoding: str = "utf-8") -> Iterator[bytes]:
    """Encode the pieces as bytes, short ones together, because each system call costs time."""
    for block in _join_blocks(pieces):
        yield encode_text(block, encoding)


def _join_blocks(pieces: Iterable[str]) -> Iterator[str]:
    """Join short pieces to blocks."""
    buffer: list[str] = []
    length = 0
    for piece in pieces:
        buffer.append(piece)
        length += len(piece)
        if length >= BLOCK:
            yield "".join(buffer)
            buffer, length = [], 0
    yield "".join(buffer)


def encode_text(text: str, encoding: str = "utf-8") -> bytes:
    """Encode the text in UTF-8 for programs, whatever the locale says, so that two different names stay different.

    On a terminal with another encoding, characters that it lacks are escaped as in JSON. Lone surrogates (of file names
    that are not UTF-8) are escaped everywhere.
    """
    codecs.register_error(ESCAPED, _escape)
    return text.encode(encoding, ESCAPED)


def _escape(error: UnicodeError) -> tuple[str, int]:
    """Escape what an encoding cannot write; the handler of encoding errors."""
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
    """Write pieces to standard output. Raises OutputError, ReaderGoneError."""
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
