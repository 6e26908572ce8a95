"""Read any command line by typer, made of the commands' requests: help, usage errors, and completion in a shell."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Sequence
from typing import Annotated, Any

import typer

from heuncli.app.cli import registry
from heuncli.app.cli.completion import COMPLETIONS, read_typed_words
from heuncli.app.cli.options import REQUIRED, RequestField, list_fields, make_request
from heuncli.app.cli.registry import Command, ParsedCommand

EPILOG = (
    "Exit codes: 0 success, 1 check failed, 2 bad usage or spec, 3 not solvable, 4 limit, 5 output error, "
    "70 internal error."
)
COMPLETION_VARIABLE = "_HEUN_COMPLETE"  # set by a shell that completes


def read(argv: list[str]) -> ParsedCommand | int:
    """Parse a command line; returns its request, or the exit code if typer itself answered (help, completion, bad
    usage).
    """
    parsed: list[ParsedCommand] = []
    app = typer.Typer(
        name="heun",
        help="Reactions, section forces and inertia forces of rigid bodies and mechanisms, after Heun (1901).",
        epilog=EPILOG,
        no_args_is_help=True,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
    )
    app.callback()(_callback)
    if COMPLETION_VARIABLE in os.environ:  # each line is a completion, which typer must not wrap
        os.environ["COLUMNS"] = "10000"
    requested = _find_requested(argv)
    for command in registry.COMMANDS:
        reader = _make_reader(command, parsed.append) if command is requested else _take_no_options
        app.command(command.name, help=command.help)(reader)
    try:
        app(argv, prog_name="heun")
    except SystemExit as leaving:
        if not parsed:
            return leaving.code if isinstance(leaving.code, int) else 0
    return parsed[0]


def _callback(
    version: Annotated[bool, typer.Option("--version", help="Show the version and the kernel, and exit.")] = False,
) -> None:
    """Add `--version` to the help; app/cli/entry.py answers it before typer is imported."""


def _find_requested(argv: Sequence[str]) -> Command | None:
    """Return the command that is named: its options alone are needed. A shell that completes hands over the line in its
    environment.
    """
    words = read_typed_words()[1:] if COMPLETION_VARIABLE in os.environ else argv
    return registry.find_command(next((word for word in words if not word.startswith("-")), ""))


def _take_no_options() -> None:
    """Stand for a command that is only listed."""


def _make_reader(command: Command, take: Callable[[ParsedCommand], None]) -> Callable[..., None]:
    """Make the function that typer calls, with the command's options as parameters."""

    def run(**values: Any) -> None:
        """Take the values that typer parsed, as a request."""
        arguments: dict[str, Any] = {name: tuple(v) if isinstance(v, list) else v for name, v in values.items()}
        take(ParsedCommand(command, make_request(request, arguments)))

    request = command.request
    parameters = [_make_parameter(field) for field in list_fields(request)]
    run.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    run.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    return run


def _make_parameter(field: RequestField) -> inspect.Parameter:
    """Make typer's parameter of an option or argument."""
    kind: Any = list[str] if field.type == tuple[str, ...] else field.type
    option = field.option
    if not option.words:
        argument = typer.Argument(
            help=option.help,
            metavar=option.metavar,
            show_default=False,
            autocompletion=COMPLETIONS.get(option.completes),
        )
        default = inspect.Parameter.empty if field.default is REQUIRED else field.default
        annotation = Annotated[kind, argument]
        return inspect.Parameter(field.name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
    default = field.default
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
                autocompletion=COMPLETIONS.get(option.completes),
            ),
        ],
    )
