"""Loads given by places and velocities of points: they are what the results tell of those points, whatever is reduced.

A load's law is the same function of the points that the results have, worked out here, in random trees, loops, welded
and carried machines, round bodies and flat scenes in any plane; in full and reduced, where points come to stand on
other bodies, on the ground or in other axes. The tangent of such a motion is that of dual numbers run through the plain
kernel.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from heuncli.multibody.response import make_workspace, tangent
from heuncli.results.results import Array, Results
from tests.shared import reducible
from tests.shared.dual_tangent import dual_tangent
from tests.shared.flat_in_any_plane import PLANES, flat
from tests.shared.loops import loop_scene
from tests.shared.scenes import moving, near, study
from tests.shared.trees import tree_scene

pytestmark = pytest.mark.heavy
Scene = dict[str, Any]
TIMES = (0.0, 0.03, 0.07)
DIGITS = 1e-12
SEEDS = 3  # of each family
UPRIGHT = [name for name, axes in PLANES.items() if name != "tilted"]

FAMILIES: dict[str, Callable[[int], Scene]] = {
    "tree": lambda seed: tree_scene(seed)[0],
    "loop": lambda seed: loop_scene(seed)[0],
    "welded": lambda seed: reducible.welded(3 * seed + 1),
    "carried": lambda seed: reducible.carried(3 * seed + 1),
    "round": lambda seed: reducible.round_scene(3 * seed + 1),
    "driven": lambda seed: reducible.driven(3 * seed + 1),
    "flat": lambda seed: flat(seed, UPRIGHT[seed % len(UPRIGHT)], bool(seed % 2), bool(seed // 2 % 2)),
}
CASES = [(family, seed) for family in FAMILIES for seed in range(SEEDS)]


class Law:
    """A law in two points of a scene, as text and of results: 2 sin(a . x) - 0.7 a' . v + 0.3 (b . y) (b' . w)."""

    def __init__(self, scene: Scene, rng: np.random.Generator) -> None:
        self.bodies = {name: {**body, "points": {**body.get("points", {})}} for name, body in scene["bodies"].items()}
        self.points = [self.point(rng, f"read{k}") for k in range(3)]
        self.directions = rng.standard_normal((4, 3))

    def point(self, rng: np.random.Generator, name: str) -> str:
        """A new point somewhere on one of the bodies, body.point."""
        body = str(rng.choice(list(self.bodies)))
        self.bodies[body]["points"][name] = (0.4 * rng.standard_normal(3)).tolist()
        return f"{body}.{name}"

    @property
    def text(self) -> str:
        """As it is written in a spec."""
        a, b, *_ = self.points
        parts = [(a, ""), (a, "v"), (b, ""), (b, "v")]
        x, v, y, w = (
            " + ".join(f"({c!r})*points.{on}.{rate}{axis}" for c, axis in zip(n.tolist(), "xyz", strict=True))
            for (on, rate), n in zip(parts, self.directions, strict=True)
        )
        return f"2*sin({x}) - 0.7*({v}) + 0.3*({y})*({w})"

    def of(self, results: Results) -> Array:
        """By the points of the results, (n_t,)."""
        a, b, *_ = (results.points[name] for name in self.points)
        x, v, y, w = self.directions
        found: Array = 2 * np.sin(a["position"] @ x) - 0.7 * a["velocity"] @ v
        return found + 0.3 * (b["position"] @ y) * (b["velocity"] @ w)


def with_law(family: str, seed: int) -> tuple[Scene, Law]:
    """A random scene with an actuator by such a law, in a plane with a couple across it."""
    scene, rng = FAMILIES[family](seed), np.random.default_rng(seed)
    law = Law(scene, rng)
    ground = {"points": {**scene.get("ground", {}).get("points", {}), "far": [4.1, -3.2, 5.3]}}
    acts: Scene = {"type": "actuator", "from": "ground.far", "to": law.points[2], "value": law.text}
    if family == "flat":
        vector: list[Any] = [0, 0, 0]
        vector[int(np.argmax(np.abs(PLANES[UPRIGHT[seed % len(UPRIGHT)]][2])))] = law.text
        acts = {"type": "couple", "on": law.points[2].partition(".")[0], "vector": vector}
    scene = {**scene, "bodies": law.bodies, "ground": ground, "forces": {**scene.get("forces", {}), "law": acts}}
    return moving(scene, TIMES, 1e-10), law


@pytest.mark.parametrize(("family", "seed"), CASES)
@pytest.mark.third
def test_a_law_is_that_of_the_points_told(family: str, seed: int) -> None:
    scene, law = with_law(family, seed)
    full, small = (study(scene, reduce=reduce) for reduce in (False, True))
    for found in (full.results, small.results):
        wanted = law.of(found)
        wanted = np.abs(wanted) if family == "flat" else wanted
        near(found.forces["law"]["value"], wanted, 1.0 + float(np.abs(wanted).max()), DIGITS)
    for name, point in full.results.points.items():
        near(small.results.points[name]["position"], point["position"], 1.0, 1e-8)
    if seed == 0:  # some seconds each
        layout = small.setup.runner.integrated_scene.layout
        state, wanted = dual_tangent(layout, 0.0, layout.y0)
        near(tangent(make_workspace(layout), 0.0, state), wanted, 1.0 + float(np.abs(wanted).max()), 1e-10)


def test_the_families_are_reduced() -> None:
    """Most of them in part: points are seen on other bodies, on the ground, and in the axes of a plane."""
    told = []
    for family in ("welded", "carried", "flat"):
        setup = study(with_law(family, 1)[0]).setup
        assert setup.reduction is not None
        told.append(" ".join(setup.reduction.explanations))
    assert "welded" in told[0]
    assert "part of the ground" in told[1]
    assert "plane" in told[2]


BALLS: Scene = {
    "gravity": [0.4, -1.1, -9.0],
    "ground": {"points": {"O": [0.1, 0.2, 0.3], "A": [1.2, 0.9, 0.4]}},
    "bodies": {
        "one": {"mass": 2, "center": [0.3, 0.1, -0.2], "inertia": [0.3, 0.4, 0.5], "position": [0.1, 0.2, 0.3],
                "angular_velocity": [1.1, -0.4, 0.7], "points": {"o": [0, 0, 0], "e": [0.5, 0.2, -0.4]}},
        "two": {"mass": 1, "center": [0.1, -0.3, 0.2], "inertia": [0.2, 0.1, 0.2], "position": [0.6, 0.4, -0.1],
                "angular_velocity": [0.2, -0.3, 0.1], "points": {"o": [0, 0, 0], "e": [0.2, -0.6, 0.3]}},
    },
    "joints": {"a": {"type": "ball", "from": "ground.O", "to": "one.o"},
               "b": {"type": "ball", "from": "one.e", "to": "two.o"}},
    "forces": {
        "wind": {"type": "force", "on": "two.e",
                 "vector": ["-points.two.e.vx*points.one.e.z", "sin(points.two.e.y)", "2"]},
        "pull": {"type": "actuator", "from": "ground.A", "to": "one.e", "value": "3*points.two.e.x - points.one.e.vy"},
    },
    "analysis": {"times": [0, 0.3, 0.8], "tolerance": 1e-11, "events": {"up": "points.two.e.vz > 0 and t > 10 ms"}},
}  # fmt: skip


def renamed(value: Any, turns: int) -> Any:
    """A scene in axes called otherwise: x is y, y is z, z is x, so many times over; all lists of three are vectors."""
    if isinstance(value, dict):
        return {k: v if k == "times" else renamed(v, turns) for k, v in value.items()}
    if isinstance(value, list):
        return [renamed(value[(k - turns) % 3], turns) for k in range(3)]
    if not isinstance(value, str):
        return value
    return re.sub(r"\.(v?)([xyz])\b", lambda m: f".{m[1]}{'xyz'[('xyz'.index(m[2]) + turns) % 3]}", value)


def test_axes_called_otherwise() -> None:
    scene = BALLS
    first = study(scene).results
    assert len(first.events["up"]["time"]) > 0
    for turns in (1, 2):
        other = study(renamed(scene, turns)).results
        for name, point in first.points.items():
            near(np.roll(point["position"], turns, axis=1), other.points[name]["position"], 1.0, 1e-9)
        near(other.events["up"]["time"], first.events["up"]["time"], 1.0, 1e-9)
        near(other.energy["work"], first.energy["work"], 1.0, 1e-8)
