"""`heun tune`: find the values of parameters for which a measure is best."""

from __future__ import annotations

import shlex
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from functools import partial

from heuncli.analyses.tune.results import TuneResults
from heuncli.analyses.tune.study import Tuning
from heuncli.analyses.tune.trials import Trials
from heuncli.analyses.variants.evaluation import Recipe, VariantEvaluator
from heuncli.analyses.variants.measures import TIME_LIMIT_CODE, VariantResult, make_failed_result
from heuncli.analyses.variants.parameters import Values, format_value
from heuncli.app.cli import jobs, timeout
from heuncli.app.cli.documents import emit_document
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.output import save
from heuncli.app.cli.progress import show_progress
from heuncli.app.cli.solving import parse_overrides, print_warnings, require_tolerance
from heuncli.app.cli.target import (
    choose_format,
    is_output,
    note_si_format,
    parse_units,
    require_other_file,
    require_writable,
)
from heuncli.app.cli.variant_workers import choose_job_count, make_death_result, require_job_count, solve_contained
from heuncli.app.commands.tune.as_json import TunedScene, make_history
from heuncli.app.commands.tune.options import FORMATS, TuneRequest, TuningOptions, make_task, parse_options
from heuncli.app.commands.tune.page import make_document
from heuncli.base.errors import HeunError, LimitError, Problem, SolveError
from heuncli.output.documents.as_data import iter_csv
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.source import read_text
from heuncli.study.model.options import Options
from heuncli.study.queries.measure import NotOneNumber

LIMIT_REACHED, NOT_GOOD = 4, 1


def main(request: TuneRequest) -> int:
    """Run the command; returns the exit code."""
    options = parse_options(request)
    require_other_file(request.output, [options.path])
    form = choose_format(request.format, request.output, FORMATS)
    units_shown = parse_units(request.units)
    require_consistent_options(request, options)
    evaluator = VariantEvaluator(make_recipe(request, options))
    require_other_file(request.output, [options.path])
    if request.history is not None:
        require_other_file(request.history, [options.path], "--history")
    tuning = run_search(request, options, evaluator)
    results = tuning.make_results()
    require_result(results)
    spec = evaluator.spec
    scene = TunedScene(spec.title, spec.path, spec.sha256, format_command(options, evaluator.recipe, results))
    if request.history is not None:
        save("".join(iter_csv(make_history(results))).encode(), request.history)
    emit_document(make_document(results, scene, units_shown), form, request.output, late=True)
    note_si_format(request.units, form, request.quiet)
    return finish(request, results, spec)


def require_consistent_options(request: TuneRequest, options: TuningOptions) -> None:
    """Raise UsageError if options contradict each other, or a number is invalid."""
    require_job_count(request.jobs)
    if request.history is None:
        return
    require_writable(request.history, "--history")
    if is_output(request.history, request.output):
        message = f"--history {request.history}: the result is written to this file"
        raise UsageError(Problem("bad-option", message, hint="name another file"))


def make_recipe(request: TuneRequest, tuning: TuningOptions) -> Recipe:
    """Make the recipe of all variants. Raises UsageError, SpecError."""
    options = Options(tolerance=require_tolerance(request.tolerance), reduce=not request.no_reduce)
    measures = tuning.measures
    return Recipe(tuning.path, read_text(tuning.path), measures, options, parse_overrides(request.set), request.case)


def run_search(request: TuneRequest, options: TuningOptions, evaluator: VariantEvaluator) -> Tuning:
    """Run the search until it ends or the time limit is reached.

    Raises UsageError, AxisError, SpecError; LimitError if no variant was solved in time.
    """
    task = make_task(request, options, evaluator)
    solver = TrialSolver(evaluator, request.jobs)
    with show_progress(request.quiet) as report:
        base_outcome = solver.solve_base()
        trials = Trials(task, solver, report)
        tuning = Tuning(trials, base_outcome)
        try:
            tuning.run()
        except timeout.TimeUp:
            trials.time_is_up = True
        if trials.time_is_up:  # the result is written even after the time limit
            timeout.disarm(late=True)
    if trials.time_is_up and trials.find_best() is None:
        message = "the time limit was reached before any variant was solved"
        raise LimitError(Problem("time-limit", message, hint="use a longer --time-limit"))
    return tuning


def require_result(results: TuneResults) -> None:
    """Raise SolveError if no variant could be solved."""
    if results.best is None:
        code, times = Counter(trial.failure.code for trial in results.history).most_common(1)[0]
        reason = next(trial.failure.text for trial in results.history if trial.failure.code == code)
        message = f"none of {len(results.history)} variants could be solved; {times} of them for this reason: {reason}"
        raise SolveError(Problem(code, message, hint="try heun run --set with one of them, or other bounds"))


def finish(request: TuneRequest, results: TuneResults, spec: Spec) -> int:
    """Print the warnings of the best variant; returns the exit code."""
    assert results.best is not None
    read = {problem.message for problem in spec.warnings}
    print_warnings(
        spec, None, request.quiet, later=[text for text in results.best.outcome.warnings if text not in read]
    )
    if results.ending == "time":
        return LIMIT_REACHED
    return NOT_GOOD if request.strict and results.ending != "converged" else 0


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


def format_command(options: TuningOptions, recipe: Recipe, results: TuneResults) -> str:
    """Format the command line that gives the measures of the best variant, to the bit."""
    words = ["heun", "run", recipe.path]
    if recipe.case is not None:
        words += ["--case", recipe.case]
    for name, value in {**recipe.overrides, **results.best_texts}.items():
        words += ["--set", f"{name}={format_value(value)}"]
    if recipe.options.tolerance is not None:
        words += ["--tolerance", repr(recipe.options.tolerance)]
    if not recipe.options.reduce:
        words += ["--no-reduce"]
    for text in (options.goal, *(condition.measure for condition in options.conditions)):
        words += ["--measure", text]
    return shlex.join(words)
