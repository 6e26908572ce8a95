"""What it costs to solve no more than a scene needs, against all of it: one line a reduction, one run of this program.

A line: the scene; what is left out; its motion (one run, as accurate as asked) in full and reduced, the ratio; the same
of all that is done from the spec to the results, most of which looks at all that is solved in either case.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from heuncli.kernel.choose import KERNEL
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.options import Options
from heuncli.study.model.selection import EVERYTHING, select_paths
from heuncli.study.model.setup import set_up
from heuncli.study.workflow import solve
from tests.bench.reducible import cluster, engine, pendulums, spun, truss
from tests.oracle.published import START, andrews, windows
from tests.oracle.values import to_yaml
from tests.shared.scenes import moving

SCENES = Path(__file__).parent / "scenes"
STILL = dict.fromkeys(START, 0.0)


class Row(NamedTuple):
    """A scene, what is left out of it, its text, and what is asked of it (paths; else everything)."""

    scene: str
    left_out: str
    text: Callable[[], str]
    asked: tuple[str, ...] = ()


class Cost(NamedTuple):
    """Milliseconds of a scene's motion, and of all from the spec to the results."""

    motion: float
    whole: float


ROWS = (
    Row("a pendulum beside a hundred", "the hundred", pendulums, ("joints.p0.force",)),
    Row("the same alone", "", lambda: pendulums(1), ("joints.p0.force",)),
    Row("slider-crank", "space", (SCENES / "crank.yaml").read_text),
    Row("Andrews' squeezer", "space", lambda: to_yaml(moving(andrews(START, STILL), (0.0, 0.03), 1e-9))),
    Row("two windows of bars", "space", lambda: to_yaml(moving(windows(2, 0.0, 1.0), (0.0, 10.0), 1e-9))),
    Row("forty windows of bars", "space", lambda: to_yaml(moving(windows(40, 0.0, 1.0), (0.0, 0.5, 1.0, 2.0), 1e-6))),
    Row("driven engine, 10 bodies", "integration, space, welds", engine),
    Row("48 bodies, welded to 8", "40 bodies", cluster),
    Row("a bar on a mast of 36", "36 bodies", truss),
    Row("a wire of 0.01 mm on a ball", "its spin", lambda: spun(1e-5, 1.0)),
    Row("a shaft, 300 rad/s", "its spin", lambda: spun(1e-2, 300.0)),
)


def reduced(repeats: int = 7) -> None:
    """A table of all rows."""
    print("| scene | left out | motion, full | reduced | ratio | spec to results, full | reduced | ratio |")
    print("|---|---|---|---|---|---|---|---|")
    for row in ROWS:
        small, full = (cost(row, reduce, repeats if KERNEL == "compiled" else 1) for reduce in (True, False))
        cells = (f"{a:.3g} ms | {b:.3g} ms | {a / b:.3g}" for a, b in zip(full, small, strict=True))
        print(f"| {row.scene} | {row.left_out} | {' | '.join(cells)} |", flush=True)


def cost(row: Row, reduce: bool, repeats: int) -> Cost:
    """Medians of processor time: what else the machine does counts less so."""
    spec: Spec = load("scene.yaml", row.text())
    asked = select_paths(row.asked, spec) if row.asked else EVERYTHING
    setup = set_up(spec, reduce=reduce, selection=asked)
    assert setup.method is not None
    run = partial(setup.runner.run, np.array(spec.analysis.times), spec.analysis.tolerance, method=setup.method)
    whole = partial(solve, spec, Options(requested_reports=asked.reports, entries=asked.entries, reduce=reduce))
    return Cost(median_ms(run, repeats), median_ms(whole, repeats))


def median_ms(f: Callable[[], object], repeats: int) -> float:
    """Median processor time of a call [ms]."""
    found = []
    for _ in range(repeats):
        begun = time.process_time()
        f()
        found.append(time.process_time() - begun)
    return 1e3 * statistics.median(found)
