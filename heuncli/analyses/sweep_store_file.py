"""The file of a store: its tables and version, the description of a sweep in it, and SQLite's errors as heun's.

A full disk or missing permission exits with 5, as for any other output. Impure: reads and writes files.
"""

from __future__ import annotations

import json
import sqlite3
import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from heuncli.analyses.sweep_rows import SweepHead
from heuncli.analyses.variants.measures import MeasureLabel
from heuncli.analyses.variants.parameters import ParameterAxis, RandomVariable
from heuncli.analyses.variants.plans import Draws, Plan
from heuncli.base.errors import OutputError, Problem, UsageError
from heuncli.version import VERSION

APPLICATION_ID = 0x6865756E  # "heun": the application id in SQLite's header
FORMAT_VERSION = 2  # version of the tables and of the JSON in them; 1 had values of parameters as texts
TABLES = (
    "CREATE TABLE heun (version TEXT NOT NULL)",
    "CREATE TABLE sweeps (number INTEGER PRIMARY KEY, identity BLOB NOT NULL UNIQUE, head TEXT NOT NULL, draws BLOB,"
    " begun TEXT NOT NULL)",
    "CREATE TABLE variants (sweep INTEGER NOT NULL, number INTEGER NOT NULL, key BLOB NOT NULL, given TEXT NOT NULL,"
    " code TEXT NOT NULL, reason TEXT NOT NULL, PRIMARY KEY (sweep, number)) WITHOUT ROWID",
    "CREATE TABLE answers (key BLOB PRIMARY KEY, measures TEXT NOT NULL, code TEXT NOT NULL, reason TEXT NOT NULL,"
    " warnings TEXT NOT NULL) WITHOUT ROWID",
)
# pages of the journal, 32 MB, after which it is written into the tables; each time waits for the disk
MAX_JOURNAL_PAGES = 8000
MAX_ATTEMPTS = 200  # attempts to change the journal mode: SQLite does not wait for another process that does so
RETRY_PAUSE = 0.05  # seconds
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
DOUBLES = np.dtype("<f8")


def initialize_store(connection: sqlite3.Connection, name: str, is_persistent: bool) -> None:
    """Make an empty file a store, or check that it is one of this version; is_persistent: the file outlives the
    process.

    Raises UsageError, sqlite3.Error.
    """
    if is_persistent:
        require_store(connection, name, may_be_empty=True)
        _enable_journal(connection)
        # a killed process loses nothing; after a system crash the last rows may be missing, but no file is
        # damaged
        connection.execute("PRAGMA synchronous = NORMAL")
        connection.execute(f"PRAGMA wal_autocheckpoint = {MAX_JOURNAL_PAGES}")
    else:
        connection.execute("PRAGMA journal_mode = MEMORY")
        connection.execute("PRAGMA synchronous = OFF")
    connection.execute("BEGIN IMMEDIATE")  # of two processes that start together, one waits and finds the tables
    try:
        if _is_empty(connection):
            connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
            connection.execute(f"PRAGMA user_version = {FORMAT_VERSION}")
            for table in TABLES:
                connection.execute(table)
            connection.execute("INSERT INTO heun VALUES (?)", (VERSION,))
        connection.execute("COMMIT")
    except BaseException:
        if connection.in_transaction:
            connection.execute("ROLLBACK")
        raise
    require_store(connection, name)
    row = connection.execute("SELECT version FROM heun").fetchone()
    if row is None:
        message = f"{name}: this store is damaged: it names no version of heun"
        raise UsageError(Problem(NOT_A_STORE, message, hint=OTHER_FILE_HINT))
    version = row[0]
    if version != VERSION:
        message = f"{name}: written by heun {version}, this is heun {VERSION}: its numbers may differ"
        hint = f"give another file; heun sweep --show {name} prints its contents"
        raise UsageError(Problem(NOT_A_STORE, message, hint=hint))


def require_store(connection: sqlite3.Connection, name: str, may_be_empty: bool = False) -> None:
    """Check that a file is a store with the tables of this version. Raises UsageError, sqlite3.Error."""
    connection.execute("BEGIN")  # read it in one transaction, because another process may be creating it
    try:
        is_empty = _is_empty(connection)
        application, form = (
            connection.execute(f"PRAGMA {pragma}").fetchone()[0] for pragma in ("application_id", "user_version")
        )
    finally:
        if connection.in_transaction:
            connection.execute("COMMIT")
    if application == APPLICATION_ID:
        if form != FORMAT_VERSION:
            message = (
                f"{name}: store format {form}, of another version of heun; this version uses format {FORMAT_VERSION}"
            )
            raise UsageError(Problem(NOT_A_STORE, message, hint=OTHER_FILE_HINT))
        return
    if not may_be_empty or not is_empty:
        what = "it is empty" if is_empty else "it is a database of another program"
        raise UsageError(Problem(NOT_A_STORE, f"{name}: not a store of sweeps: {what}", hint=OTHER_FILE_HINT))


def _is_empty(connection: sqlite3.Connection) -> bool:
    """Return whether there are no tables."""
    return bool(connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0] == 0)


def _enable_journal(connection: sqlite3.Connection) -> None:
    """Enable write-ahead logging, so that readers do not wait for writers."""
    for attempt in range(MAX_ATTEMPTS):
        try:
            connection.execute("PRAGMA journal_mode = WAL")
            return
        except sqlite3.OperationalError as error:
            if getattr(error, "sqlite_errorname", "") != "SQLITE_BUSY" or attempt == MAX_ATTEMPTS - 1:
                raise
            time.sleep(RETRY_PAUSE)


def write_head(head: SweepHead) -> tuple[str, bytes | None]:
    """Return a head as JSON, and the draws, None if there are none."""
    plan, draws = head.plan, head.plan.draws
    block = head._asdict() | {
        "measures": [tuple(measure) for measure in head.measures],
        "plan": plan._asdict() | {"draws": None if draws is None else draws._asdict() | {"values": draws.values.shape}},
    }
    return json.dumps(block), None if draws is None else draws.values.astype(DOUBLES).tobytes()


def read_head(text: str, values: bytes | None) -> SweepHead:
    """Return the stored head."""
    block = json.loads(text)
    plan = block["plan"]
    axes, columns = (
        tuple(ParameterAxis(name, tuple(values), unit) for name, values, unit in plan[key])
        for key in ("axes", "columns")
    )
    draws = None
    if plan["draws"] is not None and values is not None:
        draws_block = plan["draws"]
        values_by_row = np.frombuffer(values, DOUBLES).reshape(draws_block["values"])
        draws = Draws(
            **{
                **draws_block,
                "laws": tuple(RandomVariable(*law) for law in draws_block["laws"]),
                "values": values_by_row,
            }
        )
    measures = tuple(MeasureLabel(*measure) for measure in block["measures"])
    stored_plan = Plan(**{**plan, "axes": axes, "columns": columns, "draws": draws})
    return SweepHead(**{**block, "measures": measures, "plan": stored_plan})


@contextmanager
def convert_errors(name: str) -> Iterator[None]:
    """Convert SQLite's errors within the context to OutputError, or to UsageError if the file is no store."""
    try:
        yield
    except sqlite3.Error as error:
        raise _make_error(name, error) from None


def _make_error(name: str, error: sqlite3.Error) -> OutputError | UsageError:
    """Make the error of a file that SQLite cannot use as a store."""
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
