"""Write files atomically, and write to pipes, devices and open descriptors. Impure.

An ordinary file is first written under a temporary name in the same folder and then renamed over the target: at every
moment the target holds either the old content or the new one, and no partial file is left behind however the process
ends. If the target cannot be replaced in this way, that is reported before the work begins.
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
from heuncli.base.signals import CleanupOnSignal

if TYPE_CHECKING:
    from pathlib import Path

PACKAGE_FOLDER = os.path.dirname(os.path.dirname(__file__))  # noqa: PTH120 - of heuncli; pathlib takes 3 ms
STDOUT = "-"  # what stands for standard output where a file is named
MAX_LINKS = 40  # that lead to one file; the system follows no more
HINTS = {
    errno.ENOSPC: "free some space, or choose a file on another disk",
    errno.EDQUOT: "free some space, or choose a file on another disk",
    errno.EFBIG: "raise the file size limit (ulimit -f), or request less: --only, fewer samples",
    errno.EACCES: "check the permissions, or choose another location",
    errno.EPERM: "check the permissions, or choose another location",
    errno.EROFS: "choose a writable location",
    errno.ENAMETOOLONG: "use a shorter name",
    errno.ELOOP: "check where its links lead: ls -l",
    errno.ENOENT: "choose a folder that exists",
    errno.ENOTDIR: "choose a folder that exists",
    errno.EBADF: "open it for writing, for example: heun run scene.yaml -o /dev/fd/3 3> results",
}
FOLDER_NAMES = ("", ".", "..")  # after the last / of a folder's name
OTHER_HINT = "choose another file name"
# Errors of a system or a file system without nameless files.
NO_TMPFILE_ERRORS = (errno.EOPNOTSUPP, errno.EISDIR, errno.EINVAL, errno.ENOENT, errno.ENOSYS, errno.EPERM)
CAN_CHMOD_DESCRIPTOR = os.chmod in os.supports_fd  # whether the rights of an open file may be changed
MIN_LEFTOVER_AGE = 60.0  # seconds since the last write to a file without owner; a new file may not be locked yet
_looked_into: set[str] = set()  # folders


class ReaderGoneError(HeunError):
    """The reader of a pipe has closed it; no message is printed."""

    exit_code = 141


class FileTarget(NamedTuple):
    """Where content goes: an open descriptor, or else the file at a path with its present state (None: no file yet)."""

    path: str
    state: os.stat_result | None
    descriptor: int | None = None

    @property
    def is_replaceable(self) -> bool:
        """Whether the target can be replaced as a whole: a regular file or none yet."""
        return self.descriptor is None and (self.state is None or stat.S_ISREG(self.state.st_mode))


def write(content: bytes | Iterable[bytes], name: str) -> None:
    """Write content to a file, pipe, device or descriptor; pieces are written as they come. Raises OutputError,
    ReaderGoneError.
    """
    target = find_target(name)
    pieces = [content] if isinstance(content, bytes) else content
    try:
        if target.descriptor is not None:
            write_pieces(target.descriptor, pieces)
        elif target.is_replaceable:
            replace(pieces, target)
        else:
            _write_directly(pieces, target.path)
    except BrokenPipeError:
        raise ReaderGoneError from None
    except OSError as reason:
        raise OutputError(write_problem(name, reason)) from None


def find_target(name: str) -> FileTarget:
    """Find the target that a name leads to. Raises OutputError if it is already clear that nothing can be written
    there.
    """
    try:
        target = _resolve_target(name)
        if target.state is not None and stat.S_ISDIR(target.state.st_mode):
            raise OutputError(Problem("output-failed", f"{name}: this is a folder", hint="give a file name in it"))
        if target.is_replaceable:
            _require_replaceable(name, target)
    except OSError as reason:
        raise OutputError(write_problem(name, reason)) from None
    except ValueError:
        raise OutputError(
            Problem("output-failed", f"{name}: a file name cannot contain NUL", hint=OTHER_HINT)
        ) from None
    return target


def write_problem(name: str, error: OSError) -> Problem:
    """Return the problem for a failed write, in the system's words."""
    hint = HINTS.get(error.errno or 0, OTHER_HINT)
    return Problem("output-failed", f"{name}: {error.strerror or error}", hint=hint)


def write_pieces(descriptor: int, pieces: Iterable[bytes]) -> None:
    """Write pieces to an open descriptor, one after the other."""
    for piece in pieces:
        write_all(descriptor, piece)


def write_all(descriptor: int, content: bytes) -> None:
    """Write all content to an open descriptor, which may accept only part of it at a time, or nothing while its reader
    is busy.
    """
    remaining = memoryview(content)
    while remaining:
        try:
            remaining = remaining[os.write(descriptor, remaining) :]
        except BlockingIOError:
            import select

            select.select([], [descriptor], [])


def replace(pieces: Iterable[bytes], target: FileTarget) -> None:
    """Replace a file: write a temporary file, nameless where the system allows it, then rename it over the target.

    A killed process leaves nothing behind, except where nameless files do not exist, or between the calls that link,
    close and rename the file; the next run removes such a leftover.
    """
    folder = os.path.dirname(target.path)  # noqa: PTH120
    _remove_leftovers(folder)
    temporary = os.path.join(folder, f".heun-{os.urandom(8).hex()}")  # noqa: PTH118 - pathlib takes 3 ms
    remove = partial(_make_path(temporary).unlink, missing_ok=True)
    with CleanupOnSignal(remove):
        try:
            descriptor, is_named = _open_new(folder, temporary, 0o600 if target.state is not None else 0o666)
            try:
                _lock(descriptor)
                write_pieces(descriptor, pieces)
                if target.state is not None:
                    which = descriptor if CAN_CHMOD_DESCRIPTOR else temporary
                    os.chmod(which, stat.S_IMODE(target.state.st_mode))  # noqa: PTH101
                os.fsync(descriptor)
                if not is_named:
                    _link(descriptor, folder, os.path.basename(temporary))  # noqa: PTH119
            finally:
                os.close(descriptor)
            os.replace(temporary, target.path)  # noqa: PTH105
        except BaseException:
            remove()
            raise


