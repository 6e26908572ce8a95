"""Read a command line: which command it names, and the request that its words make.

Two readers share the work. A plain line, as nearly all are, is read here, exactly as typer would; the rest (help, usage
errors, completion) is left to typer, which takes 35 ms to import (manual/decisions.md). Both read the same requests;
tests/cli/test_readers.py compares them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from heuncli.app.cli.options import list_fields
from heuncli.app.cli.output import emit, print_stderr
from heuncli.app.cli.registry import ParsedCommand, find_command
from heuncli.base.text_safety import escape

NUMBERS: dict[object, Callable[[str], float]] = {float | None: float, int | None: int}


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
        elif field.type in NUMBERS:
            try:
                values[field.name] = NUMBERS[field.type](text)
            except ValueError:
                return None
        else:
            values[field.name] = text
    targets = [field for field in fields if not field.option.words]
    if any(target.type == tuple[str, ...] for target in targets):
        values |= {targets[0].name: tuple(arguments)} if arguments else {}
    elif len(arguments) > len(targets):
        return None
    else:
        values |= {target.name: argument for target, argument in zip(targets, arguments, strict=False)}
    if any(target.name not in values and target.name not in request._field_defaults for target in targets):
        return None
    return ParsedCommand(command, request(**values))


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
        print_stderr(text.removesuffix("\n"))
    if text := output.getvalue():
        emit(text)
    return parsed
