"""The option `-o FILE`: choose the format by the file's name, and check that it can be written. Impure: looks at the
files.
"""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.solving import require_choice
from heuncli.base.errors import Problem
from heuncli.base.files import STDOUT, find_target

ENDINGS = {"json": ".json", "csv": ".csv", "markdown": ".md", "parquet": ".parquet", "m": ".m"}


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
