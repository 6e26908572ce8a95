"""Random closed chains whose bodies weigh between a milligram and a thousand tonnes, drawn in world axes.

Statically determined or not, tests/shared/exact has the answer, and what of it is open.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from tests.honesty.near_redundant import NearScene, Rng, body, flat, scene_of

GRAVITY = 9.81


def mass(rng: Rng) -> float:
    return float(10.0 ** rng.uniform(-6, 6))


def pushed(rng: Rng, on: str, size: float, planar: bool) -> dict[str, Any]:
    """A force at `p`, between that of a feather and that of a locomotive."""
    F = rng.standard_normal(3) * 10.0 ** rng.uniform(-6, 6)
    return {
        "push": {"type": "force", "on": f"{on}.p", "vector": [float(F[0]), float(F[1]), 0.0 if planar else float(F[2])]}
    }


def bars(rng: Rng) -> NearScene:
    """A chain of two to five bars in the plane, closed on the ground by a pin or a rod, and braced within by rods."""
    n, rated = int(rng.integers(3, 6)), bool(rng.random() < 0.5)
    at = [np.zeros(3)]
    for _ in range(n):
        at.append(at[-1] + flat(rng.uniform(0.5, 1.5), rng.uniform(-1.5, 1.5)))
    bodies = {}
    for k in range(n):
        points = {"a": at[k], "b": at[k + 1], "p": 0.5 * (at[k] + at[k + 1]) + flat(0.3, rng.uniform(0, 6))}
        bodies[f"b{k}"] = body(mass(rng), 0.5 * (at[k] + at[k + 1]), 1.0, points, planar=True)
    joints: dict[str, Any] = {
        f"j{k}": {"type": "pin", "from": f"b{k - 1}.b" if k else "ground.O", "to": f"b{k}.a"} for k in range(n)
    }
    ground = {"O": at[0], "E": at[-1], "R": at[-1] + flat(1.0, rng.uniform(0, 6))}
    if rng.random() < 0.5:
        joints["end"] = {"type": "pin", "from": "ground.E", "to": f"b{n - 1}.b"}
    else:
        joints["end"] = {"type": "rod", "from": "ground.R", "to": f"b{n - 1}.b"}
    if rng.random() < 0.5:
        a, b = rng.permutation(n)[:2]
        joints["brace"] = {"type": "rod", "from": f"b{a}.p", "to": f"b{b}.p"}
    rates = {}
    if rated and n == 3 and "brace" not in joints and joints["end"]["type"] == "pin":
        rates = {"b0": float(rng.uniform(-2, 2))}
        bodies["b0"]["angular_velocity"] = [0.0, 0.0, rates["b0"]]
    more = {"gravity": [0.0, -GRAVITY, 0.0], "forces": pushed(rng, f"b{n - 1}", 1.0, True)}
    return NearScene(scene_of(bodies, joints, ground, True, **more), rates)


def slider(rng: Rng) -> NearScene:
    """A lever on a slider, each of any mass, held to it by three rods, one of them perhaps to the ground."""
    turn, heights = rng.uniform(0, 6), rng.uniform(-1, 1, (3, 2))
    places = {f"q{k}": np.array([*heights[k], 0.0]) + flat(1.0, turn + 2.1 * k) for k in range(3)}
    feet = {f"r{k}": np.array([*heights[k], 0.0]) * 0.3 for k in range(3)}
    heavy, light = float(10.0 ** rng.uniform(0, 6)), float(10.0 ** rng.uniform(-6, 0))
    if rng.random() < 0.2:
        heavy, light = light, heavy
    bodies = {
        "slider": body(heavy, np.array([0.0, 0.2, 0.0]), 1.0, {"o": np.zeros(3), **places}, planar=True),
        "lever": body(light, np.array([0.3, 0.0, 0.0]), 1.0, {**feet, "p": flat(1.0, rng.uniform(0, 6))}, planar=True),
    }
    joints = {"guide": {"type": "slide", "from": "ground.O", "to": "slider.o", "axis": [1.0, 0.0, 0.0]}}
    for k in range(3):
        owner = "ground" if k == 2 and rng.random() < 0.3 else "slider"
        joints[f"rod{k}"] = {"type": "rod", "from": f"{owner}.q{k}", "to": f"lever.r{k}"}
    ground = {"O": np.zeros(3), "q2": places["q2"]}
    push = {"type": "force", "on": "lever.p", "vector": [float(10 * rng.standard_normal()), -30.0, 0.0]}
    more = {"gravity": [0.0, -GRAVITY * (rng.random() < 0.5), 0.0], "forces": {"push": push}}
    return NearScene(scene_of(bodies, joints, ground, True, **more), {})


def cage(rng: Rng) -> NearScene:
    """Two or three bodies in space, chained by balls and braced by rods to each other and the ground."""
    n = int(rng.integers(2, 4))
    at = rng.uniform(-1, 1, (n + 1, 3)) + np.arange(n + 1)[:, None] * np.array([1.0, 0.3, 0.2])
    bodies, joints = {}, {}
    for k in range(n):
        points = {"a": at[k], "b": at[k + 1], "p": 0.5 * (at[k] + at[k + 1]) + rng.uniform(-0.5, 0.5, 3)}
        points["q"] = points["p"] + rng.uniform(-0.5, 0.5, 3)
        bodies[f"b{k}"] = body(mass(rng), 0.5 * (at[k] + at[k + 1]), 1.0, points)
        joints[f"j{k}"] = {"type": "ball", "from": f"b{k - 1}.b" if k else "ground.O", "to": f"b{k}.a"}
    ground = {"O": at[0]} | {f"g{k}": rng.uniform(-2, 2, 3) for k in range(3)}
    for k in range(int(rng.integers(1, 4))):
        to = f"b{rng.integers(n)}.{rng.choice(['p', 'q'])}"
        frm = f"b0.{rng.choice(['p', 'q'])}" if rng.random() < 0.4 and not to.startswith("b0") else f"ground.g{k}"
        joints[f"rod{k}"] = {"type": "rod", "from": frm, "to": to}
    more = {"gravity": [0.0, 0.0, -GRAVITY], "forces": pushed(rng, f"b{n - 1}", 1.0, False)}
    return NearScene(scene_of(bodies, joints, ground, False, **more), {})


def links(rng: Rng) -> NearScene:
    """Heavy bodies in the plane hang on light links from each other, in a ring or a row."""
    n = int(rng.integers(1, 4))
    bodies, joints, ground = {}, {}, {"O": np.zeros(3)}
    above, at = "ground.O", np.zeros(3)
    for k in range(n):
        to = at + flat(1.0, rng.uniform(-2.5, -0.6))
        bodies[f"link{k}"] = body(
            float(10.0 ** rng.uniform(-6, -2)), 0.5 * (at + to), 1.0, {"a": at, "b": to}, planar=True
        )
        end = to + flat(0.4, rng.uniform(0, 6))
        points = {"a": to, "b": end, "p": to + flat(0.5, rng.uniform(0, 6))}
        bodies[f"block{k}"] = body(float(10.0 ** rng.uniform(2, 6)), points["p"], 1.0, points, planar=True)
        joints[f"upper{k}"] = {"type": "pin", "from": above, "to": f"link{k}.a"}
        joints[f"lower{k}"] = {"type": "pin", "from": f"link{k}.b", "to": f"block{k}.a"}
        above, at = f"block{k}.b", end
    if rng.random() < 0.7:
        ground["E"] = at + flat(math.sqrt(2), rng.uniform(0, 6))
        joints["end"] = {"type": "rod", "from": "ground.E", "to": above}
    more = {"gravity": [0.0, -GRAVITY, 0.0], "forces": pushed(rng, "block0", 1.0, True)}
    return NearScene(scene_of(bodies, joints, ground, True, **more), {})


FAMILIES: tuple[Callable[[Rng], NearScene], ...] = (bars, slider, cage, links)


def weighted_scene(seed: int) -> tuple[str, NearScene]:
    """The family's name and the scene."""
    family = FAMILIES[seed % len(FAMILIES)]
    return family.__name__, family(np.random.default_rng([22, seed]))
