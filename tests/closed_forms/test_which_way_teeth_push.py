"""Which way the teeth of random pairs roll and push: parallel and bevel, outside and inside, any axes and ends.

The reference is where the pitch cones or cylinders stand. Teeth on the outside of a wheel are pushed to its own axis,
whichever flank carries, those on the inside of a ring away from its axis: with tan(alpha) of the force along the teeth.
Both wheels pass the pitch point alike.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from tests.oracle.turns import Array, random_rotation
from tests.shared.scenes import near, solved

CASES = 24
ALPHA = 0.35


class Pair:
    """Two wheels in the ground: feet of the pitch point on their axes, axes, pitch radii; which one is a ring."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.inside, bevel = bool(rng.random() < 0.5), rng.random() < 0.7
        self.turn, self.shift = random_rotation(rng), rng.uniform(-1, 1, 3)
        d = float(rng.uniform(0.2, 1.0))
        side = 1.0 if self.inside else -1.0
        if bevel:  # half angles of the cones, whose common line is x; both axes in the plane xy
            self.teeth, (a, b) = cones(rng, self.inside)
            axes = [np.array([math.cos(a), math.sin(a), 0.0]), np.array([math.cos(b), side * math.sin(b), 0.0])]
            points = [d * math.cos(angle) * n for angle, n in zip((a, b), axes, strict=True)]
            self.P = np.array([d, 0.0, 0.0])
        else:
            self.teeth = sorted(rng.choice(np.arange(9, 80), 2, replace=False).tolist())
            axes = [np.array([1.0, 0.0, 0.0])] * 2
            points = [np.array([0.0, d * z * s, 0.0]) for z, s in zip(self.teeth, (1.0, side), strict=True)]
            self.P = np.zeros(3)
        order = [0, 1] if rng.random() < 0.5 else [1, 0]
        self.ring = order.index(1) if self.inside else None
        self.teeth = [self.teeth[k] for k in order]
        self.points = [self.placed(points[k]) for k in order]
        self.axes = [self.turn @ axes[k] * rng.choice([-1.0, 1.0]) for k in order]
        self.P = self.placed(self.P)

    def placed(self, x: Array) -> Array:
        return np.asarray(self.turn @ x + self.shift)

    def to_axis(self, k: int) -> Array:
        """From the pitch point towards the axis of a wheel."""
        D, n = self.points[k] - self.P, self.axes[k]
        return np.asarray(D - (D @ n) * n)


def cones(rng: np.random.Generator, inside: bool) -> tuple[list[int], tuple[float, float]]:
    """Numbers of teeth and half angles, whose sines they are as; each below 90 deg, so that both are cones."""
    while True:
        one, other = sorted(int(z) for z in rng.choice(np.arange(9, 80), 2, replace=False))
        angle = float(rng.uniform(0.1, 3.0))
        first = math.atan2(math.sin(angle), other / one + (-1.0 if inside else 1.0) * math.cos(angle))
        second = angle + first if inside else angle - first
        if 0.05 < first < 1.5 and 0.05 < second < 1.5:
            return [one, other], (first, second)


def scene(pair: Pair, rng: np.random.Generator) -> dict[str, Any]:
    """The pair, driven and loaded; its mesh by teeth, or by the pitch point."""
    bodies, joints = {}, {}
    for k, name in enumerate("ab"):
        bodies[name] = {"mass": 1, "center": pair.points[k].tolist(), "inertia": [0.1, 0.1, 0.1], "points": {}}
        ends = [{"body": body, "at": pair.points[k].tolist()} for body in ("ground", name)]
        ends = ends if rng.random() < 0.5 else ends[::-1]
        joints[name] = {"type": "pin", "from": ends[0], "to": ends[1], "axis": pair.axes[k].tolist()}
    mesh: dict[str, Any] = {"type": "gear", "of": ["a", "b"], "pressure_angle": ALPHA}
    told = rng.integers(3)
    if told != 1:
        mesh |= {"teeth": pair.teeth, "internal": pair.inside}
    if told != 0:
        mesh["at"] = {"body": "ground", "at": pair.P.tolist()}
    return {
        "bodies": bodies, "joints": joints, "couplings": {"mesh": mesh},
        "drives": {"m": {"joint": "a", "rate": float(rng.normal())}},
        "forces": {"load": {"type": "torque", "joint": "b", "value": float(rng.normal())}},
        "analysis": {"type": "state"},
    }  # fmt: skip


@pytest.mark.parametrize("seed", range(CASES))
def test_teeth_outside_are_pushed_to_their_own_axis(seed: int) -> None:
    rng = np.random.default_rng([seed, 4])
    pair = Pair(rng)
    given = scene(pair, rng)
    found = solved(given)
    arms = [-pair.to_axis(k) for k in range(2)]
    omegas = [found.bodies[name]["angular_velocity"][0] for name in "ab"]
    v = [np.cross(omega, arm) for omega, arm in zip(omegas, arms, strict=True)]
    near(v[1], v[0], float(np.abs(v[0]).max()), 1e-9)
    t = v[0] / np.linalg.norm(v[0])
    load = given["forces"]["load"]["value"]
    sense = 1.0 if given["joints"]["b"]["from"]["body"] == "ground" else -1.0
    on_b = found.couplings["mesh"]["on"]["b"]["force"][0]
    turning = sense * load * pair.axes[1] + np.cross(arms[1], on_b)
    near(turning @ pair.axes[1], 0.0, abs(load), 1e-9)
    tangential = float(on_b @ t)
    for k, name in enumerate("ab"):
        force = found.couplings["mesh"]["on"][name]["force"][0]
        to_axis = pair.to_axis(k) / np.linalg.norm(pair.to_axis(k))
        inner = pair.inside and pair.ring == k
        apart = force - (force @ t) * t
        near(np.linalg.norm(apart), abs(tangential) * math.tan(ALPHA), abs(tangential), 1e-9)
        assert (apart @ to_axis > 0.0) != inner, (name, pair.inside)
