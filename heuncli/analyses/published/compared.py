"""Published numbers against what heun finds: how far apart, and whether that is more than both of them claim.

    |found - printed| <= half of the last digit printed + the source's own error + the error that heun states

What heun states may be no more than what the source claims, or a small share of the largest, so that a coarse run
cannot agree with everything.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from heuncli.analyses.published.cases import PublishedCase, PublishedNumber, PublishedTable
from heuncli.analyses.published.printed import Printed, exact, printed
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.results.results import Array
from heuncli.results.results_paths import find
from heuncli.scene.file_format.load import load_with_cases
from heuncli.scene.file_format.models import Spec
from heuncli.study.ask.expectations import instant_among
from heuncli.study.ask.measure import MeasureRequest, Peak
from heuncli.study.ask.study import Study
from heuncli.study.model.options import Options
from heuncli.study.model.selection import asked_by
from heuncli.study.quantities.stated import error_of
from heuncli.study.workflow import solve

AGREES, DIFFERS, OPEN, COARSE = "agrees", "differs", "open", "too coarse"
ROUNDED = 1.0 + 1e-6  # a number that ends in 5 may have been rounded either way
PLAIN = Options()
COARSEST = 1e-8  # of the largest of its table, that heun's stated error may be where more digits were printed


class ComparedNumber(NamedTuple):
    """A published number and heun's: with the error that heun states, and what they may differ by."""

    number: PublishedNumber
    printed: Printed
    found: float
    stated: float
    allowed: float
    verdict: str

    @property
    def difference(self) -> float:
        """Heun's less the published one."""
        return self.found - self.printed.value

    @property
    def in_last_digits(self) -> float:
        """The difference in units of the last digit printed; nan where the number is exact."""
        return self.difference / self.printed.last if self.printed.last else math.nan


class ComparedTable(NamedTuple):
    """A table of a source with heun's numbers; largest: the largest of its numbers."""

    table: PublishedTable
    numbers: tuple[ComparedNumber, ...]
    largest: float

    @property
    def is_to_the_digit(self) -> bool:
        """Whether the last digit decides: its numbers were printed, and have no other error."""
        return self.table.kind != "exact" and not self.table.error

    @property
    def worst(self) -> ComparedNumber:
        """The number that is farthest off, of what is allowed; one that does not agree first."""
        return max(self.numbers, key=lambda one: (one.verdict != AGREES, abs(one.difference) / one.allowed))


def compared(case: PublishedCase, options: Options = PLAIN) -> tuple[ComparedTable, ...]:
    """A case solved, table by table, with a time limit and reductions as the options have them. Raises HeunError."""
    spec, load_cases = load_with_cases(f"{case.name}.yaml", text=case.spec)
    scenes = {"": spec, **load_cases}
    studies: dict[tuple[str, str], Study] = {}
    for key in dict.fromkeys((table.case, table.axes) for table in case.tables):
        own = [table for table in case.tables if (table.case, table.axes) == key]
        studies[key] = _solved(scenes[key[0]], own, replace(options, axes=key[1]))
    return tuple(_compared(table, studies[table.case, table.axes]) for table in case.tables)


def _solved(spec: Spec, tables: Sequence[PublishedTable], options: Options) -> Study:
    asked = asked_by([number.path for table in tables for number in table.numbers], spec)
    return solve(spec, replace(options, wanted=asked.reports, entries=asked.entries))


def _compared(table: PublishedTable, study: Study) -> ComparedTable:
    values = [_printed(table, number, study.spec) for number in table.numbers]
    largest = max(abs(value.value) for value in values)
    numbers = tuple(
        _one(number, value, table, largest, study) for number, value in zip(table.numbers, values, strict=True)
    )
    return ComparedTable(table, numbers, largest)


def _printed(table: PublishedTable, number: PublishedNumber, spec: Spec) -> Printed:
    if table.kind != "exact":
        return printed(number.text)
    names = dict(spec.parameters)
    names |= {name: exact(text, names).value for name, text in table.let}
    return exact(number.text, names)


def _one(
    number: PublishedNumber, value: Printed, table: PublishedTable, largest: float, study: Study
) -> ComparedNumber:
    found = _found(number, study)
    claimed = value.last / 2.0 * ROUNDED + table.error * largest
    if math.isnan(found):
        return ComparedNumber(number, value, math.nan, math.nan, claimed, OPEN)
    stated = error_of(MeasureRequest("at", number.path, number.at), Peak(found, 0.0), study) or 0.0
    allowed = claimed + stated
    coarse = not stated <= max(claimed, COARSEST * largest)
    verdict = COARSE if coarse else AGREES if abs(found - value.value) <= allowed else DIFFERS
    return ComparedNumber(number, value, found, stated, allowed, verdict)


def _found(number: PublishedNumber, study: Study) -> float:
    """What heun finds at the path, at the instant. Raises HeunError where the path leads to no one number."""
    there = find(study.results, number.path)
    values: Array = there.values
    if there.timed:
        values = values[0 if number.at is None else instant_among(study.results.time, number.at)]
    return float(values.reshape(()))
