"""Compare published numbers with heun's: their difference, and whether it exceeds what both claim.
    |found - printed| <= half of the last digit printed + the source's own error + the error that heun states
Heun's stated error may not exceed what the source claims, or a small share of the largest number, so that a coarse run
cannot agree with everything.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

from heuncli.analyses.published.cases import PublishedCase, PublishedNumber, PublishedTable
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.results.results import Array
from heuncli.results.results_paths import find_values
from heuncli.scene.expressions.scope import Scope
from heuncli.scene.file_format.load import load_with_cases
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.quantity import read_number
from heuncli.study.model.options import Options
from heuncli.study.model.selection import select_paths
from heuncli.study.queries.expectations import find_instant_index
from heuncli.study.queries.measure_uncertainty import measure_uncertainty
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve

DECIMAL = re.compile(r"[+-]?(?=\.?\d)(\d*)(?:\.(\d*))?(?:[eE]([+-]?\d+))?\Z")


class PrintedNumber(NamedTuple):
    """A number as printed in its source; last_digit: one unit of its last digit, 0 if it is exact."""

    text: str
    value: float
    last_digit: float

    @property
    def digit_count(self) -> int:
        """Number of significant digits printed; 0 if the number is exact."""
        decimal = DECIMAL.match(self.text) if self.last_digit else None
        return len(f"{decimal[1]}{decimal[2] or ''}".lstrip("0")) if decimal is not None else 0


def parse_decimal(text: str) -> PrintedNumber:
    """Parse a decimal number: 0.3284 means 0.32835 to 0.32845. Raises ValueError."""
    decimal = DECIMAL.match(text)
    if decimal is None:
        raise ValueError(f"{text} is not a decimal number")
    return PrintedNumber(text, float(text), 10.0 ** (int(decimal[3] or 0) - len(decimal[2] or "")))


def evaluate_exact(text: str, names: dict[str, float]) -> PrintedNumber:
    """Evaluate an expression such as 7*l*q/24, exact in the names that it contains. Raises Finding."""
    return PrintedNumber(text, read_number(text, None, Scope(parameters=names)), 0.0)


AGREES, DIFFERS, OPEN, COARSE = "agrees", "differs", "open", "too coarse"
ROUNDING_FACTOR = 1.0 + 1e-6  # a number that ended in 5 may have been rounded either way
DEFAULT_OPTIONS = Options()
MAX_STATED_ERROR = 1e-8  # of the largest of its table: permitted stated error of heun, even if more digits were printed


class NumberComparison(NamedTuple):
    """A published number and heun's, with the error that heun states, and the permitted difference."""

    number: PublishedNumber
    published: PrintedNumber
    computed: float
    stated_error: float
    tolerance: float
    verdict: str

    @property
    def difference(self) -> float:
        """Heun's number minus the published one."""
        return self.computed - self.published.value

    @property
    def in_last_digits(self) -> float:
        """The difference in units of the last digit printed; nan if the number is exact."""
        return self.difference / self.published.last_digit if self.published.last_digit else math.nan


class TableComparison(NamedTuple):
    """A table of a source with heun's numbers; largest: the largest of its numbers."""

    table: PublishedTable
    numbers: tuple[NumberComparison, ...]
    largest: float

    @property
    def is_limited_by_digits(self) -> bool:
        """Whether the last digit decides: the numbers were printed, and have no other error."""
        return self.table.kind != "exact" and not self.table.error

    @property
    def worst(self) -> NumberComparison:
        """The number with the largest difference relative to its tolerance; one that does not agree comes first."""
        return max(self.numbers, key=lambda one: (one.verdict != AGREES, abs(one.difference) / one.tolerance))


def compare_case(case: PublishedCase, options: Options = DEFAULT_OPTIONS) -> tuple[TableComparison, ...]:
    """Solve a case and compare it table by table, with the time limit and reductions of the options. Raises
    HeunError.
    """
    spec, load_cases = load_with_cases(f"{case.name}.yaml", text=case.spec)
    scenes = {"": spec, **load_cases}
    studies: dict[tuple[str, str], Study] = {}
    for key in dict.fromkeys((table.case, table.axes) for table in case.tables):
        key_tables = [table for table in case.tables if (table.case, table.axes) == key]
        studies[key] = _solve_tables(scenes[key[0]], key_tables, replace(options, axes=key[1]))
    return tuple(_compare_table(table, studies[table.case, table.axes]) for table in case.tables)


def _solve_tables(spec: Spec, tables: Sequence[PublishedTable], options: Options) -> Study:
    """Solve a spec for all numbers of some tables."""
    selection = select_paths([number.path for table in tables for number in table.numbers], spec)
    return solve(spec, replace(options, requested_reports=selection.reports, entries=selection.entries))


def _compare_table(table: PublishedTable, study: Study) -> TableComparison:
    """Compare each published number of a table with that of a solved scene."""
    values = [_parse_number(table, number, study.spec) for number in table.numbers]
    largest = max(abs(value.value) for value in values)
    numbers = tuple(
        _compare_number(number, value, table, largest, study)
        for number, value in zip(table.numbers, values, strict=True)
    )
    return TableComparison(table, numbers, largest)


def _parse_number(table: PublishedTable, number: PublishedNumber, spec: Spec) -> PrintedNumber:
    """Parse a published number: printed digits, or an exact expression."""
    if table.kind != "exact":
        return parse_decimal(number.text)
    names = dict(spec.parameters)
    names |= {name: evaluate_exact(text, names).value for name, text in table.let}
    return evaluate_exact(number.text, names)


def _compare_number(
    number: PublishedNumber, value: PrintedNumber, table: PublishedTable, largest: float, study: Study
) -> NumberComparison:
    """Compare a number; both the printed digits and heun's stated error are allowed for."""
    computed = _compute_number(number, study)
    claimed_error = value.last_digit / 2.0 * ROUNDING_FACTOR + table.error * largest
    if math.isnan(computed):
        return NumberComparison(number, value, math.nan, math.nan, claimed_error, OPEN)
    stated_error = measure_uncertainty(study, number.path, "at", computed) or 0.0
    tolerance = claimed_error + stated_error
    is_coarse = not stated_error <= max(claimed_error, MAX_STATED_ERROR * largest)
    verdict = COARSE if is_coarse else AGREES if abs(computed - value.value) <= tolerance else DIFFERS
    return NumberComparison(number, value, computed, stated_error, tolerance, verdict)


def _compute_number(number: PublishedNumber, study: Study) -> float:
    """Return heun's number at the path and instant. Raises HeunError if the path does not lead to a single number."""
    channel = find_values(study.results, number.path)
    values: Array = channel.values
    if channel.is_timed:
        values = values[0 if number.time is None else find_instant_index(study.results.time, number.time)]
    return float(values.reshape(()))
