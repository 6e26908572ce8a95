"""`heun sensitivity`: what measures hang on, and what tolerances make of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from heuncli.analyses.sensitivity.derivative import derivative
from heuncli.analyses.sensitivity.results import NoisyDerivative, NoisyValue
from heuncli.analyses.sensitivity.spread import NumberSpread, summed
from heuncli.analyses.sensitivity.spread_words import spreads_of
from heuncli.analyses.variants.asking import Asker, Measured, Recipe
from heuncli.analyses.variants.once import REASONS, ROUNDING, AnswersOnce
from heuncli.analyses.variants.written import WrittenNumber, WrittenNumbers
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.options import FORMATS
from heuncli.app.cli.output import emit
from heuncli.app.cli.progress import progress
from heuncli.app.cli.solving import all_or_errors, overrides, tolerance
from heuncli.app.cli.target import format_of
from heuncli.app.cli.units import say_what_stays, units
from heuncli.app.cli.variant_warnings import warn_of_variants
from heuncli.app.commands.sensitivity.page import FORMS, MeasureFindings, SensitivityPage
from heuncli.app.commands.sensitivity.request import SensitivityRequest
from heuncli.base.errors import Problem
from heuncli.output.snapshots import measure
from heuncli.scene.file_format.source import text_in
from heuncli.study.model.options import Options
from heuncli.study.quantities.stated import unit_of

USUAL = 10  # variants for each number, mostly
NO_ERROR = ("no-error", "the run states no error of it, as of what is counted: no step could be chosen")


def main(request: SensitivityRequest) -> int:
    """Run the command; returns the exit code."""
    path, names = spec_and_names(request.words)
    require_other_file(request.output, [path])
    form = format_of(request.format, request.output, FORMATS)
    shown = units(request.units)
    asker = Asker(recipe_of(request, path))
    recipe, spec = asker.recipe, asker.spec
    require_other_file(request.output, [path])
    written = WrittenNumbers(recipe, spec)
    measure.known(recipe.measures, spec, [partial(written.named, name) for name in names])
    spreads = spreads_of(request.spread, written) if request.spread is not None else []
    numbers = asked_numbers(names, spreads, written)
    # a value of another dimension, or none that may be set
    all_or_errors(partial(asker.load, {number.name: number.text(number.value)}) for number in numbers)
    texts = zip(request.measure, recipe.measures, strict=True)
    heads = [(text, unit_of(asked.path, spec)) for text, asked in texts]
    most = 1 + USUAL * len(numbers)
    with progress(request.quiet) as tell:
        once = AnswersOnce(asker, lambda runs: tell(min(runs, most), most, "variants"))
        if once.of({}).code:
            asker.study({})  # raises its own error, with its place
        found = [findings(once, (k, unit), numbers, spreads) for k, (_, unit) in enumerate(heads)]
    page = SensitivityPage(spec.title, tuple(numbers), tuple(heads), tuple(found), once.runs, shown)
    emit(FORMS[form](page), request.output)
    say_what_stays(request.units, form, request.quiet)
    warn_of_variants(spec, once, request.quiet)
    return int(request.strict and any(one.kind == "refused" for each in found for one in each.slopes.values()))


def spec_and_names(words: Sequence[str]) -> tuple[str, list[str]]:
    """The spec's file, and what its measures may hang on. Raises UsageError."""
    if not words:
        hint = "heun sensitivity SPEC [NAME...] --measure WHAT"
        raise UsageError(Problem("bad-option", "sensitivity: no spec is named", hint=hint))
    for word in words[1:]:
        if "=" in word:
            hint = f"the name alone; --set {word} sets it"
            raise UsageError(Problem("bad-option", f"sensitivity: {word}: expected a parameter", hint=hint))
    return words[0], list(dict.fromkeys(words[1:]))


def recipe_of(request: SensitivityRequest, path: str) -> Recipe:
    """What every variant is made of. Raises UsageError, SpecError."""
    if not request.measure:
        hint = "such as --measure 'max abs joints.main.force'"
        raise UsageError(Problem("bad-option", "sensitivity: nothing is measured", hint=hint))
    options = Options(tolerance=tolerance(request.tolerance))
    measures = tuple(measure.parse_all(request.measure))
    return Recipe(path, text_in(path), measures, options, overrides(request.set), request.case)


def asked_numbers(
    names: Sequence[str], spreads: Sequence[NumberSpread], written: WrittenNumbers
) -> list[WrittenNumber]:
    """The numbers that are named, and those with a spread; where there are none, all parameters."""
    found = {name: written.named(name) for name in names} | {each.number.name: each.number for each in spreads}
    numbers = [*found.values()] or list(written.all())
    if not numbers:
        message = "sensitivity: the spec has no parameters that are numbers"
        raise UsageError(Problem("bad-option", message, hint="name a dotted key, such as bodies.crank.mass"))
    return numbers


def findings(
    once: AnswersOnce, which: tuple[int, str], numbers: Sequence[WrittenNumber], spreads: Sequence[NumberSpread]
) -> MeasureFindings:
    """What one measure, by its place and its unit, hangs on."""
    ask = asking(once, which, {number.name: number for number in numbers})
    slopes = {number.name: slope_of(ask, number) for number in numbers}
    total = summed(ask, spreads, slopes) if spreads else None
    return MeasureFindings(ask({}), slopes, total)


def slope_of(ask: Callable[[Mapping[str, float]], NoisyValue], number: WrittenNumber) -> NoisyDerivative:
    """The derivative by one number; one that is 0 is taken to matter over its unit."""
    return derivative(lambda x: ask({number.name: x} if x else {}), number.value, abs(number.value) or 1.0)


def asking(
    once: AnswersOnce, which: tuple[int, str], numbers: Mapping[str, WrittenNumber]
) -> Callable[[Mapping[str, float]], NoisyValue]:
    """A measure, by its place and its unit (empty: it is counted), at distances of numbers from their values."""

    def ask(distances: Mapping[str, float]) -> NoisyValue:
        values = {name: numbers[name].text(numbers[name].value + x) for name, x in distances.items()}
        answer = once.of(values)
        if answer.code:
            return NoisyValue(None, why=(answer.code, answer.reason))
        return noisy(answer.measures[which[0]], which[1])

    return ask


def noisy(found: Measured, unit: str) -> NoisyValue:
    """A measure with its error, not below its rounding."""
    if found.value is None:
        return NoisyValue(None, why=(found.word, REASONS[found.word]))
    if not unit:
        return NoisyValue(None, why=NO_ERROR)
    return NoisyValue(found.value, max(found.error or 0.0, ROUNDING * abs(found.value)))
