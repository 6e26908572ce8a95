"""Cases given to worker processes; one that passes its time is killed, told as a violation, its process replaced."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import select
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

from tests.shared.folders import ROOT

PROCESSOR = 25.0  # seconds of the processor that a case may take altogether, and
PATIENCE = 240.0  # of the clock: the machine may be busy, or the case wait for what never comes
CASES = 400  # of one process: what a process keeps from case to case does not pile up


class Judged(NamedTuple):
    """A case and how it went; code None: it had to be killed, or killed its process."""

    kind: str
    seed: int
    code: int | None
    seconds: float
    memory: float
    violations: list[str]
    command: str = ""


class Worker:
    """One process and the pipes to it."""

    def __init__(self) -> None:
        self.left = CASES
        self.process = subprocess.Popen(
            [sys.executable, "-m", "tests.faults.worker"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            stderr=subprocess.PIPE, cwd=ROOT, env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
        )  # fmt: skip

    def judge(self, kind: str, seed: int) -> Judged:
        """The case's verdict, or why there is none."""
        self.left -= 1
        assert self.process.stdin is not None and self.process.stdout is not None
        self.process.stdin.write(f"{kind}:{seed}\n".encode())
        self.process.stdin.flush()
        begun, used = time.monotonic(), self._used()
        while not select.select([self.process.stdout], [], [], 0.5)[0]:
            seconds = self._used() - used
            if seconds > PROCESSOR or time.monotonic() - begun > PATIENCE:
                self.end()
                return Judged(kind, seed, None, seconds, 0.0, [f"hangs: killed after {seconds:.0f} s of the processor"])
        answer = self.process.stdout.readline()
        if not answer:
            return Judged(kind, seed, None, 0.0, 0.0, [f"the process died: {self._reason()}"])
        told: dict[str, Any] = json.loads(answer)
        return Judged(kind, seed, **told)

    def end(self) -> None:
        """Kill the process, if it still runs."""
        self.left = 0
        with contextlib.suppress(OSError):
            self.process.kill()
        self.process.wait()

    def close(self) -> None:
        """Let the process clear away its folder."""
        with contextlib.suppress(OSError, subprocess.TimeoutExpired):
            self.process.communicate(timeout=10)
        self.end()

    def _used(self) -> float:
        """Seconds of the processor that the process has taken; of the clock where that is not told."""
        try:
            fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        except OSError:
            return time.monotonic()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def _reason(self) -> str:
        self.left = 0
        _, err = self.process.communicate()
        code = self.process.returncode
        name = signal.Signals(-code).name if code < 0 else f"exit code {code}"
        return f"{name} {err.decode(errors='replace')[-400:]}"


def judged(cases: Iterable[tuple[str, int]], jobs: int = 1) -> Iterator[Judged]:
    """The verdicts on cases, as they come."""
    waiting, done = iter(cases), queue.Queue[Judged | None]()
    turn = threading.Lock()

    def work() -> None:
        worker = Worker()
        try:
            while True:
                with turn:
                    one = next(waiting, None)
                if one is None:
                    return
                if worker.left <= 0:
                    worker.close()
                    worker = Worker()
                done.put(worker.judge(*one))
        finally:
            worker.close()
            done.put(None)

    threads = [threading.Thread(target=work, daemon=True) for _ in range(jobs)]
    for thread in threads:
        thread.start()
    for _ in threads:
        while (one := done.get()) is not None:
            yield one
