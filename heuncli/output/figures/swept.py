"""The rows of a sweep as columns of numbers, and what of them is drawn: which variable runs across, which are held.

Words pick: NAME=VALUE holds a variable, the name of a variable lays it across, that of a measure (or a part of it that
only one has) draws it alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import compress

import numpy as np

from heuncli.analyses.variants.axes import figure_of
from heuncli.base import tolerances
from heuncli.base.foreign_text import shown
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.nearest import did_you_mean
from heuncli.output.figures.refusals import NotDrawable
from heuncli.results.results import Array, Mask

APART = 0.8  # of the rows: a variable with more values than that is no axis of a grid, where there are several such
FEWEST = 4  # rows by which that is seen


class SweptVariable(NamedTuple):
    """What is varied: its name, its unit (empty: SI), its values (n,): numbers, or places among `texts`."""

    name: str
    unit: str
    values: Array
    texts: tuple[str, ...] = ()

    @property
    def head(self) -> str:
        """What an axis says of it."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    @property
    def levels(self) -> Array:
        """Its values, each once, ascending."""
        return np.unique(self.values)

    def word(self, value: float) -> str:
        """A value in words."""
        if self.texts:
            return self.texts[int(value)]
        return f"{value:.6g} {self.unit}".rstrip()


class SweptNumbers(NamedTuple):
    """A measure in each row (n,), in SI, nan where there is none; errors as the runs state them, 0 where none.

    lost: in each row of a solved variant why there is none, else empty.
    """

    text: str
    unit: str
    values: Array
    errors: Array
    lost: tuple[str, ...]


class SweptTable(NamedTuple):
    """A sweep: what is varied, what was measured; planned: variants, where that is known.

    codes: of each row that of what could not be solved, else empty.
    random: whether the variables were drawn, or listed row by row; None where the rows have to tell.
    """

    title: str
    origin: str
    variables: tuple[SweptVariable, ...]
    measures: tuple[SweptNumbers, ...]
    codes: tuple[str, ...]
    planned: int | None
    random: bool | None = None

    @property
    def rows(self) -> int:
        """How many there are."""
        return len(self.codes)


class PickedTable(NamedTuple):
    """What is drawn of a sweep: its rows, the variables that vary in them, that across first if it was named; words."""

    table: SweptTable
    varied: tuple[SweptVariable, ...]
    named: bool
    held: tuple[str, ...]

    @property
    def scattered(self) -> bool:
        """Whether there are no axes, but places at random."""
        if len(self.varied) < 2:
            return bool(self.table.random) and bool(self.varied)
        if self.table.random is not None:
            return self.table.random
        rows = self.table.rows
        return rows >= FEWEST and sum(len(one.levels) >= APART * rows for one in self.varied) >= 2


def picked(table: SweptTable, words: Sequence[str]) -> PickedTable:
    """What some words pick of a sweep. Raises NotDrawable."""
    kept = np.ones(table.rows, dtype=bool)
    across: str | None = None
    measures: list[SweptNumbers] = []
    for word in words:
        name, equals, value = word.partition("=")
        variable = next((one for one in table.variables if one.name == name.strip()), None)
        if equals and variable is not None:
            kept &= _held(variable, value.strip())
        elif variable is not None:
            across = variable.name
        else:
            measures.append(_measure(table, word))
    own = _of_rows(table._replace(measures=tuple(measures) or table.measures), kept)
    varied = [one for one in own.variables if len(one.levels) > 1]
    varied.sort(key=lambda one: one.name != across)
    if across is not None and across not in [one.name for one in varied]:
        raise NotDrawable(f"{across} has one value in what is drawn", "name another to run across, or hold fewer")
    held = tuple(f"{one.name} = {one.word(one.values[0])}" for one in own.variables if len(one.levels) == 1)
    return PickedTable(own, tuple(varied), across is not None, held)


def _held(variable: SweptVariable, text: str) -> Mask:
    """The rows in which a variable has a value."""
    if variable.texts:
        found = np.array([variable.texts[int(k)] == text for k in variable.values], dtype=bool)
    else:
        figure = figure_of(text)
        if figure is None or figure.unit not in ("", variable.unit):
            unit = f" in {variable.unit}" if variable.unit else ""
            raise NotDrawable(f"{variable.name}={text}: expected a number{unit}", f"such as {example(variable)}")
        found = np.isclose(variable.values, figure.value, rtol=tolerances.SAME_VALUE, atol=0.0)
    if not found.any():
        raise NotDrawable(f"{variable.name}={text}: no variant has this value", f"such as {example(variable)}")
    return np.asarray(found)


def example(variable: SweptVariable) -> str:
    """A value that is there, as it is typed: NAME=VALUE."""
    levels = variable.levels
    if variable.texts:
        return f"{variable.name}={shown(variable.texts[int(levels[0])])}"
    return f"{variable.name}={levels[len(levels) // 2]:.12g}"


def _measure(table: SweptTable, word: str) -> SweptNumbers:
    """The measure that a word names, or a part of whose words it is."""
    exact = [one for one in table.measures if word == one.text]
    found = exact or [one for one in table.measures if word in one.text]
    if len(found) == 1:
        return found[0]
    names = [one.name for one in table.variables] + [one.text for one in table.measures]
    if found:
        raise NotDrawable(f"{word}: {len(found)} measures have this in their words", f"name one: {found[0].text}")
    hint = did_you_mean(word, names, "columns") or f"there are: {', '.join(names)}"
    raise NotDrawable(f"{word}: no column of the sweep has this name", hint)


def _of_rows(table: SweptTable, kept: Mask) -> SweptTable:
    """Some of the rows."""
    if kept.all():
        return table
    variables = tuple(_of_texts(one._replace(values=one.values[kept])) for one in table.variables)
    measures = tuple(
        one._replace(values=one.values[kept], errors=one.errors[kept], lost=tuple(compress(one.lost, kept)))
        for one in table.measures
    )
    return table._replace(
        variables=variables, measures=measures, codes=tuple(compress(table.codes, kept)), planned=None
    )


def _of_texts(variable: SweptVariable) -> SweptVariable:
    """The variable with those of its texts that occur."""
    if not variable.texts:
        return variable
    levels, places = np.unique(variable.values, return_inverse=True)
    texts = tuple(variable.texts[int(k)] for k in levels)
    return variable._replace(values=places.astype(np.float64), texts=texts)
