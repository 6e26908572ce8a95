"""The description of a sweep, its results, one row per variant, and the columns made of them.

All formats use the columns: the headings and cells of CSV and Parquet, and the values under `set` in JSON.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from heuncli.analyses.variants.evaluation import Values
from heuncli.analyses.variants.measures import MISSING_KINDS, MeasureLabel, VariantResult
from heuncli.analyses.variants.plans import Plan
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.quantity import NumberWithUnit, ParameterValue


class SweepHead(NamedTuple):
    """The description of a sweep: the spec with its digest, what is varied, what is measured."""

    title: str
    path: str
    sha256: str
    version: str
    plan: Plan
    measures: tuple[MeasureLabel, ...]


class SweptRow(NamedTuple):
    """A variant: its number in the plan, its values, and its result."""

    number: int
    values: Values
    result: VariantResult


NUMBER = "number"
CODE, REASON = "code", "reason"
SEPARATOR = "; "  # between the reasons of several measures
Cell = int | float | str | None


class ParameterColumn(NamedTuple):
    """The column of a parameter; unit: of its numbers (empty: SI), None if its values are texts."""

    name: str
    unit: str | None

    @property
    def label(self) -> str:
        """The name; that of a parameter with the name of another column is marked."""
        return f"{self.name} (parameter)" if self.name in (NUMBER, CODE, REASON) else self.name

    @property
    def heading(self) -> str:
        """The label with the unit, such as `n [rpm]`."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label

    def make_value(self, cell: float | str) -> ParameterValue:
        """Return the value of a cell."""
        return cell if isinstance(cell, str) else NumberWithUnit(cell, self.unit or "")


def make_parameter_columns(plan: Plan) -> tuple[ParameterColumn, ...]:
    """Make the columns of all varied parameters."""
    laws = plan.draws.laws if plan.draws is not None else ()
    axis_columns = (ParameterColumn(axis.name, axis.unit) for axis in (*plan.columns, *plan.axes))
    return (*axis_columns, *(ParameterColumn(law.name, law.unit) for law in laws))


def to_cell(value: ParameterValue) -> float | str:
    """Return a value as a cell: a number in the unit of its column, or a text."""
    return value if isinstance(value, str) else float(value.value)


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

    def make_cells(self, row: SweptRow) -> list[Cell]:
        """Return the cells of a variant; None where there is no value."""
        measures: list[Cell] = [None] * (3 * len(self.measures))
        for place, one in enumerate(row.result.measures):
            measures[3 * place : 3 * place + 3] = (to_finite(number) for number in (one.value, one.error, one.time))
        return [
            row.number,
            *(to_cell(row.values[one.name]) for one in self.parameters),
            *measures,
            row.result.code,
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
    if row.result.code:
        return row.result.reason
    missing = [(text, one.word) for text, one in zip(measures, row.result.measures, strict=True) if one.word]
    return SEPARATOR.join(f"{text}: {MISSING_KINDS[word].sentence} [{word}]" for text, word in missing)


def find_missing_words(reason: str, measures: Sequence[str]) -> dict[str, str]:
    """Return the words of the measures without a value, by measure, from what `explain_missing` gives."""
    entries = [entry.removesuffix("]").rpartition(" [") for entry in reason.split(SEPARATOR) if entry.endswith("]")]
    return {
        measure: word
        for measure in measures
        for text, _, word in entries
        if text.startswith(f"{measure}: ") and word in MISSING_KINDS
    }
