"""The option `--units`, which applies to tables only."""

from __future__ import annotations

from heuncli.app.cli.output import print_stderr
from heuncli.study.quantities.table_units import Units, read_display_units

TABLES = ("table", "markdown")


def parse_units(words: str | None) -> Units:
    """Parse the units in which tables are shown. Raises UsageError."""
    return read_display_units("--units", words)


def note_si_format(words: str | None, form: str, quiet: bool) -> None:
    """Print a note to standard error that a format other than a table stays in SI although units were given."""
    if words is not None and not quiet and form not in TABLES:
        print_stderr(f"heun: --units applies to tables only; {form} stays in SI")
