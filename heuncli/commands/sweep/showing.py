"""`heun sweep --show FILE`: a sweep of a store told as it is there; nothing is solved. Impure: reads the store."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path

from heuncli.cli.entry import UsageError
from heuncli.cli.guard import same_file
from heuncli.cli.output import say
from heuncli.cli.units import say_what_stays
from heuncli.commands.sweep.request import SweepRequest
from heuncli.commands.sweep.running import exit_code
from heuncli.commands.sweep.shards import shard_of
from heuncli.commands.sweep.telling.noticed import noticed_in, say_noticed
from heuncli.commands.sweep.telling.told import Telling, tell
from heuncli.errors import Problem
from heuncli.foreign_text import shown
from heuncli.sweeps.store.store import StoredSweep, opened

ALONE = (
    "words", "measure", "variants", "store", "set", "jobs", "time_limit_each", "method", "step", "tolerance", "zip",
    "samples", "seed", "indices",
)  # fmt: skip


def show(request: SweepRequest, how: Telling) -> int:
    """Tell a sweep of a store; returns the exit code. Raises UsageError, OutputError."""
    assert request.show is not None
    _require_alone(request)
    name, asked = name_and_number(request.show)
    shard = shard_of(request.shard)
    if request.output is not None and same_file(name, request.output):
        raise UsageError(Problem("bad-option", "--show and -o name the same file", hint="name another file"))
    store = opened(name)
    with closing(store.connection):
        sweeps = list(store.sweeps())
        sweep = _chosen(name, asked, sweeps)
        if len(sweeps) > 1 and asked is None and not request.quiet:
            for one in sweeps:
                say(f"heun: {shown(name)}:{one.number}  {line_of(one)}")
        rows = store.rows(sweep.number, sweep.head.plan.names, shard)
        tell(sweep.head, rows, how)
        say_what_stays(request.units, how.form, request.quiet)
        if sweep.done < sweep.head.plan.size and not request.quiet:
            say(f"heun: {sweep.done} of {sweep.head.plan.size} variants are done")
        noticed = noticed_in(sweep.head, rows)
        say_noticed(noticed, request.quiet)
        return exit_code(noticed, request.strict)


def name_and_number(word: str) -> tuple[str, int | None]:
    """The store's file, and the number of the sweep in it where one is named. Raises OutputError."""
    name, colon, number = word.rpartition(":")
    if colon and name and number.isascii() and number.isdecimal() and not Path(word).exists():
        word, asked = name, int(number)
    else:
        asked = None
    if not Path(word).is_file():
        raise UsageError(Problem("unreadable", f"--show {word}: there is no such file", hint="--store FILE makes one"))
    return word, asked


def line_of(sweep: StoredSweep) -> str:
    """A sweep of a store in a line."""
    head = sweep.head
    of = f"{shown(head.path)}: {', '.join(head.plan.names)}"
    return f"{sweep.begun}  {of}; {sweep.done} of {head.plan.size} variants; {', '.join(m.text for m in head.measures)}"


def _chosen(name: str, asked: int | None, sweeps: list[StoredSweep]) -> StoredSweep:
    found = sweeps[-1:] if asked is None else [one for one in sweeps if one.number == asked]
    if not found:
        known = ", ".join(str(one.number) for one in sweeps)
        message = f"--show {name}: there is no sweep {asked if asked is not None else 'in it'}"
        raise UsageError(Problem("bad-option", message, hint=f"there are: {known}" if known else "it holds none"))
    return found[0]


def _require_alone(request: SweepRequest) -> None:
    """Raise UsageError where more is asked for than to tell what is there."""
    for name in ALONE:
        if getattr(request, name):
            word = " ".join(request.words) if name == "words" else f"--{name.removesuffix('_each').replace('_', '-')}"
            hint = "--show solves nothing: leave it out, or name the store with --store"
            raise UsageError(Problem("bad-option", f"--show with {word}", hint=hint))
