"""The same closed chain told otherwise: turned, mirrored, other units, reordered, other joints cut, other ends first.

Where reactions are open, the split of least norm is compared: it is told by the scene alone, so it must turn and scale
with it; and what is open must be so in every telling that keeps the axes.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
import pytest

from heuncli.results import Results
from tests.oracle import transforms
from tests.oracle.turns import Array, random_rotation
from tests.shared.loops import DRIVEN, QUICK, SOME, loop_scene
from tests.shared.retold import Told, same_results
from tests.shared.scenes import moving, near, solved, study
from tests.shared.seeds import spared

TIMES = np.array([0.0, 0.15])
SAME = 1e-9
THESE = spared([*SOME, *DRIVEN[:6]], QUICK)


def run(scene: Mapping[str, Any], times: Array = TIMES) -> Results:
    return solved(moving(scene, times, 1e-12), least_norm=True)


@cache
def original(seed: int) -> tuple[dict[str, Any], Results]:
    scene, _ = loop_scene(seed)
    return scene, run(scene)


def same_choices(first: Results, second: Results, names: Mapping[str, str] | None = None) -> None:
    """The same components were open before a split was chosen."""
    for name, block in first.joints.items():
        assert second.joints[(names or {}).get(name, name)].get("chosen") == block.get("chosen")


@pytest.mark.parametrize("mirror", [False, True], ids=["turned", "mirrored"])
@pytest.mark.parametrize("seed", THESE)
def test_world_turned(seed: int, mirror: bool) -> None:
    scene, first = original(seed)
    Q = random_rotation(np.random.default_rng(seed)) @ np.diag([1, 1, -1.0 if mirror else 1.0])
    same_results(Told(Q=Q), first, run(transforms.turned(scene, Q)), SAME)


@pytest.mark.parametrize("seed", THESE)
def test_other_units(seed: int) -> None:
    """Millimetres, tonnes, milliseconds: every number far from where it was."""
    scene, first = original(seed)
    told = Told(length=1e3, mass=1e-3, time=1e3)
    second = run(transforms.units_changed(scene, told.length, told.mass, told.time), TIMES * told.time)
    same_results(told, first, second, SAME)
    same_choices(first, second)


@pytest.mark.parametrize("seed", THESE)
def test_bodies_and_joints_reordered(seed: int) -> None:
    scene, first = original(seed)
    for shuffle in range(2):
        other, bodies, joints = transforms.renamed(scene, np.random.default_rng(10 * seed + shuffle))
        second = run(other)
        same_results(Told(bodies=bodies, joints=joints), first, second, SAME)
        same_choices(first, second, joints)


@pytest.mark.parametrize("seed", THESE)
def test_origins_of_bodies_moved(seed: int) -> None:
    scene, first = original(seed)
    rng = np.random.default_rng(seed)
    other = scene
    for name in scene["bodies"]:
        other = transforms.origin_moved(other, name, rng.standard_normal(3))
    second = run(other)
    same_results(Told(), first, second, SAME, points=False)
    same_choices(first, second)


@pytest.mark.parametrize("seed", THESE)
def test_ends_swapped(seed: int) -> None:
    """A ball, pin, weld or rod told from its other end: its reaction turns round."""
    scene, first = original(seed)
    other, turned = scene, []
    for name, joint in scene["joints"].items():
        if joint["type"] in ("ball", "pin", "weld", "rod"):
            other = transforms.swapped(other, name)
            turned.append(name)
    second = run(other)
    F = max(1.0, *(float(np.abs(j["force"]).max()) for j in first.joints.values()))
    for name, joint in first.joints.items():
        there = second.joints[name]
        sign = -1.0 if name in turned else 1.0
        near(there["force"], sign * joint["force"], F, SAME)
        shift = there["point"] - joint["point"]
        near(there["moment"], sign * (joint["moment"] - np.cross(shift, joint["force"])), F, SAME)
        if "drive" in joint:
            near(there["drive"], joint["drive"], F, SAME)
    for part in ("force", "moment"):
        near(second.foundation[part], first.foundation[part], 3 * F, SAME)
    for name, body in first.bodies.items():
        near(second.bodies[name]["center"], body["center"], 1.0, SAME)


def cut_joints(scene: Mapping[str, Any]) -> tuple[set[str], Results]:
    """The joints a run is closed at, and its results."""
    found = study(moving(scene, TIMES, 1e-12), least_norm=True)
    joints = found.scene.mechanism.joints
    return {joints[k].name for k in found.scene.layout.spanning.cut}, found.results


LOOP = {"type": "pin", "axis": [0.1, 0.2, 1.0]}


def ring(kinds: tuple[str, ...]) -> dict[str, Any]:
    """A closed chain of bars in space, each on a pin or slide to the next, all axes parallel."""
    n = len(kinds)
    corners = np.array([[np.cos(a), np.sin(a), 0.1 * k] for k, a in enumerate(2 * np.pi * np.arange(n) / n)])
    axis = np.array(LOOP["axis"])
    bodies: dict[str, Any] = {}
    for k in range(1, n):
        middle = (corners[k - 1] + corners[k]) / 2
        bodies[f"b{k}"] = {"mass": 1.0 + 0.2 * k, "center": middle.tolist(), "inertia": [0.11, 0.12, 0.13],
                           "points": {"O": [0, 0, 0]}}
    joints = {}
    for k, kind in enumerate(kinds):
        a, b = ("ground", "b1") if k == 0 else (f"b{k}", f"b{k + 1}") if k < n - 1 else (f"b{n - 1}", "ground")
        direction = axis if kind == "pin" else np.cross(axis, corners[k] + [0.3, 0, 0])
        ends = {"from": {"body": a, "at": corners[k].tolist()}, "to": {"body": b, "at": corners[k].tolist()}}
        joints[f"j{k}"] = {"type": kind, "axis": direction.tolist(), **ends}
    joints["j0"]["initial"] = {"rate": 1.3}
    return {"title": "ring", "gravity": [1.0, -9.0, 0.5], "bodies": bodies, "joints": joints}


@pytest.mark.parametrize("kinds", [("pin",) * 4, ("pin", "pin", "slide", "pin"), ("pin", "slide", "pin", "pin", "pin")])
def test_every_cut_gives_the_same(kinds: tuple[str, ...]) -> None:
    """A joint named in an expression is never cut: naming all but one chooses where the ring is closed."""
    scene = ring(kinds)
    if len(kinds) == 5:
        scene["joints"]["j1"]["initial"] = {"speed": 0.4}
    cuts, results = set(), []
    for open_at in range(len(kinds)):
        named = [f"j{k}.angle" if kind == "pin" else f"j{k}.travel" for k, kind in enumerate(kinds) if k != open_at]
        nothing = {"type": "force", "on": "b1.O", "vector": ["0*(" + "+".join(named) + ")", 0, 0]}
        cut, found = cut_joints({**scene, "forces": {"nothing": nothing}})
        cuts |= cut
        results.append(found)
    assert cuts == set(scene["joints"])
    for other in results[1:]:
        same_results(Told(), results[0], other, SAME)
        same_choices(results[0], other)
        for name, block in results[0].coordinates.items():
            for what, values in block.items():
                near(other.coordinates[name][what], values, max(1.0, float(np.abs(values).max())), SAME)
