"""Read the bytes of files and of standard input, up to a limit. The only place at which heun opens its input. Impure.

The size of an ordinary file is checked before a byte is read. Pipes, `<(command)` and `/dev/fd/N` are read until they
end or exceed the limit. Devices may never end, so they are refused unread, except a terminal and the null device.

The files that a command has read are remembered by device and inode, so that the command never overwrites one of them:
a link, a hard link, another spelling or `/dev/fd/3` is the same file.

Results name the spec they belong to by a digest of its text. It imports SHA-256 from Python's own C module, as `random`
does, because hashlib loads OpenSSL first, which takes 3 ms.
"""

from __future__ import annotations

import errno
import os
import stat
import sys
from typing import BinaryIO

from heuncli.base.errors import Finding

# Reading

STANDARD_INPUT = "-"
INPUT_HINT = "give a file, or - for standard input"
CHUNK = 1 << 20  # bytes per read: few calls, and little memory beyond the limit
FILE_KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISBLK, "a disk"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
)
REASONS = {  # why a file cannot be opened, and what to do
    errno.ENOENT: ("file not found", None),
    errno.ENOTDIR: ("file not found: the part before the last / is not a folder", None),
    errno.EACCES: ("no permission to read the file", "check its permissions"),
    errno.EPERM: ("no permission to read the file", "check its permissions"),
    errno.ELOOP: ("its links form a loop", "check where they lead: ls -l"),
    errno.ENAMETOOLONG: ("the file name is too long", None),
    errno.ENXIO: ("this is a socket, not a file", INPUT_HINT),
}
_NAMES_READ: dict[tuple[int, int], str] = {}  # device and number of each file -> the name it was read by


def forget_files_read() -> None:
    """Forget the files that earlier commands read."""
    _NAMES_READ.clear()


def find_name_read(state: os.stat_result) -> str | None:
    """Return the name by which an ordinary file was read, or None. Pipes and devices hold no content to protect."""
    return _NAMES_READ.get((state.st_dev, state.st_ino)) if stat.S_ISREG(state.st_mode) else None


def read_bytes(path: str, max_size: int) -> bytearray:
    """Read a file, or standard input for "-". Raises Finding [unreadable], or [too-large] above `max_size` bytes."""
    try:
        if path == STANDARD_INPUT:
            return _read_standard_input(max_size)
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NOCTTY", 0) | getattr(os, "O_BINARY", 0))
        try:
            _require_readable(descriptor, path, max_size)
        except BaseException:
            os.close(descriptor)
            raise
        with os.fdopen(descriptor, "rb") as file:
            return _read_limited(file, max_size)
    except OSError as error:
        raise _unreadable_finding(error) from None
    except ValueError as error:
        if isinstance(error, Finding):
            raise
        hint = "a file name cannot contain NUL or half a character"
        raise Finding("unreadable", "this cannot be the name of a file", hint) from None


def _read_standard_input(max_size: int) -> bytearray:
    if sys.stdin is None:
        raise Finding("unreadable", "standard input is closed", "give a file, or pipe a spec in: heun ... - < FILE")
    try:
        descriptor = sys.stdin.buffer.fileno()
    except (OSError, ValueError):  # a stream without a file descriptor
        return _read_limited(sys.stdin.buffer, max_size)
    _require_readable(descriptor, STANDARD_INPUT, max_size)
    return _read_limited(sys.stdin.buffer, max_size)


def _require_readable(descriptor: int, path: str, max_size: int) -> None:
    """Refuse a file of an unreadable kind or size before it is read, and remember an ordinary file."""
    state = os.fstat(descriptor)
    if stat.S_ISREG(state.st_mode):
        _NAMES_READ.setdefault((state.st_dev, state.st_ino), path)
    kind = next((words for is_kind, words in FILE_KINDS if is_kind(state.st_mode)), None)
    if kind is not None and not (stat.S_ISCHR(state.st_mode) and _is_finite_device(descriptor)):
        hint = "for folders of specs use heun check" if kind == "a folder" else INPUT_HINT
        raise Finding("unreadable", f"this is {kind}, not a file", hint)
    if stat.S_ISREG(state.st_mode) and state.st_size > max_size:
        raise _too_large_finding(_format_megabytes(state.st_size), max_size)


def _is_finite_device(descriptor: int) -> bool:
    """Whether an open device comes to an end: a terminal (by Ctrl-D) or the null device."""
    return os.isatty(descriptor) or os.path.samestat(os.fstat(descriptor), os.stat(os.devnull))  # noqa: PTH116 - pathlib takes 3 ms


def _read_limited(file: BinaryIO, max_size: int) -> bytearray:
    """Read a stream in chunks. Raises Finding [too-large] above `max_size` bytes."""
    content = bytearray()
    while chunk := file.read(CHUNK):
        content += chunk
        if len(content) > max_size:
            raise _too_large_finding(f"more than {_format_megabytes(max_size)}", max_size)
    return content


def _unreadable_finding(error: OSError) -> Finding:
    """Explain an OSError in words."""
    message, hint = REASONS.get(error.errno or 0, (None, None))
    hint = hint or "paths are relative to the folder where heun was started"
    return Finding("unreadable", message or f"it cannot be read: {error.strerror or error}", hint)


def _too_large_finding(size_text: str, max_size: int) -> Finding:
    """Make the finding for a file above the limit."""
    hint = "is it the right file? Generated data may be split or thinned"
    return Finding("too-large", f"the file has {size_text}; at most {_format_megabytes(max_size)} are read", hint)


def _format_megabytes(size: int) -> str:
    return f"{size / 1e6:.6g} MB"


# Digest

try:
    from _sha2 import sha256  # type: ignore[import-not-found]
except ImportError:
    try:
        from _sha256 import sha256  # type: ignore[import-not-found] # before Python 3.12
    except ImportError:  # Python built without it
        from hashlib import sha256


def digest(content: bytes | bytearray) -> str:
    """Return the SHA-256 digest in hexadecimal digits."""
    digits: str = sha256(content).hexdigest()
    return digits
