"""`heun find`: find where a measure meets a value, over an interval of a parameter."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Annotated

from heuncli.analyses.find.results import FindResults, IntervalFindings
from heuncli.analyses.find.study import find_meetings
from heuncli.analyses.variants.conditions import Comparison, parse_condition, resolve_condition
from heuncli.analyses.variants.evaluation import Recipe, VariantEvaluator
from heuncli.analyses.variants.measures import CachedEvaluator
from heuncli.analyses.variants.parameters import DesignVariable, parse_interval
from heuncli.analyses.variants.samples import Sample, make_sample
from heuncli.app.cli.documents import emit_document
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.options import (
    CASE,
    FORMAT,
    FORMATS,
    OUTPUT,
    QUIET,
    SET,
    SPEC,
    TIME_LIMIT,
    TOLERANCE,
    UNITS,
    Option,
)
from heuncli.app.cli.progress import show_progress
from heuncli.app.cli.solving import parse_overrides, require_tolerance
from heuncli.app.cli.target import choose_format, note_si_format, parse_units, require_other_file
from heuncli.app.cli.variant_workers import print_variant_warnings
from heuncli.app.commands.find.page import FindPage, make_document
from heuncli.base.errors import Problem, SolveError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.units import parse_unit
from heuncli.output.tables import measure
from heuncli.scene.file_format.source import read_text
from heuncli.study.model.options import Options
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.measure_uncertainty import find_unit


class FindRequest(NamedTuple):
    """The options and arguments of `heun find`."""

    spec: Annotated[str, SPEC]
    unknown: Annotated[
        str, Option((), "Parameter or dotted key, and the ends of its interval: n=500:6000rpm.", "NAME=A:B")
    ]
    condition: Annotated[
        str,
        Option(
            (), "A measure, =, <, <=, > or >=, and a value with its unit: 'max joints.main.force = 10 kN'.", "CONDITION"
        ),
    ]
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    scan: Annotated[
        int | None,
        Option(
            ("--scan",),
            "Number of values solved first. Default: 7; more values find crossings that lie closer together.",
            "N",
        ),
    ] = None
    evaluations: Annotated[int | None, Option(("--evaluations",), "Maximum number of variants. Default: 300.", "N")] = (
        None
    )
    tolerance: Annotated[float | None, TOLERANCE] = None
    format: Annotated[str | None, FORMAT] = None
    output: Annotated[str | None, OUTPUT] = None
    units: Annotated[str | None, UNITS] = None
    strict: Annotated[
        bool,
        Option(("--strict",), "Exit with 1 if the condition is met nowhere, or part of the interval is not solved."),
    ] = False
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False


DEFAULT_SCAN, DEFAULT_EVALUATIONS = 7, 300  # default numbers of variants: of the scan, in all
FORM = "expected MEASURE = VALUE, or <, >, <=, >= in place of ="
HINT = "for example 'max joints.main.force = 10 kN'"
MIN_SCAN = 4  # fewer values do not show a course
MAX_SCAN = 10_000


def main(request: FindRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = choose_format(request.format, request.output, FORMATS)
    interval, words = parse_interval(request.unknown), parse_condition(request.condition, FORM, HINT)
    measure_request = measure.parse_measure(words.measure)
    scan, max_variants = parse_counts(request)
    units_shown = parse_units(request.units)
    options = Options(tolerance=require_tolerance(request.tolerance))
    settings = parse_overrides(request.set)
    evaluator = VariantEvaluator(
        Recipe(request.spec, read_text(request.spec), (measure_request,), options, settings, request.case)
    )
    scenes = measure.check_with_others(
        [measure_request], evaluator.spec, [partial(evaluator.load_samples, interval)], "find"
    )[0]
    require_other_file(request.output, [request.spec])
    unit = find_unit(measure_request.path, evaluator.spec)
    condition = resolve_condition(words, unit, scenes, HINT)
    with show_progress(request.quiet) as report:
        cached = CachedEvaluator(evaluator.answer, lambda runs: report(min(runs, 2 * scan), 2 * scan, "variants"))
        sample_at = make_sampler(cached, interval, condition)
        findings = find_meetings(
            sample_at,
            interval.low,
            interval.high,
            condition.relation,
            scan_count=scan,
            max_evaluations=max_variants,
            value=condition.value,
        )
    require_known_measure(findings)
    page_units = units_shown if request.units else use_condition_unit(units_shown, condition)
    results = FindResults(evaluator.spec.title, condition, interval, findings, scan)
    emit_document(make_document(FindPage(results, page_units)), form, request.output)
    note_si_format(request.units, form, request.quiet)
    print_variant_warnings(evaluator.spec, cached, request.quiet)
    return int(request.strict and (not is_met(findings, condition) or bool(findings.unsolved_stretches)))


def parse_counts(request: FindRequest) -> tuple[int, int]:
    """Return the number of variants in the scan, and in all. Raises UsageError."""
    scan = DEFAULT_SCAN if request.scan is None else request.scan
    max_variants = max(DEFAULT_EVALUATIONS, 2 * scan) if request.evaluations is None else request.evaluations
    if not MIN_SCAN <= scan <= MAX_SCAN:
        message = f"--scan {scan}: expected {MIN_SCAN} to {MAX_SCAN:,}"
        raise UsageError(Problem("bad-option", message, hint="for example --scan 25"))
    if max_variants < scan:
        message = f"--evaluations {max_variants}: fewer than the {scan} values of the scan"
        raise UsageError(Problem("bad-option", message, hint=f"for example --evaluations {DEFAULT_EVALUATIONS}"))
    return scan, max_variants


def make_sampler(
    evaluator: CachedEvaluator, variable: DesignVariable, condition: Comparison
) -> Callable[[float], Sample]:
    """Make the function that samples the measure at a value of the unknown."""

    def sample_at(x: float) -> Sample:
        """Solve the variant of one value, and return the measure there."""
        result = evaluator.evaluate({variable.name: variable.make_value(x)})
        found = result.find_noisy_value(0, magnitude=abs(condition.value))
        return make_sample(x, found, condition.value, singular=result.singular)

    return sample_at


def require_known_measure(findings: IntervalFindings) -> None:
    """Raise SolveError if no variant has the measure."""
    if findings.least is None:
        stretch = findings.unsolved_stretches[0]
        message = f"none of the {len(findings.samples)} variants gives a result: {stretch.reason}"
        raise SolveError(
            Problem(stretch.code, message, hint="try another interval; heun run --set shows one variant in detail")
        )


def use_condition_unit(units_shown: Units, condition: Comparison) -> Units:
    """Return the display units with the measure in the unit in which its value was given."""
    if not condition.given_unit or not condition.unit:
        return units_shown
    size, of_si = parse_unit(condition.given_unit)[0], parse_unit(condition.unit)[0]
    return Units({**units_shown.display_units, condition.unit: (condition.given_unit, of_si / size)})


def is_met(findings: IntervalFindings, condition: Comparison) -> bool:
    """Return whether the condition is met anywhere."""
    if condition.side:
        return bool(findings.met_stretches) or (
            condition.includes_value and bool(findings.crossings or findings.touches)
        )
    return bool(findings.crossings or findings.touches)
