"""Every call by which a result gets into a file fails in turn: the old file stands, and nothing is left beside it."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from heuncli.app.cli import entry
from heuncli.base import files
from tests.shared.command import HANGING

CALLS = ("open", "write", "fsync", "close", "chmod", "replace")
MOST = 12  # calls that one file takes, more than there are: then nothing fails, and the file is written
COMMANDS = {
    "run -o out.json": "out.json",
    "run -o out.csv --only joints": "out.csv",
    "model -o out.txt": "out.txt",
    "check -o out.json": "out.json",
    "modes -o out.csv": "out.csv",
    "chart --methods RK4 --steps 0.01 --save out.svg": "out.svg",
}


class Failing:
    """A function of the system that fails the n-th time it is called on what is being written."""

    def __init__(self, call: Callable[..., Any], at: int, why: int) -> None:
        self.call, self.left, self.why = call, at, why

    def __call__(self, *given: Any, **words: Any) -> Any:
        self.left -= 1
        if self.left:
            return self.call(*given, **words)
        if self.call is CLOSE:  # it is closed all the same, as of a disk over the network
            self.call(*given)
        raise OSError(self.why, os.strerror(self.why))


CLOSE = os.close


def outcome(folder: Path, monkeypatch: pytest.MonkeyPatch, command: str, name: str, at: int, why: int) -> int:
    """The exit code of a command while whose file is written a call fails."""
    write = files.write

    def failing(content: bytes, target: str) -> None:
        with monkeypatch.context() as patch:
            patch.setattr(os, name, Failing(getattr(os, name), at, why))
            write(content, target)

    with monkeypatch.context() as patch:
        patch.setattr(files, "write", failing)
        patch.chdir(folder)
        words = command.split()
        return entry.enter([words[0], "hanging.yaml", *words[1:]])


@pytest.mark.parametrize(
    ("command", "name", "old"),
    [
        *((next(iter(COMMANDS)), name, old) for name in CALLS for old in (b"old", None)),
        *((command, "replace", b"old") for command in COMMANDS),  # by the same function
    ],
)
def test_a_call_that_fails_leaves_all_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], command: str, name: str,
    old: bytes | None,
) -> None:  # fmt: skip
    (tmp_path / "hanging.yaml").write_text(HANGING + "analysis: {duration: 0.02, samples: 2}\n")
    target = tmp_path / COMMANDS[command]
    if old is not None:
        target.write_bytes(old)
    before = sorted(tmp_path.iterdir())
    why = errno.ENOSPC if name != "chmod" else errno.EPERM
    for at in range(1, MOST):
        code = outcome(tmp_path, monkeypatch, command, name, at, why)
        told = capsys.readouterr()
        if code == 0:
            break
        assert (code, told.out) == (5, "")
        line, hint = told.err.splitlines()
        assert line == f"heun: {target.name}: {os.strerror(why)} [output-failed]" and hint.startswith("  hint: ")
        assert sorted(tmp_path.iterdir()) == before
        assert old is None or target.read_bytes() == old
    assert at > 1 or (name, old) == ("chmod", None)  # whose rights are those of a new file
    assert code == 0 and target.read_bytes() not in (old, b"")


def test_a_part_at_a_time_is_all_of_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And a disk that fills up on the way is found."""
    write = os.write
    monkeypatch.setattr(os, "write", lambda number, content: write(number, content[:7]))
    files.write(b"x" * 1000, str(tmp_path / "out"))
    assert (tmp_path / "out").read_bytes() == b"x" * 1000
    monkeypatch.setattr(os, "write", Failing(os.write, 100, errno.ENOSPC))
    with pytest.raises(files.OutputError):
        files.write(b"y" * 1000, str(tmp_path / "out"))
    assert (tmp_path / "out").read_bytes() == b"x" * 1000
