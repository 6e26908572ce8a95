"""Bytes of a file, or of what stands for one, up to a limit: the one place at which heun opens what it reads. Impure.

Ordinary files are judged by their size before a byte is read. Pipes, `<(command)` and `/dev/fd/N` are read until they
end or pass the limit. Devices are refused unread, but for a terminal and for what is always empty: they never end.

Which files a command has read is remembered, by what they are and not by what they are called, for none of them is
written over: a link, a hard link, another spelling or `/dev/fd/3` is the same file.
"""

from __future__ import annotations

import errno
import os
import stat
import sys
from typing import BinaryIO

from heuncli.base.errors import Finding

STANDARD_INPUT = "-"
GIVE = "give a file, or - for standard input"
CHUNK = 1 << 20  # bytes at a time: few calls, and beyond the limit no more than this is kept
FILE_KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISBLK, "a disk"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
)
REASONS = {  # why a file cannot be opened, and what to do
    errno.ENOENT: ("there is no such file", None),
    errno.ENOTDIR: ("there is no such file: what stands before the last / is no folder", None),
    errno.EACCES: ("the file may not be read", "look at its permissions"),
    errno.EPERM: ("the file may not be read", "look at its permissions"),
    errno.ELOOP: ("its links lead in a circle", "look where they lead: ls -l"),
    errno.ENAMETOOLONG: ("the name is too long for a file", None),
    errno.ENXIO: ("this is a socket, not a file", GIVE),
}
_READ: dict[tuple[int, int], str] = {}  # device and number of each file -> the name it was read by


def forget() -> None:
    """Another command begins: nothing was read yet."""
    _READ.clear()


def name_of(state: os.stat_result) -> str | None:
    """By what name an ordinary file was read, if it was; a pipe or a device is no content that could be lost."""
    return _READ.get((state.st_dev, state.st_ino)) if stat.S_ISREG(state.st_mode) else None


def read_bytes(path: str, most: int) -> bytearray:
    """The content of a file, or of standard input for "-". Raises Finding: unreadable, or too-large beyond `most`."""
    try:
        if path == STANDARD_INPUT:
            return _of_standard_input(most)
        number = os.open(path, os.O_RDONLY | getattr(os, "O_NOCTTY", 0) | getattr(os, "O_BINARY", 0))
        try:
            _guard(number, path, most)
        except BaseException:
            os.close(number)
            raise
        with os.fdopen(number, "rb") as file:
            return _bounded(file, most)
    except OSError as error:
        raise _unreadable(error) from None
    except ValueError as error:
        if isinstance(error, Finding):
            raise
        hint = "a name holds no NUL and no half of a character"
        raise Finding("unreadable", "this cannot be the name of a file", hint) from None


def _of_standard_input(most: int) -> bytearray:
    if sys.stdin is None:
        raise Finding("unreadable", "standard input is closed", "name a file, or send a spec: heun ... - < FILE")
    try:
        number = sys.stdin.buffer.fileno()
    except (OSError, ValueError):  # one that is none of the system's
        return _bounded(sys.stdin.buffer, most)
    _guard(number, STANDARD_INPUT, most)
    return _bounded(sys.stdin.buffer, most)


def _guard(number: int, path: str, most: int) -> None:
    """Refuse what is of a kind that is not read, or too large, before reading; number: of an open file."""
    state = os.fstat(number)
    if stat.S_ISREG(state.st_mode):
        _READ.setdefault((state.st_dev, state.st_ino), path)
    kind = next((words for is_kind, words in FILE_KINDS if is_kind(state.st_mode)), None)
    if kind is not None and not (stat.S_ISCHR(state.st_mode) and _ends(number)):
        hint = "for folders of specs: heun check" if kind == "a folder" else GIVE
        raise Finding("unreadable", f"this is {kind}, not a file", hint)
    if stat.S_ISREG(state.st_mode) and state.st_size > most:
        raise _too_large(_megabytes(state.st_size), most)


def _ends(number: int) -> bool:
    """Whether an open device comes to an end: a terminal by Ctrl-D, the null device at once."""
    return os.isatty(number) or os.path.samestat(os.fstat(number), os.stat(os.devnull))  # noqa: PTH116 - pathlib takes 3 ms


def _bounded(file: BinaryIO, most: int) -> bytearray:
    """All of a stream, chunk by chunk, until it is more than is read."""
    content = bytearray()
    while chunk := file.read(CHUNK):
        content += chunk
        if len(content) > most:
            raise _too_large(f"more than {_megabytes(most)}", most)
    return content


def _unreadable(error: OSError) -> Finding:
    """Why something cannot be read, in words."""
    message, hint = REASONS.get(error.errno or 0, (None, None))
    hint = hint or "paths are relative to where heun was started"
    return Finding("unreadable", message or f"it cannot be read: {error.strerror or error}", hint)


def _too_large(found: str, most: int) -> Finding:
    """What is beyond the limit: how large it is, and how much is read."""
    hint = "is it the right file? What is generated may be split, or thinned"
    return Finding("too-large", f"this has {found}; at most {_megabytes(most)} are read", hint)


def _megabytes(size: int) -> str:
    return f"{size / 1e6:.6g} MB"
