"""What load collectives take: a million samples counted and sorted; a machine's motion with its turns searched."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

import numpy as np

from heuncli.output.tables.collective_tables import count_collectives
from heuncli.scene.file_format.load import load
from heuncli.study.load_collectives import Counting, LoadHistory, make_collective
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve
from tests.shared.folders import SPECS

T = TypeVar("T")
SAMPLES = 1_000_000
ASKED = Counting(slopes=(3.0, 5.0), bins=64)
MOTIONS = (
    ("engine", "joints.main.force.y,joints.wrist.force"), ("jib", "sections.root.stress.normal_max"),
    ("double", "joints.pivot.force.z"),
)  # fmt: skip


def histories() -> dict[str, np.ndarray]:
    """A million samples each: noise turns most often, a walk less, ranges that shrink and grow close last."""
    noise, k = np.random.default_rng(1).normal(size=SAMPLES), np.arange(SAMPLES)
    nested = np.where(k % 2, 1.0, -1.0) * np.abs(k - SAMPLES / 2 - 0.3)
    return {"noise": noise, "walk": np.cumsum(noise), "nested ranges": nested}


def collective_times() -> None:
    """Print it."""
    print(f"\n{'collective':44s}{'instants':>10s}{'cycles':>10s}{'[ms]':>8s}")
    for name, values in histories().items():
        history = LoadHistory(name, "N", np.arange(SAMPLES, dtype=np.float64), values, 1e-9)
        one, ms = timed(lambda history=history: make_collective(history, ASKED))
        print(f"{'a million samples: ' + name:44s}{SAMPLES:10d}{one.total_cycles:10.0f}{ms:8.1f}")
    for name, paths in MOTIONS:
        study = solve(load(str(SPECS / f"{name}.yaml")), Options())
        found, ms = timed(lambda study=study, paths=paths: count_collectives(study, paths.split(","), ASKED))
        total, instants = sum(one.total_cycles for one in found), len(found[0].history.times)
        print(f"{name + ' ' + paths:44s}{instants:10d}{total:10.1f}{ms:8.1f}")


def timed(call: Callable[[], T]) -> tuple[T, float]:
    """What is called for, and its processor time [ms]."""
    begun = time.process_time()
    found = call()
    return found, 1e3 * (time.process_time() - begun)
