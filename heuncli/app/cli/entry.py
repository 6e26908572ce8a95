"""Run a command line and return its exit code (manual/commands.md, "Exit codes").

Results go to standard output, everything else to standard error; a command that fails writes no results. Impure.

Two readers share a command line. A plain line, as nearly all are, is read here, exactly as typer would; the rest (help,
usage errors, completion) is left to typer, which takes 35 ms to import (manual/decisions.md). Both read the same
requests; tests/cli/test_readers.py compares them.
"""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from heuncli.app.cli import terminal, timeout
from heuncli.app.cli.options import REQUIRED, list_fields, make_request
from heuncli.app.cli.output import emit, print_stderr
from heuncli.app.cli.registry import ParsedCommand, find_command
from heuncli.base.errors import HeunError, LimitError, Problem
from heuncli.base.errors import UsageError as UsageError  # re-exported for the commands
from heuncli.base.files import ReaderGoneError
from heuncli.base.process import progress_listener, remaining_address_space
from heuncli.base.text_safety import escape
from heuncli.scene.file_format.reading import forget_files_read
from heuncli.version import VERSION

INTERRUPTED = 130  # exit code
BUG = 70  # exit code
Result = TypeVar("Result")
EXIT_CODE_PRIORITY = (BUG, 5, 2, 3, 4, 1)  # manual/commands.md, "Exit codes": which exit code stands for several files
MIN_MEMORY = 160e6  # bytes of address space for the modules of Python, NumPy and the kernel
UNMAPPED = ("failed to map segment", "cannot allocate memory", "Cannot allocate memory")  # messages of system loaders
OUT_OF_MEMORY = Problem("out-of-memory", "not enough memory", hint="use fewer samples, or --only")


class Bug(HeunError):
    """An unexpected exception: a mistake in heun itself."""

    exit_code = BUG


def enter(argv: Sequence[str]) -> int:
    """Run one command line; returns its exit code."""
    forget_files_read()
    try:
        return run_contained(lambda: _run_command(list(argv)), argv)
    except ReaderGoneError as gone:
        return gone.exit_code
    except HeunError as error:
        _print_traceback()
        report_problems(error.problems)
        return error.exit_code
    except KeyboardInterrupt:
        print_stderr("heun: interrupted")
        return INTERRUPTED


def run_contained(work: Callable[[], Result], argv: Sequence[str]) -> Result:
    """Run the work of a command line and return its result; every failure becomes a HeunError.

    Lack of memory becomes LimitError, any other unexpected exception KernelError where the compiled kernel is not of
    these sources, else Bug. The error is raised outside of the `except`, so that the caught exception and all that its
    frames hold are freed first.
    """
    error: HeunError
    try:
        return work()
    except HeunError:
        raise
    except MemoryError:
        error = LimitError(OUT_OF_MEMORY)
    except Exception as mishap:
        _print_traceback()
        error = _make_error(mishap, argv)
    raise error


def report_problems(problems: Sequence[Problem], label: str = "") -> None:
    """Print every problem to standard error, with location, message, code and hint."""
    for line in format_problems(problems, label):
        print_stderr(line)
    print_explain_hint(problems)


def print_explain_hint(problems: Sequence[Problem]) -> None:
    """Print which `heun explain` describes these problems, on a terminal."""
    if sys.stderr is not None and sys.stderr.isatty() and problems:
        codes = list(dict.fromkeys(problem.code for problem in problems))
        others = f" (also: {', '.join(codes[1:4])})" if codes[1:] else ""
        print_stderr(f"for details: heun explain {codes[0]}{others}")


def format_problems(problems: Sequence[Problem], label: str = "") -> list[str]:
    """Return every problem as it is printed."""
    return [f"{'' if problem.location else 'heun: '}{escape(label)}{problem}" for problem in problems]


def select_exit_code(codes: Sequence[int]) -> int:
    """Return the exit code that stands for those of several files."""
    return next((code for code in EXIT_CODE_PRIORITY if code in codes), 0)


def _run_command(argv: list[str]) -> int:
    """Run the command of a line, under its time limit; returns its exit code. Raises HeunError."""
    if (text := terminal.find_text(argv)) is not None:
        emit(text)
        return 0
    parsed = read_command_line(argv)
    if isinstance(parsed, int):
        return parsed
    command, request = parsed
    for name in ("time_limit", "time_limit_each"):
        _require_limit(f"--{name.replace('_', '-')}", getattr(request, name, None))
    _require_memory()
    limit = getattr(request, "time_limit", None)
    with progress_listener(None if getattr(request, "quiet", False) else lambda text: print_stderr(f"heun: {text}")):
        return timeout.run_with_limit(lambda: command.main(request), limit, command.grace, command.phase)


def _require_limit(option: str, limit: float | None) -> None:
    """Raise UsageError if a time limit is not a positive, finite number."""
    if limit is not None and not 0.0 < limit < math.inf:
        hint = f"for example {option} 60, in s; leave it out for no limit"
        raise UsageError(Problem("bad-option", f"{option} {limit:g}: expected a positive number", hint=hint))


def _require_memory() -> None:
    """Raise LimitError [out-of-memory] if a limit on the address space leaves too little to start."""
    available = remaining_address_space()
    if available is None:
        return
    if available < MIN_MEMORY:
        message = f"the memory limit leaves {available / 1e6:.0f} MB; heun needs {MIN_MEMORY / 1e6:.0f} MB to start"
        raise LimitError(Problem("out-of-memory", message, hint="raise the limit (ulimit -v)"))
    import numpy as np

    np.ones((64, 64)) @ np.ones((64, 64))  # BLAS allocates its memory now; it would end the process without any


