"""The rows of sweeps in an SQLite file: written as they come, taken up again where a sweep ended, told when it is done.

    heun      1 row:   heun's version, by which all of it was made
    sweeps    a row a sweep:    number, identity, head (JSON: what it is of, and its plan), draws (what is drawn)
    variants  a row a variant:  sweep, number, key, given (JSON: its values); code, reason: of what may be tried again
    answers   a row a key:      key, measures (JSON: value, error, instant, word), code, reason, warnings (JSON)

An answer stands under its key (analyses/variants/keys.py), and is there for every sweep that has a variant of that key.
What another attempt may answer otherwise (a time limit, memory, a process that died) is no answer: it stands by its
variant.

The journal is a write-ahead log. Every row is a transaction of its own, so that whoever is killed has lost what was
under way, and two sweeps write by turns; a row that both have is written once. Without a file of the user's the same
tables are in one of SQLite's own in the folder of temporary files, which is gone with the process.

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

from heuncli.analyses.sweep_store.rows import SweepHead, SweptRow
from heuncli.analyses.sweep_store.store.errors import told_errors
from heuncli.analyses.sweep_store.store.heads import head_of_texts, texts_of_head
from heuncli.analyses.sweep_store.store.kinds import begun, require_own
from heuncli.analyses.variants.asking import Answer, Measured
from heuncli.base.files import place_of
from heuncli.base.named_tuples import NamedTuple

AGAIN = frozenset({"time-limit", "out-of-memory", "too-much-memory", "worker-died", "bug"})  # no answer for good
PATIENCE = 120.0  # seconds for which another sweep may write


class StoredSweep(NamedTuple):
    """A sweep of a store: its number, what it is of, how many of its variants are there, and when it was begun."""

    number: int
    head: SweepHead
    done: int
    begun: str


class Store:
    """An open store; as a context it is closed at the end."""

    def __init__(self, name: str | None) -> None:
        """Open a store, which is made where there is none; None: one that is gone with the process.

        Raises OutputError, UsageError where the file is another program's, or of another version.
        """
        self.name = name if name is not None else "the folder of temporary files"
        if name is not None:
            place_of(name)
        with told_errors(self.name):
            # an absolute path: SQLite has meanings of its own for ":memory:" and "file:..."
            where = str(Path(name).absolute()) if name is not None else ""
            self.connection = sqlite3.connect(where, timeout=PATIENCE, isolation_level=None)
            begun(self.connection, self.name, kept=name is not None)

    def __enter__(self) -> Store:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.connection.close()

    def sweep(self, head: SweepHead, identity: bytes) -> int:
        """The number of a sweep, which is a new one where there is none of this identity."""
        texts, draws = texts_of_head(head)
        with told_errors(self.name):
            self.connection.execute(
                "INSERT OR IGNORE INTO sweeps (identity, head, draws, begun) VALUES (?, ?, ?, datetime('now'))",
                (identity, texts, draws),
            )
            found = self.connection.execute("SELECT number FROM sweeps WHERE identity = ?", (identity,)).fetchone()
        return int(found[0])

    def has(self, key: bytes) -> bool:
        """Whether there is an answer."""
        with told_errors(self.name):
            return self.connection.execute("SELECT 1 FROM answers WHERE key = ?", (key,)).fetchone() is not None

    def take_up(self, sweep: int, number: int, key: bytes, given: tuple[str, ...]) -> None:
        """A variant whose answer is there already belongs to a sweep, too."""
        with told_errors(self.name):
            self.connection.execute(f"{VARIANT} WHERE code <> ''", (sweep, number, key, json.dumps(given), "", ""))

    def keep(self, sweep: int, number: int, key: bytes, given: tuple[str, ...], answer: Answer) -> None:
        """A variant is answered."""
        for_good = answer.code not in AGAIN
        again = ("", "") if for_good else (answer.code, answer.reason)
        with told_errors(self.name):
            self.connection.execute("BEGIN IMMEDIATE")
            try:
                if for_good:
                    self.connection.execute(ANSWER, (key, *_texts(answer)))
                self.connection.execute(VARIANT, (sweep, number, key, json.dumps(given), *again))
                self.connection.execute("COMMIT")
            except sqlite3.Error:
                if self.connection.in_transaction:
                    self.connection.execute("ROLLBACK")
                raise

    def rows(self, sweep: int, names: tuple[str, ...], shard: tuple[int, int] = (1, 1)) -> StoredRows:
        """The rows of a sweep, or of a shard of it, in the order of its plan."""
        return StoredRows(self, sweep, names, shard)

    def sweeps(self) -> Iterator[StoredSweep]:
        """All sweeps, in the order in which they were begun. Raises UsageError where one cannot be read."""
        with told_errors(self.name):
            found = self.connection.execute(
                "SELECT number, head, draws, begun, (SELECT count(*) FROM variants WHERE sweep = sweeps.number)"
                " FROM sweeps ORDER BY number"
            ).fetchall()
        for number, texts, draws, begun_, done in found:
            yield StoredSweep(number, head_of_texts(texts, draws), done, begun_)


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
    """The rows of a sweep, which may be gone through several times: read from the file each time, not kept."""

    def __init__(self, store: Store, sweep: int, names: tuple[str, ...], shard: tuple[int, int]) -> None:
        self.store, self.sweep, self.names, self.shard = store, sweep, names, shard

    def __iter__(self) -> Iterator[SweptRow]:
        k, n = self.shard
        with (
            told_errors(self.store.name),
            closing(self.store.connection.execute(ROWS, (self.sweep, n, k - 1))) as found,
        ):
            for number, given, measures, code, reason, warnings in found:
                values = dict(zip(self.names, json.loads(given), strict=True))
                measured = tuple(Measured(*one) for one in json.loads(measures or "[]"))
                answer = Answer(measured, code, reason, tuple(json.loads(warnings or "[]")))
                yield SweptRow(number, values, answer)


def opened(name: str) -> Store:
    """A store that is there, to be read alone. Raises OutputError, UsageError."""
    store = Store.__new__(Store)
    store.name = name
    with told_errors(name):
        store.connection = _to_read(name)
        require_own(store.connection, name)
    return store


def _to_read(name: str) -> sqlite3.Connection:
    """A connection to read by; rw, for the last one that is closed clears the journal away, if it may."""
    where = Path(name).resolve().as_uri()
    for how in ("mode=rw", "mode=ro", "mode=ro&immutable=1"):
        connection = sqlite3.connect(f"{where}?{how}", uri=True, timeout=PATIENCE, isolation_level=None)
        try:
            connection.execute("SELECT count(*) FROM sqlite_master").fetchone()
        except sqlite3.OperationalError:
            connection.close()
            if "immutable" in how:
                raise
        else:
            return connection
    raise AssertionError


def _texts(answer: Answer) -> tuple[Any, ...]:
    """An answer as it is stored."""
    measures = json.dumps([tuple(one) for one in answer.measures]) if answer.measures else ""
    return measures, answer.code, answer.reason, json.dumps(answer.warnings) if answer.warnings else ""
