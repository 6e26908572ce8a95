"""What it costs to solve no more than a scene needs, against all of it: one line a reduction, one run of this program.

A line: the scene; its motion (one run, as accurate as asked) in full and reduced, the ratio; the same of all that is
done from the spec to the results, most of which looks at the whole scene in either case; steps of both.
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from heuncli.kernel.choose import KERNEL
from heuncli.spec.load import load
from heuncli.study.setup import set_up
from heuncli.study.solve import Options, solve

HEAD = "heun: 1\ntitle: {}\ngravity: [0, 0, -9.81]\nground: {{points: {{O: [0, 0, 0]}}}}\nbodies:\n"
TAIL = "analysis: {duration: 1, samples: 21, tolerance: 1e-8}\nreport: [motion, foundation]\n"
BRICK = "mass: 1, center: [0, 0, 0], inertia: [0.02, 0.03, 0.04]"


class Cost(NamedTuple):
    """Milliseconds of a scene's motion, and of all from the spec to the results; steps of the motion."""

    motion: float
    whole: float
    steps: int


def cluster(links: int = 8) -> str:
    """A chain on balls of which each link is six bricks, welded in a circle."""
    places = [(0.2 * min(k, 5 - k), 0.2 * (k > 2), 0.0) for k in range(6)]
    bodies, joints = [], []
    for i in range(links):
        for k, (x, y, z) in enumerate(places):
            bodies.append(f"  b{i}_{k}: {{{BRICK}, position: [{i + x}, {y}, {z}]}}\n")
            other = (k + 1) % 6
            at = [one - of for one, of in zip((x, y, z), places[other], strict=True)]
            ends = f"from: {{body: b{i}_{k}, at: [0, 0, 0]}}, to: {{body: b{i}_{other}, at: {at}}}"
            joints.append(f"  w{i}_{k}: {{type: weld, {ends}}}\n")
        before = f"{{body: b{i - 1}_2, at: [0.6, 0, 0]}}" if i else "ground.O"
        joints.append(f"  j{i}: {{type: ball, from: {before}, to: {{body: b{i}_0, at: [0, 0, 0]}}}}\n")
    return HEAD.format("welded") + "".join(bodies) + "joints:\n" + "".join(joints) + TAIL


def truss(bays: int = 4) -> str:
    """A mast of bars on balls, nine to a bay, that carries a swinging brick."""
    ring = [(math.cos(a), math.sin(a)) for a in (0.0, 2.0 * math.pi / 3, 4.0 * math.pi / 3)]

    def node(level: int, k: int) -> list[float]:
        return [*ring[k % 3], 1.0 * level]

    steps = (0, 0, 1, 0), (0, 0, 1, 1), (1, 0, 1, 1)  # from level and corner, to level and corner
    bars = [((n + i, k + j), (n + u, k + v)) for n in range(bays) for k in range(3) for i, j, u, v in steps]
    bodies, joints = [], []
    first: dict[tuple[int, int], str] = {}
    for n, bar in enumerate(bars):
        p, q = (node(*end) for end in bar)
        shape = f"{{type: cylinder, from: {p}, to: {q}, radius: 0.02, density: 7850}}"
        bodies.append(f"  k{n}: {{shapes: [{shape}]}}\n")
        for level, k in bar:
            place = f"{{body: k{n}, at: {node(level, k)}}}"
            base = f"{{body: ground, at: {node(level, k)}}}" if level == 0 else None
            of = base or first.setdefault((level, k % 3), place)
            if of != place:
                joints.append(f"  j{len(joints)}: {{type: ball, from: {of}, to: {place}}}\n")
    x, y, z = node(bays, 0)
    bodies.append(f"  x: {{{BRICK}, position: [{x + 0.3}, {y}, {z - 0.1}], angular_velocity: [0.1, 0.2, 3]}}\n")
    joints.append(f"  swing: {{type: ball, from: {first[bays, 0]}, to: {{body: x, at: [-0.3, 0, 0.1]}}}}\n")
    return HEAD.format("mast") + "".join(bodies) + "joints:\n" + "".join(joints) + TAIL


def spun(radius: float, spin: float) -> str:
    """A wire a metre long, or a shaft, on a ball; radius [m]."""
    shape = f"{{type: cylinder, from: [0, 0, 0], to: [0, 0, -1], radius: {radius}, density: 7850}}"
    body = f"  w: {{shapes: [{shape}], points: {{top: [0, 0, 0]}}, orientation: {{axis: [1, 0, 0], angle: 60 deg}}, "
    body += f"angular_velocity: {{vector: [0.3, -0.2, {spin}], frame: body}}}}\n"
    tail = "joints:\n  j: {type: ball, from: ground.O, to: w.top}\nanalysis: {duration: 1, samples: 21}\n"
    return HEAD.format("wire") + body + tail


ROWS: dict[str, Callable[[], str]] = {
    "48 bodies welded to 8": cluster,
    "bar on a mast of 36 bars": truss,
    "wire of 0.01 mm on a ball": lambda: spun(1e-5, 1.0),
    "shaft of 20 mm, 300 rad/s": lambda: spun(1e-2, 300.0),
}


def reduced(repeats: int = 7) -> None:
    """A table of all rows."""
    print("scene                        motion [ms]: full, reduced, ratio   spec to results [ms]   steps")
    for name, text in ROWS.items():
        small, full = (cost(text(), reduce, repeats if KERNEL == "compiled" else 1) for reduce in (True, False))
        print(
            f"{name:28s} {full.motion:9.2f} {small.motion:8.2f} {full.motion / small.motion:7.1f}   "
            f"{full.whole:9.1f} {small.whole:8.1f} {full.whole / small.whole:6.1f}   {full.steps}, {small.steps}"
        )


def cost(text: str, reduce: bool, repeats: int) -> Cost:
    """Medians of processor time: what else the machine does counts less so."""
    spec = load("scene.yaml", text)
    runner = set_up(spec, reduce=reduce).runner
    times = np.array(spec.analysis.times)
    run = runner.trajectory(times, spec.analysis.tolerance)
    motion = median_ms(partial(runner.trajectory, times, spec.analysis.tolerance), repeats)
    return Cost(motion, median_ms(partial(solve, spec, Options(reduce=reduce)), repeats), run.steps)


def median_ms(f: Callable[[], object], repeats: int) -> float:
    """Median processor time of a call [ms]."""
    found = []
    for _ in range(repeats):
        begun = time.process_time()
        f()
        found.append(time.process_time() - begun)
    return 1e3 * statistics.median(found)
