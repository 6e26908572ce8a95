"""The figures that matter, of this checkout beside another: `python -m tests.bench figures [--against PATH]`.

Only what both sides are sure to have is used, the command line and the lines that `tests.bench motion` prints, so that
any two commits can be compared; the other checkout needs its kernel compiled in place. The checkouts take turns, and
processor time is counted, so that what else the machine does matters less.
"""

from __future__ import annotations

import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from tests.bench.generated import chain
from tests.oracle.published import windows
from tests.oracle.values import to_yaml
from tests.shared.scenes import moving

HERE = Path(__file__).parents[2]
SCENES = Path(__file__).parent / "scenes"
ALONE = re.compile(r"(\w+) +to 1e-09 m: error \S+ m, +(\S+) ms alone")
HEUN = [sys.executable, "-m", "heuncli"]

Figures = dict[str, float]  # by name, with its unit


def environment(checkout: Path, kernel: str) -> dict[str, str]:
    """In which a process runs a checkout's own code; compiled once, as where it is installed."""
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return kept | {"PYTHONPATH": str(checkout), "HEUN_KERNEL": kernel, "OPENBLAS_NUM_THREADS": "1"}


def motions(checkout: Path, kernel: str, names: set[str]) -> dict[str, float]:
    """Milliseconds of the benchmark scenes to 1e-9 m, as the checkout's own benchmark prints them."""
    command = [sys.executable, "-u", "-m", "tests.bench", "motion"]
    found: dict[str, float] = {}
    with subprocess.Popen(
        command, cwd=checkout, env=environment(checkout, kernel), stdout=subprocess.PIPE, text=True
    ) as run:
        assert run.stdout is not None
        for line in run.stdout:
            if match := ALONE.match(line):
                found[match[1]] = float(match[2])
            if names <= found.keys():
                run.terminate()  # the scenes after these are not asked for
                return found
    raise SystemExit(f"{' '.join(command)} in {checkout}: no figure of {', '.join(sorted(names - found.keys()))}")


def processor_seconds(command: list[str], checkout: Path) -> tuple[float, str]:
    """Processor time of a whole process, and what it printed."""
    with tempfile.TemporaryFile("w+") as output:
        run = subprocess.Popen(command, stdout=output, cwd=SCENES, env=environment(checkout, "require"))
        _, status, used = os.wait4(run.pid, 0)
        run.returncode = os.waitstatus_to_exitcode(status)
        if run.returncode:
            raise SystemExit(f"{' '.join(command)} in {checkout}: exit code {run.returncode}")
        output.seek(0)
        return used.ru_utime + used.ru_stime, output.read()


def compiled(checkout: Path) -> Figures:
    """The motions alone, compiled."""
    found = motions(checkout, "require", {"double", "top", "chain10", "crank"})
    return {f"{name} to 1e-9 m, compiled [ms]": ms for name, ms in found.items()}


def plain(checkout: Path) -> Figures:
    """The double pendulum by the plain kernel."""
    return {"double to 1e-9 m, plain [ms]": motions(checkout, "pure", {"double"})["double"]}


def starting(checkout: Path) -> Figures:
    """A small run against the import of NumPy alone, in turn."""
    bare, run = [], []
    for _ in range(10):
        bare.append(processor_seconds([sys.executable, "-c", "import numpy"], checkout)[0])
        run.append(processor_seconds([*HEUN, "run", "double.yaml"], checkout)[0])
    return {"heun run double.yaml [times import numpy]": statistics.median(run) / statistics.median(bare)}


def long_chain(checkout: Path) -> Figures:
    """A chain of 1,000 bodies over 0.1 s, the foundation's loads only: the whole command."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "chain1000.yaml"
        path.write_text(chain(1000, duration=0.1))
        seconds, _ = processor_seconds([*HEUN, "run", str(path), "--only", "foundation"], checkout)
    return {"chain of 1,000 bodies, foundation [s]": seconds}


def many_windows(checkout: Path) -> Figures:
    """Forty windows of bars, of which much is indeterminate: the whole command, and verdicts and sums in it; tables."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "windows40.yaml"
        path.write_text(to_yaml(moving(windows(40, 0.0, 1.0), (0.0, 0.5, 1.0), 1e-6)))
        seconds, text = processor_seconds([*HEUN, "run", str(path), "--format", "json", "--quiet"], checkout)
        tables, _ = processor_seconds([*HEUN, "run", str(path), "--quiet"], checkout)
    recover = json.loads(text)["work"]["seconds"]["recover"]
    return {
        "forty windows of bars [s]": seconds,
        "of that verdicts, sums and loads [s]": recover,
        "the same as tables, extremes searched [s]": tables,
    }


PARTS: tuple[Callable[[Path], Figures], ...] = (compiled, plain, starting, long_chain, many_windows)


def figures(against: Path | None, rounds: int = 3) -> None:
    """Print them, each the median of some rounds in which the checkouts take turns."""
    checkouts = [HERE] if against is None else [HERE, against.resolve()]
    heads = ["here", "there", "here/there"][: 1 if against is None else 3]
    print(f"{'':44}" + "".join(f"{head:>12}" for head in heads), time.strftime("  %Y-%m-%d"))
    for part in PARTS:
        runs: list[list[Figures]] = [[] for _ in checkouts]
        for _ in range(rounds):
            for checkout, found in zip(checkouts, runs, strict=True):
                found.append(part(checkout))
        for name in runs[0][0]:
            middle = [statistics.median(figure[name] for figure in found) for found in runs]
            ratio = [middle[0] / middle[1]] if len(middle) == 2 else []
            print(f"{name:44}" + "".join(f"{value:12.3f}" for value in (*middle, *ratio)), flush=True)