def _is_memory_error(error: Exception) -> bool:
    """Return whether a library could not be loaded for lack of memory."""
    return isinstance(error, ImportError) and any(words in str(error) for words in UNMAPPED)


def _make_error(mishap: Exception, argv: Sequence[str]) -> HeunError:
    """Make the error that an unexpected exception becomes."""
    if _is_memory_error(mishap):
        return LimitError(OUT_OF_MEMORY)
    from heuncli.kernel.form import KernelError, find_stale_problem  # all else has it by now, or does not need it

    stale = find_stale_problem()
    return Bug(_make_bug_problem(mishap, argv)) if stale is None else KernelError(stale)


def _print_traceback() -> None:
    """Print the traceback of the current exception, if HEUN_DEBUG is 1."""
    if os.environ.get("HEUN_DEBUG") == "1":
        import traceback

        print_stderr(traceback.format_exc())


def _make_bug_problem(bug: Exception, argv: Sequence[str]) -> Problem:
    """Make the problem of an unexpected exception: where it was raised, and the line that led to it."""
    location = bug.__traceback__
    while location is not None and location.tb_next is not None:
        location = location.tb_next
    file = os.path.basename(location.tb_frame.f_code.co_filename) if location else ""  # noqa: PTH119 - pathlib takes 3 ms
    where = f" at {file}:{location.tb_lineno}" if location else ""
    line = f"heun {' '.join(argv)} (version {VERSION})"
    hint = f"please report it with the spec, this line, and: {line}; HEUN_DEBUG=1 shows the traceback"
    return Problem("bug", f"this is a bug in heun: {type(bug).__name__}: {bug}{where}", hint=hint)


NUMBER_PARSERS: dict[object, Callable[[str], float]] = {float | None: float, int | None: int}


def read_command_line(argv: Sequence[str]) -> ParsedCommand | int:
    """Return the command and its request; or the exit code if help or an error of usage was the answer."""
    return read_plain(argv) or _read_with_typer([*argv])


def read_plain(argv: Sequence[str]) -> ParsedCommand | None:
    """Parse a command line, or return None if typer has to: for help, errors, `--`, bundled short options."""
    command = find_command(argv[0]) if argv else None
    if command is None:
        return None
    request = command.request
    fields = list_fields(request)
    options = {word: field for field in fields for word in field.option.words}
    values: dict[str, Any] = {}
    arguments: list[str] = []
    words = iter(argv[1:])
    for word in words:
        if not word.startswith("-") or word == "-":
            arguments.append(word)
            continue
        name, equals, value = word.partition("=") if word.startswith("--") else (word, "", "")
        field = options.get(name)
        if field is None or (field.type is bool and equals):
            return None
        text = "" if field.type is bool else value if equals else next(words, None)
        if text is None:
            return None
        if field.type is bool:
            values[field.name] = True
        elif field.type == tuple[str, ...]:
            values[field.name] = (*values.get(field.name, ()), text)
        elif field.type in NUMBER_PARSERS:
            try:
                values[field.name] = NUMBER_PARSERS[field.type](text)
            except ValueError:
                return None
        else:
            values[field.name] = text
    positional_fields = [field for field in fields if not field.option.words]
    if any(target.type == tuple[str, ...] for target in positional_fields):
        values |= {positional_fields[0].name: tuple(arguments)} if arguments else {}
    elif len(arguments) > len(positional_fields):
        return None
    else:
        values |= {target.name: argument for target, argument in zip(positional_fields, arguments, strict=False)}
    if any(target.name not in values and target.default is REQUIRED for target in positional_fields):
        return None
    return ParsedCommand(command, make_request(request, values))


# Options of other programs: what they are called here.
FOREIGN_OPTIONS = {
    **{f"--{form}": f"--format {form}" for form in ("json", "csv", "markdown", "table")}, "--md": "--format markdown",
    "--out": "--output FILE", "--outfile": "--output FILE", "--save": "--output FILE", "--param": "--set NAME=VALUE",
    "--times": "--at WHEN", "--verbose": "--full", "--short": "--summary", "--silent": "--quiet",
    "--tol": "--tolerance NUMBER", "--dt": "--step SECONDS", "--solver": "--method NAME", "--timeout": "--time-limit S",
}  # fmt: skip


def find_option_hints(argv: Sequence[str]) -> list[str]:
    """Return a hint for each option of another program, where the command has such an option under heun's name."""
    command = find_command(argv[0]) if argv else None
    if command is None:
        return []
    words = {word for field in list_fields(command.request) for word in field.option.words}
    typed = [word.partition("=")[0] for word in argv[1:]]
    found = {word: FOREIGN_OPTIONS[word] for word in typed if word in FOREIGN_OPTIONS and word not in words}
    return [f"hint: write {known} for {word}" for word, known in found.items() if known.split()[0] in words]


def _read_with_typer(argv: list[str]) -> ParsedCommand | int:
    """Read any command line by typer; what typer prints goes to the streams as heun writes them."""
    import contextlib
    import io
    import warnings

    output, errors = io.StringIO(), io.StringIO()  # typer reports to output if standard error is closed
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors), warnings.catch_warnings():
        # An older typer may use deprecated parts of a newer click; `python -W error` must not fail for that.
        warnings.simplefilter("ignore", DeprecationWarning)
        from heuncli.app.cli import typer_reader

        parsed = typer_reader.read([*map(escape, argv)])  # an error message quotes the words
        if not isinstance(parsed, int):
            parsed = typer_reader.read(argv)
    if text := errors.getvalue():
        print_stderr("\n".join([text.removesuffix("\n"), *find_option_hints(argv)]))
    if text := output.getvalue():
        emit(text)
    return parsed
