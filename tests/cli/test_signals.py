"""Signals at chosen instants, in a process of its own: one line, 128 + the number, and no half of a file."""

from __future__ import annotations

import fcntl
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from heuncli.base import files, signals
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
    import heuncli.base.files
    from heuncli.base import files
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
    return subprocess.run(
        [sys.executable, "-c", SHOT, str(int(number)), where, "run", "hanging.yaml", "-o", "out.json"],
        capture_output=True, text=True, cwd=folder, timeout=60, check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip


@pytest.mark.parametrize(
    "where",
    ["heuncli.app.cli.entry", "yaml", "heuncli.scene.file_format.plain_reading", "numpy", "heuncli.study.workflow"],
)
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


@pytest.mark.parametrize("old", [None, "old"])
def test_a_signal_once_it_is_written_leaves_the_new_one(folder: Path, old: str | None) -> None:
    if old is not None:
        (folder / "out.json").write_text(old)
    done = shot(signal.SIGTERM, "os.replace", folder)
    assert done.returncode == 143
    assert (folder / "out.json").read_text().endswith("}\n")
    assert not list(folder.glob(".heun*"))


# Writes half of a file and dies, by a signal that nothing is done about.
KILLED = """\
import os, signal, sys
from heuncli.base import files
if sys.argv[1] == "named":
    del os.O_TMPFILE
def pieces():
    yield b"half"
    os.kill(os.getpid(), signal.SIGKILL)
files.write(pieces(), "out.json")
"""


def killed(folder: Path, how: str) -> list[Path]:
    """Names that a process leaves which is killed while it writes."""
    before = set(folder.iterdir())
    done = subprocess.run(
        [sys.executable, "-c", KILLED, how], cwd=folder, check=False, env={**os.environ, "PYTHONPATH": str(ROOT)}
    )
    assert done.returncode == -signal.SIGKILL
    return [path for path in folder.iterdir() if path not in before]


@pytest.mark.parametrize("old", [None, "old"])
def test_a_killed_process_leaves_nothing(tmp_path: Path, old: str | None) -> None:
    if old is not None:
        (tmp_path / "out.json").write_text(old)
    left = killed(tmp_path, "unnamed")
    if left and not hasattr(os, "O_TMPFILE"):
        pytest.skip("files without a name are not to be had here")
    assert left == []
    assert old is None or (tmp_path / "out.json").read_text() == old


def test_what_a_killed_process_leaves_the_next_one_removes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where no file is without a name: what is old, of this user, and written by nobody."""
    monkeypatch.setattr(files, "_looked_into", set())
    (left,) = killed(tmp_path, "named")
    others = [tmp_path / name for name in (".heun-0", ".heun-" + "a" * 16, ".heun-" + "b" * 16, ".heun-" + "c" * 16)]
    others[2].symlink_to("there is no such file")
    for path in (others[0], others[1], others[3]):
        path.write_text("another's")
    for path in (left, others[0], others[3]):
        os.utime(path, (0.0, 0.0))
    with others[3].open() as at_work:
        fcntl.flock(at_work, fcntl.LOCK_EX)
        files.write(b"whole", str(tmp_path / "out.json"))
    assert sorted(tmp_path.iterdir()) == sorted([*others, tmp_path / "out.json"])
    assert (tmp_path / "out.json").read_bytes() == b"whole"


@pytest.mark.parametrize("named", [False, True])
@pytest.mark.parametrize("old", [None, 0o640])
def test_rights_are_those_of_the_old_file_or_the_usual(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, named: bool, old: int | None
) -> None:
    if named:
        monkeypatch.delattr(os, "O_TMPFILE", raising=False)
    path = tmp_path / "out.json"
    if old is not None:
        path.write_text("old")
        path.chmod(old)
    before = os.umask(0o027)
    try:
        files.write(b"new", str(path))
    finally:
        os.umask(before)
    assert path.stat().st_mode & 0o777 == (0o640 if old is None else old)
    assert [one.name for one in tmp_path.iterdir()] == ["out.json"]


def test_one_cleanup_does_not_stop_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    done: list[object] = []
    monkeypatch.setattr(signals, "_cleanups", [lambda: done.append("first"), lambda: 1 / 0])
    monkeypatch.setattr(os, "_exit", done.append)
    monkeypatch.setattr(os, "write", lambda number, line: done.append(line))
    signals.exit_after_cleanup(130, b"told")
    assert done == ["first", b"told", 130]
