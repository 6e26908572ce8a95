"""The axes of a sweep, each value with its place: words of the command line, or columns of the table `--variants FILE`.

Names and units of all axes are checked before the first variant runs, and all problems reported at once. Problems that
depend on the size of a value (a negative mass, a loop that does not close) are not checked here: such a variant gets
the reason in its row.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress

from heuncli.analyses.variants.evaluation import SPELLING_CODES, VariantEvaluator, varies_cases
from heuncli.analyses.variants.parameters import CASE, ParameterAxis, RandomVariable, format_value, parse_axis_values
from heuncli.analyses.variants.spec_numbers import SpecNumbers
from heuncli.app.cli.entry import UsageError
from heuncli.base.errors import Problem, SourceLocation, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import suggest
from heuncli.scene.file_format.names import ALL_CASES
from heuncli.scene.file_format.parameters import parse_path
from heuncli.scene.file_format.quantity import NumberWithUnit, ParameterValue, parse_number_with_unit

MAX_SAMPLES = 1000  # of an axis; each is read twice before the first variant runs


class AxisColumn(NamedTuple):
    """A column of a table of variants: its file, and the location of its head and of each cell (line, column from
    1).
    """

    file: str
    head: tuple[int, int]
    cells: Sequence[tuple[int, int]]


class AxisArgument(NamedTuple):
    """An axis, and the word of the command line or the column that defines it."""

    parameter: ParameterAxis | RandomVariable
    word: str
    column: AxisColumn | None = None

    @property
    def name(self) -> str:
        """Name of the parameter."""
        return self.parameter.name

    @property
    def is_all_cases(self) -> bool:
        """Whether it is the word `case=all`."""
        if self.name != CASE or self.column is not None or isinstance(self.parameter, RandomVariable):
            return False
        return [*self.parameter.values] == [ALL_CASES]

    def list_samples(self) -> dict[ParameterValue, int]:
        """Return one value of each kind (numbers of each unit, and all other texts), with its index among the values;
        of a random variable one typical value.
        """
        parameter = self.parameter
        if isinstance(parameter, RandomVariable):
            return {NumberWithUnit(parameter.a, parameter.unit): 0}
        if parameter.unit is not None:
            return {parameter.find_value(0): 0}
        known_kinds: set[str] = set()
        samples: dict[ParameterValue, int] = {}
        for k, value in enumerate(parameter.values):
            text = str(value)
            number = parse_number_with_unit(text)
            kind = f"number {number.unit}" if number is not None else text
            if kind not in known_kinds:
                known_kinds.add(kind)
                samples[text] = k
                if len(samples) >= MAX_SAMPLES:
                    break
        return samples

    def locate_problem(self, problem: Problem, k: int | None = None) -> Problem:
        """Return a problem of the k-th value, or of the name, with its location."""
        if self.column is None:
            place, prefix = None, f"{self.word}: "
        else:
            line, column = self.column.head if k is None else self.column.cells[k]
            place, prefix = SourceLocation(self.column.file, line, column, self.name), ""
        inner_location = problem.location
        inner_text = (
            f"at {inner_location}: {inner_location.path}: "
            if inner_location is not None and not inner_location.file.startswith("--set ")
            else ""
        )
        return Problem(problem.code, f"{prefix}{inner_text}{problem.message}", place, problem.hint)


def parse_axis(word: str) -> AxisArgument:
    """Parse one word of the command line. Raises AxisError."""
    return AxisArgument(parse_axis_values(word), word)


def parse_shard(word: str | None) -> tuple[int, int]:
    """Return the number of the part, and of how many. Raises UsageError."""
    if word is None:
        return 1, 1
    k, slash, n = word.partition("/")
    numbers = [int(text) for text in (k, n) if text.isascii() and text.isdecimal() and len(text) < 10]
    if not slash or len(numbers) < 2 or not 1 <= numbers[0] <= numbers[1]:
        message = f"--shard {word}: expected K/N, the K-th part of N"
        raise UsageError(Problem("bad-option", message, hint="for example --shard 2/8; the last is 8/8"))
    return numbers[0], numbers[1]


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
    """Say where the unit of an axis is given."""
    unit = SpecNumbers(evaluator.recipe, evaluator.spec).find_number(axis.name).unit
    return (
        f"in the head of the column: {axis.name} [{unit}]"
        if axis.column is not None
        else f"with the unit: {axis.word}{unit}"
    )
