"""Make the columns of a sweep: each parameter as numbers of one unit, or as texts if it has none.

All formats use them: the headings and cells of CSV and Parquet, and the values under `set` in JSON.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from heuncli.analyses.sweep_store.rows import SweepHead, SweptRow
from heuncli.analyses.variants.plans import Plan
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.quantity import parse_number_with_unit
from heuncli.study.quantities.digits import OPEN, UNKNOWN

NUMBER = "number"
CODE, REASON = "code", "reason"
WORDS = {  # the word of a measure without value -> what tables show, and why
    "open": (OPEN, "open: statically indeterminate, depends on stiffness"),
    "unknown": (UNKNOWN, "not known near a singular position"),
    "beyond": (UNKNOWN, "not reliable past the horizon"),
    "absent": ("-", "does not happen in this run"),
}
Cell = int | float | str | None


class ParameterColumn(NamedTuple):
    """The column of a parameter; unit: of its numbers (empty: SI), None if its values are texts."""

    name: str
    unit: str | None

    @property
    def heading(self) -> str:
        """The heading, such as `n [rpm]`; a parameter with the name of another column is marked."""
        name = f"{self.name} (parameter)" if self.name in (NUMBER, CODE, REASON) else self.name
        return f"{name} [{self.unit}]" if self.unit else name

    def parse_value(self, text: str) -> float | str:
        """Return a value in the column's unit, from the form of `--set`."""
        figure = parse_number_with_unit(text) if self.unit is not None else None
        return text if figure is None else figure.value


def make_parameter_columns(plan: Plan) -> tuple[ParameterColumn, ...]:
    """Make the columns of all varied parameters."""
    laws = plan.draws.laws if plan.draws is not None else ()
    axis_columns = (ParameterColumn(axis.name, find_common_unit(axis.texts)) for axis in (*plan.columns, *plan.axes))
    return (*axis_columns, *(ParameterColumn(law.name, law.unit) for law in laws))


def find_common_unit(texts: Sequence[str]) -> str | None:
    """Return the unit of all texts, empty if they are plain numbers; None if they have no common unit."""
    unit: str | None = None
    for text in texts:
        figure = parse_number_with_unit(text)
        if figure is None or (unit is not None and figure.unit != unit):
            return None
        unit = figure.unit
    return unit


class SweepColumns(NamedTuple):
    """The columns of a sweep in CSV and Parquet."""

    parameters: tuple[ParameterColumn, ...]
    measures: tuple[str, ...]

    @property
    def headings(self) -> list[str]:
        """Number, parameters, of each measure its value, its error and its instant, then the reason why there is
        none.
        """
        measures = (head for text in self.measures for head in (text, f"{text} error", f"{text} at [s]"))
        return [NUMBER, *(one.heading for one in self.parameters), *measures, CODE, REASON]

    def parse_values(self, texts: Mapping[str, str]) -> list[float | str]:
        """Return the parameter values of a variant."""
        return [one.parse_value(texts[one.name]) for one in self.parameters]

    def make_cells(self, row: SweptRow) -> list[Cell]:
        """Return the cells of a variant; None where there is no value."""
        measures: list[Cell] = [None] * (3 * len(self.measures))
        for place, one in enumerate(row.answer.measures):
            measures[3 * place : 3 * place + 3] = (to_finite(number) for number in (one.value, one.error, one.time))
        return [
            row.number,
            *self.parse_values(row.values),
            *measures,
            row.answer.code,
            explain_missing(row, self.measures),
        ]


def make_columns(head: SweepHead) -> SweepColumns:
    """Make the columns of a sweep."""
    measures = tuple(f"{one.text} [{one.unit}]" if one.unit else one.text for one in head.measures)
    return SweepColumns(make_parameter_columns(head.plan), measures)


def to_finite(number: float | None) -> float | None:
    """Return a number as files hold it: None for an infinite one, and 0 for minus zero."""
    return None if number is None or not math.isfinite(number) else number + 0.0


def explain_missing(row: SweptRow, measures: Sequence[str]) -> str:
    """Say why a variant, or a measure of it, has no value; empty if all have one."""
    if row.answer.code:
        return row.answer.reason
    missing = [(text, one.word) for text, one in zip(measures, row.answer.measures, strict=True) if one.word]
    return "; ".join(f"{text}: {WORDS[word][1]}" for text, word in missing)
