"""`heun run --watch`: again at each save of the spec, or of a file that it reads, until somebody ends it.

Looking at a file's state five times a second needs nothing of the system, and sees editors that put a new file in the
place of the old one. Impure: files, time, terminal.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NoReturn

from heuncli.app.cli import terminal
from heuncli.app.cli.entry import UsageError, contained, report_problems
from heuncli.app.cli.output import say
from heuncli.app.commands.run.request import RunRequest
from heuncli.base.errors import Finding, HeunError, Problem
from heuncli.base.foreign_text import shown
from heuncli.scene.file_format.names import mapping
from heuncli.scene.file_format.reading import STANDARD_INPUT
from heuncli.scene.file_format.source import read

PAUSE = 0.2  # s between two looks
CLEAR = "\x1b[2J\x1b[3J\x1b[H"
State = tuple[tuple[str, int, int, int] | None, ...]


def watch(request: RunRequest, run: Callable[[RunRequest], int]) -> NoReturn:
    """Run again and again; ended by an interrupt. Raises UsageError where there is nothing to watch."""
    for given, word in ((request.time_limit is not None, "--time-limit"), (request.spec == STANDARD_INPUT, "-")):
        if given:
            hint = "--watch goes on until Ctrl-C, and looks at a file"
            raise UsageError(Problem("bad-option", f"--watch with {word}", hint=hint))
    once = request._replace(watch=False)
    while True:
        before = state(request.spec)
        _clear()
        try:
            contained(lambda: run(once), ("run", request.spec))
        except HeunError as error:
            report_problems(error.problems)
        if not request.quiet:
            say(f"heun: watching {shown(request.spec)}; Ctrl-C ends it")
        while (now := state(request.spec)) == before or now[0] is None:  # gone for the moment in which it is replaced
            time.sleep(PAUSE)


def _clear() -> None:
    """An empty screen, where there is one."""
    if terminal.present() and terminal.styled():
        sys.stdout.write(CLEAR)
        sys.stdout.flush()


def state(spec: str) -> State:
    """What tells whether a file was saved: of the spec, and of the tables and curves that it names."""
    return tuple(_stamp(Path(name)) for name in (spec, *_files_of(spec)))


def _stamp(path: Path) -> tuple[str, int, int, int] | None:
    try:
        found = path.stat()
    except OSError:
        return None
    return str(path), found.st_mtime_ns, found.st_size, found.st_ino


def _files_of(spec: str) -> Iterator[str]:
    """The files that a spec names; none while it cannot be read."""
    try:
        data = mapping(read(spec, None).data)
    except (HeunError, Finding):
        return
    expected: Any = data.get("expect")
    named = [mapping(table).get("file") for table in mapping(data.get("tables")).values()]
    named += [mapping(item).get("curve") for item in (expected if isinstance(expected, list) else [])]
    yield from (str(Path(spec).parent / name) for name in named if isinstance(name, str))
