"""Store the rows of sweeps in an SQLite file: each row is written when it is solved, an interrupted sweep is continued,
a finished one is read.

    heun      1 row:            the version of heun that wrote the file
    sweeps    a row a sweep:    number, identity, head (JSON: its description and plan), draws (random numbers), begun
    variants  a row a variant:  sweep, number, key, given (JSON: its values, numbers in the units of the plan); code,
                                reason: only of failures to retry
    answers   a row a key:      key, measures (JSON: value, error, instant, word), code, reason, warnings (JSON)

A result is stored under its key (analyses/variants/keys.py), and serves every sweep that has a variant with that key. A
failure that another attempt may avoid (a time limit, memory, a process that died) is no result: it is stored with its
variant.

The journal is a write-ahead log. Every row is a transaction of its own, so a killed process loses only the variant that
it is solving. Two sweeps write in turns; a row that both have is written once. If the user names no file, SQLite keeps
the same tables in a temporary file of its own, which disappears with the process.

Impure: reads and writes files.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from types import TracebackType
from typing import Any

from heuncli.analyses.sweep_rows import SweepHead, SweptRow, make_parameter_columns
from heuncli.analyses.sweep_store_file import (
    convert_errors,
    initialize_store,
    read_head,
    require_store,
    write_head,
)
from heuncli.analyses.variants.measures import TIME_LIMIT_CODE, WORKER_DIED, MeasureValue, VariantResult
from heuncli.analyses.variants.parameters import Values
from heuncli.analyses.variants.plans import Plan
from heuncli.base.errors import Problem, UsageError
from heuncli.base.files import find_target
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape

RETRY_CODES = frozenset({TIME_LIMIT_CODE, "out-of-memory", "too-much-memory", WORKER_DIED, "bug"})  # not final
LOCK_TIMEOUT = 120.0  # seconds to wait for another sweep that writes


class StoredSweep(NamedTuple):
    """A sweep of a store.

    variant_count: how many of its variants are stored
    start_time: when it was started
    """

    number: int
    head: SweepHead
    variant_count: int
    start_time: str


class Store:
    """An open store; as a context manager it is closed at the end."""

    def __init__(self, name: str | None) -> None:
        """Open a store, or create it; None: one that disappears with the process.

        Raises OutputError, UsageError if the file belongs to another program, or to another version.
        """
        self.name = name if name is not None else "the temporary folder"
        if name is not None:
            find_target(name)
        with convert_errors(self.name):
            # an absolute path: SQLite has meanings of its own for ":memory:" and "file:..."
            where = str(Path(name).absolute()) if name is not None else ""
            self.connection = sqlite3.connect(where, timeout=LOCK_TIMEOUT, isolation_level=None)
            try:
                initialize_store(self.connection, self.name, is_persistent=name is not None)
            except BaseException:
                self.connection.close()
                raise

    def __enter__(self) -> Store:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.connection.close()

    def find_or_add_sweep(self, head: SweepHead, identity: bytes) -> int:
        """Return the number of the sweep with this identity, which is added if there is none."""
        texts, draws = write_head(head)
        with convert_errors(self.name):
            self.connection.execute(
                "INSERT OR IGNORE INTO sweeps (identity, head, draws, begun) VALUES (?, ?, ?, datetime('now'))",
                (identity, texts, draws),
            )
            found = self.connection.execute("SELECT number FROM sweeps WHERE identity = ?", (identity,)).fetchone()
        return int(found[0])

    def has_result(self, key: bytes) -> bool:
        """Return whether there is a result for the key."""
        with convert_errors(self.name):
            return self.connection.execute("SELECT 1 FROM answers WHERE key = ?", (key,)).fetchone() is not None

    def link_variant(self, sweep: int, variant_number: int, key: bytes, values: Values) -> None:
        """Add a variant to a sweep; its result is stored already, from this sweep or another."""
        with convert_errors(self.name):
            self.connection.execute(
                f"{VARIANT} WHERE code <> ''", (sweep, variant_number, key, _dump_values(values), "", "")
            )

    def add_result(self, sweep: int, number: int, key: bytes, values: Values, result: VariantResult) -> None:
        """Store the result of a variant."""
        is_final = result.code not in RETRY_CODES
        retry_reason = ("", "") if is_final else (result.code, result.reason)
        with convert_errors(self.name):
            self.connection.execute("BEGIN IMMEDIATE")
            try:
                if is_final:
                    self.connection.execute(ANSWER, (key, *_to_row(result)))
                self.connection.execute(VARIANT, (sweep, number, key, _dump_values(values), *retry_reason))
                self.connection.execute("COMMIT")
            except sqlite3.Error:
                if self.connection.in_transaction:
                    self.connection.execute("ROLLBACK")
                raise

    def find_rows(self, sweep: int, plan: Plan, shard: tuple[int, int] = (1, 1)) -> StoredRows:
        """Return the stored rows of a sweep or of one shard, in the plan's order."""
        return StoredRows(self, sweep, plan, shard)

    def iter_sweeps(self) -> Iterator[StoredSweep]:
        """Yield all sweeps, in the order in which they were started. Raises UsageError if one cannot be read."""
        with convert_errors(self.name):
            found = self.connection.execute(
                "SELECT number, head, draws, begun, (SELECT count(*) FROM variants WHERE sweep = sweeps.number)"
                " FROM sweeps ORDER BY number"
            ).fetchall()
        for number, texts, draws, start_time, variant_count in found:
            yield StoredSweep(number, read_head(texts, draws), variant_count, start_time)


