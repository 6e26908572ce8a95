"""What `--units` asks for: of tables alone."""

from __future__ import annotations

from heuncli.cli.entry import UsageError
from heuncli.cli.output import say
from heuncli.errors import Finding, Problem
from heuncli.report import table_units
from heuncli.report.table_units import Units

TABLES = ("table", "markdown")


def units(words: str | None) -> Units:
    """The units that tables show. Raises UsageError."""
    if words is None:
        return Units()
    try:
        return table_units.asked(words)
    except Finding as finding:
        raise UsageError(Problem("bad-option", f"--units {words}: {finding.message}", hint=finding.hint)) from None


def say_what_stays(words: str | None, form: str, quiet: bool) -> None:
    """On standard error, that what is no table stays in SI though units were asked for."""
    if words is not None and not quiet and form not in TABLES:
        say(f"heun: --units is of tables: {form} stays in SI")
