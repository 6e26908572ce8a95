"""Solve variants in processes of their own, and print the warnings of all. What ends one early becomes its result.

Impure: the clock.
"""

from __future__ import annotations

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
from heuncli.scene.file_format.models import Spec

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
