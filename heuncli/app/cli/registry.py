"""The table of commands: a new command is a folder in heuncli/app/commands and a row here.

The folder of a command holds the code that only this command needs:

    request.py   the named tuple of its options, such as RunRequest of `heun run`; imports the vocabulary of
                 app/cli/options.py and nothing else, because `--help` reads the requests of all commands
    command.py   main(request) -> exit code; the only module that knows the command line, files and the terminal
    page.py      how the result is shown; and the like. What it computes is in heuncli/analyses

Both modules are imported by name when the command runs, so nothing below heuncli/app/commands imports them, and no
command loads code of another. Code that two commands share is in layers below: app/cli, output, analyses or study.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

from heuncli.app.cli.options import Request
from heuncli.app.cli.timeout import DEFAULT_PHASE, GRACE
from heuncli.base.named_tuples import NamedTuple


class Command(NamedTuple):
    """A command.

    name: its word on the command line
    folder: its folder in heuncli/app/commands, if not the name
    page: the manual page that describes it
    grace: how long it may run beyond its time limit [s]; longer for a command that then shows a partial result
    phase: what the error of the time limit names as the current work, if app/cli/timeout.py has no words for the
    modules at work
    """

    name: str
    folder: str = ""
    page: str = "commands"
    grace: float = GRACE
    phase: str = DEFAULT_PHASE

    @property
    def request(self) -> type[Request]:
        """The named tuple of its options."""
        request_type: type[Request] = getattr(self._module("request"), f"{self.name.capitalize()}Request")
        return request_type

    def main(self, request: Request) -> int:
        """Run the command; returns the exit code."""
        return int(self._module("command").main(request))

    def _module(self, file: str) -> Any:
        return import_module(f"heuncli.app.commands.{self.folder or self.name}.{file}")


class ParsedCommand(NamedTuple):
    """A parsed command line: a command and its request."""

    command: Command
    request: Request


COMMANDS = (
    Command("run"),
    Command("validate"),
    Command("model", page="model"),
    Command("modes", page="modes"),
    Command("balance", page="balance", phase="while the cycle was computed"),
    Command("chart", page="chart", grace=0.8),
    Command("probe", page="probe", phase="while disturbances of the motion were examined"),
    Command("lagrange", page="lagrange", phase="while the equations were formed"),
    Command("sweep", page="variants"),
    Command("find", page="variants"),
    Command("sensitivity", page="variants"),
    Command("tune", page="variants", grace=0.8, phase="while variants were solved"),
    Command("plot", page="pictures"),
    Command("show", page="pictures"),
    Command("report", page="pictures"),
    Command("export", page="exporting"),
    Command("check", page="pipelines"),
    Command("diff", page="pipelines"),
    Command("import", folder="importing", page="importing"),
    Command("methods", page="methods"),
    Command("explain"),
    Command("schema"),
    Command("new"),
)


def find_command(name: str) -> Command | None:
    """Return the command of a name, or None."""
    return next((command for command in COMMANDS if command.name == name), None)
