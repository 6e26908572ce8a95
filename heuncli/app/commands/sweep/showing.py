"""`heun sweep --show FILE`: write a sweep from a store; nothing is solved. Impure: reads the store."""

from __future__ import annotations

from contextlib import closing

from heuncli.analyses.sweep_store import choose_sweep, format_sweep, open_store, split_store_argument
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.guard import is_same_file
from heuncli.app.cli.output import print_stderr
from heuncli.app.cli.target import note_si_format
from heuncli.app.commands.sweep.axis_arguments import parse_shard
from heuncli.app.commands.sweep.output.sweep_warnings import collect_warnings, print_warnings_summary
from heuncli.app.commands.sweep.output.writer import SweepOutput, write_sweep
from heuncli.app.commands.sweep.request import SweepRequest
from heuncli.app.commands.sweep.running import choose_exit_code
from heuncli.base.errors import Problem
from heuncli.base.text_safety import escape

EXCLUDED_OPTIONS = (
    "words", "measure", "variants", "store", "set", "jobs", "time_limit_each", "method", "step", "tolerance", "zip",
    "samples", "seed", "indices",
)  # fmt: skip


def show_stored(request: SweepRequest, output: SweepOutput) -> int:
    """Write a sweep of a store; returns the exit code. Raises UsageError, OutputError."""
    assert request.show is not None
    _require_alone(request)
    name, sweep_number = split_store_argument(request.show, "--show")
    shard = parse_shard(request.shard)
    if request.output is not None and is_same_file(name, request.output):
        raise UsageError(Problem("bad-option", "--show and -o name the same file", hint="name another file"))
    store = open_store(name)
    with closing(store.connection):
        sweeps = list(store.iter_sweeps())
        sweep = choose_sweep(name, sweep_number, sweeps, "--show")
        if len(sweeps) > 1 and sweep_number is None and not request.quiet:
            for one in sweeps:
                print_stderr(f"heun: {escape(name)}:{one.number}  {format_sweep(one)}")
        rows = store.find_rows(sweep.number, sweep.head.plan, shard)
        write_sweep(sweep.head, rows, output)
        note_si_format(request.units, output.form, request.quiet)
        if sweep.variant_count < sweep.head.plan.size and not request.quiet:
            print_stderr(f"heun: {sweep.variant_count} of {sweep.head.plan.size} variants are done")
        sweep_warnings = collect_warnings(sweep.head, rows)
        print_warnings_summary(sweep_warnings, request.quiet)
        return choose_exit_code(sweep_warnings, request.strict)


def _require_alone(request: SweepRequest) -> None:
    """Raise UsageError for options that would solve something."""
    for name in EXCLUDED_OPTIONS:
        if getattr(request, name):
            word = " ".join(request.words) if name == "words" else f"--{name.removesuffix('_each').replace('_', '-')}"
            hint = "leave it out; --show solves nothing. Or name the store with --store"
            raise UsageError(Problem("bad-option", f"--show and {word} cannot be combined", hint=hint))