def _open_new(folder: str, temporary: str, mode: int) -> tuple[int, bool]:
    """Open a new file with at most the rights `mode` from the start; return its descriptor and whether it has its
    temporary name.
    """
    if hasattr(os, "O_TMPFILE") and os.path.isdir("/proc/self/fd"):  # noqa: PTH112 - by which it gets its name
        try:
            return os.open(folder, os.O_WRONLY | os.O_TMPFILE, mode), False
        except OSError as reason:
            if reason.errno not in NO_TMPFILE_ERRORS:
                raise
    return os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), mode), True


def _link(descriptor: int, folder: str, name: str) -> None:
    """Give a name to an open nameless file."""
    folder_descriptor = os.open(folder, os.O_RDONLY)
    try:  # only with a folder given Python lets the system follow the link
        os.link(f"/proc/self/fd/{descriptor}", name, src_dir_fd=folder_descriptor, dst_dir_fd=folder_descriptor)
    finally:
        os.close(folder_descriptor)


def _lock(descriptor: int) -> None:
    """Lock a file for as long as it is open, which marks it as being written."""
    with suppress(ImportError, OSError):  # no such locks there; then nothing is removed there either
        import fcntl

        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _remove_leftovers(folder: str) -> None:
    """Remove temporary files of this user whose writing process has died; done once per folder."""
    if folder in _looked_into:
        return
    _looked_into.add(folder)
    with suppress(ImportError, OSError):
        import fcntl

        for entry in os.scandir(folder):
            if entry.name.startswith(".heun-") and len(entry.name) == 22:
                with suppress(OSError):
                    descriptor = os.open(entry.path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
                    try:
                        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                        state = os.fstat(descriptor)
                        is_old = time.time() - state.st_mtime > MIN_LEFTOVER_AGE
                        if stat.S_ISREG(state.st_mode) and state.st_uid == os.geteuid() and is_old:
                            os.unlink(entry.path)  # noqa: PTH108
                    finally:
                        os.close(descriptor)


def _make_path(name: str) -> Path:
    """Make the path of a name."""
    from pathlib import Path  # 3 ms that only files need

    return Path(name)


def _write_directly(pieces: Iterable[bytes], path: str) -> None:
    """Write to a target that cannot be replaced as a whole: a pipe or a device."""
    descriptor = os.open(path, os.O_WRONLY | getattr(os, "O_NOCTTY", 0))
    try:
        write_pieces(descriptor, pieces)
    finally:
        os.close(descriptor)


def _resolve_target(name: str) -> FileTarget:
    """Find what a name leads to, with its present status. Raises OSError."""
    descriptor = _find_descriptor(name)
    if descriptor is not None:
        return FileTarget(name, os.fstat(descriptor), descriptor)
    path = os.path.realpath(name)  # which takes gone/../scene.yaml for scene.yaml; the system does not, nor the guard
    state = _file_state(name)
    if state is None and _make_path(path).exists():
        # it was made a moment ago; or it is not where the system looks, which is an error
        state = _make_path(name).stat()
    if state is not None and not stat.S_ISREG(state.st_mode):
        return FileTarget(name, state)
    return FileTarget(path, state)


def _file_state(name: str) -> os.stat_result | None:
    """Return the status of the file at a name, or None if there is none."""
    try:
        return _make_path(name).stat()
    except FileNotFoundError:
        return None


def _find_descriptor(name: str) -> int | None:
    """Return the number of the open descriptor that a name means (/dev/stdout, /dev/fd/3), also through links; None if
    it is none.
    """
    descriptor_folders = {os.path.realpath(folder) for folder in ("/dev/fd", "/proc/self/fd")}
    path = _make_path(name)
    for _ in range(MAX_LINKS):
        if path.name.isascii() and path.name.isdecimal() and os.path.realpath(path.parent) in descriptor_folders:
            return int(path.name)
        if not path.is_symlink():
            break
        path = path.parent / path.readlink()
    return None


def _require_replaceable(name: str, target: FileTarget) -> None:
    """Raise OutputError if the target cannot be replaced as a whole."""
    path = _make_path(target.path)
    folder = (path if _make_path(name).is_symlink() else _make_path(name)).parent
    if not path.parent.is_dir():
        hint = "create it first, or choose another location"
        raise OutputError(Problem("output-failed", f"{name}: there is no folder {folder}", hint=hint))
    if os.path.split(name)[1] in FOLDER_NAMES:
        raise OutputError(
            Problem("output-failed", f"{name}: this is the name of a folder", hint="give a file name in it")
        )
    if target.state is not None and not os.access(path, os.W_OK):
        raise OutputError(
            Problem("output-failed", f"{name}: no permission to write the file", hint=HINTS[errno.EACCES])
        )
    if not os.access(path.parent, os.W_OK | os.X_OK):
        hint = HINTS[errno.EACCES]
        if target.state is not None:  # which could be written, but not replaced as a whole
            hint = f"choose another folder, or use > {name} instead of -o, which overwrites the file in place"
        raise OutputError(Problem("output-failed", f"{name}: no permission to write in the folder {folder}", hint=hint))
