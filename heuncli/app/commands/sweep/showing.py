"""`heun sweep --show FILE`: a sweep of a store told as it is there; nothing is solved. Impure: reads the store."""

from __future__ import annotations

from contextlib import closing

from heuncli.analyses.sweep_store.store.store import opened
from heuncli.analyses.sweep_store.which import chosen, line_of, name_and_number
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.guard import same_file
from heuncli.app.cli.output import say
from heuncli.app.cli.units import say_what_stays
from heuncli.app.commands.sweep.request import SweepRequest
from heuncli.app.commands.sweep.running import exit_code
from heuncli.app.commands.sweep.shards import shard_of
from heuncli.app.commands.sweep.telling.noticed import noticed_in, say_noticed
from heuncli.app.commands.sweep.telling.told import Telling, tell
from heuncli.base.errors import Problem
from heuncli.base.foreign_text import shown

ALONE = (
    "words", "measure", "variants", "store", "set", "jobs", "time_limit_each", "method", "step", "tolerance", "zip",
    "samples", "seed", "indices",
)  # fmt: skip


def show(request: SweepRequest, how: Telling) -> int:
    """Tell a sweep of a store; returns the exit code. Raises UsageError, OutputError."""
    assert request.show is not None
    _require_alone(request)
    name, asked = name_and_number(request.show, "--show")
    shard = shard_of(request.shard)
    if request.output is not None and same_file(name, request.output):
        raise UsageError(Problem("bad-option", "--show and -o name the same file", hint="name another file"))
    store = opened(name)
    with closing(store.connection):
        sweeps = list(store.sweeps())
        sweep = chosen(name, asked, sweeps, "--show")
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


def _require_alone(request: SweepRequest) -> None:
    """Raise UsageError where more is asked for than to tell what is there."""
    for name in ALONE:
        if getattr(request, name):
            word = " ".join(request.words) if name == "words" else f"--{name.removesuffix('_each').replace('_', '-')}"
            hint = "--show solves nothing: leave it out, or name the store with --store"
            raise UsageError(Problem("bad-option", f"--show with {word}", hint=hint))
