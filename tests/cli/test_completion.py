"""What a shell completes, asked for as bash, zsh and fish ask."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from heuncli.app.cli.entry import enter
from tests.shared.command import HANGING
from tests.shared.shell import ENVIRONMENT

SPEC = HANGING + "cases: {heavy: {set: {m: 3}}, light: {set: {m: 0.1}}}\n"


@pytest.fixture
def beside(tmp_path: Path) -> Path:
    (tmp_path / "scene.yaml").write_text(SPEC)
    (tmp_path / "folder").mkdir()
    (tmp_path / "notes.txt").write_text("")
    (tmp_path / "wrong.yaml").write_text("heun: [")
    return tmp_path


Asked = Callable[[str, str], list[str]]


def question(shell: str, line: str) -> dict[str, str]:
    """What a shell sets to ask for the completions of the last word of a line, on a narrow terminal."""
    own = {"bash": {"COMP_WORDS": line, "COMP_CWORD": str(len(line.split(" ")) - 1)},
           "zsh": {"_TYPER_COMPLETE_ARGS": line},
           "fish": {"_TYPER_COMPLETE_ARGS": line, "_TYPER_COMPLETE_FISH_ACTION": "get-args"}}[shell]  # fmt: skip
    return {"_HEUN_COMPLETE": f"complete_{shell}", "COLUMNS": "20", **own}


def offered(shell: str, text: str) -> list[str]:
    """The completions in an answer."""
    if shell == "zsh":
        return [part.split('":')[0].replace('\\"', '"') for part in text.split('"') if part.strip(" :()'\n")][1:]
    return [line.split("\t")[0] for line in text.splitlines() if line]


@pytest.fixture
def asked(beside: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Asked:
    """What is offered to a shell for a line, in this process."""
    monkeypatch.chdir(beside)

    def ask(shell: str, line: str) -> list[str]:
        with monkeypatch.context() as environment:
            for name, value in question(shell, line).items():
                environment.setenv(name, value)
            capsys.readouterr()
            assert enter([]) == 0
        text, complaints = capsys.readouterr()
        assert complaints == ""
        return offered(shell, text)

    return ask


def test_a_shell_asks_a_process(beside: Path) -> None:
    line = [sys.executable, "-m", "heuncli"]
    environment = {**ENVIRONMENT, **question("bash", "heun run sc")}
    done = subprocess.run(line, cwd=beside, env=environment, capture_output=True, text=True, check=True)
    assert (offered("bash", done.stdout), done.stderr) == (["scene.yaml"], "")


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("heun ru", {"run"}), ("heun run --meth", {"--method"}), ("heun run sc", {"scene.yaml"}),
        ("heun run scene.yaml --case ", {"heavy", "light", "all"}),
        ("heun run scene.yaml --only joints.", {"joints.pivot"}),
        ("heun run scene.yaml --measure joints.pivot.force.", {f"joints.pivot.force.{axis}" for axis in "xyz"}),
        ("heun run scene.yaml --set m", {"m="}), ("heun model scene.yaml --case h", {"heavy"}),
    ],
)  # fmt: skip
@pytest.mark.third
def test_a_shell_completes(asked: Asked, shell: str, line: str, expected: set[str]) -> None:
    found = asked(shell, line)
    if shell == "zsh":
        assert expected <= {word for part in found for word in (part, part.split(":")[0])}
    else:
        assert {word.split("  ")[0] for word in found} == expected


def test_files_are_specs_and_folders(asked: Asked) -> None:
    assert set(asked("bash", "heun run ")) == {"folder/", "scene.yaml", "wrong.yaml"}


def test_a_spec_that_cannot_be_read_completes_nothing(asked: Asked) -> None:
    assert asked("bash", "heun run wrong.yaml --case ") == []
    assert asked("bash", "heun run nosuch.yaml --case ") == []


def test_several_reports_are_completed_behind_each_other(asked: Asked) -> None:
    found = asked("bash", "heun run scene.yaml --only energy,joints.")
    assert found == ["energy,joints.pivot"]


def test_dotted_keys_of_entries(asked: Asked) -> None:
    assert "bodies.bar.mass=" in asked("bash", "heun run scene.yaml --set bodies.bar.")


HOSTILE = [
    "$(touch x)",
    "`id`",
    "x;id",
    "a\nb",
    "\u202ey",
    "\x1b[2J",
    'q"c',
    "it's",
    "a|b",
    "a&b",
    "a>b",
    "a*",
    "~root",
    "a\\b",
]


def test_nothing_is_offered_that_a_shell_would_run(beside: Path, asked: Asked) -> None:
    entries = {name: {"mass": 1} for name in (*HOSTILE, "rod")}
    data = {
        "parameters": dict.fromkeys(HOSTILE, 1) | {"n": 1},
        "bodies": entries,
        "joints": entries,
        "cases": entries,
    }
    beside.joinpath("scene.yaml").write_text(json.dumps(data))
    for name in HOSTILE:
        (beside / f"{name}.yaml").write_text("")
    assert set(asked("bash", "heun run ")) == {"folder/", "scene.yaml", "wrong.yaml"}
    assert asked("bash", "heun run scene.yaml --set n") == ["n="]
    assert set(asked("bash", "heun run scene.yaml --case ")) == {"rod", "all"}
    assert asked("bash", "heun run scene.yaml --only joints.") == ["joints.rod"]
