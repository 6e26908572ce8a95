"""What is answered before anything is imported: as the rest would, and left to the rest where that cannot be."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from heuncli.app.cli.entry import enter
from heuncli.app.cli.terminal import find_line_width
from tests.shared.help_text import HELP, help_of_typer
from tests.shared.shell import shell

RENEW = "renew it: python -m tests.manual.tables"


@pytest.mark.parametrize("columns", [80, 81, 200])
def test_the_help_is_what_typer_makes_of_the_registry(columns: int) -> None:
    assert help_of_typer(columns) == HELP.read_text("ascii"), RENEW


def answer(*words: str, code: str = "pass", **environment: str) -> str:
    """What is answered at once in a process of its own; nothing where it is left to the rest."""
    call = f"import sys; from heuncli.app.cli import terminal; {code}; sys.exit(not terminal.try_answer(sys.argv[1:]))"
    line = [sys.executable, "-c", call, *words]
    return subprocess.run(line, capture_output=True, text=True, env={**os.environ, **environment}, check=False).stdout


def test_help_and_version_and_nothing_else(capsys: pytest.CaptureFixture[str]) -> None:
    assert enter(["--version"]) == 0
    assert answer("--version") == capsys.readouterr().out != ""
    assert answer("--help", COLUMNS="80") == HELP.read_text("ascii")
    for words in ((), ("run",), ("--help", "run"), ("run", "--help"), ("-h",), ("--", "--help")):
        assert answer(*words, COLUMNS="80") == ""


@pytest.mark.parametrize("columns", ["79", "40"])
def test_narrow_terminals_are_left_to_typer(columns: str) -> None:
    assert answer("--help", COLUMNS=columns) == ""
    assert help_of_typer(int(columns)) != HELP.read_text("ascii")


@pytest.mark.parametrize("size", [(66, 20), (0, 0), OSError()], ids=str)
@pytest.mark.parametrize("given", [None, "", "0", "-5", "wide", "100", " 90 "])
def test_the_width_of_a_line_is_the_one_that_python_finds(
    given: str | None, size: tuple[int, int] | OSError, monkeypatch: pytest.MonkeyPatch
) -> None:
    def found(number: int) -> os.terminal_size:
        if isinstance(size, OSError):
            raise size
        return os.terminal_size(size)

    with monkeypatch.context() as terminal:  # this test itself is told on another one
        terminal.delenv("COLUMNS", raising=False)
        if given is not None:
            terminal.setenv("COLUMNS", given)
        terminal.setattr("os.get_terminal_size", found)
        terminal.setattr("sys.__stdout__", sys.stdin)
        line, ours = find_line_width(), shutil.get_terminal_size().columns
    assert line == ours


def test_what_goes_wrong_is_told_by_the_rest(tmp_path: Path) -> None:
    assert answer("--version", HEUN_KERNEL="nonsense") == answer("--version", code="sys.stdout = None") == ""
    done = shell("HEUN_KERNEL=nonsense heun --version", tmp_path)
    assert (done.returncode, "[unknown-kernel]" in done.stderr) == (2, True)
    done = shell("heun --help >&-", tmp_path)
    assert (done.returncode, "[output-closed]" in done.stderr) == (5, True)
