"""Every command with every option ends as documented: of `options.py` each line on a scene, each scene once."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import pytest

from tests.faults.options import LINES, line_words, scene_in, uncovered, wrong
from tests.shared.all_scenes import all_scenes
from tests.shared.command import Done
from tests.shared.in_process import run_command

STRIDE = 7  # between the scenes of neighbouring lines: prime to their number
LIMIT = 1.0  # [s] of a run: one that is longer ends with exit 4, as documented
MOVES = re.compile(r"duration|times\"?:")
CHEAP = (("validate", "{spec}"), ("model", "{spec} --format json"), ("lagrange", "{spec} --format json"))


@cache
def texts() -> tuple[dict[str, str], dict[str, str]]:
    """The texts of scenes at one instant, on which all lines run, and of those that move."""
    found = all_scenes()
    moving = {name: text for name, text in found.items() if MOVES.search(text)}
    return {name: text for name, text in found.items() if name not in moving}, moving


def test_every_option_has_a_line() -> None:
    assert uncovered() == [], "give these options words in tests/faults/options.py"


@pytest.mark.heavy
@pytest.mark.parametrize("command", LINES)
@pytest.mark.third
def test_a_command_with_all_its_options(command: str, tmp_path: Path) -> None:
    still, _ = texts()
    names = sorted(still)
    first = sum(len(lines) for lines in list(LINES.values())[: list(LINES).index(command)])
    for number, line in enumerate(LINES[command], first):
        name = names[number * STRIDE % len(names)]
        folder = tmp_path / str(number)
        folder.mkdir()
        words = line_words(line, scene_in(folder, name, still[name], LIMIT), command)
        assert wrong(run_command(words), words) == [], f"{name}: heun {command} {line}"


@pytest.mark.heavy
@pytest.mark.long
def test_every_scene_that_moves(tmp_path: Path) -> None:
    _, moving = texts()
    for number, (name, text) in enumerate(moving.items()):
        folder = tmp_path / str(number)
        folder.mkdir()
        command, line = CHEAP[number % len(CHEAP)]
        words = line_words(line, scene_in(folder, name, text, LIMIT), command)
        assert wrong(run_command(words), words) == [], f"{name}: heun {command} {line}"


@pytest.mark.parametrize(
    ("code", "out", "err"),
    [(70, "", "a bug"), (0, '{"a": NaN}', ""), (2, "", "no code"), (1, "peak nan", ""), (0, "", "Traceback")],
)
def test_what_is_wrong_is_found(code: int, out: str, err: str) -> None:
    words = ["run", "scene.yaml", *(["--format", "json"] if out.startswith("{") else [])]
    assert wrong(Done(code, out, err), words)
