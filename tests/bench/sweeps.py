"""Sweeps: what 10,000 variants take, what a store adds, how memory grows with their number, runs that `find` takes."""

from __future__ import annotations

import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

from tests.shared.folders import ROOT, SPECS
from tests.shared.shell import ENVIRONMENT

TRUSS = ROOT / "heuncli" / "starters" / "truss.yaml"
PEAK = "import resource,sys;from heuncli.app.cli.entry import enter;enter(sys.argv[1:]);" + (
    "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"
)


class Sweep(NamedTuple):
    """A sweep: its spec, the word that varies it by a count, and what is measured."""

    spec: Path
    axis: str
    measure: str

    def words(self, count: int) -> list[str]:
        """The command line."""
        return ["sweep", str(self.spec), self.axis.format(count), "--measure", self.measure, "--format", "csv"]


DOUBLE = Sweep(SPECS / "double.yaml", "bodies.upper.mass=0.5:2/{}", "max abs joints.elbow.force")
STATES = Sweep(TRUSS, "F=1:100/{}kN", "joints.low.force")
REACHED = ((DOUBLE, 20.0), (STATES, 6.0))  # s for 10,000 variants on two cores


class Cost(NamedTuple):
    """Seconds of the clock, and of the processors in the process itself and all of its workers."""

    wall: float
    processor: float


def sweeps() -> None:
    """Print all of it."""
    heads = (("10,000 variants", "<34"), ("wall [s]", ">10"), ("processor [s]", ">15"), ("each [ms]", ">12"))
    print("".join(f"{head:{width}}" for head, width in heads) + f"{'to reach [s]':>14s}")
    for sweep, reach in REACHED:
        cost = run(sweep.words(10_000))
        each = 1e3 * cost.processor / 10_000
        print(f"{told(sweep):34s}{cost.wall:10.1f}{cost.processor:15.1f}{each:12.2f}{reach:14.0f}")
    store()
    memory()
    find()


def told(sweep: Sweep) -> str:
    """A sweep in some words."""
    return f"{sweep.spec.stem} {sweep.axis.partition('=')[0]}"


def store() -> None:
    """What a store adds, of processor time, for the cheapest variants: least of some, in turn."""
    count = 2000
    costs: dict[bool, list[float]] = {False: [], True: []}
    for _ in range(3):
        for kept in costs:
            with tempfile.TemporaryDirectory() as folder:
                more = ["--store", str(Path(folder) / "runs.sqlite")] if kept else []
                costs[kept].append(run([*STATES.words(count), *more]).processor)
    without, with_ = min(costs[False]), min(costs[True])
    print(f"a store adds {100.0 * (with_ / without - 1.0):.1f} % to {count} variants of {told(STATES)}")


def memory() -> None:
    """The peak of the process and of its largest worker, for few and many variants."""
    for count in (1000, 20_000):
        command = [sys.executable, "-c", PEAK, *STATES.words(count), "-o", os.devnull]
        done = subprocess.run(command, capture_output=True, text=True, env=ENVIRONMENT, check=True)
        own, largest = (int(word) / 1024 for word in done.stdout.split())
        print(f"{count:6d} variants: {own:.0f} MB, its largest worker {largest:.0f} MB")


def find() -> None:
    """Runs that one crossing takes."""
    words = ["find", str(SPECS / "rotor.yaml"), "n=500:6000rpm", "max joints.right.force = 200 N", "--format", "json"]
    command = [sys.executable, "-m", "heuncli", *words]
    done = subprocess.run(command, capture_output=True, text=True, env=ENVIRONMENT, check=False)
    runs = re.search(r'"runs": (\d+)', done.stdout)
    print(f"find, one crossing: {runs[1] if runs else 'not told'} runs (to reach: 12)")


def run(words: list[str]) -> Cost:
    """A command as a process, and what it takes."""
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    command = [sys.executable, "-m", "heuncli", *words]
    subprocess.run(command, stdout=subprocess.DEVNULL, env=ENVIRONMENT, check=True)
    wall, after = time.monotonic() - begun, resource.getrusage(resource.RUSAGE_CHILDREN)
    return Cost(wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
