"""The options of what is written: file, format and units of tables. Those of figures are in figure_output.py.

Outputs that would overwrite the command's inputs are refused before anything is solved. Impure: looks at the files.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from heuncli.app.cli.output import print_stderr
from heuncli.base.errors import Problem, UsageError
from heuncli.base.files import STDOUT, find_target
from heuncli.scene.file_format.reading import find_name_read

if TYPE_CHECKING:
    from heuncli.study.quantities.table_units import Units

ENDINGS = {"json": ".json", "csv": ".csv", "markdown": ".md", "parquet": ".parquet", "m": ".m"}
TABLES = ("table", "markdown")


def choose_format(requested: str | None, output: str | None, formats: Sequence[str]) -> str:
    """Return the requested format, else that of the file's ending, else the first, which .txt and no ending also mean.

    Raises UsageError for an unknown ending: a table in a file named as a spreadsheet helps nobody.
    """
    if output is not None and output != STDOUT:
        require_writable(output)
    if requested is not None:
        from heuncli.study.model.options import require_choice  # with all that solves

        return require_choice("--format", requested, formats)
    if output is None or output == STDOUT:
        return formats[0]
    endings = {ENDINGS[form]: form for form in formats if form in ENDINGS} | {".txt": formats[0], "": formats[0]}
    ending = find_ending(output)
    if ending not in endings:
        known = ", ".join(f"{end} ({form})" for end, form in endings.items() if end)
        hint = f"accepted: {known}; with --format {'|'.join(formats)} any name is accepted"
        raise UsageError(Problem("bad-option", f"-o {output}: unknown file extension {ending}", hint=hint))
    return endings[ending]


def find_ending(name: str) -> str:
    """Return the ending of a file's name in lower case, as `.csv`, or an empty text."""
    name = os.path.basename(name)  # noqa: PTH119 - pathlib takes 3 ms
    return name[name.rfind(".") :].lower() if "." in name else ""


def require_writable(output: str, option: str = "-o") -> None:
    """Raise an error before the work if a file could not be written after it: UsageError, OutputError."""
    if not output:
        hint = f"for example {option} {'results.json' if option == '-o' else 'chart.svg'}"
        raise UsageError(Problem("bad-option", f"{option}: expected a file name", hint=hint))
    find_target(output)


def parse_units(words: str | None) -> Units:
    """Parse the units in which tables are shown. Raises UsageError."""
    from heuncli.study.quantities.table_units import read_display_units  # with NumPy

    return read_display_units("--units", words)


def note_si_format(words: str | None, form: str, quiet: bool) -> None:
    """Print a note to standard error that a format other than a table stays in SI although units were given."""
    if words is not None and not quiet and form not in TABLES:
        print_stderr(f"heun: --units applies to tables only; {form} stays in SI")


def require_other_file(output: str | None, specs: Sequence[str], option: str = "-o", kind: str = "spec") -> None:
    """Require that the output is none of the specs, nor any file read so far. Raises UsageError.

    For None and `-` the output is standard output, which a shell may append to a spec (`>>`).

    kind: what the input files are called in the message, if not specs: `model`
    """
    to_stdout = output is None or output == STDOUT
    state = _read_stdout_status() if to_stdout else _read_status(output)
    if state is None:
        return
    name = find_name_read(state)
    is_spec = name in specs or (not to_stdout and any(is_same_file(output, spec) for spec in specs))
    if is_spec or name is not None:
        member = "table" if kind == "spec" else "part"
        what = f"the {kind} itself" if is_spec else f"a {member} of the {kind}"
        where = "standard output" if to_stdout else f"{option} {output}"
        raise UsageError(Problem("bad-option", f"{where}: would overwrite {what}", hint="name another file"))


def is_same_file(name: str | None, other: str | None) -> bool:
    """Return whether two names lead to the same file, or would if it existed."""
    states = _read_status(name), _read_status(other)
    if states[0] is not None and states[1] is not None:
        return os.path.samestat(states[0], states[1])
    return name is not None and other is not None and _resolve_path(name) == _resolve_path(other)


def is_output(name: str, output: str | None) -> bool:
    """Return whether a file is the one to which the result goes: `output`, for None and `-` standard output."""
    return is_same_file("/dev/stdout" if output in (None, STDOUT) else output, name)


def _resolve_path(name: str) -> str:
    """Return the real path of a name, or the name itself if its folder is gone."""
    try:
        return os.path.realpath(name)
    except (OSError, ValueError):
        return name


def _read_status(name: str | None) -> os.stat_result | None:
    """Return the status of a file, or None if it does not exist or is standard output."""
    if name is None or name == STDOUT:
        return None
    from pathlib import Path  # 3 ms that only files need

    try:
        return Path(name).stat()
    except (OSError, ValueError):
        return None


def _read_stdout_status() -> os.stat_result | None:
    """Return the status of the file behind standard output, or None if there is none."""
    try:
        return os.fstat(sys.stdout.fileno()) if sys.stdout is not None else None
    except (OSError, ValueError):  # a stream without a file descriptor
        return None
