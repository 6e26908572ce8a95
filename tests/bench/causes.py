"""What loads by cause cost: a recovery of ten causes against one without, printed."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from typing import Any

from heuncli.scene.file_format.load import load
from heuncli.study.compose.blocks import make_blocks
from heuncli.study.compose.recovery import recover
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve

REPORTS = frozenset({"motion", "foundation", "joints", "sections", "forces", "energy"})
FORCES = 7  # beside gravity, drives and motion


def chain(n: int, cuts: int, loop: bool) -> str:
    """Bars on balls and pins by turns, under forces, 1,001 instants; cuts: bodies with 11 each; loop: its end held."""
    bar = "{type: cylinder, from: [0, 0, 0], to: [1, 0, 0], radius: 0.02, density: 7850}"
    bodies = "".join(
        f"  b{i}: {{shapes: [{bar}], points: {{p: [0, 0, 0], q: [1, 0, 0]}}, position: [{i}, 0, 0]}}\n"
        for i in range(n)
    )
    joints = "".join(
        f"  j{i}: {{type: {('ball', 'pin, axis: [0, 1, 0]')[i % 2]}, "
        f"from: {f'b{i - 1}.q' if i else 'ground.O'}, to: b{i}.p}}\n"
        for i in range(n)
    )
    joints += f"  end: {{type: rod, from: ground.E, to: b{n - 1}.q}}\n" * loop
    forces = "".join(f"  f{k}: {{type: force, on: b{k % n}.q, vector: [1, {0.3 * k}, 2]}}\n" for k in range(FORCES))
    sections = "".join(f"  s{i}: {{body: b{i}, from: p, to: q, count: 11}}\n" for i in range(cuts))
    return (
        f"heun: 1\ngravity: [0, 0, -9.81]\nground: {{points: {{O: [0, 0, 0], E: [{n}, 2, 1]}}}}\nbodies:\n{bodies}"
        f"joints:\n{joints}forces:\n{forces}{'sections:' * bool(cuts)}\n{sections}"
        "analysis: {duration: 0.5, samples: 1001, tolerance: 1e-6}\n"
    )


def recovery(study: Study, causes: bool) -> dict[str, Any]:
    """The blocks of a run recovered anew from its states."""
    found = study.history.solutions
    again = study.setup.runner.evaluate(found.times, found.states, causes=causes)
    return make_blocks(recover(study.setup, again, False), REPORTS | ({"shares"} if causes else set()))


def least_ms(f: Callable[[], Any], repeats: int) -> float:
    """Least processor time of a call [ms]."""
    found = []
    for _ in range(repeats):
        begun = time.process_time()
        f()
        found.append(time.process_time() - begun)
    return 1e3 * min(found)


def by_cause() -> None:
    """Chains with and without cuts and a loop."""
    for n, cuts, loop in ((3, 0, False), (3, 1, False), (10, 0, False), (10, 2, False), (4, 0, True), (4, 1, True)):
        study = solve(load("chain.yaml", chain(n, cuts, loop)))
        without, with_all = (least_ms(partial(recovery, study, causes), 15) for causes in (False, True))
        what = f"{n} bodies{', a loop' * loop}{f', {11 * cuts} cuts' * bool(cuts)}"
        print(
            f"{what}: {without:.1f} ms, with {FORCES + 3} causes {with_all:.1f} ms, {with_all / without:.2f} times that"
        )
