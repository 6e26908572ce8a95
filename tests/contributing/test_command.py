"""A command is a folder with its request and its work, and a row."""

from __future__ import annotations

from pathlib import Path

from tests.contributing.addition import Addition, Edit, heun

WEIGH = Addition(
    "A command",
    {
        "heuncli/app/cli/registry.py": (
            Edit('    Command("explain"),\n', '    Command("explain"),\n    Command("weigh"),\n'),
        ),
        "heuncli/app/cli/help.txt": (
            Edit("  schema       Print", "  weigh        The mass of all bodies together.\n  schema       Print"),
        ),
    },
    {
        "heuncli/app/commands/weigh/__init__.py": "",
        "heuncli/app/commands/weigh/request.py": '''"""What `heun weigh` is asked for: its options and arguments."""

from typing import Annotated, NamedTuple

from heuncli.app.cli.options import OUTPUT, SPEC


class WeighRequest(NamedTuple):
    """The mass of all bodies together."""

    spec: Annotated[str, SPEC]
    output: Annotated[str | None, OUTPUT] = None
''',
        "heuncli/app/commands/weigh/command.py": '''"""`heun weigh`: the mass of all bodies together."""

from heuncli.app.cli.output import emit
from heuncli.app.commands.weigh.request import WeighRequest
from heuncli.multibody.mechanism.build import build
from heuncli.scene.file_format.load import load


def main(request: WeighRequest) -> int:
    """Run the command; returns the exit code."""
    emit(f"{sum(body.mass for body in build(load(request.spec), {}).bodies):g} kg\\n", request.output)
    return 0
''',
        "two.yaml": """\
heun: 1
bodies:
  a: {mass: 4, center: [0, 0, 0], inertia: [1, 1, 1]}
  b: {mass: 0.5, center: [0, 0, 0], inertia: [1, 1, 1]}
""",
    },
)


def test_a_command(tmp_path: Path) -> None:
    """It is helped with, does its work, writes where it is told to, and its misspelt name is known."""
    folder = WEIGH.made_in(tmp_path)
    assert "The mass of all bodies together." in heun(folder, "weigh", "--help").stdout
    assert "The mass of all bodies together." in heun(folder, "--help").stdout
    assert heun(folder, "weigh", "two.yaml").stdout == "4.5 kg\n"
    assert heun(folder, "weigh", "two.yaml", "-o", "mass.txt").returncode == 0
    assert (folder / "mass.txt").read_text() == "4.5 kg\n"
    assert heun(folder, "weigh", "nothing.yaml").returncode == 2
    assert "weigh" in heun(folder, "wheigh").stderr
    assert heun(folder, "explain", "weigh").stdout.startswith("# Commands\n")  # the page that its row names


def test_its_list() -> None:
    assert WEIGH.is_as_listed()
