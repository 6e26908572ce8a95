"""Signals at chosen instants, in a process of its own: one line, 128 + the number, and no half of a file."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.shared.folders import ROOT

# Sends itself a signal, twice, when a module is looked for or a function of `os` is called; then runs the command.
SHOT = """\
import os, signal, sys
number, where, words = int(sys.argv[1]), sys.argv[2], sys.argv[3:]
def shoot():
    for _ in range(2):
        os.kill(os.getpid(), number)
class Finder:
    def find_spec(self, name, path=None, target=None):
        if name == where:
            shoot()
def shot(call):
    def shooting(*given, **words):
        done = call(*given, **words)
        shoot()
        return done
    return shooting
from heuncli.__main__ import main
if where.startswith("os."):
    import heuncli.cli.files
    from heuncli.cli import files
    write = files.write
    def writing(*given):
        setattr(os, where[3:], shot(getattr(os, where[3:])))
        write(*given)
    files.write = writing
else:
    sys.meta_path.insert(0, Finder())
sys.argv[1:] = words
main()
"""


def shot(number: int, where: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """`heun run hanging.yaml -o out.json`, and what became of it."""
    signal_was = signal.signal(signal.SIGINT, signal.default_int_handler)  # what is ignored is ignored by children, too
    try:
        return subprocess.run(
            [sys.executable, "-c", SHOT, str(int(number)), where, "run", "hanging.yaml", "-o", "out.json"],
            capture_output=True, text=True, cwd=folder, timeout=60, check=False,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
        )  # fmt: skip
    finally:
        signal.signal(signal.SIGINT, signal_was)


@pytest.mark.parametrize("where", ["heuncli.cli.entry", "yaml", "pydantic_core", "numpy", "heuncli.study.workflow"])
def test_an_interrupt_while_something_is_imported(folder: Path, where: str) -> None:
    done = shot(signal.SIGINT, where, folder)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "heun: interrupted\n")


@pytest.mark.parametrize(
    ("number", "line"),
    [(signal.SIGINT, "heun: interrupted\n"), (signal.SIGTERM, "heun: terminated\n"), (signal.SIGHUP, "")],
)
@pytest.mark.parametrize("where", ["os.open", "os.fsync"])
def test_a_signal_while_a_file_is_written_leaves_the_old_one(
    folder: Path, number: signal.Signals, line: str, where: str
) -> None:
    (folder / "out.json").write_text("old")
    before = sorted(folder.iterdir())
    done = shot(number, where, folder)
    assert (done.returncode, done.stdout, done.stderr) == (128 + number, "", line)
    assert sorted(folder.iterdir()) == before
    assert (folder / "out.json").read_text() == "old"


def test_a_signal_once_it_is_written_leaves_the_new_one(folder: Path) -> None:
    done = shot(signal.SIGTERM, "os.replace", folder)
    assert done.returncode == 143
    assert (folder / "out.json").read_text().endswith("}\n")
    assert not list(folder.glob(".heun*"))
