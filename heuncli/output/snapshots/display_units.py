"""Read the units in which tables and diagrams show values. JSON and CSV always use SI."""

from __future__ import annotations

from heuncli.base.errors import Finding, Problem, UsageError
from heuncli.study.quantities import table_units
from heuncli.study.quantities.table_units import Units


def read_display_units(option: str, words: str | None) -> Units:
    """Return the display units that replace SI units, from words such as `kN,mm`. Raises UsageError."""
    if words is None:
        return Units()
    try:
        return table_units.parse_units(words)
    except Finding as finding:
        raise UsageError(Problem("bad-option", f"{option} {words}: {finding.message}", hint=finding.hint)) from None
