"""What the README shows is what happens, and its reference names every key, unit and function there is."""

from __future__ import annotations

import io
import re
import shlex
import sys
from pathlib import Path

import pytest
from pydantic import BaseModel

from heuncli.cli.entry import enter
from heuncli.cli.requests import COMMANDS, LATER_COMMANDS
from heuncli.expressions.grammar import ARITY, CONSTANTS
from heuncli.expressions.units import UNITS
from heuncli.spec import format as document
from heuncli.spec.load import load
from heuncli.study.solve.solve import solve
from tests.shared.picture import picture

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "README.md").read_text()


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", TEXT, re.MULTILINE | re.DOTALL)


def words_of(line: str) -> list[str]:
    """The words of a heun command as a shell would split them, up to a pipe."""
    words = shlex.split(line, comments=True)
    return words[1 : words.index("|")] if "|" in words else words[1:]


SHOWN = [block.splitlines() for block in blocks("console")]
TYPED = [line for block in blocks("sh") for line in block.splitlines() if line.startswith("heun ")]


@pytest.fixture
def beside_specs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder to write to, in which specs/ is found as in a checkout."""
    (tmp_path / "specs").symlink_to(ROOT / "specs")
    monkeypatch.chdir(tmp_path)


@pytest.mark.heavy
@pytest.mark.usefixtures("beside_specs")
@pytest.mark.parametrize("line", TYPED)
def test_commands_run(line: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert enter(words_of(line)) == 0
    told = capsys.readouterr().err.splitlines()
    assert all(line.startswith("warning: heun: specs/flat_four_bar.yaml: passes through") for line in told)


@pytest.mark.heavy
@pytest.mark.usefixtures("beside_specs")
@pytest.mark.parametrize("shown", SHOWN, ids=lambda shown: shown[0])
def test_shown_output_is_the_output(shown: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    command, *lines = shown
    assert command.startswith("$ heun ")
    assert enter(words_of(command.removeprefix("$ "))) == 0
    printed = iter(capsys.readouterr().out.splitlines())
    for line in lines:
        assert any(steady(other).startswith(steady(line)) for other in printed), line


def steady(line: str) -> str:
    """A line without its error estimates, which differ in the last bits from machine to machine."""
    return re.sub(r"\de-\d+", "#", line)


def test_the_first_example_runs(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    (example,) = blocks("yaml")
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(example.encode())))
    assert enter(["run", "-"]) == 0
    assert "A bar hangs, and swings" in capsys.readouterr().out


def test_the_picture_shows_the_moments() -> None:
    shaft = solve(load(str(ROOT / "specs" / "chimney.yaml"))).results.sections["shaft"]
    assert "\n".join(picture(shaft["s"], shaft["M2"][0])) in blocks("text")[0]


def keys() -> set[str]:
    models = [m for m in vars(document).values() if isinstance(m, type) and issubclass(m, BaseModel)]
    return {field.alias or name for model in models for name, field in model.model_fields.items()}


def test_every_key_unit_function_and_command_is_named() -> None:
    named = set(re.findall(r"[A-Za-z_]\w*", " ".join(re.findall(r"`([^`\n]+)`", TEXT))))
    later = {"step", "method"}  # keys of what the README lists as not yet
    assert sorted(keys() - named - later) == []
    assert sorted(UNITS.keys() - named) == []
    assert sorted((ARITY.keys() | CONSTANTS.keys()) - named) == []
    assert sorted(set(LATER_COMMANDS) - named) == []
    assert all(f"heun {command}" in TEXT for command in COMMANDS)
