"""`heun sensitivity`: derivatives of measures by parameters, and the effect of tolerances on them."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Annotated

from heuncli.analyses.sensitivity import NoisyDerivative, compute_derivative
from heuncli.analyses.tolerance_analysis import NumberSpread, combine_tolerances, parse_spreads
from heuncli.analyses.variants.evaluation import Recipe, VariantEvaluator
from heuncli.analyses.variants.measures import CachedEvaluator, KnownResults, MeasureLabel, NoisyValue, Reason
from heuncli.analyses.variants.spec_numbers import SpecNumber, SpecNumbers
from heuncli.app.cli import jobs, timeout
from heuncli.app.cli.documents import emit_document
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.options import CASE, FORMAT, FORMATS, OUTPUT, QUIET, SET, TIME_LIMIT, TOLERANCE, UNITS, Option
from heuncli.app.cli.progress import show_progress
from heuncli.app.cli.solving import collect_results, parse_overrides, require_tolerance
from heuncli.app.cli.target import choose_format, note_si_format, parse_units, require_other_file
from heuncli.app.cli.variant_workers import choose_job_count, print_variant_warnings, require_job_count, solve_contained
from heuncli.app.commands.sensitivity.page import MeasureFindings, SensitivityPage, make_document
from heuncli.base.errors import Problem, SolveError
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.tables import measure
from heuncli.scene.file_format.source import read_text
from heuncli.study.model.options import Options
from heuncli.study.queries.measure_uncertainty import find_unit


class SensitivityRequest(NamedTuple):
    """The options and arguments of `heun sensitivity`."""

    words: Annotated[
        tuple[str, ...],
        Option(
            (),
            "YAML file of the spec, and parameters or dotted keys. Default: all parameters given as numbers.",
            "SPEC NAME...",
            completes="spec",
        ),
    ]
    measure: Annotated[
        tuple[str, ...],
        Option(
            ("--measure",),
            "Result to differentiate: 'max abs sections.middle.M1', 'final energy.kinetic'. May be repeated.",
            "WHAT",
            completes="measure",
        ),
    ] = ()
    spread: Annotated[
        str | None,
        Option(
            ("--spread",), "Tolerances (±) of parameters; show their combined effect on the results.", "NAME=VALUE,..."
        ),
    ] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    tolerance: Annotated[float | None, TOLERANCE] = None
    format: Annotated[str | None, FORMAT] = None
    output: Annotated[str | None, OUTPUT] = None
    units: Annotated[str | None, UNITS] = None
    jobs: Annotated[
        int | None, Option(("--jobs", "-j"), "Number of processes; each solves the variants of one parameter.", "N")
    ] = None
    strict: Annotated[bool, Option(("--strict",), "Exit with 1 if a derivative cannot be given.")] = False
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False


VARIANTS_PER_NUMBER = 10  # usual number
NO_ERROR = Reason("no-error", "the run states no error for it (as for counts), so no step can be chosen")


def main(request: SensitivityRequest) -> int:
    """Run the command; returns the exit code."""
    path, names = parse_words(request.words)
    require_other_file(request.output, [path])
    form = choose_format(request.format, request.output, FORMATS)
    units_shown = parse_units(request.units)
    evaluator = VariantEvaluator(make_recipe(request, path))
    recipe, spec = evaluator.recipe, evaluator.spec
    require_other_file(request.output, [path])
    written = SpecNumbers(recipe, spec)
    measure.check_with_others(recipe.measures, spec, [partial(written.find_number, name) for name in names])
    spreads = parse_spreads(request.spread, written) if request.spread is not None else []
    numbers = select_numbers(names, spreads, written)
    # raises SpecError for a wrong dimension, or a key that cannot be set
    collect_results(partial(evaluator.load, {number.name: number.make_value(number.value)}) for number in numbers)
    texts = zip(request.measure, recipe.measures, strict=True)
    heads = [MeasureLabel(text, find_unit(measure_request.path, spec)) for text, measure_request in texts]
    variant_count = 1 + VARIANTS_PER_NUMBER * len(numbers)
    with show_progress(request.quiet) as report:
        cached = CachedEvaluator(
            evaluator.answer, lambda runs: report(min(runs, variant_count), variant_count, "variants")
        )
        start = time.perf_counter()
        if cached.evaluate({}).code:
            evaluator.solve({})  # raises the error with its location
        job_count = choose_job_count(request.jobs, len(numbers), time.perf_counter() - start)
        solve_ahead(cached, evaluator, heads, numbers, job_count)
        all_findings = [analyse_measure(cached, k, head, numbers, spreads) for k, head in enumerate(heads)]
    page = SensitivityPage(spec.title, tuple(numbers), tuple(heads), tuple(all_findings), cached.runs, units_shown)
    emit_document(make_document(page), form, request.output)
    note_si_format(request.units, form, request.quiet)
    print_variant_warnings(spec, cached, request.quiet)
    return int(request.strict and any(one.kind == "refused" for each in all_findings for one in each.slopes.values()))


def solve_ahead(
    cached: CachedEvaluator,
    evaluator: VariantEvaluator,
    heads: Sequence[MeasureLabel],
    numbers: Sequence[SpecNumber],
    job_count: int,
) -> None:
    """Solve the variants that the derivatives need, those of one number in the same process, and cache their results.

    The order of the results does not depend on the number of processes. Raises SolveError if a process died.
    """

    def solve_for(number: SpecNumber, results: CachedEvaluator) -> None:
        """Solve all variants that the derivatives by one number need."""
        for k, head in enumerate(heads):
            compute_slope(make_evaluation(results, k, head, {number.name: number}), number)

    def solve_in_worker(number: SpecNumber) -> KnownResults:
        """Do the same in a process of its own; returns the results."""
        worker_results = CachedEvaluator(
            lambda values: solve_contained(evaluator, values, "sensitivity", timeout.remaining_time())
        )
        worker_results.add_known(cached.known)
        solve_for(number, worker_results)
        return worker_results.known

    def refuse(number: SpecNumber, death: jobs.ProcessDeath) -> KnownResults:
        """Raise SolveError: the process of a number died."""
        raise SolveError(death.make_problem(f"solved the variants of {number.name}", "try --jobs 1"))

    if job_count == 1:
        for number in numbers:
            solve_for(number, cached)
        return
    for known in jobs.run_in_order(solve_in_worker, numbers, job_count, refuse):
        cached.add_known(known)


def parse_words(words: Sequence[str]) -> tuple[str, list[str]]:
    """Return the spec's file, and the names of the numbers. Raises UsageError."""
    if not words:
        hint = "heun sensitivity SPEC [NAME...] --measure WHAT"
        raise UsageError(Problem("bad-option", "sensitivity: no spec is given", hint=hint))
    for word in words[1:]:
        if "=" in word:
            hint = f"give the name only; --set {word} sets it"
            raise UsageError(Problem("bad-option", f"sensitivity: {word}: expected a parameter", hint=hint))
    return words[0], list(dict.fromkeys(words[1:]))