ANSWER = "INSERT OR IGNORE INTO answers VALUES (?, ?, ?, ?, ?)"
VARIANT = """\
INSERT INTO variants VALUES (?, ?, ?, ?, ?, ?)
ON CONFLICT (sweep, number) DO UPDATE SET code = excluded.code, reason = excluded.reason"""
ROWS = """\
SELECT variants.number, given, measures,
    CASE WHEN answers.key IS NULL THEN variants.code ELSE answers.code END,
    CASE WHEN answers.key IS NULL THEN variants.reason ELSE answers.reason END, warnings
FROM variants LEFT JOIN answers USING (key)
WHERE sweep = ? AND variants.number % ? = ? ORDER BY variants.number"""


class StoredRows:
    """The rows of a sweep, which can be iterated several times: they are read from the file each time."""

    def __init__(self, store: Store, sweep: int, plan: Plan, shard: tuple[int, int]) -> None:
        self.store, self.sweep, self.shard = store, sweep, shard
        self.columns = make_parameter_columns(plan)

    def __iter__(self) -> Iterator[SweptRow]:
        k, n = self.shard
        with (
            convert_errors(self.store.name),
            closing(self.store.connection.execute(ROWS, (self.sweep, n, k - 1))) as found,
        ):
            for number, cells, measures, code, reason, warnings in found:
                pairs = zip(self.columns, json.loads(cells), strict=True)
                values = {column.name: column.make_value(cell) for column, cell in pairs}
                readings = tuple(MeasureValue(*numbers) for numbers in json.loads(measures or "[]"))
                answer = VariantResult(readings, code, reason, tuple(json.loads(warnings or "[]")))
                yield SweptRow(number, values, answer)


def open_store(name: str) -> Store:
    """Open an existing store for reading. Raises OutputError, UsageError."""
    store = Store.__new__(Store)
    store.name = name
    with convert_errors(name):
        store.connection = _connect_for_reading(name)
        require_store(store.connection, name)
    return store


def split_store_argument(word: str, option: str) -> tuple[str, int | None]:
    """Split `FILE` or `FILE:NUMBER` into the store's file and the number of the sweep, None without one. Raises
    UsageError.
    """
    name, colon, number = word.rpartition(":")
    if colon and name and number.isascii() and number.isdecimal() and not Path(word).exists():
        word, sweep_number = name, int(number)
    else:
        sweep_number = None
    if not Path(word).is_file():
        message = f"{option} {word}: file not found"
        raise UsageError(Problem("unreadable", message, hint="create one with heun sweep ... --store FILE"))
    return word, sweep_number


def choose_sweep(name: str, number: int | None, sweeps: list[StoredSweep], option: str) -> StoredSweep:
    """Return the sweep with that number, or the last. Raises UsageError."""
    found = sweeps[-1:] if number is None else [sweep for sweep in sweeps if sweep.number == number]
    if not found:
        numbers = ", ".join(str(sweep.number) for sweep in sweeps)
        message = f"{option} {name}: there is no sweep {number if number is not None else 'in it'}"
        raise UsageError(Problem("bad-option", message, hint=f"known: {numbers}" if numbers else "it is empty"))
    return found[0]


def format_sweep(sweep: StoredSweep) -> str:
    """Format a sweep of a store in one line."""
    head = sweep.head
    spec_and_names = f"{escape(head.path)}: {', '.join(head.plan.names)}"
    return (
        f"{sweep.start_time}  {spec_and_names}; {sweep.variant_count} of {head.plan.size} variants; "
        f"{', '.join(m.text for m in head.measures)}"
    )


def _connect_for_reading(name: str) -> sqlite3.Connection:
    """Return a connection for reading; first in mode rw, because the last one to close removes the journal if it
    may.
    """
    where = Path(name).resolve().as_uri()
    for mode in ("mode=rw", "mode=ro", "mode=ro&immutable=1"):
        connection = sqlite3.connect(f"{where}?{mode}", uri=True, timeout=LOCK_TIMEOUT, isolation_level=None)
        try:
            connection.execute("SELECT count(*) FROM sqlite_master").fetchone()
        except sqlite3.OperationalError:
            connection.close()
            if "immutable" in mode:
                raise
        else:
            return connection
    raise AssertionError


def _dump_values(values: Values) -> str:
    """Format the values of a variant as JSON."""
    return json.dumps([value if isinstance(value, str) else value.value for value in values.values()])


def _to_row(result: VariantResult) -> tuple[Any, ...]:
    """Return a result as its row in the table."""
    measures = json.dumps([tuple(reading) for reading in result.measures]) if result.measures else ""
    return measures, result.code, result.reason, json.dumps(result.warnings) if result.warnings else ""
