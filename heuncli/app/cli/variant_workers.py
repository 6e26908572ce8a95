"""Solve variants in processes of this machine, in batches, and print the warnings of all.

What ends a variant early becomes its result. Impure: processes, the clock.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import islice
from typing import TYPE_CHECKING

from heuncli.analyses.variants.evaluation import VariantEvaluator
from heuncli.analyses.variants.measures import (
    TIME_LIMIT_CODE,
    WORKER_DIED,
    CachedEvaluator,
    VariantResult,
    make_failed_result,
)
from heuncli.analyses.variants.parameters import Values, format_value
from heuncli.app.cli import jobs, timeout
from heuncli.app.cli.entry import UsageError, run_contained
from heuncli.app.cli.output import print_stderr
from heuncli.app.cli.solving import print_warnings
from heuncli.base.errors import HeunError, Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import Spec

if TYPE_CHECKING:
    from heuncli.analyses.variants.plans import Plan

MIN_SECONDS = 0.02  # s; for shorter variants several processes do not pay


def require_job_count(requested: int | None) -> None:
    """Raise UsageError if --jobs is not a number of processes."""
    if requested is not None and requested < 1:
        problem = Problem("bad-option", f"--jobs {requested}: expected 1 or more", hint="for example --jobs 2")
        raise UsageError(problem)


def choose_job_count(requested: int | None, item_count: int, seconds: float) -> int:
    """Return the number of processes for some items; seconds: what one variant takes.

    requested: by the user; None: one per processor, if a variant takes long enough
    """
    if requested is None and seconds < MIN_SECONDS:
        return 1
    return jobs.choose_job_count(requested, item_count)


def solve_contained(evaluator: VariantEvaluator, values: Values, command: str, limit: float | None) -> VariantResult:
    """Solve a variant; a time limit [s], lack of memory and bugs of heun become its result.

    command: named in the report of a bug
    """
    words = [evaluator.recipe.path, *(f"{name}={format_value(value)}" for name, value in values.items())]
    try:
        return run_contained(lambda: timeout.run_with_limit(lambda: evaluator.answer(values), limit), (command, *words))
    except HeunError as error:
        return make_failed_result(error)


def make_death_result(death: jobs.ProcessDeath) -> VariantResult:
    """Make the result of a variant that ended two processes, or one at the hard end of its time limit."""
    if death.is_time_up:
        return VariantResult(code=TIME_LIMIT_CODE, reason="the time limit was reached, but the work did not stop")
    return VariantResult(code=WORKER_DIED, reason=f"the process that solved it failed twice: {death.description}")


def print_variant_warnings(spec: Spec, evaluator: CachedEvaluator, quiet: bool) -> None:
    """Print the warnings of reading the spec and of solving its variants."""
    print_warnings(spec, None, quiet)
    for text, variants in ({} if quiet else evaluator.count_warnings()).items():
        print_stderr(f"warning: heun: {text} (in {variants} of {evaluator.runs} variants)")


BATCH_SECONDS = 0.2  # seconds of a batch: long compared with the transfer, short enough to lose
GROWTH = 8  # largest growth from batch to batch: the first variants include one-off work
MAX_BATCH = 2000  # largest number of variants of a batch


class BatchResults(NamedTuple):
    """The results of a batch, and the time it took [s]."""

    results: tuple[VariantResult, ...]
    seconds: float


def solve_variants(
    evaluator: VariantEvaluator, plan: Plan, numbers: Iterator[int], job_count: int, stop_descriptor: int | None = None
) -> Iterator[tuple[int, VariantResult]]:
    """Yield each number with its result, in the order of completion.

    stop_descriptor: a file descriptor; the work ends once anything can be read from it
    """
    batches = Batches(numbers)
    work = partial(solve_batch, evaluator, plan)
    if not jobs.can_fork():
        while (batch := batches.next()) is not None:
            batch_results = work(batch)
            batches.record_time(batch, batch_results.seconds)
            yield from zip(batch, batch_results.results, strict=True)
        return
    for batch, outcome in jobs.run_as_completed(work, batches.next, job_count, stop_descriptor):
        if isinstance(outcome, jobs.ProcessDeath):
            yield from ((number, make_death_result(outcome)) for number in batches.retries.add_lost(batch, outcome))
        else:
            batches.record_time(batch, outcome.seconds)
            yield from zip(batch, outcome.results, strict=True)


def solve_batch(evaluator: VariantEvaluator, plan: Plan, numbers: Sequence[int]) -> BatchResults:
    """Solve some variants; a failure of one does not stop the others."""
    start = time.monotonic()
    results = tuple(
        solve_contained(evaluator, plan.find_values(number), "sweep", evaluator.recipe.options.time_limit)
        for number in numbers
    )
    return BatchResults(results, time.monotonic() - start)


class Batches:
    """Batches of variant numbers, each as large as a process solves in about BATCH_SECONDS."""

    def __init__(self, numbers: Iterator[int]) -> None:
        self.numbers = numbers
        self.size = 1
        self.retries = jobs.RetryQueue()  # variants of batches whose process died

    def next(self) -> tuple[int, ...] | None:
        """Return the next batch, or None if there is none now."""
        retry = self.retries.pop_next()
        if retry is not None:
            return (retry,)
        return tuple(islice(self.numbers, self.size)) or None

    def record_time(self, batch: Sequence[int], seconds: float) -> None:
        """Record the time of a solved batch, and adapt the size of the next ones."""
        self.retries.forget(batch)
        fitting = BATCH_SECONDS * len(batch) / max(seconds, 1e-6)
        self.size = int(min(max(fitting, 1.0), GROWTH * len(batch), MAX_BATCH))
