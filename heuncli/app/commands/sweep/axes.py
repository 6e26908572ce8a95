"""The axes of a sweep, each value with its place: words of the command line, or columns of a table of variants."""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.analyses.variants.parameters import (
    CASE,
    ParameterAxis,
    RandomVariable,
    parse_axis_values,
)
from heuncli.app.cli.entry import UsageError
from heuncli.base.errors import Problem, SourceLocation
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.names import ALL_CASES
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
        axis = self.parameter
        if isinstance(axis, RandomVariable):
            return {NumberWithUnit(axis.a, axis.unit): 0}
        if axis.unit is not None:
            return {axis.find_value(0): 0}
        known_kinds: set[str] = set()
        samples: dict[ParameterValue, int] = {}
        for k, value in enumerate(axis.values):
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
