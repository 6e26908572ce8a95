"""What SQLite complains of, as errors of heun: no room and no right to write leave with 5, as any other output does."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager

from heuncli.base.errors import OutputError, Problem, UsageError

NOT_A_STORE = "not-a-store"
OTHER = "name another file: it is made where there is none"
ROOM = "make room, or name a place on another disk; what was done before is kept"
# by the beginning of SQLite's name of the error: what is said, and what to do
REASONS = {
    "SQLITE_FULL": ("the disk is full", ROOM),
    "SQLITE_IOERR": ("it cannot be read or written", ROOM),
    "SQLITE_READONLY": ("it may not be written", "look at the permissions, or name another place"),
    "SQLITE_CANTOPEN": ("it cannot be opened", "look at the name and the permissions, or name another place"),
    "SQLITE_BUSY": ("another process has been writing for minutes", "wait for it, or end it"),
    "SQLITE_LOCKED": ("another process has been writing for minutes", "wait for it, or end it"),
}


@contextmanager
def told_errors(name: str) -> Iterator[None]:
    """Of what goes wrong with a store of that name raise OutputError, or UsageError where it is none."""
    try:
        yield
    except sqlite3.Error as error:
        raise _told(name, error) from None


def _told(name: str, error: sqlite3.Error) -> OutputError | UsageError:
    kind = getattr(error, "sqlite_errorname", "")
    if kind.startswith("SQLITE_NOTADB"):
        return UsageError(Problem(NOT_A_STORE, f"{name}: this is no store of sweeps", hint=OTHER))
    if kind.startswith("SQLITE_CORRUPT"):
        message = f"{name}: this store is damaged: {error}"
        return UsageError(Problem(NOT_A_STORE, message, hint="sqlite3 FILE .recover saves what can be; " + OTHER))
    found = next((told for begin, told in REASONS.items() if kind.startswith(begin)), (str(error), ROOM))
    return OutputError(Problem("output-failed", f"{name}: {found[0]}", hint=found[1]))
