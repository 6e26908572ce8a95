"""The commands, a row each: a new command is a folder in heuncli/app/commands and a row here.

The folder of a command holds what it alone needs:

    request.py   the named tuple of its options, such as RunRequest of `heun run`; imports the vocabulary of
                 app/cli/options.py and nothing else, for `--help` reads the requests of all commands
    command.py   main(request) -> exit code; the one module that knows the command line, files and the terminal
    study.py     what it finds out; page.py: how that is told; results.py: the rows of what is found; and the like

Both modules are found by name when the command is asked for, so that nothing below heuncli/app/commands imports any of
it, and one command loads nothing of another. What two commands need stands below them: in cli, report, drawing or
study.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

from heuncli.app.cli.alarm import GRACE, UNTOLD
from heuncli.app.cli.options import Request
from heuncli.base.named_tuples import NamedTuple


class Command(NamedTuple):
    """A command.

    name: the word of the command line; folder: in heuncli/app/commands, where that is not the name; page: the name of
    the page of the manual that tells of it; grace [s]: how long it may go on beyond its time limit, longer for a
    command that then tells the part that is done; phase: what the error of the time limit says was under way, where
    app/cli/alarm.py has no words for the modules at work.
    """

    name: str
    folder: str = ""
    page: str = "commands"
    grace: float = GRACE
    phase: str = UNTOLD

    @property
    def request(self) -> type[Request]:
        """The named tuple of its options."""
        found: type[Request] = getattr(self._module("request"), f"{self.name.capitalize()}Request")
        return found

    def main(self, request: Request) -> int:
        """Do what is asked for; returns the exit code."""
        return int(self._module("command").main(request))

    def _module(self, file: str) -> Any:
        return import_module(f"heuncli.app.commands.{self.folder or self.name}.{file}")


class Asked(NamedTuple):
    """A command line that is understood: a command, and what it is asked for."""

    command: Command
    request: Request


COMMANDS = (
    Command("run"),
    Command("validate"),
    Command("model", page="model"),
    Command("modes", page="modes"),
    Command("balance", page="balance", phase="while the cycle was followed"),
    Command("chart", folder="charting", page="chart", grace=0.8),
    Command("probe", folder="probing", page="probe", phase="while the neighbourhood of the motion was looked at"),
    Command("lagrange", page="lagrange", phase="while the equations were made"),
    Command("sweep", page="variants"),
    Command("find", page="variants"),
    Command("sensitivity", page="variants"),
    Command("tune", page="variants", grace=0.8, phase="while variants were tried"),
    Command("plot", page="pictures"),
    Command("show", page="pictures"),
    Command("report", folder="reporting", page="pictures"),
    Command("export", folder="exporting", page="exporting"),
    Command("check", page="pipelines"),
    Command("diff", page="pipelines"),
    Command("import", folder="importing", page="importing"),
    Command("methods", page="methods"),
    Command("explain"),
    Command("schema"),
    Command("new"),
)


def command_of(name: str) -> Command | None:
    """The command of a name, if there is one."""
    return next((command for command in COMMANDS if command.name == name), None)
