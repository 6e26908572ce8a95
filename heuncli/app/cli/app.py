"""The command line as typer reads it, made of the commands' requests: help, completion, usage errors."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Mapping
from typing import Annotated, Any

import typer

from heuncli.app.cli import registry
from heuncli.app.cli.completion import BY_WORD
from heuncli.app.cli.options import RequestField, fields_of
from heuncli.app.cli.registry import Asked, Command

EPILOG = "Exit codes: 0 fine, 1 a check failed, 2 bad usage or spec, 3 cannot be solved, 4 a limit, 5 output, 70 a bug."
COMPLETING = "_HEUN_COMPLETE"  # set by the shell that asks


def read(argv: list[str]) -> Asked | int:
    """The request of a command line, or the exit code where typer has answered itself (help, completion, bad usage)."""
    taken: list[Asked] = []
    app = typer.Typer(
        name="heun",
        help="Reactions, section forces and mass effects of rigid bodies and linked chains, after Heun (1901).",
        epilog=EPILOG,
        no_args_is_help=True,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
    )
    app.callback()(_callback)
    if COMPLETING in os.environ:  # each line is a completion: typer breaks what explains one at the terminal's width
        os.environ["COLUMNS"] = "10000"
    named = registry.command_of(argv[0]) if argv else None
    for command in registry.COMMANDS if named is None else (named,):
        app.command(command.name, help=command.request.__doc__)(_reader(command, taken.append))
    try:
        app(argv, prog_name="heun")
    except SystemExit as leaving:
        if not taken:
            return leaving.code if isinstance(leaving.code, int) else 0
    return taken[0]


def _callback(
    version: Annotated[bool, typer.Option("--version", help="The version, and which kernel runs.")] = False,
) -> None:
    """Takes `--version` into the help; app/cli/entry.py answers it before typer is imported."""


def _reader(command: Command, take: Callable[[Asked], None]) -> Callable[..., None]:
    """A function with the command's options as parameters, which typer calls with their values."""

    def run(**values: Any) -> None:
        given: dict[str, Any] = {name: tuple(v) if isinstance(v, list) else v for name, v in values.items()}
        take(Asked(command, request(**given)))

    request = command.request
    parameters = [_parameter(field, request._field_defaults) for field in fields_of(request)]
    run.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    run.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    return run


def _parameter(field: RequestField, defaults: Mapping[str, Any]) -> inspect.Parameter:
    kind: Any = list[str] if field.type == tuple[str, ...] else field.type
    option = field.option
    if not option.words:
        argument = typer.Argument(
            help=option.help, metavar=option.metavar, show_default=False, autocompletion=BY_WORD.get(option.completes)
        )
        default = defaults.get(field.name, inspect.Parameter.empty)
        annotation = Annotated[kind, argument]
        return inspect.Parameter(field.name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
    default = defaults[field.name]
    return inspect.Parameter(
        field.name,
        inspect.Parameter.KEYWORD_ONLY,
        default=list(default) if isinstance(default, tuple) else default,
        annotation=Annotated[
            kind,
            typer.Option(
                *option.words,
                help=option.help,
                metavar=option.metavar,
                show_default=False,
                autocompletion=BY_WORD.get(option.completes),
            ),
        ],
    )
