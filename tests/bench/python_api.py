"""What solving from Python takes beside the command in one process: processor time, least of interleaved runs."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import heuncli
from heuncli.app.cli.entry import enter
from heuncli.results.results_schema import REPORTS
from tests.shared.folders import SPECS

EXPORTED = [name for name in REPORTS if name != "points"]  # as JSON has them
TIMES = 60
FREE = 1.0  # ms that Python may take beyond the command


def python_api() -> None:
    """Print them for some scenes, and what a signal and a measure take of one that is solved."""
    with tempfile.TemporaryDirectory() as folder:
        out = str(Path(folder) / "out.json")
        for name in ("double", "engine", "six_cylinder"):
            path = str(SPECS / f"{name}.yaml")
            command, program = least(
                lambda path=path: enter(["run", path, "--format", "json", "-o", out, "-q"]),
                lambda path=path: heuncli.solve(path, only=EXPORTED).to_json(),
            )
            print(f"{name}: heun run --format json {command:.2f} ms, heuncli.solve and to_json {program:.2f} ms "
                  f"({program - command:+.2f}, goal at most {FREE:+.0f})")  # fmt: skip
    study = heuncli.solve(SPECS / "engine.yaml")
    (frame,) = least(lambda: heuncli.solve(SPECS / "engine.yaml")["joints.main.force"].values)
    (measured,) = least(lambda: study.measure("max abs joints.main.force"))
    print(f"engine: solved and one array taken {frame:.2f} ms, a measure more {measured:.2f} ms")


def least(*works: Callable[[], object]) -> list[float]:
    """The least processor time of each, in ms, taken by turns."""
    found = [float("inf")] * len(works)
    for _ in range(TIMES):
        for k, work in enumerate(works):
            begun = time.process_time()
            work()
            found[k] = min(found[k], 1e3 * (time.process_time() - begun))
    return found
