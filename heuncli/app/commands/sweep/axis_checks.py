"""Check the names and units of all axes before the first variant runs; all problems are reported at once.

Problems that depend on the size of a value (a negative mass, a loop that does not close) are not checked here: such a
variant gets the reason in its row.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress

from heuncli.analyses.variants.evaluation import SPELLING_CODES, VariantEvaluator, varies_cases
from heuncli.analyses.variants.parameters import CASE, format_value
from heuncli.analyses.variants.spec_numbers import SpecNumbers
from heuncli.app.commands.sweep.axes import AxisArgument
from heuncli.base.errors import Problem, SpecError
from heuncli.base.spelling import suggest
from heuncli.scene.file_format.parameters import parse_path

# Codes of problems that do not depend on a value's size, besides those that begin with unknown-.
NAME_CODES = frozenset({
    "no-such-key", "dimension", "wrong-dimension", "wrong-kind", "expression-syntax", "expression-limit",
    "function-arguments", "parameter-circle", "not-in-time", "not-yaml", "bad-character", "too-deep", "empty",
})  # fmt: skip
ONCE = "give one axis per parameter"


def find_problems(
    axes: Sequence[AxisArgument], evaluator: VariantEvaluator, overrides: Collection[str]
) -> list[Problem]:
    """Return the problems of the axes' names and units.

    overrides: names that --set sets in all variants
    """
    problems = list(_find_duplicates(axes, evaluator, overrides))
    for axis in axes if not problems else ():
        if axis.name == CASE and varies_cases(evaluator.spec):
            problems += _check_cases(axis, evaluator)
        elif axis.name == CASE and CASE not in evaluator.spec.parameters:
            problem = Problem(
                "no-such-key", "the spec has no load cases", hint="cases: {NAME: {set: {PARAMETER: VALUE}}}"
            )
            problems.append(axis.locate_problem(problem))
        else:
            problems += _check_values(axis, evaluator)
    return list(dict.fromkeys(problems))


def _find_duplicates(
    axes: Sequence[AxisArgument], evaluator: VariantEvaluator, overrides: Collection[str]
) -> Iterator[Problem]:
    """Yield parameters that two words vary, or that are both varied and set."""
    data = {"parameters": dict.fromkeys(evaluator.spec.parameters)}
    paths = [parse_path(axis.name, data) for axis in axes]
    fixed = [parse_path(name, data) for name in overrides]
    for k, axis in enumerate(axes):
        if paths[k] in paths[:k]:
            yield axis.locate_problem(Problem("bad-option", f"{axis.name} is varied twice", hint=ONCE))
        elif paths[k] in fixed:
            message = f"{axis.name} is varied, and set by --set"
            yield axis.locate_problem(Problem("bad-option", message, hint="leave one of them out"))


def _check_cases(axis: AxisArgument, evaluator: VariantEvaluator) -> Iterator[Problem]:
    """Yield load cases that do not exist."""
    known = evaluator.spec.cases
    for value, k in axis.list_samples().items():
        text = format_value(value)
        if text not in known and not axis.is_all_cases:
            hint = suggest(text, known, "cases")
            yield axis.locate_problem(Problem("unknown-case", f"there is no load case '{text}'", hint=hint), k)


def _check_values(axis: AxisArgument, evaluator: VariantEvaluator) -> Iterator[Problem]:
    """Yield the problems of an axis that do not depend on the size of its values, at the first location of each
    kind.
    """
    for value, k in axis.list_samples().items():
        try:
            evaluator.load({axis.name: value})
        except SpecError as error:
            relevant = [each for each in error.problems if each.code in NAME_CODES or each.code.startswith("unknown-")]
            count_text = f"; {len(relevant)} places in all" if len(relevant) > 1 else ""
            for problem in relevant[:1]:
                extended = problem._replace(message=problem.message + count_text)
                yield axis.locate_problem(extended, None if problem.code == "no-such-key" else k)


def find_warnings(axes: Sequence[AxisArgument], evaluator: VariantEvaluator) -> list[str]:
    """Return warnings about the axes, one sentence each, before their variants are solved."""
    warnings = []
    for axis in axes:
        for value, k in axis.list_samples().items():
            with suppress(SpecError):
                spec = evaluator.load({axis.name: value})
                located = [
                    axis.locate_problem(problem, k) for problem in spec.warnings if problem.code in SPELLING_CODES
                ]
                warnings += [str(problem._replace(hint=_make_unit_hint(axis, evaluator))) for problem in located]
    unused = evaluator.find_unused_parameters([axis.name for axis in axes])
    warnings += [f"{axis.word}: {axis.name} has no effect" for axis in axes if axis.name in unused]
    return list(dict.fromkeys(warnings))


def _make_unit_hint(axis: AxisArgument, evaluator: VariantEvaluator) -> str:
    unit = SpecNumbers(evaluator.recipe, evaluator.spec).find_number(axis.name).unit
    return (
        f"in the head of the column: {axis.name} [{unit}]"
        if axis.column is not None
        else f"with the unit: {axis.word}{unit}"
    )
