"""`heun new KIND [FILE]`: a spec to start from, written where nothing stands; without arguments the kinds."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from heuncli.analyses.published.files import names, spec_of
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.output import emit, say
from heuncli.app.commands.new.request import NewRequest
from heuncli.base import files
from heuncli.base.errors import OutputError, Problem
from heuncli.base.foreign_text import shown
from heuncli.base.nearest import did_you_mean

FOLDER = Path(__file__).parents[3] / "starters"
STANDARD_OUTPUT = "-"
SCHEMA = """\
# yaml-language-server: $schema=heun.schema.json
# An editor completes and underlines by that line, once `heun schema -o heun.schema.json` has written the file here.
"""


def main(request: NewRequest) -> int:
    """Run the command; returns the exit code."""
    known = kinds()
    published = {name: text_of(name).splitlines()[0].removeprefix("# ") for name in names()}
    if request.kind is None:
        emit(f"{_listed(known)}\npublished cases, which heun check --references holds against what was printed:\n"
             f"{_listed(published)}")  # fmt: skip
        return 0
    if request.kind not in {**known, **published}:
        hint = f"{did_you_mean(request.kind, {**known, **published}, 'kinds')}; heun new lists them"
        raise UsageError(Problem("bad-option", f"new {request.kind}: there is no such kind", hint=hint))
    text = SCHEMA + text_of(request.kind)
    file = request.file if request.file is not None else f"{request.kind}.yaml"
    if file == STANDARD_OUTPUT:
        emit(text)
        return 0
    _write(text, file)
    say(f"heun: {shown(file)} written; next: heun run {shown(file)}")
    return 0


def _listed(titles: Mapping[str, str]) -> str:
    width = max(map(len, titles))
    return "".join(f"{kind:<{width}}  {title}\n" for kind, title in titles.items())


def text_of(kind: str) -> str:
    """The spec of a kind, or of a published case."""
    own = FOLDER / f"{kind}.yaml"
    return own.read_text(encoding="utf-8") if own.exists() else spec_of(kind)


def kinds() -> dict[str, str]:
    """The kinds, with their titles."""
    found = {path.stem: path.read_text(encoding="utf-8") for path in sorted(FOLDER.glob("*.yaml"))}
    return {kind: text.splitlines()[0].removeprefix("# ") for kind, text in found.items()}


def _write(text: str, file: str) -> None:
    """A new file, whole or not at all. Raises UsageError where something stands, OutputError."""
    taken = UsageError(
        Problem("bad-option", f"new: {file}: something stands there", hint="name another file; none is written over")
    )
    try:
        number = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)  # not through a link, either
    except (FileExistsError, IsADirectoryError):
        raise taken from None
    except OSError as reason:
        raise OutputError(files.failed(file, reason)) from None
    try:
        files.write_all(number, text.encode())
    except BaseException as reason:
        Path(file).unlink()
        if isinstance(reason, OSError):
            raise OutputError(files.failed(file, reason)) from None
        raise
    finally:
        os.close(number)
