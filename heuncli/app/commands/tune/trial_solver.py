"""Solve variants for the search of `heun tune`, in this process or in several. Impure: processes, the clock."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial

from heuncli.analyses.variants.evaluation import Values, VariantEvaluator
from heuncli.analyses.variants.measures import TIME_LIMIT_CODE, VariantResult, make_failed_result
from heuncli.app.cli import jobs, timeout
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.variant_workers import choose_job_count, make_death_result, solve_contained
from heuncli.base.errors import HeunError, Problem
from heuncli.study.queries.measure import NotOneNumber

NO_NUMBER = "bad-option"  # the code of a measure that is not one number
MIN_REMAINING = 1e-9  # s; less than this left means that the limit is reached


class TrialSolver:
    """Solves several variants at once, and returns the outcomes in their order."""

    def __init__(self, evaluator: VariantEvaluator, jobs: int | None) -> None:
        """jobs: number of processes; None: one per processor, if a variant takes long enough"""
        self.evaluator, self.jobs = evaluator, jobs
        self.seconds = 0.0  # solving time of the scene as it is

    def solve_base(self) -> VariantResult:
        """Solve the scene as it is. Raises UsageError if a measure is not a single number in it."""
        start = time.perf_counter()
        try:
            return self.evaluator.measure({})
        except NotOneNumber as error:
            (problem,) = error.problems
            raise UsageError(problem) from None
        except HeunError as error:
            return make_failed_result(error)
        finally:
            self.seconds = time.perf_counter() - start

    def __call__(self, variants: Sequence[Values]) -> Iterator[VariantResult]:
        """Yield the outcomes of variants, by their values. Raises UsageError if a measure is not a single
        number.
        """
        job_count = choose_job_count(self.jobs, len(variants), self.seconds) if len(variants) > 1 else 1
        work: Callable[[Values], VariantResult] = partial(
            solve_in_worker if job_count > 1 else solve_variant, self.evaluator
        )
        for result in jobs.run_in_order(work, variants, job_count, lambda _, death: make_death_result(death)):
            if result.code == NO_NUMBER:
                raise UsageError(Problem(result.code, result.reason, hint="for example 'max foundation.force'"))
            yield result


def solve_variant(evaluator: VariantEvaluator, values: Values) -> VariantResult:
    """Solve a variant in this process, where the time limit interrupts whatever is going on."""
    remaining = timeout.remaining_time()
    if remaining is not None and remaining <= MIN_REMAINING:
        return VariantResult(code=TIME_LIMIT_CODE)
    try:
        return timeout.run_interruptible(partial(evaluator.answer, values))
    except timeout.TimeUp:  # SciPy calls this, and lets no exception pass unchanged
        return VariantResult(code=TIME_LIMIT_CODE)


def solve_in_worker(evaluator: VariantEvaluator, values: Values) -> VariantResult:
    """Solve a variant in a worker process under the time limit set here."""
    return solve_contained(evaluator, values, "tune", timeout.remaining_time())
