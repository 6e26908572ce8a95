"""A command is a module with its options and its work, and a row."""

from __future__ import annotations

import json
from pathlib import Path

from tests.contributing.addition import Addition, Edit, heun

WEIGH = Addition(
    "A command",
    {
        "heuncli/app/cli/registry.py": (
            Edit(
                '    Command("schema",',
                '    Command("weigh", "The mass of all bodies together."),\n    Command("schema",',
            ),
        ),
        "heuncli/app/cli/help.txt": (
            Edit("  schema       Print", "  weigh        The mass of all bodies together.\n  schema       Print"),
        ),
    },
    {
        "heuncli/app/commands/weigh.py": '''"""`heun weigh`: the mass of all bodies together."""

from typing import Annotated, NamedTuple

from heuncli.app.cli.documents import emit_document
from heuncli.app.cli.options import FORMAT, OUTPUT, SPEC
from heuncli.app.cli.target import choose_format
from heuncli.multibody.mechanism.build import build
from heuncli.output.documents.document import OutputColumn, OutputDocument, OutputTable
from heuncli.scene.file_format.load import load

COLUMNS = (OutputColumn("body", "text"), OutputColumn("mass", unit="kg"))


class WeighRequest(NamedTuple):
    """The options and arguments of `heun weigh`."""

    spec: Annotated[str, SPEC]
    format: Annotated[str | None, FORMAT] = None
    output: Annotated[str | None, OUTPUT] = None


def main(request: WeighRequest) -> int:
    """Run the command; returns the exit code."""
    form = choose_format(request.format, request.output, ("table", "json", "csv", "markdown"))
    spec = load(request.spec)
    rows = [(body.name, body.mass) for body in build(spec, {}).bodies]
    rows.append(("all", sum(mass for _, mass in rows)))
    emit_document(OutputDocument(spec.title, parts=[OutputTable("MASSES", COLUMNS, rows)]), form, request.output)
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
    text = heun(folder, "weigh", "two.yaml").stdout
    words = [line.split() for line in text.splitlines()[2:]]
    assert words == [["MASSES"], ["body", "mass", "[kg]"], ["a", "4"], ["b", "0.5"], ["all", "4.5"]]
    assert heun(folder, "weigh", "two.yaml", "-o", "mass.txt").returncode == 0
    assert (folder / "mass.txt").read_text() == text
    assert heun(folder, "weigh", "two.yaml", "--format", "csv").stdout == "body,mass\na,4.0\nb,0.5\nall,4.5\n"
    masses = json.loads(heun(folder, "weigh", "two.yaml", "--format", "json").stdout)["masses"]
    assert masses[-1] == {"body": "all", "mass": 4.5}
    assert "| all | 4.5 |" in heun(folder, "weigh", "two.yaml", "--format", "markdown").stdout
    assert heun(folder, "weigh", "nothing.yaml").returncode == 2
    assert "weigh" in heun(folder, "wheigh").stderr
    assert heun(folder, "explain", "weigh").stdout.startswith("# Commands\n")  # the page that its row names


def test_its_list() -> None:
    assert WEIGH.is_as_listed()
