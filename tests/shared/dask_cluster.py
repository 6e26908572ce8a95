"""A Dask cluster of processes on this machine: a scheduler and its workers, which are started and killed one by one."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.shared.folders import ROOT

START = 60.0  # seconds that a process may take to start on a busy machine
# Workers that lack heun, or have another one: what they import first (PYTHONPATH, sitecustomize).
NO_HEUN = """\
import sys
class NoHeun:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] == "heuncli":
            raise ModuleNotFoundError("No module named 'heuncli'", name="heuncli")
sys.meta_path.insert(0, NoHeun())
"""
OTHER_TEXT = """\
from heuncli.app.commands.sweep.cluster import worker as cluster_worker
cluster_worker.text_digest = lambda: "another"
"""


class DaskProcess:
    """A scheduler or a worker."""

    def __init__(self, folder: Path, module: str, *words: str, **env: str) -> None:
        self.log = folder / f"{module}-{len([*folder.iterdir()])}.log"
        quiet = {"PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "ignore", "OPENBLAS_NUM_THREADS": "1"}
        with self.log.open("w") as log:
            self.process = subprocess.Popen(
                [sys.executable, "-m", f"distributed.cli.{module}", *words, "--no-dashboard", "--host", "127.0.0.1"],
                stdout=log, stderr=log, cwd=folder, env={**os.environ, **quiet, **env}, start_new_session=True,
            )  # fmt: skip

    def kill(self) -> None:
        """At once, with all that it has started."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()


class DaskCluster:
    """A scheduler with its workers; files of theirs stand in a folder of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        file = folder / "scheduler.json"
        self.scheduler = DaskProcess(folder, "dask_scheduler", "--port", "0", "--scheduler-file", str(file))
        self.workers: list[DaskProcess] = []
        begun = time.monotonic()
        while True:
            with contextlib.suppress(OSError, ValueError):
                self.address: str = json.loads(file.read_text())["address"]
                break
            assert time.monotonic() < begun + START, self.scheduler.log.read_text()
            time.sleep(0.05)

    def work(self, *words: str, **env: str) -> DaskProcess:
        """One worker more, of one thread, which is not there yet."""
        words = words or ("--no-nanny",)
        one = DaskProcess(self.folder, "dask_worker", self.address, "--nthreads", "1", *words, **env)
        self.workers.append(one)
        return one

    def lacking_heun(self) -> DaskProcess:
        """A worker whose Python has no heun."""
        return self._prepared("lacking", {"sitecustomize.py": NO_HEUN})

    def of_another_version(self, version: str) -> DaskProcess:
        """A worker with a heun that has little but its version."""
        return self._prepared("other", {"heuncli/__init__.py": "", "heuncli/version.py": f"VERSION = '{version}'\n"})

    def _prepared(self, name: str, files: dict[str, str]) -> DaskProcess:
        folder = self.folder / name
        for file, text in files.items():
            (folder / file).parent.mkdir(parents=True, exist_ok=True)
            (folder / file).write_text(text)
        return self.work("--no-nanny", PYTHONPATH=str(folder))

    def preload(self, text: str) -> str:
        """A file that a worker runs before it begins."""
        file = self.folder / "preload.py"
        file.write_text(text)
        return str(file)

    @contextlib.contextmanager
    def client(self) -> Iterator[Any]:
        """A client of its own."""
        import distributed

        with distributed.Client(self.address, timeout=START, set_as_default=False) as client:
            yield client

    def with_workers(self, count: int) -> list[str]:
        """So many of one thread, those that are there among them; returns the addresses."""
        self.workers = [one for one in self.workers if one.process.poll() is None]
        while len(self.workers) > count:
            self.workers.pop().kill()
        for _ in range(count - len(self.workers)):
            self.work()
        return self.there(count)

    def there(self, count: int) -> list[str]:
        """Wait until there are so many workers, no more and no less."""
        with self.client() as client:
            begun = time.monotonic()
            while len(found := client.nthreads()) != count:
                assert time.monotonic() < begun + START, [one.log.read_text() for one in self.workers]
                time.sleep(0.05)
            return [*found]

    def at_work(self) -> tuple[list[str], list[str]]:
        """Keys of the tasks that wait or are worked on, and of the results that are kept."""
        with self.client() as client:
            under_way = [key for keys in client.processing().values() for key in keys]
            return under_way, [key for keys in client.has_what().values() for key in keys]

    def end(self) -> None:
        """All of it."""
        for one in [*self.workers, self.scheduler]:
            one.kill()
