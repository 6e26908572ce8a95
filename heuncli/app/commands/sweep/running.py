"""Run a sweep: send missing variants to the workers, store every result, and write all of them at the end.

`--show FILE` writes a sweep from its store; nothing is solved then. The workers are processes of this machine, each
forked from this one with the scene set up:

    solve_variants(evaluator, plan, numbers, jobs)  ->  (number, VariantResult), in the order of completion

The cluster has the same form: it takes numbers as it has capacity for them, and yields each taken number once. If a
process dies its batch is lost: the variants of the batch are tried once more, one by one, and the one that ends a
second process gets that as its result. Impure: processes, files, the clock.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Generator, Iterator
from contextlib import closing

from heuncli.analyses.sweep_rows import SweepHead
from heuncli.analyses.sweep_store import Store, StoredRows, choose_sweep, format_sweep, open_store, split_store_argument
from heuncli.analyses.sweep_store_file import write_head
from heuncli.analyses.variants.evaluation import VariantEvaluator
from heuncli.analyses.variants.keys import VariantKeys
from heuncli.analyses.variants.measures import VariantResult
from heuncli.analyses.variants.parameters import Values
from heuncli.app.cli import jobs
from heuncli.app.cli.entry import BUG, UsageError
from heuncli.app.cli.options import list_fields
from heuncli.app.cli.output import print_stderr
from heuncli.app.cli.progress import ReportProgress, show_progress
from heuncli.app.cli.target import is_same_file, note_si_format
from heuncli.app.cli.variant_workers import solve_variants
from heuncli.app.commands.sweep.axes import parse_shard
from heuncli.app.commands.sweep.request import SweepRequest
from heuncli.app.commands.sweep.sweep_warnings import SweepWarnings, collect_warnings, print_warnings_summary
from heuncli.app.commands.sweep.writer import SweepOutput, write_sweep
from heuncli.base.errors import OutputError, Problem, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.signals import GracefulStop
from heuncli.base.text_safety import escape
from heuncli.study.queries.measure import NotOneNumber

REPORT_INTERVAL = 0.1  # seconds between progress reports
NO_NUMBER = ("bad-option", "unknown-path")  # codes of a measure that is not a number of the scene


class SweepTask(NamedTuple):
    """A sweep to run: its evaluator, head, keys and store, and the part (shard) of it."""

    evaluator: VariantEvaluator
    head: SweepHead
    keys: VariantKeys
    store: Store
    shard: tuple[int, int]

    @property
    def size(self) -> int:
        """Number of variants of the part."""
        k, n = self.shard
        return len(range(k - 1, self.head.plan.size, n))

    def compute_identity(self) -> bytes:
        """Return the digest that identifies the same sweep: of spec, plan, measures and options."""
        texts, draws = write_head(self.head)
        return bytes(hashlib.sha256(b"\0".join((self.keys.make_spec_key(), texts.encode(), draws or b""))).digest())


class PendingVariant(NamedTuple):
    """A variant that is being solved: its key and its values."""

    key: bytes
    values: Values


def run_sweep(sweep: SweepTask, request: SweepRequest, output: SweepOutput) -> int:
    """Solve the missing variants and write all results; returns the exit code."""
    sweep_number = sweep.store.find_or_add_sweep(sweep.head, sweep.compute_identity())
    with GracefulStop() as stopping:
        done_count = _solve_missing(sweep, sweep_number, request, stopping)
    rows = sweep.store.find_rows(sweep_number, sweep.head.plan, sweep.shard)
    if stopping.number:
        if request.store is None and done_count:
            write_sweep(sweep.head, rows, output)
        advice = "the same command continues with the rest" if request.store is not None else "--store FILE keeps them"
        print_stderr(f"{stopping.reason}: {done_count} of {sweep.size} variants are done; {advice}")
        return 128 + stopping.number
    warnings = collect_warnings(sweep.head, rows)
    if len(warnings.codes) == 1 and warnings.failure_count == sweep.size:
        _raise_common_error(sweep, rows)
    write_sweep(sweep.head, rows, output)
    note_si_format(request.units, output.form, request.quiet)
    print_warnings_summary(warnings, request.quiet)
    return choose_exit_code(warnings, request.strict)


def choose_exit_code(warnings: SweepWarnings, strict: bool) -> int:
    """Return the exit code of a finished sweep."""
    return BUG if "bug" in warnings.codes else 1 if strict and warnings.failure_count else 0


def _solve_missing(sweep: SweepTask, sweep_number: int, request: SweepRequest, stopping: GracefulStop) -> int:
    """Solve and store the missing variants; returns how many variants of the part are done."""
    pending: dict[int, PendingVariant] = {}
    count = SweepProgress(sweep.size)
    plan, store = sweep.head.plan, sweep.store

    def iter_missing() -> Iterator[int]:
        """Yield the variants without a stored result, and link the others to theirs."""
        for variant in plan.iter_numbers(sweep.shard):
            if stopping.number:  # a batch in this process cannot wait for the descriptor
                return
            values = plan.find_values(variant)
            pending_variant = PendingVariant(sweep.keys.make_key(values), values)
            if store.has_result(pending_variant.key):
                store.link_variant(sweep_number, variant, *pending_variant)
                count.stored += 1
            else:
                pending[variant] = pending_variant
                yield variant

    results = _solve_variants(sweep, iter_missing(), request, stopping.descriptor)
    with show_progress(request.quiet) as report, closing(results):
        try:
            for variant, result in results:
                if not count.successes and result.code in NO_NUMBER:
                    _require_numbers(sweep.evaluator, plan.find_values(variant))
                store.add_result(sweep_number, variant, *pending.pop(variant), result)
                count.add(result)
                count.report(report)
        except OutputError as error:
            done_text = f"; {count.done_count} of {count.total} variants are done" + (
                " and kept" if request.store else ""
            )
            error.replace_problems(
                *(problem._replace(message=problem.message + done_text) for problem in error.problems)
            )
            raise
    return count.done_count


def _solve_variants(
    sweep: SweepTask, numbers: Iterator[int], request: SweepRequest, stop_descriptor: int
) -> Generator[tuple[int, VariantResult], None, None]:
    """Solve the variants, in processes of this machine or on a cluster."""
    plan = sweep.head.plan
    if request.dask is None:
        yield from solve_variants(
            sweep.evaluator, plan, numbers, jobs.choose_job_count(request.jobs, sweep.size), stop_descriptor
        )
        return
    from heuncli.app.commands.sweep.cluster import scheduler  # imports an optional, large package

    def report_line(line: str) -> None:
        """Print a line about the cluster."""
        if not request.quiet:
            print_stderr(f"heun: {line}")

    yield from scheduler.solve_variants(
        sweep.evaluator.recipe, plan, numbers, request.dask, sweep.size, report_line, stop_descriptor
    )


class SweepProgress:
    """The progress of a sweep."""

    def __init__(self, total: int) -> None:
        self.total, self.stored, self.solved_now, self.successes = total, 0, 0, 0
        self.start_time = self.report_time = time.monotonic()

    @property
    def done_count(self) -> int:
        """Number of variants that are done."""
        return self.stored + self.solved_now

    def add(self, result: VariantResult) -> None:
        """Count another result."""
        self.solved_now += 1
        self.successes += not result.code

    def report(self, report_progress: ReportProgress) -> None:
        """Report how many variants are done, how fast, and how long the rest will take."""
        now = time.monotonic()
        if now < self.report_time + REPORT_INTERVAL:
            return
        self.report_time = now
        rate = self.solved_now / max(now - self.start_time, 1e-9)
        remaining = (self.total - self.done_count) / rate
        report_progress(
            self.done_count,
            self.total,
            f"{self.done_count} of {self.total} variants, {rate:.3g} per second, {format_duration(remaining)} left",
        )


def format_duration(seconds: float) -> str:
    """Format a remaining time."""
    minutes, s = divmod(int(seconds + 0.5), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02} min" if hours else f"{minutes} min {s:02} s" if minutes else f"{s} s"


def _require_numbers(evaluator: VariantEvaluator, values: Values) -> None:
    """Raise the error of a measure that is not a number, if the scene can be solved."""
    try:
        evaluator.measure(values)
    except NotOneNumber as error:
        error.replace_problems(
            *(problem._replace(message=f"--measure: {problem.message}") for problem in error.problems)
        )
        raise


def _raise_common_error(sweep: SweepTask, rows: StoredRows) -> None:
    """Raise the SpecError that all variants share, with its location and hint."""
    first = next(iter(rows))
    try:
        sweep.evaluator.load(first.values)
    except SpecError as error:
        if error.problems[0].code == first.result.code:
            raise


EXCLUDED_OPTIONS = (
    "words", "measure", "variants", "store", "set", "jobs", "time_limit_each", "method", "step", "tolerance", "zip",
    "samples", "seed", "indices", "dask", "no_reduce", "least_norm",
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
            for stored_sweep in sweeps:
                print_stderr(f"heun: {escape(name)}:{stored_sweep.number}  {format_sweep(stored_sweep)}")
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
    fields = {field.name: field for field in list_fields(SweepRequest)}
    for name in EXCLUDED_OPTIONS:
        if fields[name].read_value(request) != fields[name].default:
            word = " ".join(request.words) if name == "words" else f"--{name.removesuffix('_each').replace('_', '-')}"
            hint = "leave it out; --show solves nothing. Or name the store with --store"
            raise UsageError(Problem("bad-option", f"--show and {word} cannot be combined", hint=hint))
