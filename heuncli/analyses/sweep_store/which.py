"""Which sweep of a store is meant: FILE, the last of it, or FILE:NUMBER. Impure: looks whether the file is there."""

from __future__ import annotations

from pathlib import Path

from heuncli.analyses.sweep_store.store.store import StoredSweep
from heuncli.base.errors import Problem, UsageError
from heuncli.base.foreign_text import shown


def name_and_number(word: str, asked_by: str) -> tuple[str, int | None]:
    """The store's file, and the number of the sweep in it where one is named. Raises UsageError."""
    name, colon, number = word.rpartition(":")
    if colon and name and number.isascii() and number.isdecimal() and not Path(word).exists():
        word, asked = name, int(number)
    else:
        asked = None
    if not Path(word).is_file():
        message = f"{asked_by} {word}: there is no such file"
        raise UsageError(Problem("unreadable", message, hint="heun sweep ... --store FILE makes one"))
    return word, asked


def chosen(name: str, asked: int | None, sweeps: list[StoredSweep], asked_by: str) -> StoredSweep:
    """The sweep of that number, or the last. Raises UsageError."""
    found = sweeps[-1:] if asked is None else [one for one in sweeps if one.number == asked]
    if not found:
        known = ", ".join(str(one.number) for one in sweeps)
        message = f"{asked_by} {name}: there is no sweep {asked if asked is not None else 'in it'}"
        raise UsageError(Problem("bad-option", message, hint=f"there are: {known}" if known else "it holds none"))
    return found[0]


def line_of(sweep: StoredSweep) -> str:
    """A sweep of a store in a line."""
    head = sweep.head
    of = f"{shown(head.path)}: {', '.join(head.plan.names)}"
    return f"{sweep.begun}  {of}; {sweep.done} of {head.plan.size} variants; {', '.join(m.text for m in head.measures)}"
