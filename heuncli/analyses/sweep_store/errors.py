"""Convert SQLite's errors into errors of heun: a full disk or missing permission exits with 5, as for any other
output.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager

from heuncli.base.errors import OutputError, Problem, UsageError

NOT_A_STORE = "not-a-store"
OTHER_FILE_HINT = "give another file; a new one is created"
DISK_HINT = "free some space, or use another disk; earlier results are kept"
# by the beginning of SQLite's name of the error: message, and hint
REASONS = {
    "SQLITE_FULL": ("the disk is full", DISK_HINT),
    "SQLITE_IOERR": ("it cannot be read or written", DISK_HINT),
    "SQLITE_READONLY": ("no permission to write", "check the permissions, or use another location"),
    "SQLITE_CANTOPEN": ("it cannot be opened", "check the name and the permissions, or use another location"),
    "SQLITE_BUSY": ("another process has been writing for minutes", "wait for it, or end it"),
    "SQLITE_LOCKED": ("another process has been writing for minutes", "wait for it, or end it"),
}


@contextmanager
def convert_errors(name: str) -> Iterator[None]:
    """Convert SQLite's errors within the context to OutputError, or to UsageError if the file is no store."""
    try:
        yield
    except sqlite3.Error as error:
        raise _make_error(name, error) from None


def _make_error(name: str, error: sqlite3.Error) -> OutputError | UsageError:
    kind = getattr(error, "sqlite_errorname", "")
    if kind.startswith("SQLITE_NOTADB"):
        return UsageError(Problem(NOT_A_STORE, f"{name}: not a store of sweeps", hint=OTHER_FILE_HINT))
    if kind.startswith("SQLITE_CORRUPT"):
        message = f"{name}: this store is damaged: {error}"
        return UsageError(
            Problem(NOT_A_STORE, message, hint="sqlite3 FILE .recover saves what can be; " + OTHER_FILE_HINT)
        )
    found = next((reason for begin, reason in REASONS.items() if kind.startswith(begin)), (str(error), DISK_HINT))
    return OutputError(Problem("output-failed", f"{name}: {found[0]}", hint=found[1]))
