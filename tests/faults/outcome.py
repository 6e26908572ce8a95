"""A command line run in this process, and what it left behind: exit code, texts, time, memory, noise."""

from __future__ import annotations

import io
import os
import resource
import sys
import time
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from heuncli.app.cli.entry import enter

MEGABYTE = 2**20


class Outcome(NamedTuple):
    """seconds: of the processor. memory: the most that was held meanwhile [MB]. noise: what came past Python."""

    argv: tuple[str, ...]
    code: int
    out: bytes
    err: bytes
    seconds: float
    memory: float
    noise: bytes = b""


def run(argv: Sequence[str], content: bytes = b"") -> Outcome:
    """Run a command line with this standard input; Python's warnings are errors.

    What escapes from `enter` has the exit code of a bug.
    """
    kept = sys.stdin, sys.stdout, sys.stderr
    out, err = io.BytesIO(), io.BytesIO()
    sys.stdin = io.TextIOWrapper(io.BytesIO(content), "utf-8")
    sys.stdout = io.TextIOWrapper(out, "utf-8", write_through=True)
    sys.stderr = io.TextIOWrapper(err, "utf-8", "backslashreplace", write_through=True)
    _forget_peak()
    begun = time.process_time()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            code = enter(argv)
    except SystemExit as left:
        code = int(left.code or 0)
    except BaseException as bug:
        code = 70
        err.write(f"Traceback: {type(bug).__name__}: {bug} came through enter\n".encode("utf-8", "backslashreplace"))
    finally:
        seconds = time.process_time() - begun
        mine, (sys.stdin, sys.stdout, sys.stderr) = (sys.stdin, sys.stdout, sys.stderr), kept
        texts = out.getvalue(), err.getvalue()
        for stream in mine:
            stream.detach() if not stream.closed else None
    return Outcome(tuple(argv), code, *texts, seconds, peak())


def _forget_peak() -> None:
    """Let the kernel count the peak of memory anew, where it can."""
    try:
        Path("/proc/self/clear_refs").write_text("5")
    except OSError:
        return


def peak() -> float:
    """The most memory held since [MB]."""
    try:
        lines = Path("/proc/self/status").read_text().splitlines()
        return next(float(line.split()[1]) / 1024 for line in lines if line.startswith("VmHWM"))
    except (OSError, StopIteration):
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1024 if sys.platform == "linux" else MEGABYTE)


class Noise:
    """What is written to the process's own standard output and error meanwhile: by C and Fortran, past Python."""

    def __init__(self, path: Path) -> None:
        self.file = path.open("w+b")
        for descriptor in (1, 2):
            os.dup2(self.file.fileno(), descriptor)

    def taken(self) -> bytes:
        """What came since the last time."""
        self.file.seek(0)
        noise = self.file.read()
        self.file.seek(0)
        self.file.truncate()
        return noise
