"""Solve the variants of a plan in processes of this machine, each forked from this one with the scene set up.

    solve_variants(evaluator, plan, numbers, jobs)  ->  (number, VariantResult), in the order of completion

The cluster has the same form: it takes numbers as it has capacity for them, and yields each taken number once. If a
process dies its batch is lost: the variants of the batch are tried once more, one by one, and the one that ends a
second process gets that as its result. Impure: processes, the clock.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import islice

from heuncli.analyses.variants.evaluation import VariantEvaluator
from heuncli.analyses.variants.measures import VariantResult
from heuncli.analyses.variants.plans import Plan
from heuncli.app.cli import jobs
from heuncli.app.cli.variant_workers import make_death_result, solve_contained
from heuncli.base.named_tuples import NamedTuple

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
