"""`heun run --watch`: run again whenever the spec, or a file that it reads, is saved, until interrupted.

Checking the status of the files five times a second works on every system, and also notices editors that replace the
old file by a new one. Impure: files, time, terminal.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NoReturn

from heuncli.app.cli import terminal
from heuncli.app.cli.entry import UsageError, report_problems, run_contained
from heuncli.app.cli.output import print_stderr
from heuncli.app.commands.run.request import RunRequest
from heuncli.base.errors import Finding, HeunError, Problem
from heuncli.base.text_safety import escape
from heuncli.scene.file_format.names import as_mapping
from heuncli.scene.file_format.reading import STANDARD_INPUT
from heuncli.scene.file_format.source import read_source

CHECK_INTERVAL = 0.2  # s between two checks
CLEAR = "\x1b[2J\x1b[3J\x1b[H"
State = tuple[tuple[str, int, int, int] | None, ...]


def watch(request: RunRequest, run: Callable[[RunRequest], int]) -> NoReturn:
    """Run again after each change, until interrupted. Raises UsageError if there is no file to watch."""
    for is_given, word in ((request.time_limit is not None, "--time-limit"), (request.spec == STANDARD_INPUT, "-")):
        if is_given:
            hint = "leave it out; --watch runs until Ctrl-C and needs a file"
            raise UsageError(Problem("bad-option", f"--watch and {word} cannot be combined", hint=hint))
    single_run = request._replace(watch=False)
    while True:
        old_state = read_state(request.spec)
        _clear_screen()
        try:
            run_contained(lambda: run(single_run), ("run", request.spec))
        except HeunError as error:
            report_problems(error.problems)
        if not request.quiet:
            print_stderr(f"heun: watching {escape(request.spec)}; Ctrl-C stops it")
        while (new_state := read_state(request.spec)) == old_state or new_state[
            0
        ] is None:  # briefly missing while an editor replaces it
            time.sleep(CHECK_INTERVAL)


def _clear_screen() -> None:
    """Clear the screen, if there is one."""
    if terminal.is_terminal() and terminal.supports_styles():
        sys.stdout.write(CLEAR)
        sys.stdout.flush()


def read_state(spec: str) -> State:
    """Return the status of the spec and of the tables and curves that it names; it differs after a save."""
    return tuple(_read_stamp(Path(name)) for name in (spec, *_iter_files(spec)))


def _read_stamp(path: Path) -> tuple[str, int, int, int] | None:
    try:
        status = path.stat()
    except OSError:
        return None
    return str(path), status.st_mtime_ns, status.st_size, status.st_ino


def _iter_files(spec: str) -> Iterator[str]:
    """Yield the files that a spec names; none while it cannot be read."""
    try:
        data = as_mapping(read_source(spec, None).data)
    except (HeunError, Finding):
        return
    expected: Any = data.get("expect")
    names = [as_mapping(table).get("file") for table in as_mapping(data.get("tables")).values()]
    names += [as_mapping(item).get("curve") for item in (expected if isinstance(expected, list) else [])]
    yield from (str(Path(spec).parent / name) for name in names if isinstance(name, str))
