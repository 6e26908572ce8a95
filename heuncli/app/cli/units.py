"""What `--units` asks for: of tables alone."""

from __future__ import annotations

from heuncli.app.cli.output import say
from heuncli.output.snapshots.asked_units import asked_units
from heuncli.study.quantities.table_units import Units

TABLES = ("table", "markdown")


def units(words: str | None) -> Units:
    """The units that tables show. Raises UsageError."""
    return asked_units("--units", words)


def say_what_stays(words: str | None, form: str, quiet: bool) -> None:
    """On standard error, that what is no table stays in SI though units were asked for."""
    if words is not None and not quiet and form not in TABLES:
        say(f"heun: --units is of tables: {form} stays in SI")
