"""What a shell completes, asked for as bash, zsh and fish ask."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.shared.command import HANGING

SPEC = HANGING + "cases: {heavy: {set: {m: 3}}, light: {set: {m: 0.1}}}\n"


@pytest.fixture
def beside(tmp_path: Path) -> Path:
    (tmp_path / "scene.yaml").write_text(SPEC)
    (tmp_path / "folder").mkdir()
    (tmp_path / "notes.txt").write_text("")
    (tmp_path / "wrong.yaml").write_text("heun: [")
    return tmp_path


def asked(shell: str, line: str, folder: Path) -> list[str]:
    """The completions of the last word of a line."""
    words = line.split(" ")
    own = {"bash": {"COMP_WORDS": line, "COMP_CWORD": str(len(words) - 1)},
           "zsh": {"_TYPER_COMPLETE_ARGS": line},
           "fish": {"_TYPER_COMPLETE_ARGS": line, "_TYPER_COMPLETE_FISH_ACTION": "get-args"}}[shell]  # fmt: skip
    env = {**os.environ, "_HEUN_COMPLETE": f"complete_{shell}", "COLUMNS": "20", **own}  # of any terminal
    done = subprocess.run([sys.executable, "-m", "heuncli"], cwd=folder, env=env, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    if shell == "zsh":
        return [part.split('":')[0].replace('\\"', '"') for part in done.stdout.split('"') if part.strip(" :()'\n")][1:]
    return [line.split("\t")[0] for line in done.stdout.splitlines() if line]


@pytest.mark.parametrize("shell", ["bash", *(pytest.param(name, marks=pytest.mark.heavy) for name in ("zsh", "fish"))])
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
def test_a_shell_completes(beside: Path, shell: str, line: str, expected: set[str]) -> None:
    found = asked(shell, line, beside)
    if shell == "zsh":
        assert expected <= {word for part in found for word in (part, part.split(":")[0])}
    else:
        assert {word.split("  ")[0] for word in found} == expected


def test_files_are_specs_and_folders(beside: Path) -> None:
    assert set(asked("bash", "heun run ", beside)) == {"folder/", "scene.yaml", "wrong.yaml"}


def test_a_spec_that_cannot_be_read_completes_nothing(beside: Path) -> None:
    assert asked("bash", "heun run wrong.yaml --case ", beside) == []
    assert asked("bash", "heun run nosuch.yaml --case ", beside) == []


def test_several_reports_are_completed_behind_each_other(beside: Path) -> None:
    found = asked("bash", "heun run scene.yaml --only energy,joints.", beside)
    assert found == ["energy,joints.pivot"]


def test_dotted_keys_of_entries(beside: Path) -> None:
    assert "bodies.bar.mass=" in asked("bash", "heun run scene.yaml --set bodies.bar.", beside)


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


def test_nothing_is_offered_that_a_shell_would_run(beside: Path) -> None:
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
    assert set(asked("bash", "heun run ", beside)) == {"folder/", "scene.yaml", "wrong.yaml"}
    assert asked("bash", "heun run scene.yaml --set n", beside) == ["n="]
    assert set(asked("bash", "heun run scene.yaml --case ", beside)) == {"rod", "all"}
    assert asked("bash", "heun run scene.yaml --only joints.", beside) == ["joints.rod"]