def make_recipe(request: SensitivityRequest, path: str) -> Recipe:
    """Make the recipe of all variants. Raises UsageError, SpecError."""
    if not request.measure:
        hint = "for example --measure 'max abs joints.main.force'"
        raise UsageError(Problem("bad-option", "sensitivity: no --measure is given", hint=hint))
    require_job_count(request.jobs)
    options = Options(tolerance=require_tolerance(request.tolerance))
    measures = tuple(measure.parse_measures(request.measure))
    return Recipe(path, read_text(path), measures, options, parse_overrides(request.set), request.case)


def select_numbers(
    names: Sequence[str], spreads: Sequence[NumberSpread], spec_numbers: SpecNumbers
) -> list[SpecNumber]:
    """Return the named numbers and those with a tolerance; if there are none, all parameters."""
    by_name = {name: spec_numbers.find_number(name) for name in names} | {
        each.number.name: each.number for each in spreads
    }
    numbers = [*by_name.values()] or list(spec_numbers.iter_parameters())
    if not numbers:
        message = "sensitivity: the spec has no numeric parameters"
        raise UsageError(Problem("bad-option", message, hint="give a dotted key, such as bodies.crank.mass"))
    return numbers


def analyse_measure(
    evaluator: CachedEvaluator,
    index: int,
    label: MeasureLabel,
    numbers: Sequence[SpecNumber],
    spreads: Sequence[NumberSpread],
) -> MeasureFindings:
    """Compute derivatives and tolerance effects of one measure."""
    evaluate = make_evaluation(evaluator, index, label, {number.name: number for number in numbers})
    slopes = {number.name: compute_slope(evaluate, number) for number in numbers}
    total = combine_tolerances(evaluate, spreads, slopes) if spreads else None
    return MeasureFindings(evaluate({}), slopes, total)


def compute_slope(evaluate: Callable[[Mapping[str, float]], NoisyValue], number: SpecNumber) -> NoisyDerivative:
    """Compute the derivative by one number; a number that is 0 is varied on the scale of its unit."""
    return compute_derivative(lambda x: evaluate({number.name: x} if x else {}), number.value, abs(number.value) or 1.0)


def make_evaluation(
    evaluator: CachedEvaluator, index: int, label: MeasureLabel, numbers: Mapping[str, SpecNumber]
) -> Callable[[Mapping[str, float]], NoisyValue]:
    """Make the function that evaluates a measure at distances of numbers from their values.

    label: if its unit is empty the measure is a count, for which a run states no error
    """

    def evaluate_at(distances: Mapping[str, float]) -> NoisyValue:
        """Evaluate the measure where the numbers have these distances from their values."""
        values = {name: numbers[name].make_value(numbers[name].value + x) for name, x in distances.items()}
        found = evaluator.evaluate(values).find_noisy_value(index)
        return found if label.unit or found.value is None else NoisyValue(None, why=NO_ERROR)

    return evaluate_at
