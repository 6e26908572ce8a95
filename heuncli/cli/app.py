"""The command line as typer reads it, made of the rows in cli/requests.py: help, completion, and usage errors."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Annotated, Any

import typer

from heuncli.cli.requests import COMMANDS, LATER_OPTIONS, Request, Row, rows

EPILOG = "Exit codes: 0 fine, 1 a check failed, 2 bad usage or spec, 3 cannot be solved, 4 a limit, 5 output, 70 a bug."


def read(argv: list[str]) -> Request | int:
    """The request of a command line, or the exit code where typer has answered itself (help, completion, bad usage)."""
    taken: list[Request] = []
    app = typer.Typer(
        name="heun",
        help="Reactions, section forces and mass effects of rigid bodies and linked chains, after Heun (1901).",
        epilog=EPILOG,
        no_args_is_help=True,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
    )
    app.callback()(_callback)
    for name, command in COMMANDS.items():
        app.command(name, help=command.__doc__)(_reader(command, taken.append))
    try:
        app(argv, prog_name="heun")
    except SystemExit as leaving:
        if not taken:
            return leaving.code if isinstance(leaving.code, int) else 0
    return taken[0]


def _callback(
    version: Annotated[bool, typer.Option("--version", help="The version, and which kernel runs.")] = False,
) -> None:
    """Takes `--version` into the help; cli/entry.py answers it before typer is imported."""


def _reader(command: type[Request], take: Callable[[Request], None]) -> Callable[..., None]:
    """A function with the command's options as parameters, which typer calls with their values."""

    def run(**values: Any) -> None:
        given: dict[str, Any] = {name: tuple(v) if isinstance(v, list) else v for name, v in values.items()}
        take(command(**given))

    parameters = [_parameter(row, command._field_defaults) for row in rows(command)]
    run.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    run.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    return run


def _parameter(row: Row, defaults: Mapping[str, Any]) -> inspect.Parameter:
    kind: Any = list[str] if row.type == tuple[str, ...] else row.type
    words, text, metavar = row.option
    if not words:
        argument = typer.Argument(help=text, metavar=metavar, show_default=False)
        default = defaults.get(row.name, inspect.Parameter.empty)
        annotation = Annotated[kind, argument]
        return inspect.Parameter(row.name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
    default = defaults[row.name]
    return inspect.Parameter(
        row.name,
        inspect.Parameter.KEYWORD_ONLY,
        default=list(default) if isinstance(default, tuple) else default,
        annotation=Annotated[
            kind,
            typer.Option(*words, help=text, metavar=metavar, show_default=False, hidden=row.name in LATER_OPTIONS),
        ],
    )
