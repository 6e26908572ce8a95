"""Units that are asked for: of tables, in which JSON and CSV have no part."""

from __future__ import annotations

from heuncli.base.errors import Finding, Problem, UsageError
from heuncli.study.quantities import table_units
from heuncli.study.quantities.table_units import Units


def asked_units(option: str, words: str | None) -> Units:
    """The units in which tables and diagrams show SI units, such as `kN,mm`. Raises UsageError."""
    if words is None:
        return Units()
    try:
        return table_units.asked(words)
    except Finding as finding:
        raise UsageError(Problem("bad-option", f"{option} {words}: {finding.message}", hint=finding.hint)) from None
