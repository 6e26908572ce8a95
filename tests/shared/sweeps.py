"""Sweeps in processes of their own, some of which are killed, and what their stores hold."""

from __future__ import annotations

import os
import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import closing, suppress
from pathlib import Path
from typing import NamedTuple

from tests.shared.command import SPEC_TEXTS
from tests.shared.shell import ENVIRONMENT

STORE = "runs.sqlite"
COUNT = 24
DURATION = "duration: 30"
SWINGING = SPEC_TEXTS["swinging"].replace("duration: 1", DURATION)  # some tens of milliseconds a variant
WORDS = ("sweep", "swinging.yaml", f"m=1:2/{COUNT}", "--measure", "max abs joints.pivot.force", "--format", "csv")


class Held(NamedTuple):
    """What a store holds: its answers, and the variants of all its sweeps by (sweep, number)."""

    answers: int
    variants: list[tuple[int, int]]


def begin(folder: Path, *words: str) -> subprocess.Popen[str]:
    """A sweep as a process in a folder; more words behind those that all have."""
    command = [sys.executable, "-m", "heuncli", *WORDS, *words]
    return subprocess.Popen(command, cwd=folder, stdout=-1, stderr=-1, text=True, env=ENVIRONMENT)


def rows(folder: Path, *words: str) -> str:
    """The rows of a sweep that nobody disturbs."""
    with begin(folder, *words) as process:
        out, err = process.communicate(timeout=300)
    assert process.returncode == 0, err
    return out


def workers_of(pid: int) -> list[int]:
    """The processes that a process has made; none where it is gone."""
    with suppress(OSError):
        return [int(word) for word in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    return []


def alive(pid: int) -> bool:
    """Whether a process is there, and not dead already."""
    with suppress(OSError):
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    return False


def wait_until_gone(pids: list[int], seconds: float = 20.0) -> None:
    """Wait for processes to end."""
    until = time.monotonic() + seconds
    while any(map(alive, pids)):
        assert time.monotonic() < until, f"still there: {pids}"
        time.sleep(0.02)


def held(folder: Path) -> Held:
    """What the store of a folder holds; of none, nothing."""
    if not (folder / STORE).exists():
        return Held(0, [])
    with closing(sqlite3.connect(folder / STORE)) as connection:
        try:
            (answers,) = connection.execute("SELECT count(*) FROM answers").fetchone()
        except sqlite3.OperationalError:  # killed before it was made
            return Held(0, [])
        return Held(answers, connection.execute("SELECT sweep, number FROM variants ORDER BY 1, 2").fetchall())


def at_work(process: subprocess.Popen[str]) -> None:
    """Wait until a sweep has workers, or has ended."""
    while process.poll() is None and not workers_of(process.pid):
        time.sleep(0.005)


def timed(folder: Path) -> tuple[str, float]:
    """The rows of a sweep that nobody disturbs, and how long its workers are at work [s]."""
    with begin(folder, "--jobs", "2") as process:
        at_work(process)
        begun = time.monotonic()
        out, err = process.communicate(timeout=300)
    assert process.returncode == 0, err
    return out, time.monotonic() - begun


def killed(folder: Path, after: float, worker: bool) -> int:
    """Kill a sweep with a store, or one of its workers; returns how many answers are kept then.

    after: seconds since its workers are at work; below zero: so many since it was begun. A sweep that has lost a
    worker goes on; it is waited for.
    """
    with begin(folder, "--store", STORE, "--jobs", "2") as process:
        if after >= 0.0:
            at_work(process)
        time.sleep(abs(after))
        theirs = workers_of(process.pid)
        with suppress(ProcessLookupError):
            os.kill(theirs[0] if worker and theirs else process.pid, signal.SIGKILL)
        process.communicate(timeout=300)
    wait_until_gone(theirs)
    return held(folder).answers
