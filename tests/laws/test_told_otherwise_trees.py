"""The same scene told otherwise runs the same: turned, mirrored, other units, faster, names, origins, ends."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

from heuncli.results import Results
from tests.oracle import transforms
from tests.oracle.turns import Array, random_rotation, random_unit
from tests.shared.retold import Told, same_results
from tests.shared.scenes import moving, near, solved
from tests.shared.trees import SOME, seeds, tree_scene

TIMES = np.array([0.0, 0.1, 0.25])
TOLERANCE = 1e-12  # of the motion; what is derived from it agrees to SAME
SAME = 1e-9


def inside(shape: dict[str, Any], rng: np.random.Generator) -> Array:
    """A place inside a shape, not its centre, where another shape may have a point."""
    if "from" in shape:
        return 0.4 * np.array(shape["from"]) + 0.6 * np.array(shape["to"])
    reach = min(shape["size"]) / 2 if "size" in shape else shape["radius"]
    return np.array(shape["center"]) + 0.4 * reach * random_unit(rng)


def cut_through(body: dict[str, Any], rng: np.random.Generator) -> dict[str, Any] | None:
    """An oblique cut of a body with shapes."""
    solid = [s for s in body.get("shapes", ()) if s["type"] != "point"]
    if not solid:
        return None
    at = inside(solid[0], rng)
    return {"at": at.tolist(), "normal": random_unit(rng).tolist(), "first_axis": random_unit(rng).tolist()}


@cache
def original(seed: int) -> tuple[dict[str, Any], Results]:
    """A scene with cuts through its bodies, and its results."""
    scene, _ = tree_scene(seed)
    rng = np.random.default_rng(1000 + seed)
    cuts = {f"cut_{name}": cut_through(body, rng) for name, body in scene["bodies"].items()}
    scene["sections"] = {n: {"body": n[4:], **c} for n, c in cuts.items() if c is not None}
    points = {n: f["on"] for n, f in scene.get("forces", {}).items() if f["type"] == "couple"}
    assert all(isinstance(on, dict) or "." in on for on in points.values())  # every couple says where it enters
    return scene, solved(moving(scene, TIMES, TOLERANCE))


def run(scene: dict[str, Any], times: Array = TIMES) -> Results:
    return solved(moving(scene, times, TOLERANCE))


def with_cuts(scene: dict[str, Any], told: dict[str, Any], change: Callable[[str, Array, bool], Array],
              names: dict[str, str] | None = None) -> dict[str, Any]:
    """The transformed scene with the cuts transformed: change(body, vector, whether it is a place)."""
    cuts = {}
    for name, cut in scene["sections"].items():
        body = cut["body"]
        cuts[name] = {"body": (names or {}).get(body, body)}
        cuts[name] |= {k: change(body, np.array(cut[k]), k == "at").tolist() for k in ("at", "normal", "first_axis")}
    return {**told, "sections": cuts}


@pytest.mark.parametrize("mirror", [False, True], ids=["turned", "mirrored"])
@pytest.mark.parametrize("seed", SOME)
def test_world_turned(seed: int, mirror: bool) -> None:
    """Forces and places turn with the world; in a mirror moments and spins turn the other way round as well."""
    scene, first = original(seed)
    Q = random_rotation(np.random.default_rng(seed)) @ np.diag([1, 1, -1.0 if mirror else 1.0])
    other = with_cuts(scene, transforms.turned(scene, Q), lambda _, v, place: Q @ v)
    same_results(Told(Q=Q), first, run(other), SAME)


@pytest.mark.parametrize("seed", SOME)
def test_other_units(seed: int) -> None:
    """Lengths in inches, masses in pounds, times in tenths of a second."""
    scene, first = original(seed)
    told = Told(length=39.37, mass=2.2, time=10.0)
    other = transforms.units_changed(scene, told.length, told.mass, told.time)
    other = with_cuts(scene, other, lambda _, v, place: told.length * v if place else v)
    same_results(told, first, run(other, TIMES * told.time), SAME)


@pytest.mark.parametrize("seed", SOME)
def test_faster(seed: int) -> None:
    """Heun: k -> c² k with σ -> c σ makes every reaction c² times as large, at the same places."""
    scene, first = original(seed)
    c = 3.0
    other = with_cuts(scene, transforms.faster(scene, c), lambda _, v, place: v)
    same_results(Told(time=1 / c), first, run(other, TIMES / c), SAME)


@pytest.mark.parametrize("seed", SOME)
def test_bodies_and_joints_renamed_and_reordered(seed: int) -> None:
    scene, first = original(seed)
    other, bodies, joints = transforms.renamed(scene, np.random.default_rng(seed))
    other = with_cuts(scene, other, lambda _, v, place: v, bodies)
    same_results(Told(bodies=bodies, joints=joints), first, run(other), SAME)


@pytest.mark.parametrize("seed", SOME)
def test_origins_of_bodies_moved(seed: int) -> None:
    scene, first = original(seed)
    rng = np.random.default_rng(seed)
    by = {name: rng.standard_normal(3) for name in scene["bodies"]}
    other = {k: v for k, v in scene.items() if k != "sections"}
    for name, shift in by.items():
        other = transforms.origin_moved(other, name, shift)
    other = with_cuts(scene, other, lambda body, v, place: v - by[body] if place else v)
    same_results(Told(), first, run(other), SAME)


@pytest.mark.parametrize("seed", seeds(8))
def test_ends_swapped(seed: int) -> None:
    """A ball, pin, weld or rod told from its other end: its reaction turns round, all else stays."""
    scene, _ = tree_scene(seed, kinds=("ball", "pin", "weld", "rod"))
    first = run(scene)
    other = scene
    for name in scene["joints"]:
        other = transforms.swapped(other, name)
    second = run(other)
    F = max(1.0, *(float(np.abs(j["force"]).max()) for j in first.joints.values())) if first.joints else 1.0
    for name, joint in first.joints.items():
        there = second.joints[name]
        near(there["force"], -joint["force"], F, SAME)
        shift = there["point"] - joint["point"]
        near(there["moment"], -joint["moment"] + np.cross(shift, joint["force"]), F, SAME)
    for name, body in first.bodies.items():
        near(second.bodies[name]["center_acceleration"], body["center_acceleration"], F, SAME)
    for part in ("force", "moment"):
        near(second.foundation[part], first.foundation[part], 3 * F, SAME)
