"""Random chaotic scenes that nothing damps or drives: their energy stays, their motion is soon forgotten."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from heuncli.results.results import Array
from heuncli.study.queries.study import Study
from tests.honesty.near_redundant import Rng, body, flat, scene_of
from tests.shared.scenes import study
from tests.shared.seeds import spared

Scene = dict[str, Any]
G = 9.81
SEEDS = spared(range(200), range(0, 200, 20))
INSTANTS = 41


def pendulum(rng: Rng, n: int) -> Scene:
    """n bars in the plane, pinned in a row, thrown high."""
    at, bodies, joints = np.zeros(3), {}, {}
    for k in range(n):
        to = at + flat(rng.uniform(0.5, 1.5), rng.uniform(-0.6, 3.7))
        bodies[f"b{k}"] = body(float(rng.uniform(0.5, 3)), 0.5 * (at + to), 0.6, {"a": at, "b": to}, planar=True)
        joints[f"j{k}"] = {"type": "pin", "from": f"b{k - 1}.b" if k else "ground.O", "to": f"b{k}.a"}
        at = to
    bodies["b0"]["angular_velocity"] = [0.0, 0.0, float(rng.uniform(-6, 6))]
    return scene_of(bodies, joints, {"O": np.zeros(3)}, True, gravity=[0.0, -G, 0.0])


def double(rng: Rng) -> Scene:
    return pendulum(rng, 2)


def triple(rng: Rng) -> Scene:
    return pendulum(rng, 3)


def balls(rng: Rng) -> Scene:
    """Two bars in space, on balls."""
    at, bodies, joints = np.zeros(3), {}, {}
    for k in range(2):
        u = rng.standard_normal(3) + np.array([0.0, 0.0, 0.5])
        to = at + rng.uniform(0.6, 1.2) * u / math.sqrt(float(u @ u))
        bodies[f"b{k}"] = body(float(rng.uniform(0.5, 2)), 0.5 * (at + to), 0.6, {"a": at, "b": to})
        bodies[f"b{k}"]["angular_velocity"] = rng.uniform(-3, 3, 3).tolist()
        joints[f"j{k}"] = {"type": "ball", "from": f"b{k - 1}.b" if k else "ground.O", "to": f"b{k}.a"}
        at = to
    del bodies["b1"]["angular_velocity"]
    return scene_of(bodies, joints, {"O": np.zeros(3)}, False, gravity=[0.0, 0.0, -G])


def hung_loop(rng: Rng) -> Scene:
    """A parallelogram-like loop of bars with a pendulum on its coupler."""
    A, D = np.zeros(3), np.array([rng.uniform(1.6, 2.0), 0.0, 0.0])
    B = flat(rng.uniform(0.9, 1.1), -1.2)
    C = D + flat(rng.uniform(0.9, 1.1), -1.9)
    P = 0.5 * (B + C)
    E = P + flat(rng.uniform(0.7, 1.2), rng.uniform(0.0, 3.1))
    parts = {"left": (A, B), "coupler": (B, C), "right": (C, D), "hung": (P, E)}
    bodies = {
        name: body(float(rng.uniform(0.5, 2)), 0.5 * (a + b), 0.6, {"a": a, "b": b, "p": P}, planar=True)
        for name, (a, b) in parts.items()
    }
    joints = {
        "A": {"type": "pin", "from": "ground.A", "to": "left.a"},
        "B": {"type": "pin", "from": "left.b", "to": "coupler.a"},
        "C": {"type": "pin", "from": "coupler.b", "to": "right.a"},
        "D": {"type": "pin", "from": "ground.D", "to": "right.b"},
        "P": {"type": "pin", "from": "coupler.p", "to": "hung.a"},
    }
    bodies["hung"]["angular_velocity"] = [0.0, 0.0, float(rng.uniform(4, 9))]
    return scene_of(bodies, joints, {"A": A, "D": D}, True, gravity=[0.0, -G, 0.0])


def elastic(rng: Rng) -> Scene:
    """A bar in the plane hung on a spring, thrown."""
    at = flat(rng.uniform(0.8, 1.4), rng.uniform(-0.5, 3.6))
    to = at + flat(rng.uniform(0.6, 1.2), rng.uniform(-0.5, 3.6))
    bar = body(1.0, 0.5 * (at + to), 0.6, {"a": at, "b": to}, planar=True)
    bar |= {
        "velocity": [float(rng.uniform(-3, 3)), 0.0, 0.0],
        "angular_velocity": [0.0, 0.0, float(rng.uniform(-4, 4))],
    }
    spring = {
        "type": "spring",
        "from": "ground.O",
        "to": "bar.a",
        "stiffness": float(rng.uniform(20, 80)),
        "length": 0.0,
    }
    scene = scene_of({"bar": bar}, {}, {"O": np.zeros(3)}, True, gravity=[0.0, -G, 0.0])
    del scene["joints"]
    return scene | {"forces": {"spring": spring}}


FAMILIES: tuple[Callable[[Rng], Scene], ...] = (double, triple, balls, hung_loop, elastic)


def chaotic_scene(seed: int) -> tuple[str, Scene]:
    """The family's name and the scene, asked for at two to five instants of a long run."""
    rng = np.random.default_rng([23, seed])
    family = FAMILIES[seed % len(FAMILIES)]
    scene = family(rng)
    analysis = {
        "duration": float(rng.uniform(5, 10)),
        "samples": int(rng.integers(2, 6)),
        "tolerance": float(10.0 ** rng.uniform(-5, -3)),
    }
    return family.__name__, scene | {"analysis": analysis}


@cache
def run_of(seed: int) -> Study:
    return study(chaotic_scene(seed)[1])


def grid(run: Study) -> Array:
    """Instants over the run, and its asked ones."""
    end = float(run.results.time[-1])
    return np.unique([*run.results.time, *(end * np.linspace(0.013, 0.997, INSTANTS))])
