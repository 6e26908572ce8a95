"""`heun new KIND [FILE]`: write a spec to start from, never over an existing file; without arguments list the kinds."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

from heuncli.analyses.published.cases import list_names, spec_of
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.options import Option
from heuncli.app.cli.output import emit, print_stderr
from heuncli.base import files
from heuncli.base.errors import OutputError, Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import suggest
from heuncli.base.text_safety import escape


class NewRequest(NamedTuple):
    """The options and arguments of `heun new`."""

    kind: Annotated[str | None, Option((), "Kind of machine: pendulum, crane, ...; or a published case.", "KIND")] = (
        None
    )
    file: Annotated[str | None, Option((), "Output file; - is standard output. Default: KIND.yaml.", "FILE")] = None


FOLDER = Path(__file__).parents[2] / "starters"
STANDARD_OUTPUT = "-"
SCHEMA = """\
# yaml-language-server: $schema=heun.schema.json
# This line lets an editor complete and check the keys; `heun schema -o heun.schema.json` writes the file.
"""


def main(request: NewRequest) -> int:
    """Run the command; returns the exit code."""
    known = list_kinds()
    published = {name: read_text(name).splitlines()[0].removeprefix("# ") for name in list_names()}
    if request.kind is None:
        emit(f"{_format_list(known)}\npublished cases, which heun check --references compares with published results:\n"
             f"{_format_list(published)}")  # fmt: skip
        return 0
    if request.kind not in {**known, **published}:
        hint = f"{suggest(request.kind, {**known, **published}, 'kinds')}; heun new lists them"
        raise UsageError(Problem("bad-option", f"new {request.kind}: there is no such kind", hint=hint))
    text = SCHEMA + read_text(request.kind)
    file = request.file if request.file is not None else f"{request.kind}.yaml"
    if file == STANDARD_OUTPUT:
        emit(text)
        return 0
    _write_new(text, file)
    print_stderr(f"heun: {escape(file)} written; next: heun run {escape(file)}")
    return 0


def _format_list(titles: Mapping[str, str]) -> str:
    """Format names with their titles, one per line."""
    width = max(map(len, titles))
    return "".join(f"{kind:<{width}}  {title}\n" for kind, title in titles.items())


def read_text(kind: str) -> str:
    """Read the spec of a kind, or of a published case."""
    starter = FOLDER / f"{kind}.yaml"
    return starter.read_text(encoding="utf-8") if starter.exists() else spec_of(kind)


def list_kinds() -> dict[str, str]:
    """Return the kinds with their titles."""
    starters = {path.stem: path.read_text(encoding="utf-8") for path in sorted(FOLDER.glob("*.yaml"))}
    return {kind: text.splitlines()[0].removeprefix("# ") for kind, text in starters.items()}


def _write_new(text: str, file: str) -> None:
    """Write a new file, whole or not at all. Raises UsageError if the file exists, OutputError."""
    exists_error = UsageError(
        Problem(
            "bad-option",
            f"new: {file}: this file exists",
            hint="give another file name; existing files are not overwritten",
        )
    )
    try:
        number = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)  # O_EXCL also refuses a link
    except (FileExistsError, IsADirectoryError):
        raise exists_error from None
    except OSError as reason:
        raise OutputError(files.write_problem(file, reason)) from None
    try:
        try:
            files.write_all(number, text.encode())
        finally:
            os.close(number)  # an open file cannot be removed on Windows
    except BaseException as reason:
        Path(file).unlink()
        if isinstance(reason, OSError):
            raise OutputError(files.write_problem(file, reason)) from None
        raise
