"""`heun find`: where a measure meets a value, over an interval of a parameter."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from heuncli.analyses.find.results import CourseFindings, FindCondition
from heuncli.analyses.find.study import SIDES, look
from heuncli.analyses.variants.asking import Asker, Recipe
from heuncli.analyses.variants.axes import Interval, interval_of
from heuncli.analyses.variants.conditions import condition_of, in_si
from heuncli.analyses.variants.course import Sample
from heuncli.analyses.variants.once import REASONS, ROUNDING, AnswersOnce
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.options import FORMATS
from heuncli.app.cli.output import emit
from heuncli.app.cli.progress import progress
from heuncli.app.cli.solving import overrides, tolerance
from heuncli.app.cli.target import format_of
from heuncli.app.cli.units import say_what_stays, units
from heuncli.app.cli.variant_warnings import warn_of_variants
from heuncli.app.commands.find.page import FORMS, FoundPage
from heuncli.app.commands.find.request import FindRequest
from heuncli.base.errors import Problem, SolveError
from heuncli.base.units import parse_unit
from heuncli.output.snapshots import measure
from heuncli.scene.file_format.source import text_in
from heuncli.study.model.options import Options
from heuncli.study.quantities.stated import unit_of
from heuncli.study.quantities.table_units import Units

SCAN, MOST = 7, 300  # variants of the scan, and in all, where it is not said
FORM = "expected MEASURE = VALUE, or <, >, <=, >= between the two"
HINT = "such as 'max joints.main.force = 10 kN'"
LEAST_SCAN = 4  # places: fewer tell of no course
MOST_SCAN = 10_000


def main(request: FindRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = format_of(request.format, request.output, FORMATS)
    interval, words = interval_of(request.unknown), condition_of(request.condition, FORM, HINT)
    asked = measure.parse(words.measure)
    scan, most = counts(request)
    shown = units(request.units)
    options = Options(tolerance=tolerance(request.tolerance))
    given = overrides(request.set)
    asker = Asker(Recipe(request.spec, text_in(request.spec), (asked,), options, given, request.case))
    scenes = measure.known([asked], asker.spec, [partial(asker.scenes, interval)], "find")[0]
    require_other_file(request.output, [request.spec])
    unit = unit_of(asked.path, asker.spec)
    value = in_si(words, unit, scenes, HINT)
    condition = FindCondition(words.measure, words.sign, value, unit, words.unit)
    with progress(request.quiet) as tell:
        once = AnswersOnce(asker, lambda runs: tell(min(runs, 2 * scan), 2 * scan, "variants"))
        ask = asking(once, interval, condition)
        found = look(ask, interval.low, interval.high, condition.relation, count=scan, most=most, value=value)
    require_some(found)
    own = shown if request.units else in_unit(shown, condition)
    page = FoundPage(asker.spec.title, condition, interval, found, scan, most, own)
    emit(FORMS[form](page), request.output)
    say_what_stays(request.units, form, request.quiet)
    warn_of_variants(asker.spec, once, request.quiet)
    return int(request.strict and (not is_met(found, condition) or bool(found.unsolved)))


def counts(request: FindRequest) -> tuple[int, int]:
    """How many variants are in the scan, and at most in all. Raises UsageError."""
    scan = SCAN if request.scan is None else request.scan
    most = max(MOST, 2 * scan) if request.evaluations is None else request.evaluations
    if not LEAST_SCAN <= scan <= MOST_SCAN:
        message = f"--scan {scan}: accepted: {LEAST_SCAN} to {MOST_SCAN:,}"
        raise UsageError(Problem("bad-option", message, hint="such as --scan 25"))
    if most < scan:
        message = f"--evaluations {most}: fewer than the {scan} of the scan"
        raise UsageError(Problem("bad-option", message, hint=f"such as --evaluations {MOST}"))
    return scan, most


def asking(once: AnswersOnce, interval: Interval, condition: FindCondition) -> Callable[[float], Sample]:
    """What is known of the measure at a value of the unknown."""

    def ask(x: float) -> Sample:
        answer = once.of({interval.name: interval.text(x)})
        if answer.code:
            return Sample(x, None, why=(answer.code, answer.reason))
        (found,) = answer.measures
        if found.value is None:
            return Sample(x, None, why=(found.word, REASONS[found.word]))
        rounding = ROUNDING * (abs(found.value) + abs(condition.value))
        error = max(found.error or 0.0, rounding)
        return Sample(x, found.value - condition.value, error, singular=answer.singular)

    return ask


def require_some(found: CourseFindings) -> None:
    """Raise SolveError where no variant has the measure."""
    if found.least is None:
        stretch = found.unsolved[0]
        message = f"the measure is known in none of the {len(found.samples)} variants: {stretch.reason}"
        raise SolveError(
            Problem(stretch.code, message, hint="another interval; heun run --set tells more of one variant")
        )


def in_unit(shown: Units, condition: FindCondition) -> Units:
    """Units in which the measure is told: that in which its value was given."""
    if not condition.own or not condition.unit:
        return shown
    size, of_si = parse_unit(condition.own)[0], parse_unit(condition.unit)[0] if condition.unit != "1" else 1.0
    return Units({**shown.shown, condition.unit: (condition.own, of_si / size)})


def is_met(found: CourseFindings, condition: FindCondition) -> bool:
    """Whether the condition is met anywhere."""
    if SIDES[condition.relation]:
        return bool(found.met) or ("=" in condition.relation and bool(found.crossings or found.touches))
    return bool(found.crossings or found.touches)
