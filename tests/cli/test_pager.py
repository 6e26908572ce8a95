"""A pager on a terminal: keys are its own, and whatever ends heun ends it and gives the terminal back as it was."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from tests.shared.folders import ROOT

termios = pytest.importorskip("termios")

# Takes the terminal as less does: it hides what is typed, is not interrupted, and waits for a key behind the text.
PAGER = """\
#!/bin/sh
stty -echo -icanon < /dev/tty
trap '' INT QUIT
cat > /dev/null
printf 'ready' > /dev/tty
key=$(dd bs=1 count=1 2> /dev/null < /dev/tty)
printf "took $key" > /dev/tty
stty echo icanon < /dev/tty
"""
# The command as the leader of a terminal's session.
LEADER = """\
import fcntl, os, sys, termios
fcntl.ioctl(0, termios.TIOCSCTTY, 0)
os.execv(sys.executable, [sys.executable, "-m", "heuncli", *sys.argv[1:]])
"""


class Terminal:
    """A terminal of 24 lines with a command on it."""

    def __init__(self, ours: int, theirs: int, process: subprocess.Popen[bytes]) -> None:
        self.ours, self.theirs, self.process = ours, theirs, process
        self.text = b""

    def wait_for(self, word: bytes) -> None:
        """Read until a word was written."""
        until = time.monotonic() + 60.0
        while word not in self.text:
            assert time.monotonic() < until, self.text
            if select.select([self.ours], [], [], 1.0)[0]:
                self.text += os.read(self.ours, 65536)

    def type(self, keys: bytes) -> None:
        os.write(self.ours, keys)

    @property
    def echoes(self) -> bool:
        """Whether the terminal shows what is typed."""
        return bool(termios.tcgetattr(self.theirs)[3] & termios.ECHO)


@contextmanager
def reading(folder: Path, pager: str) -> Iterator[Terminal]:
    """`heun explain run` on a terminal, up to where the pager waits for a key."""
    ours, theirs = os.openpty()
    (folder / "bin").mkdir()
    (folder / "bin" / "a-pager").write_text(PAGER)
    (folder / "bin" / "a-pager").chmod(0o755)
    path = os.pathsep.join([str(folder / "bin"), os.environ.get("PATH", os.defpath)])
    env = {**os.environ, "PAGER": pager, "PATH": path, "TERM": "dumb", "PYTHONPATH": str(ROOT)}
    process = subprocess.Popen(
        [sys.executable, "-c", LEADER, "explain", "commands"], stdin=theirs, stdout=theirs, stderr=theirs, cwd=folder,
        env=env, start_new_session=True,
    )  # fmt: skip
    try:
        terminal = Terminal(ours, theirs, process)
        terminal.wait_for(b"ready")
        assert not terminal.echoes
        yield terminal
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        os.close(ours)
        os.close(theirs)


def others_of(session: int) -> list[int]:
    """Processes of a session, but for its leader."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            state, _, _, its_session = stat.read_text().rpartition(")")[2].split()[:4]
            found += [int(stat.parent.name)] if int(its_session) == session and state != "Z" else []
    return [number for number in found if number != session]


def test_an_interrupt_is_for_the_pager(folder: Path) -> None:
    with reading(folder, "a-pager") as terminal:
        terminal.type(b"\x03\x1c")  # Ctrl-C, Ctrl-\
        terminal.type(b"q")
        terminal.wait_for(b"took q")
        assert terminal.process.wait(60) == 0
        assert terminal.echoes
        assert b"interrupted" not in terminal.text


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="the processes of a session are read from /proc")
@pytest.mark.parametrize(
    ("number", "pager"), [(signal.SIGTERM, "a-pager"), (signal.SIGHUP, "a-pager"), (signal.SIGTERM, "A='b c' a-pager")]
)
def test_what_ends_heun_ends_the_pager(folder: Path, number: signal.Signals, pager: str) -> None:
    with reading(folder, pager) as terminal:
        terminal.process.send_signal(number)
        assert terminal.process.wait(60) == 128 + number
        assert terminal.echoes
        until = time.monotonic() + 10.0  # the system takes a moment to bury what was ended
        while (left := others_of(terminal.process.pid)) and time.monotonic() < until:
            time.sleep(0.01)
        assert left == []
