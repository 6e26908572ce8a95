"""Published cases that come with heun, as tests use them: specs at other instants, numbers as they were printed."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache

from heuncli.analyses.published.cases import read_case, spec_of
from heuncli.analyses.published.comparison import TableComparison, compare_case, parse_decimal


def spec_at(name: str, times: Sequence[float], tolerance: float) -> str:
    """The spec of a case, asked for other instants at a tolerance."""
    analysis = f"analysis: {{times: {list(times)}, tolerance: {tolerance}}}"
    text, changed = re.subn(r"^analysis: .*$", analysis, spec_of(name), flags=re.MULTILINE)
    assert changed == 1
    return text


@cache
def printed_values(name: str, kind: str = "") -> dict[tuple[str, float | None], float]:
    """The numbers of a case by path and instant; of tables of one kind where that is named."""
    return {
        (number.path, number.time): parse_decimal(number.text).value
        for table in read_case(name).tables
        if kind in ("", table.kind)
        for number in table.numbers
    }


def course(name: str, path: str) -> dict[float, float]:
    """What was printed at a path, by instant."""
    return {at: value for (of, at), value in printed_values(name).items() if of == path and at is not None}


@cache
def compared_case(name: str) -> tuple[TableComparison, ...]:
    """A case, solved once for all tests."""
    return compare_case(read_case(name))
