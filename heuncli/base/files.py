"""A file that is written whole or not at all, and what stands for one: pipes, devices, open descriptors. Impure.

An ordinary file is written beside its place and put there as a whole: at every moment the old content or the new one
stands there, and nothing that ends the process leaves anything else. Where that cannot be, it is said before the work.
"""

from __future__ import annotations

import errno
import os
import stat
import time
from collections.abc import Iterable
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING

from heuncli.base.errors import HeunError, OutputError, Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.signals import Undoing

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
# What a system or a file system says that knows no files without names.
KNOWS_NO_SUCH = (errno.EOPNOTSUPP, errno.EISDIR, errno.EINVAL, errno.ENOENT, errno.ENOSYS, errno.EPERM)
IS_CHANGED_OPEN = os.chmod in os.supports_fd  # whether the rights of an open file may be changed
LEFT_BEHIND = 60.0  # seconds since anything was written to a file of nobody; what was just made may not be locked yet
_looked_into: set[str] = set()  # folders


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
    """Write beside the place, into a file without a name where the system has such, then put that into the place.

    So a process that is killed leaves nothing, but where there are none, or between the calls that name, close and
    place a file: what it leaves then the next run removes.
    """
    folder = os.path.dirname(place.path)  # noqa: PTH120
    _remove_left_behind(folder)
    temporary = os.path.join(folder, f".heun-{os.urandom(8).hex()}")  # noqa: PTH118 - pathlib takes 3 ms
    remove = partial(_path(temporary).unlink, missing_ok=True)
    with Undoing(remove):
        try:
            number, is_named = _open_new(folder, temporary, 0o600 if place.state is not None else 0o666)
            try:
                _lock(number)
                write_pieces(number, pieces)
                if place.state is not None:
                    which = number if IS_CHANGED_OPEN else temporary
                    os.chmod(which, stat.S_IMODE(place.state.st_mode))  # noqa: PTH101
                os.fsync(number)
                if not is_named:
                    _link(number, folder, os.path.basename(temporary))  # noqa: PTH119
            finally:
                os.close(number)
            os.replace(temporary, place.path)  # noqa: PTH105
        except BaseException:
            remove()
            raise


def _open_new(folder: str, temporary: str, mode: int) -> tuple[int, bool]:
    """A new file, open, with no more rights than `mode` from the start; and whether it has its temporary name."""
    if hasattr(os, "O_TMPFILE") and os.path.isdir("/proc/self/fd"):  # noqa: PTH112 - by which it gets its name
        try:
            return os.open(folder, os.O_WRONLY | os.O_TMPFILE, mode), False
        except OSError as reason:
            if reason.errno not in KNOWS_NO_SUCH:
                raise
    return os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), mode), True


def _link(number: int, folder: str, name: str) -> None:
    """Give an open file without a name one."""
    place = os.open(folder, os.O_RDONLY)
    try:  # only with a folder given Python lets the system follow the link
        os.link(f"/proc/self/fd/{number}", name, src_dir_fd=place, dst_dir_fd=place)
    finally:
        os.close(place)


def _lock(number: int) -> None:
    """Mark a file as one that somebody writes, for as long as it is open."""
    with suppress(ImportError, OSError):  # no such locks there; then nothing is removed there either
        import fcntl

        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _remove_left_behind(folder: str) -> None:
    """Remove files of this user that a process was writing which is dead; looked for once in each folder."""
    if folder in _looked_into:
        return
    _looked_into.add(folder)
    with suppress(ImportError, OSError):
        import fcntl

        for entry in os.scandir(folder):
            if entry.name.startswith(".heun-") and len(entry.name) == 22:
                with suppress(OSError):
                    number = os.open(entry.path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
                    try:
                        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
                        state = os.fstat(number)
                        is_old = time.time() - state.st_mtime > LEFT_BEHIND
                        if stat.S_ISREG(state.st_mode) and state.st_uid == os.geteuid() and is_old:
                            os.unlink(entry.path)  # noqa: PTH108
                    finally:
                        os.close(number)


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
