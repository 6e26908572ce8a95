"""`-o FILE`: the format its name asks for, and what would keep it from being written. Impure: looks at the files."""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.solving import choice
from heuncli.base.errors import Problem
from heuncli.base.files import STDOUT, place_of

ENDINGS = {"json": ".json", "csv": ".csv", "markdown": ".md", "parquet": ".parquet", "m": ".m"}


def format_of(asked: str | None, output: str | None, formats: Sequence[str]) -> str:
    """The format asked for, else what the file's name ends in, else the first, which .txt and no ending mean, too.

    An ending that means none of them is refused: a table in a file that is named a spreadsheet helps nobody.
    """
    if output is not None and output != STDOUT:
        require_room(output)
    if asked is not None:
        return choice("--format", asked, formats)
    if output is None or output == STDOUT:
        return formats[0]
    from pathlib import Path  # 3 ms that only files need

    endings = {ENDINGS[form]: form for form in formats if form in ENDINGS} | {".txt": formats[0], "": formats[0]}
    name = Path(output).name
    ending = name[name.rfind(".") :].lower() if "." in name else ""
    if ending not in endings:
        known = ", ".join(f"{end} ({form})" for end, form in endings.items() if end)
        hint = f"known endings: {known}; with --format {'|'.join(formats)} any name will do"
        raise UsageError(Problem("bad-option", f"-o {output}: no format is known by the ending {ending}", hint=hint))
    return endings[ending]


def require_room(output: str, option: str = "-o") -> None:
    """Say before the work what would keep a file from being written after it."""
    if not output:
        hint = f"such as {option} {'results.json' if option == '-o' else 'chart.svg'}"
        raise UsageError(Problem("bad-option", f"{option}: expected the name of a file", hint=hint))
    place_of(output)
