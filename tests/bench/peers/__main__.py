"""heun beside other programs, printed: `python -m tests.bench.peers [--scenes A,B] [--programs A,B]`.

Wants the extra `bench` (MuJoCo, Pinocchio, Exudyn, CasADi); what is not installed is named and left out. All in one run
and on the same machine, in processor time; errors are those of the centres of mass at the end against the
reference in quadruple precision. Nothing here asserts a time. Impure: measures, starts processes.
"""

from __future__ import annotations

import argparse
import importlib
import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before NumPy is loaded

from tests.bench.chart import chart
from tests.bench.peers.scenes import DRAWN, FOLDER, SCENES, draw, error
from tests.bench.peers.ways import Way

PROGRAMS = {"heun": "H", "mujoco": "M", "pinocchio": "P", "exudyn": "E", "casadi": "C"}  # with their letters
GOALS = (1e-3, 1e-6, 1e-9, 1e-12)  # [m]
LONGEST = 0.5  # [s] of one run: settings finer than that are not tried
FINEST = 3e-13  # [m] errors that are small enough


class Run(NamedTuple):
    """A run of a program: scene, way and setting by number, error [m], median time [ms]."""

    program: str
    scene: str
    way: int
    setting: int
    label: str
    error: float
    ms: float


def installed(names: Sequence[str]) -> tuple[dict[str, ModuleType], list[str]]:
    """The programs that are there, and those that are not, with the reason."""
    found, missing = {}, []
    for name in names:
        try:
            found[name] = importlib.import_module(f"tests.bench.peers.with_{name}")
        except ImportError as reason:
            missing.append(f"{name} ({reason})")
    return found, missing


def seconds(f: Callable[[], Any]) -> float:
    """Processor time of a call [s]."""
    begun = time.process_time()
    f()
    return time.process_time() - begun


def median_ms(f: Callable[[], Any], first: float) -> float:
    """Median processor time of some calls [ms]; of long ones fewer."""
    repeats = 5 if first < 0.05 else 2 if first < 0.2 else 1
    return 1e3 * statistics.median([first, *(seconds(f) for _ in range(repeats))][1 if repeats > 1 else 0 :])


def runs_of(program: str, scene: str, number: int, way: Way) -> Iterator[Run]:
    """A way at its settings, until they are finer than need be, or too slow."""
    for k, setting in enumerate(way.settings):
        try:
            integrate, centers = way.prepare(setting)
            integrate()
            first = seconds(integrate)
            off = error(scene, centers())
        except Exception as reason:  # what a program does not bear is told, and no reason to end
            said = str(reason).strip().splitlines()[-1:] or [type(reason).__name__]
            print(f"  {program} {scene} {way.label} {setting}: {said[0][:80]}", file=sys.stderr)
            break
        yield Run(program, scene, number, k, way.label, off, median_ms(integrate, first))
        if first > LONGEST or off < FINEST:
            break


def fastest(runs: Sequence[Run], goal: float) -> Run | None:
    """The fastest of the runs that reach the goal."""
    reached = [run for run in runs if run.error <= goal]
    return min(reached, key=lambda run: run.ms) if reached else None


def table(scene: str, runs: Sequence[Run], programs: Sequence[str]) -> None:
    """Milliseconds of integration alone to reach each error, and by which way."""
    print(f"\n{scene}: ms of integration alone to reach an error of")
    print(f"{'':12}" + "".join(f"{f'{goal:.0e} m':>28}" for goal in GOALS))
    for program in programs:
        own = [run for run in runs if run.program == program]
        cells = [fastest(own, goal) for goal in GOALS]
        told = [f"{run.ms:.3g} {run.label}" if run is not None else "-" for run in cells]
        print(f"{program:12}" + "".join(f"{cell:>28}" for cell in told))


def front(runs: Sequence[Run]) -> list[tuple[float, float]]:
    """Those that no other run of the same program beats in both."""
    found: list[tuple[float, float]] = []
    for run in sorted(runs, key=lambda run: run.ms):
        if math.isfinite(run.error) and run.error > 0.0 and (not found or run.error < found[-1][1]):
            found.append((run.ms, run.error))
    return [point for point in found if point[1] < 1.0]


def process_ms(command: Sequence[str], environment: dict[str, str], repeats: int = 3) -> float:
    """Median processor time of a whole process [ms]."""
    found = []
    for _ in range(repeats):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        found.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return 1e3 * statistics.median(found)


def processes(scene: str, runs: Sequence[Run], programs: Sequence[str]) -> None:
    """Whole processes: imports, set-up, one run to 1e-9 m; of heun its command as well, with all that it answers."""
    print(f"\n{scene}: ms of a whole process (imports, set-up, one integration to 1e-9 m)")
    with tempfile.TemporaryDirectory() as folder:
        drawn = Path(folder) / "drawn.json"
        draw(drawn)
        environment = {**os.environ, DRAWN: str(drawn)}
        for program in programs:
            run = fastest([run for run in runs if run.program == program], 1e-9)
            if run is not None:
                one = f"{program},{scene},{run.way},{run.setting}"
                command = [sys.executable, "-m", "tests.bench.peers.one", one]
                print(f"{program:12}{process_ms(command, environment):8.0f}   {run.label}")
        command = [sys.executable, "-m", "heuncli", "run", str(FOLDER / f"{scene}.yaml"), "--format", "json"]
        told = "its command: spec read, checked, 201 instants with all reactions, as JSON"
        print(f"{'heun run':12}{process_ms(command, environment):8.0f}   {told}")


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(prog="python -m tests.bench.peers")
    parser.add_argument("--scenes", default=",".join(SCENES))
    parser.add_argument("--programs", default=",".join(PROGRAMS))
    given = parser.parse_args()
    found, missing = installed(given.programs.split(","))
    print("; ".join(f"{name} {module.version()}" for name, module in found.items()))
    if missing:
        print(f"not installed: {'; '.join(missing)}")
    print("processor time, one thread; error: largest distance of a centre of mass from the reference at the end")
    for scene in given.scenes.split(","):
        runs: list[Run] = []
        for name, module in found.items():
            for number, way in enumerate(module.ways(scene)):
                runs += runs_of(name, scene, number, way)
        table(scene, runs, list(found))
        points = {PROGRAMS[name]: front([run for run in runs if run.program == name]) for name in found}
        print(chart({letter: own for letter, own in points.items() if own}))
        print("  ".join(f"{PROGRAMS[name]} {name}" for name in found), flush=True)
        if scene == "double":
            processes(scene, runs, list(found))


if __name__ == "__main__":
    main()
