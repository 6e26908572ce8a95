"""The table of commands: a new command is a module in heuncli/app/commands and a row here.

The module has the named tuple of the command's options, such as ModesRequest of `heun modes`, and main(request) -> exit
code. A longer command is a folder: `command.py` with main, and the modules that only this command needs, such as
`page.py` for how its result is shown. What a command computes is in heuncli/analyses.

A module is imported by its name when its command runs, so nothing below heuncli/app/commands imports it, and no command
loads code of another. Code that two commands share is in layers below: app/cli, output, analyses or study.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

from heuncli.app.cli.options import Request
from heuncli.app.cli.timeout import DEFAULT_PHASE, GRACE
from heuncli.base.named_tuples import NamedTuple

FOLDER = "heuncli.app.commands"


class Command(NamedTuple):
    """A command.

    name: its word on the command line
    help: what it does, a line of `heun --help`; stands here so that the list of commands imports none
    module: where its `main` is, in heuncli/app/commands, if not in the module of its name
    request_module: where its request is, if not there: `heun run --help` needs no more than that
    page: the manual page that describes it
    grace: how long it may run beyond its time limit [s]; longer for a command that then shows a partial result
    phase: what the error of the time limit names as the current work, if app/cli/timeout.py has no words for the
    modules at work
    """

    name: str
    help: str
    module: str = ""
    request_module: str = ""
    page: str = "commands"
    grace: float = GRACE
    phase: str = DEFAULT_PHASE

    @property
    def request(self) -> type[Request]:
        """The named tuple of its options."""
        module = import_module(f"{FOLDER}.{self.request_module or self.module or self.name}")
        request_type: type[Request] = getattr(module, f"{self.name.capitalize()}Request")
        return request_type

    def main(self, request: Request) -> int:
        """Run the command; returns the exit code."""
        return int(self._import_module().main(request))

    def _import_module(self) -> Any:
        """Import the module of its `main`."""
        return import_module(f"{FOLDER}.{self.module or self.name}")


class ParsedCommand(NamedTuple):
    """A parsed command line: a command and its request."""

    command: Command
    request: Request


COMMANDS = (
    Command("run", "Solve a spec and report its loads and motion.", module="run.command", request_module="run.request"),
    Command("validate", "Read specs and report every error of every file."),
    Command("model", "Show the model that heun makes from a spec, and why.", page="model"),
    Command(
        "modes",
        "Find frequencies, damping and mode shapes of small oscillations about the rest position.",
        page="modes",
    ),
    Command(
        "balance",
        "Find inertia forces (mass effects) over a cycle: foundation loads by order, counterweights, flywheel.",
        module="balance.command",
        page="balance",
        phase="while the cycle was computed",
    ),
    Command(
        "chart",
        "Compare speed and accuracy of methods at several tolerances or steps, and show which fail and where.",
        page="chart",
        grace=0.8,
    ),
    Command(
        "probe",
        "Show where a motion is numerically difficult (singular positions, stiffness, chaos), with a verdict.",
        page="probe",
        phase="while disturbances of the motion were examined",
    ),
    Command(
        "lagrange",
        "Evaluate Lagrange's equations: effective inertia, generalised forces by cause, velocity terms.",
        module="lagrange.command",
        page="lagrange",
        phase="while the equations were formed",
    ),
    Command(
        "sweep",
        "Solve variants of a spec and list a result of each.",
        module="sweep.command",
        request_module="sweep.request",
        page="variants",
    ),
    Command(
        "find",
        "Find every value of a parameter at which a result equals a value, or where it is below or above.",
        module="find.command",
        page="variants",
    ),
    Command("sensitivity", "Show how results depend on parameters.", module="sensitivity.command", page="variants"),
    Command(
        "tune",
        "Find the parameter values that minimise or maximise a result, within limits on other results.",
        module="tune.command",
        request_module="tune.options",
        page="variants",
        grace=0.8,
        phase="while variants were solved",
    ),
    Command(
        "plot",
        "Plot loads and motion (over time, along a bar, polar), the machine, a sweep, modes or orders.",
        module="plot.command",
        request_module="plot.request",
        page="pictures",
    ),
    Command(
        "show",
        "Show the moving machine and its loads on a self-contained page for a browser.",
        page="pictures",
    ),
    Command(
        "report",
        "Write a client report: loads, sections, checks, the machine, and the accuracy of the results.",
        module="report.command",
        request_module="report.request",
        page="pictures",
    ),
    Command(
        "export", "Write load cases of a body for a stress analysis, or the scene as URDF or MJCF.", page="exporting"
    ),
    Command(
        "check",
        "Check specs, and folders of specs, against their `expect` values and golden files.\n\n"
        "With --references: check published cases against their published results.",
        module="check.command",
        request_module="check.request",
        page="pipelines",
    ),
    Command(
        "diff",
        "Show what changed by more than the stated errors between two specs, golden files or JSON results.",
        module="diff.command",
        page="pipelines",
    ),
    Command(
        "import",
        "Convert a model of another program to a spec: a robot in URDF, or a MuJoCo model (MJCF).",
        module="importing",
        page="importing",
    ),
    Command("methods", "List the integration methods and their uses.", page="methods"),
    Command("explain", "Show a page or section of the manual, or explain a term or code.", module="explain.command"),
    Command("schema", "Print the JSON Schema of specs, for editors."),
    Command("new", "Write a spec to start from; without arguments, list the kinds."),
)


def find_command(name: str) -> Command | None:
    """Return the command of a name, or None."""
    return next((command for command in COMMANDS if command.name == name), None)
