"""What is varied as it was given: words of the command line and columns of a table, every value with its place."""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.analyses.variants.axes import Drawn, ParameterAxis, axis_of, figure_of, text_of
from heuncli.base.errors import Problem, SourceLocation
from heuncli.base.named_tuples import NamedTuple

MOST_SAMPLES = 1000  # of an axis: each is read twice before the first variant runs


class GivenColumn(NamedTuple):
    """A column of a table of variants: its file, where its head stands, and each of its cells (line, column from 1)."""

    file: str
    head: tuple[int, int]
    cells: Sequence[tuple[int, int]]


class GivenAxis(NamedTuple):
    """An axis, and the word of the command line or the column that asks for it."""

    axis: ParameterAxis | Drawn
    word: str
    column: GivenColumn | None = None

    @property
    def name(self) -> str:
        """What is varied."""
        return self.axis.name

    @property
    def texts(self) -> Sequence[str]:
        """Its values; of what is drawn one that is like them."""
        axis = self.axis
        return (text_of(axis.a, axis.unit),) if isinstance(axis, Drawn) else axis.texts

    def samples(self) -> dict[str, int]:
        """By text, and with its place among the values, one of each kind: a number of each unit, and all else."""
        seen: set[str] = set()
        found: dict[str, int] = {}
        for k, text in enumerate(self.texts):
            figure = figure_of(text)
            kind = f"number {figure.unit}" if figure is not None else text
            if kind not in seen:
                seen.add(kind)
                found[text] = k
                if len(found) >= MOST_SAMPLES:
                    break
        return found

    def told(self, problem: Problem, k: int | None = None) -> Problem:
        """A problem of its k-th value, or of its name, at its place."""
        if self.column is None:
            place, where = None, f"{self.word}: "
        else:
            line, column = self.column.head if k is None else self.column.cells[k]
            place, where = SourceLocation(self.column.file, line, column, self.name), ""
        at = problem.location
        entered = f"at {at}: {at.path}: " if at is not None and not at.file.startswith("--set ") else ""
        return Problem(problem.code, f"{where}{entered}{problem.message}", place, problem.hint)


def of_word(word: str) -> GivenAxis:
    """What one word of the command line asks for. Raises AxisError."""
    return GivenAxis(axis_of(word), word)
