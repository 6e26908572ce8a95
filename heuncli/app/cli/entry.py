"""From the words of the command line to an exit code (manual/commands.md, "Exit codes").

Results go to standard output, everything else to standard error; a command that fails has written nothing. Impure.
"""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Callable, Sequence
from typing import TypeVar

from heuncli.app.cli import alarm, at_once, memory, plain
from heuncli.app.cli.output import emit, say
from heuncli.app.cli.registry import Asked
from heuncli.base.announcements import listening
from heuncli.base.errors import HeunError, LimitError, Problem
from heuncli.base.errors import UsageError as UsageError  # for the commands: what they raise beside what is here
from heuncli.base.files import ReaderGone
from heuncli.base.foreign_text import shown
from heuncli.scene.file_format.reading import forget
from heuncli.version import VERSION

INTERRUPTED = 130
Given = TypeVar("Given")
BUG = 70
OF_SEVERAL = (BUG, 5, 2, 3, 4, 1)  # manual/commands.md, "Exit codes": which exit code stands for several files
OUT_OF_MEMORY = Problem("out-of-memory", "the memory does not suffice", hint="fewer samples, or --only")


class Bug(HeunError):
    """What heun does not know how to name: its own mistake."""

    exit_code = BUG


def enter(argv: Sequence[str]) -> int:
    """Run one command line; returns its exit code."""
    forget()
    try:
        return contained(lambda: _command(list(argv)), argv)
    except ReaderGone as gone:
        return gone.exit_code
    except HeunError as error:
        _debug()
        report_problems(error.problems)
        return error.exit_code
    except KeyboardInterrupt:
        say("heun: interrupted")
        return INTERRUPTED


def contained(work: Callable[[], Given], argv: Sequence[str]) -> Given:
    """What the work of a command line gives. Raises HeunError whatever goes wrong: Bug, LimitError where memory ends.

    It is raised outside of the `except`: by then the exception that was caught is freed, with all that its frames hold.
    """
    error: HeunError
    try:
        return work()
    except HeunError:
        raise
    except MemoryError:
        error = LimitError(OUT_OF_MEMORY)
    except Exception as mishap:
        _debug()
        error = LimitError(OUT_OF_MEMORY) if memory.ended(mishap) else Bug(_bug_report(mishap, argv))
    raise error


def report_problems(problems: Sequence[Problem], label: str = "") -> None:
    """Every problem on standard error, as place, finding, code and hint."""
    for line in lines_of(problems, label):
        say(line)
    say_what_explains(problems)


def say_what_explains(problems: Sequence[Problem]) -> None:
    """Where the manual tells of these problems, for somebody at a terminal."""
    if sys.stderr is not None and sys.stderr.isatty() and problems:
        codes = list(dict.fromkeys(problem.code for problem in problems))
        others = f" (and of {', '.join(codes[1:4])})" if codes[1:] else ""
        say(f"heun explain {codes[0]} tells more{others}")


def lines_of(problems: Sequence[Problem], label: str = "") -> list[str]:
    """Every problem as it is told."""
    return [f"{'' if problem.location else 'heun: '}{shown(label)}{problem}" for problem in problems]


def worst(codes: Sequence[int]) -> int:
    """The exit code that stands for those of several files."""
    return next((code for code in OF_SEVERAL if code in codes), 0)


def _command(argv: list[str]) -> int:
    if (text := at_once.text_for(argv)) is not None:
        emit(text)
        return 0
    asked = plain.read(argv) or _through_typer(argv)
    if isinstance(asked, int):
        return asked
    command, request = asked
    for name in ("time_limit", "time_limit_each"):
        _require_limit(f"--{name.replace('_', '-')}", getattr(request, name, None))
    memory.require_some()
    limit = getattr(request, "time_limit", None)
    with listening(None if getattr(request, "quiet", False) else lambda text: say(f"heun: {text}")):
        return alarm.limited(lambda: command.main(request), limit, command.grace, command.phase)


def _require_limit(option: str, limit: float | None) -> None:
    """Raise UsageError where a time limit is none that can be kept."""
    if limit is not None and not 0.0 < limit < math.inf:
        hint = f"such as {option} 60, in s; without it there is none"
        raise UsageError(Problem("bad-option", f"{option} {limit:g}: expected a positive number", hint=hint))


def _through_typer(argv: list[str]) -> Asked | int:
    import contextlib
    import io
    import warnings

    answers, complaints = io.StringIO(), io.StringIO()  # where standard error is closed typer complains to the other
    with contextlib.redirect_stdout(answers), contextlib.redirect_stderr(complaints), warnings.catch_warnings():
        # What an older typer uses of a newer click is not heun's to mend, and no reason to end `python -W error`.
        warnings.simplefilter("ignore", DeprecationWarning)
        from heuncli.app.cli import app

        answer = app.read(list(map(shown, argv)))  # a complaint quotes what it does not understand
        if not isinstance(answer, int):
            answer = app.read(argv)
    if text := complaints.getvalue():
        say(text.removesuffix("\n"))
    if text := answers.getvalue():
        emit(text)
    return answer


def _debug() -> None:
    """The traceback of the exception at hand, for those who ask for it."""
    if os.environ.get("HEUN_DEBUG") == "1":
        import traceback

        say(traceback.format_exc())


def _bug_report(bug: Exception, argv: Sequence[str]) -> Problem:
    location = bug.__traceback__
    while location is not None and location.tb_next is not None:
        location = location.tb_next
    file = os.path.basename(location.tb_frame.f_code.co_filename) if location else ""  # noqa: PTH119 - pathlib takes 3 ms
    where = f" at {file}:{location.tb_lineno}" if location else ""
    line = f"heun {' '.join(argv)} (version {VERSION})"
    hint = f"please report it with the spec, this line, and: {line}; HEUN_DEBUG=1 shows the traceback"
    return Problem("bug", f"this is a bug in heun: {type(bug).__name__}: {bug}{where}", hint=hint)
