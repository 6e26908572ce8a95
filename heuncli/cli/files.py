"""A file that is written whole or not at all, and what stands for one: pipes, devices, open descriptors. Impure.

An ordinary file is written beside its place and renamed into it: at every moment the old content or the new one stands
there, and no signal leaves anything else. Where that cannot be, it is said before the work.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterable
from functools import partial
from typing import TYPE_CHECKING

from heuncli.cli.leaving import Undoing
from heuncli.errors import HeunError, OutputError, Problem
from heuncli.named_tuples import NamedTuple

if TYPE_CHECKING:
    from pathlib import Path

STDOUT = "-"  # what stands for standard output where a file is named
MOST_LINKS = 40  # that lead to one file; the system follows no more
HINTS = {
    errno.ENOSPC: "make room, or name a place on another disk",
    errno.EDQUOT: "make room, or name a place on another disk",
    errno.EFBIG: "raise the limit on the size of files (ulimit -f), or ask for less: --only, fewer samples",
    errno.EACCES: "look at the permissions, or name another place",
    errno.EPERM: "look at the permissions, or name another place",
    errno.EROFS: "name a place that may be written",
    errno.ENAMETOOLONG: "name it shorter",
    errno.ELOOP: "look where its links lead: ls -l",
    errno.ENOENT: "name a folder that exists",
    errno.ENOTDIR: "name a folder that exists",
    errno.EBADF: "open it for writing, such as: heun run scene.yaml -o /dev/fd/3 3> results",
}
NO_NAMES = ("", ".", "..")  # behind the last / of what is a folder
OTHER_HINT = "name another file"


class ReaderGone(HeunError):
    """Nobody reads any more what is written; nothing needs saying."""

    exit_code = 141


class FilePlace(NamedTuple):
    """Where content goes: an open descriptor, else a file by its path, with what stands there (None: nothing yet)."""

    path: str
    state: os.stat_result | None
    descriptor: int | None = None

    @property
    def ordinary(self) -> bool:
        """Whether it can be replaced as a whole."""
        return self.descriptor is None and (self.state is None or stat.S_ISREG(self.state.st_mode))


def write(content: bytes | Iterable[bytes], name: str) -> None:
    """Write to a file, or to what stands for one; pieces as they come. Raises OutputError, ReaderGone."""
    place = place_of(name)
    pieces = [content] if isinstance(content, bytes) else content
    try:
        if place.descriptor is not None:
            write_pieces(place.descriptor, pieces)
        elif place.ordinary:
            replace(pieces, place)
        else:
            _into(pieces, place.path)
    except BrokenPipeError:
        raise ReaderGone from None
    except OSError as reason:
        raise OutputError(failed(name, reason)) from None


def place_of(name: str) -> FilePlace:
    """Where a name leads. Raises OutputError where nothing could be written there, as far as that is seen before."""
    try:
        place = _place(name)
        if place.state is not None and stat.S_ISDIR(place.state.st_mode):
            raise OutputError(Problem("output-failed", f"{name}: this is a folder", hint="name a file in it"))
        if place.ordinary:
            _require_room(name, place)
    except OSError as reason:
        raise OutputError(failed(name, reason)) from None
    except ValueError:
        raise OutputError(Problem("output-failed", f"{name}: a name holds no NUL", hint=OTHER_HINT)) from None
    return place


def failed(name: str, reason: OSError) -> Problem:
    """Why something could not be written, in the system's words."""
    hint = HINTS.get(reason.errno or 0, OTHER_HINT)
    return Problem("output-failed", f"{name}: {reason.strerror or reason}", hint=hint)


def write_pieces(number: int, pieces: Iterable[bytes]) -> None:
    """Write to an open descriptor, piece by piece."""
    for piece in pieces:
        write_all(number, piece)


