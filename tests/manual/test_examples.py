"""What the README and the manual show is what happens: their scenes run, their commands print what stands there."""

from __future__ import annotations

import doctest
import io
import json
import re
import shlex
import sys
from itertools import pairwise
from pathlib import Path

import pytest

from heuncli.app.cli.entry import enter
from heuncli.scene.file_format.source import read_source
from tests.shared.manual import README, ROOT, TEXTS, blocks


def words_of(line: str) -> list[str]:
    """The words of a heun command as a shell would split them, up to a pipe."""
    words = shlex.split(line, comments=True)
    return words[1 : words.index("|")] if "|" in words else words[1:]


def command_in(line: str) -> str | None:
    """The heun command that a line of a shell runs: itself, or what stands in `NAME=$(...)`."""
    stored = re.fullmatch(r"\w+=\$\((heun .*)\)", line)
    return stored[1] if stored else line if line.startswith("heun ") else None


SHOWN = {f"{name}: {block.splitlines()[0]}": block.splitlines() for name in TEXTS for block in blocks(name, "console")}
LINES = [line for name in TEXTS for block in blocks(name, "sh") for line in block.splitlines()]
RUN_BELOW = {shlex.join(words_of(lines[0].removeprefix("$ "))) for lines in SHOWN.values()}
TYPED = {shlex.join(words): words for line in LINES if (command := command_in(line)) and (words := words_of(command))}
TYPED = {line: words for line, words in sorted(TYPED.items()) if line not in RUN_BELOW}


@pytest.fixture
def beside_specs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder to write to, in which specs/ is found as in a checkout."""
    (tmp_path / "specs").symlink_to(ROOT / "specs")
    monkeypatch.chdir(tmp_path)


BUDGET = "24"  # of a search whose result is not shown: it ends as told, whatever it has found by then
WARNED = ("flat_four_bar.yaml: singular positions at t = ", "rigid bodies do not determine the split, impacts: ")


@pytest.mark.heavy
@pytest.mark.usefixtures("beside_specs")
@pytest.mark.parametrize("words", TYPED.values(), ids=TYPED)
@pytest.mark.sixth
def test_commands_run(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """Each once, however often it stands there; not those whose output is shown, which run below.

    A search is given fewer variants than the page gives it: what it finds is the matter of the closed forms.
    """
    assert enter([BUDGET if before == "--evaluations" else word for before, word in pairwise(["", *words])]) == 0
    told = [line for line in capsys.readouterr().err.splitlines() if not line.startswith("unit: ")]
    assert all(line.startswith("warning: ") and any(part in line for part in WARNED) for line in told), told


def test_no_command_is_missed() -> None:
    """Every line of a shell that names heun is run, but for those that install it first."""
    named = [line for line in LINES if re.search(r"\bheun (?!-)\w+ ", line.partition("#")[0])]
    left = [line for line in named if command_in(line) is None]
    assert all(line.startswith(("pip install", "for ")) for line in left), left


@pytest.mark.heavy
@pytest.mark.usefixtures("beside_specs")
@pytest.mark.parametrize("shown", SHOWN.values(), ids=SHOWN)
@pytest.mark.sixth
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


@pytest.mark.heavy
@pytest.mark.usefixtures("beside_specs")
@pytest.mark.parametrize("name", [name for name in TEXTS if blocks(name, "pycon")])
def test_python_answers_as_shown(name: str) -> None:
    """The lines of a page one after the other, as somebody types them."""
    pytest.importorskip("pandas")
    text = "\n".join(blocks(name, "pycon"))
    examples = doctest.DocTestParser().get_doctest(text, {}, name, None, None)
    told: list[str] = []
    found = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(examples, out=told.append)
    assert found.attempted and not found.failed, "".join(told)


@pytest.mark.heavy
@pytest.mark.usefixtures("beside_specs")
@pytest.mark.parametrize("text", [block for name in TEXTS for block in blocks(name, "python") if "heuncli" in block])
def test_programs_run(text: str) -> None:
    exec(compile(text, "example", "exec"), {})


WHOLE = {f"{name}: {block.splitlines()[1]}": block for name in TEXTS for block in blocks(name, "yaml")
         if block.startswith("heun: 1\n")}  # fmt: skip
PARTS = [(name, block) for name in TEXTS for block in blocks(name, "yaml") if not block.startswith("heun: 1\n")]


@pytest.mark.heavy
@pytest.mark.parametrize("text", WHOLE.values(), ids=WHOLE)
@pytest.mark.third
def test_scenes_run_and_are_as_they_expect(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run_and_check(text, tmp_path, capsys)


@pytest.mark.heavy
@pytest.mark.parametrize(("name", "text"), PARTS, ids=[f"{name}: {part.splitlines()[1]}" for name, part in PARTS])
@pytest.mark.third
def test_parts_of_scenes_belong_to_the_first_one_of_their_page(
    name: str, text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Their entries replace those of the same name; `analysis` and lists are replaced as a whole."""
    scene = dict(read_source("scene.yaml", blocks(name, "yaml")[0]).data)
    for block, given in read_source("part.yaml", text).data.items():
        entries = isinstance(given, dict) and block != "analysis"
        scene[block] = {**scene.get(block, {}), **given} if entries else given
    run_and_check(json.dumps(scene), tmp_path, capsys)


def run_and_check(text: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A scene runs without a warning, with nothing open, and its numbers are those that it expects."""
    file = folder / "scene.yaml"
    file.write_text(text)
    assert enter(["run", str(file), "--strict"]) == 0
    assert enter(["check", str(file)]) == 0
    assert capsys.readouterr().err == ""


def test_the_first_example_runs(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    (example,) = blocks(README, "yaml")
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(example.encode())))
    assert enter(["run", "-"]) == 0
    assert "A bar swings on a pin" in capsys.readouterr().out
