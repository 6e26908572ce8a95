"""Every command is a module or folder in heuncli/app/commands and a row in app/cli/registry.py, and loads no other.

The contracts of import-linter hold that where imports are written down; here it is seen in fresh processes.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import heuncli
from heuncli.app.cli.options import list_fields
from heuncli.app.cli.registry import COMMANDS, Command

PACKAGE = Path(heuncli.__file__).parent
LINES = {  # of others: the spec
    "methods": (), "explain": (), "schema": (), "new": (),
    "diff": ("-", "nosuch.json"), "find": ("-", "bodies.bar.mass=1:2kg", "max joints.pivot.force = 15 N"),
    "sensitivity": ("-", "bodies.bar.mass", "--measure", "max joints.pivot.force"),
    "export": ("loads", "-", "--at", "last"),
    "chart": ("-", "--methods", "RK4", "--steps", "0.02"),
}  # fmt: skip
SWINGING = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies: {bar: {mass: 1, center: [0, 0, -0.5], inertia: [0.1, 0.1, 0.01]}}
joints: {pivot: {type: pin, axis: [1, 0, 0], from: ground.O, to: {body: bar, at: [0, 0, 0]}}}
analysis: {duration: 0.1, samples: 3}
"""
# What is loaded first belongs to no command; then each line of words is done by a fork, so that it is loaded once.
LOADED = """\
import io, json, os, sys
import numpy, pydantic, yaml, heuncli.study.workflow, heuncli.scene.file_format.load
text, *lines = json.load(sys.stdin)
for words in lines:
    if not (child := os.fork()):
        sys.stdin = io.TextIOWrapper(io.BytesIO(text.encode()))
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
        sys.stdout, told = io.TextIOWrapper(io.BytesIO()), sys.stdout
        from heuncli.app.cli.entry import enter
        enter(words)
        print(*(name for name in sys.modules if name.startswith("heuncli.app.commands.")), file=told, flush=True)
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0, words
"""


def test_every_module_has_its_row_and_every_row_its_module_and_its_page() -> None:
    folder = PACKAGE / "app" / "commands"
    modules = {path.parent.name for path in folder.glob("*/__init__.py")}
    modules |= {path.stem for path in folder.glob("*.py")} - {"__init__"}
    assert {head_of(command) for command in COMMANDS} == modules and len(COMMANDS) == len(modules)
    assert all((PACKAGE / "manual" / f"{command.page}.md").exists() for command in COMMANDS)
    assert all(command.help and list_fields(command.request) for command in COMMANDS)


def head_of(command: Command) -> str:
    """Its module or folder."""
    return (command.module or command.name).partition(".")[0]


def list_loaded(*lines: tuple[str, ...]) -> list[set[str]]:
    """Modules of commands that a fresh process has loaded when it has done each of these."""
    done = subprocess.run(
        [sys.executable, "-c", LOADED],
        input=json.dumps([SWINGING, *lines]), capture_output=True, text=True, check=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(PACKAGE.parent), os.environ.get("PYTHONPATH", "")])},
    )  # fmt: skip
    return [set(line.split()) for line in done.stdout.splitlines()]


def folders_of(modules: set[str]) -> Iterator[str]:
    """Whose they are."""
    return (name.split(".")[3] for name in modules)


@pytest.mark.heavy
def test_a_command_loads_nothing_of_another() -> None:
    lines = [(command.name, *LINES.get(command.name, ("-",))) for command in COMMANDS]
    for command, found in zip(COMMANDS, list_loaded(*lines), strict=True):
        assert f"heuncli.app.commands.{command.module or command.name}" in found
        assert {*folders_of(found)} == {head_of(command)}


def test_the_help_of_all_commands_loads_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    assert list_loaded(("--help",)) == [set()]  # where it is at hand
    monkeypatch.setenv("COLUMNS", "70")
    assert list_loaded(("--help",)) == [set()]  # as typer makes it
