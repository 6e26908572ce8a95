"""Parse plain command lines without typer, which takes 35 ms to import.

It reads what it fully understands, exactly as typer would, and leaves the rest to typer: help and errors.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from heuncli.app.cli.options import list_fields
from heuncli.app.cli.registry import ParsedCommand, find_command

NUMBERS: dict[object, Callable[[str], float]] = {float | None: float, int | None: int}


def read(argv: Sequence[str]) -> ParsedCommand | None:
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
