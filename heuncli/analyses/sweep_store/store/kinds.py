"""Whether a file is a store of sweeps, and of which version; a new one is made one. Impure: reads and writes files."""

from __future__ import annotations

import sqlite3
import time

from heuncli.analyses.sweep_store.store.errors import NOT_A_STORE, OTHER
from heuncli.base.errors import Problem, UsageError
from heuncli.version import VERSION

APPLICATION = 0x6865756E  # "heun": by which SQLite's header names the program that a file belongs to
FORMAT = 1  # of the tables
TABLES = (
    "CREATE TABLE heun (version TEXT NOT NULL)",
    "CREATE TABLE sweeps (number INTEGER PRIMARY KEY, identity BLOB NOT NULL UNIQUE, head TEXT NOT NULL, draws BLOB,"
    " begun TEXT NOT NULL)",
    "CREATE TABLE variants (sweep INTEGER NOT NULL, number INTEGER NOT NULL, key BLOB NOT NULL, given TEXT NOT NULL,"
    " code TEXT NOT NULL, reason TEXT NOT NULL, PRIMARY KEY (sweep, number)) WITHOUT ROWID",
    "CREATE TABLE answers (key BLOB PRIMARY KEY, measures TEXT NOT NULL, code TEXT NOT NULL, reason TEXT NOT NULL,"
    " warnings TEXT NOT NULL) WITHOUT ROWID",
)
JOURNAL = 8000  # pages of the journal, 32 MB, from which on it goes into the tables: each time the disk is waited for
ATTEMPTS = 200  # to change the kind of the journal while another process does so: SQLite does not wait for that
PAUSE = 0.05  # seconds


def begun(connection: sqlite3.Connection, name: str, kept: bool) -> None:
    """Make an empty file a store, or see that it is one of this version; kept: a file that outlives the process.

    Raises UsageError, sqlite3.Error.
    """
    if kept:
        require_own(connection, name, may_be_empty=True)
        _journal(connection)
        # who is killed loses nothing; where the system falls the last rows may be gone, but no file is damaged
        connection.execute("PRAGMA synchronous = NORMAL")
        connection.execute(f"PRAGMA wal_autocheckpoint = {JOURNAL}")
    else:
        connection.execute("PRAGMA journal_mode = MEMORY")
        connection.execute("PRAGMA synchronous = OFF")
    connection.execute("BEGIN IMMEDIATE")  # of two that begin at once one waits, and finds all made
    try:
        if _is_empty(connection):
            connection.execute(f"PRAGMA application_id = {APPLICATION}")
            connection.execute(f"PRAGMA user_version = {FORMAT}")
            for table in TABLES:
                connection.execute(table)
            connection.execute("INSERT INTO heun VALUES (?)", (VERSION,))
    finally:
        connection.execute("COMMIT")
    require_own(connection, name)
    version = connection.execute("SELECT version FROM heun").fetchone()[0]
    if version != VERSION:
        message = f"{name}: this store is of heun {version}, this is heun {VERSION}: its numbers may be others"
        hint = f"name another file; heun sweep --show {name} prints what is in it"
        raise UsageError(Problem(NOT_A_STORE, message, hint=hint))


def require_own(connection: sqlite3.Connection, name: str, may_be_empty: bool = False) -> None:
    """See that a file is a store, of the tables of this version. Raises UsageError, sqlite3.Error."""
    connection.execute("BEGIN")  # one look at all of it, for another process may be making it
    try:
        is_empty = _is_empty(connection)
        application, form = (
            connection.execute(f"PRAGMA {of}").fetchone()[0] for of in ("application_id", "user_version")
        )
    finally:
        if connection.in_transaction:
            connection.execute("COMMIT")
    if application == APPLICATION:
        if form != FORMAT:
            message = f"{name}: a store in form {form}, of another version of heun; this one has form {FORMAT}"
            raise UsageError(Problem(NOT_A_STORE, message, hint=OTHER))
        return
    if not may_be_empty or not is_empty:
        what = "it is empty" if is_empty else "it is a database of another program"
        raise UsageError(Problem(NOT_A_STORE, f"{name}: this is no store of sweeps: {what}", hint=OTHER))


def _is_empty(connection: sqlite3.Connection) -> bool:
    """Whether there are no tables."""
    return bool(connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0] == 0)


def _journal(connection: sqlite3.Connection) -> None:
    """Write ahead: who reads does not wait for who writes."""
    for attempt in range(ATTEMPTS):
        try:
            connection.execute("PRAGMA journal_mode = WAL")
            return
        except sqlite3.OperationalError as error:
            if getattr(error, "sqlite_errorname", "") != "SQLITE_BUSY" or attempt == ATTEMPTS - 1:
                raise
            time.sleep(PAUSE)
