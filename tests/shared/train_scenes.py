"""Random gear trains: coaxial wheels, planets on an arm, more meshes than there are wheels to hold, all in mesh.

Wheels turn at rates that are drawn first; every pair meshes where these let it roll. So whatever meshes closes, and
what is held twice is held alike.
"""

from __future__ import annotations

import itertools
from functools import cache
from typing import Any

import numpy as np

from tests.oracle.read import GROUND
from tests.oracle.scenes import Maker
from tests.oracle.turns import Array, across, random_unit
from tests.shared.geared_scenes import HUNG, member
from tests.shared.trees import ABOUT, Case, case

LOADS = ("force", "couple", "spring", "torque", "damper")


def train_scene(seed: int, planets: int | None = None) -> dict[str, Any]:
    """A planetary train on the ground or on a body that moves anyhow; of two planets or more something is open."""
    rng = np.random.default_rng(seed)
    maker = Maker(rng, "given")
    base = GROUND
    if seed % 2:
        maker.body("base", HUNG, 0.0, 1.0, 0.3)
        base = "base"
    n, O = random_unit(rng), rng.uniform(-1, 1, 3)
    u, v = across(n)
    wheels: dict[str, tuple[str, float, Array]] = {"ring": ("j_arm", 0.0, np.zeros(3))}  # joint, rate, place on the arm
    member(maker, rng, base, "arm", "pin", O, n)
    ends = maker.scene["joints"]["j_arm"]
    a = owned(maker, ends, "arm")  # of the arm: the point and the axis about which it turns on the base
    for name in ("sun", "sun2")[: 1 + seed // 2 % 2]:
        member(maker, rng, base, name, "pin", O + rng.uniform(-0.5, 0.5) * n, n)
        wheels[name] = (f"j_{name}", float(rng.uniform(-3, 3)), np.zeros(3))
    turn = maker.state["arm"].rotation.T @ base_of(maker, base)
    for k in range(planets or int(rng.integers(1, 4))):
        angle, far = rng.uniform(0, 2 * np.pi), rng.uniform(0.5, 1.0)
        spot = turn @ (far * (np.cos(angle) * u + np.sin(angle) * v))
        member(maker, rng, "arm", f"planet{k}", "pin", a + spot, turn @ n)
        wheels[f"planet{k}"] = (f"j_planet{k}", float(rng.uniform(-4, 4)), spot)
    maker.scene["couplings"] = meshes(rng, wheels, float(rng.uniform(-2, 2)), a)
    maker.body("hung", HUNG, 0.5, 0.0, 0.0)
    maker.set_moving()
    maker.loads(LOADS, True)
    return maker.scene


def owned(maker: Maker, ends: dict[str, Any], body: str) -> Array:
    """The point of a body at a joint."""
    for end in (ends["from"], ends["to"]):
        if isinstance(end, dict) and end["body"] == body:
            return np.array(end["at"])
        if isinstance(end, str) and end.startswith(f"{body}."):
            return np.array(maker.scene["bodies"][body]["points"][end.partition(".")[2]])
    raise ValueError(body)


def base_of(maker: Maker, base: str) -> Array:
    """The attitude of the base."""
    return np.eye(3) if base == GROUND else maker.state[base].rotation


def meshes(
    rng: np.random.Generator, wheels: dict[str, tuple[str, float, Array]], arm: float, a: Array
) -> dict[str, Any]:
    """Every pair that may roll on each other; arm: its rate."""
    found = {}
    pairs = itertools.combinations(wheels.items(), 2)
    for (one, (j1, w1, p1)), (two, (j2, w2, p2)) in pairs:
        d = p2 - p1
        if not (one.startswith("planet") or two.startswith("planet")) or abs(w1 - w2) < 0.3:
            continue
        x = (w2 - arm) / (w2 - w1)  # of the way from the one axis to the other
        if min(abs(x), abs(x - 1.0)) < 0.15 or abs(x) > 3.0:
            continue
        of = [j1, j2] if rng.random() < 0.5 else [j2, j1]
        at = {"body": "arm", "at": (a + p1 + x * d).tolist()}
        helix = float(rng.uniform(-0.4, 0.4)) if rng.random() < 0.5 else 0.0
        found[f"{one}_{two}"] = {"type": "gear", "of": of, "at": at, "helix": helix, "pressure_angle": 0.0}
    return found


@cache
def train(seed: int, planets: int | None = None) -> Case:
    """A random train's run, with the oracle's answer at every instant."""
    return case({**train_scene(seed, planets), "foundation": {"about": ABOUT.tolist()}})