def write_all(number: int, content: bytes) -> None:
    """Write to an open descriptor, which may take a part at a time, or none while its reader rests."""
    left = memoryview(content)
    while left:
        try:
            left = left[os.write(number, left) :]
        except BlockingIOError:
            import select

            select.select([], [number], [])


def replace(pieces: Iterable[bytes], place: FilePlace) -> None:
    """Write beside the place, then rename into it."""
    temporary = str(_path(place.path).with_name(f".heun-{os.urandom(8).hex()}"))
    remove = partial(_path(temporary).unlink, missing_ok=True)
    with Undoing(remove):
        try:
            _fill(temporary, pieces, place.state)
            _path(temporary).replace(place.path)
        except BaseException:
            remove()
            raise


def _fill(temporary: str, pieces: Iterable[bytes], old: os.stat_result | None) -> None:
    """A new file with the pieces and, from the start, no more rights than the old one; of a new one, the usual."""
    new = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
    number = os.open(temporary, new, 0o600 if old is not None else 0o666)
    try:
        write_pieces(number, pieces)
        os.fsync(number)
    finally:
        os.close(number)
    if old is not None:
        _path(temporary).chmod(stat.S_IMODE(old.st_mode))


def _path(name: str) -> Path:
    from pathlib import Path  # 3 ms that only files need

    return Path(name)


def _into(pieces: Iterable[bytes], path: str) -> None:
    """Write into what cannot be replaced as a whole: a pipe, a device."""
    number = os.open(path, os.O_WRONLY | getattr(os, "O_NOCTTY", 0))
    try:
        write_pieces(number, pieces)
    finally:
        os.close(number)


def _place(name: str) -> FilePlace:
    number = _descriptor(name)
    if number is not None:
        return FilePlace(name, os.fstat(number), number)
    path = os.path.realpath(name)  # which takes gone/../scene.yaml for scene.yaml; the system does not, nor the guard
    state = _state(name)
    if state is None and _path(path).exists():
        state = _path(name).stat()  # it was made a moment ago; or it is not where the system looks, which is an error
    if state is not None and not stat.S_ISREG(state.st_mode):
        return FilePlace(name, state)
    return FilePlace(path, state)


def _state(name: str) -> os.stat_result | None:
    """What stands at a name; None: nothing."""
    try:
        return _path(name).stat()
    except FileNotFoundError:
        return None


def _descriptor(name: str) -> int | None:
    """The number of the open descriptor that a name stands for (/dev/stdout, /dev/fd/3), also through links."""
    own = {os.path.realpath(folder) for folder in ("/dev/fd", "/proc/self/fd")}
    path = _path(name)
    for _ in range(MOST_LINKS):
        if path.name.isascii() and path.name.isdecimal() and os.path.realpath(path.parent) in own:
            return int(path.name)
        if not path.is_symlink():
            break
        path = path.parent / path.readlink()
    return None


def _require_room(name: str, place: FilePlace) -> None:
    """Refuse what could not be replaced as a whole."""
    path = _path(place.path)
    shown = (path if _path(name).is_symlink() else _path(name)).parent
    if not path.parent.is_dir():
        hint = "make it first, or name another place"
        raise OutputError(Problem("output-failed", f"{name}: there is no folder {shown}", hint=hint))
    if os.path.split(name)[1] in NO_NAMES:
        raise OutputError(Problem("output-failed", f"{name}: this is the name of a folder", hint="name a file in it"))
    if place.state is not None and not os.access(path, os.W_OK):
        raise OutputError(Problem("output-failed", f"{name}: the file may not be written", hint=HINTS[errno.EACCES]))
    if not os.access(path.parent, os.W_OK | os.X_OK):
        hint = HINTS[errno.EACCES]
        if place.state is not None:  # which could be written, but not replaced as a whole
            hint = f"name a file elsewhere, or > {name} in place of -o, which writes as it goes"
        raise OutputError(Problem("output-failed", f"{name}: the folder {shown} may not be written", hint=hint))
