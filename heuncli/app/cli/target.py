"""The options `-o FILE`, `--format` and `--units`: where, in which format and in which units is written.

Impure: looks at the files.
"""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.output import print_stderr
from heuncli.app.cli.solving import require_choice
from heuncli.base.errors import Problem
from heuncli.base.files import STDOUT, find_target
from heuncli.study.quantities.table_units import Units, read_display_units

ENDINGS = {"json": ".json", "csv": ".csv", "markdown": ".md", "parquet": ".parquet", "m": ".m"}
TABLES = ("table", "markdown")


def choose_format(requested: str | None, output: str | None, formats: Sequence[str]) -> str:
    """Return the requested format, else that of the file's ending, else the first, which .txt and no ending also mean.

    Raises UsageError for an unknown ending: a table in a file named as a spreadsheet helps nobody.
    """
    if output is not None and output != STDOUT:
        require_writable(output)
    if requested is not None:
        return require_choice("--format", requested, formats)
    if output is None or output == STDOUT:
        return formats[0]
    from pathlib import Path  # 3 ms that only files need

    endings = {ENDINGS[form]: form for form in formats if form in ENDINGS} | {".txt": formats[0], "": formats[0]}
    name = Path(output).name
    ending = name[name.rfind(".") :].lower() if "." in name else ""
    if ending not in endings:
        known = ", ".join(f"{end} ({form})" for end, form in endings.items() if end)
        hint = f"accepted: {known}; with --format {'|'.join(formats)} any name is accepted"
        raise UsageError(Problem("bad-option", f"-o {output}: unknown file extension {ending}", hint=hint))
    return endings[ending]


def require_writable(output: str, option: str = "-o") -> None:
    """Raise an error before the work if a file could not be written after it: UsageError, OutputError."""
    if not output:
        hint = f"for example {option} {'results.json' if option == '-o' else 'chart.svg'}"
        raise UsageError(Problem("bad-option", f"{option}: expected a file name", hint=hint))
    find_target(output)


def parse_units(words: str | None) -> Units:
    """Parse the units in which tables are shown. Raises UsageError."""
    return read_display_units("--units", words)


def note_si_format(words: str | None, form: str, quiet: bool) -> None:
    """Print a note to standard error that a format other than a table stays in SI although units were given."""
    if words is not None and not quiet and form not in TABLES:
        print_stderr(f"heun: --units applies to tables only; {form} stays in SI")
