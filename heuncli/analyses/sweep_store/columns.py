"""What stands in the columns of a sweep: each parameter as numbers of one unit, or as texts where it has none.

The same in all forms: heads and cells of CSV and Parquet are made here, and the values under `set` in JSON.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from heuncli.analyses.sweep_store.rows import SweepHead, SweptRow
from heuncli.analyses.variants.axes import figure_of
from heuncli.analyses.variants.plans import Plan
from heuncli.base.named_tuples import NamedTuple
from heuncli.study.quantities.digits import OPEN, UNKNOWN

NUMBER = "number"
CODE, REASON = "code", "reason"
WORDS = {  # of measures that a variant does not give -> what tables show, and why
    "open": (OPEN, "open: redundant supports share it in a way that rigid bodies leave undetermined"),
    "unknown": (UNKNOWN, "not known beside a singular pose"),
    "beyond": (UNKNOWN, "beyond the horizon nothing is claimed"),
    "absent": ("-", "does not happen in this run"),
}
Cell = int | float | str | None


class ParameterColumn(NamedTuple):
    """A parameter; unit: of its numbers (empty: SI), None where its values are texts."""

    name: str
    unit: str | None

    @property
    def head(self) -> str:
        """What stands above it: `n [rpm]`; a parameter that is called as another column is told apart."""
        name = f"{self.name} (parameter)" if self.name in (NUMBER, CODE, REASON) else self.name
        return f"{name} [{self.unit}]" if self.unit else name

    def value(self, text: str) -> float | str:
        """A value in the column's unit, from the form of `--set`."""
        figure = figure_of(text) if self.unit is not None else None
        return text if figure is None else figure.value


def parameters_of(plan: Plan) -> tuple[ParameterColumn, ...]:
    """The columns of what is varied."""
    drawn = plan.draws.laws if plan.draws is not None else ()
    own = (ParameterColumn(axis.name, common_unit(axis.texts)) for axis in (*plan.columns, *plan.axes))
    return (*own, *(ParameterColumn(law.name, law.unit) for law in drawn))


def common_unit(texts: Sequence[str]) -> str | None:
    """The unit of all of them, empty where they are plain numbers; None where they are not of one unit."""
    unit: str | None = None
    for text in texts:
        figure = figure_of(text)
        if figure is None or (unit is not None and figure.unit != unit):
            return None
        unit = figure.unit
    return unit


class SweepColumns(NamedTuple):
    """The columns of a sweep in CSV and Parquet."""

    parameters: tuple[ParameterColumn, ...]
    measures: tuple[str, ...]

    @property
    def heads(self) -> list[str]:
        """Number, parameters, of each measure its value, its error and its instant, then why there is none."""
        measures = (head for text in self.measures for head in (text, f"{text} error", f"{text} at [s]"))
        return [NUMBER, *(one.head for one in self.parameters), *measures, CODE, REASON]

    def values(self, texts: Mapping[str, str]) -> list[float | str]:
        """The parameters of a variant."""
        return [one.value(texts[one.name]) for one in self.parameters]

    def cells(self, row: SweptRow) -> list[Cell]:
        """A variant; None where there is no value."""
        measures: list[Cell] = [None] * (3 * len(self.measures))
        for place, one in enumerate(row.answer.measures):
            measures[3 * place : 3 * place + 3] = (finite(number) for number in (one.value, one.error, one.at))
        return [row.number, *self.values(row.values), *measures, row.answer.code, why(row, self.measures)]


def columns_of(head: SweepHead) -> SweepColumns:
    """The columns of a sweep."""
    measures = tuple(f"{one.text} [{one.unit}]" if one.unit else one.text for one in head.measures)
    return SweepColumns(parameters_of(head.plan), measures)


def finite(number: float | None) -> float | None:
    """A number as files hold it: none that is infinite, and no minus before a zero."""
    return None if number is None or not math.isfinite(number) else number + 0.0


def why(row: SweptRow, measures: Sequence[str]) -> str:
    """The reason why a variant, or a measure of it, has no value; empty where all have one."""
    if row.answer.code:
        return row.answer.reason
    lost = [(text, one.word) for text, one in zip(measures, row.answer.measures, strict=True) if one.word]
    return "; ".join(f"{text}: {WORDS[word][1]}" for text, word in lost)
