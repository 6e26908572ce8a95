"""Laws of what sensors read and bearings carry: moments move with their force, two bearings replace their joint."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.base.joint_kinds import TYPES
from heuncli.results.results import Results
from tests.oracle.turns import Array
from tests.shared.loops import loop_scene
from tests.shared.scenes import moving, near, solved
from tests.shared.trees import cut_through, tree_scene

TIMES = (0.0, 0.1)
CASES = [("tree", 1), ("loop", 3), *(pytest.param(*case, marks=pytest.mark.heavy) for case in (
    *(("tree", n) for n in (2, 3, 5, 7)), *(("loop", n) for n in (0, 1, 4, 6, 1001))
))]  # fmt: skip


def instrumented(kind: str, seed: int) -> dict[str, Any]:
    """A random scene: sensors on every joint and on cuts of bodies, bearings wherever they may be."""
    made, _ = loop_scene(seed, masses="shapes") if kind == "loop" else tree_scene(seed, masses="shapes")
    rng = np.random.default_rng(seed + 77)
    bodies = [*made["bodies"], "ground"]

    def choose(source: str) -> dict[str, Any]:
        point = {"body": str(rng.choice(bodies)), "at": rng.normal(size=3).tolist()}
        return {"of": source, "point": point, "axes": str(rng.choice(bodies))}

    joints, sensors = {}, {}
    for name, joint in made["joints"].items():
        joints[name] = dict(joint)
        if TYPES[joint["type"]].carries_tilting:
            axial = {} if TYPES[joint["type"]].shifts else {"axial": ("first", "second")[seed % 2]}
            joints[name]["bearings"] = {"at": [float(rng.normal()), float(3.0 + rng.normal())], **axial}
        sensors[f"at_{name}"] = choose(f"joints.{name}")
    cuts = {name: cut_through(body, rng) for name, body in made["bodies"].items()}
    sections = {f"cut_{name}": {"body": name, **cut} for name, cut in cuts.items() if cut}
    sensors |= {f"in_{name}": choose(f"sections.{name}") for name in sections}
    return {**made, "joints": joints, "sections": sections, "sensors": sensors}


def body_of(end: Any) -> str:
    return str(end["body"] if isinstance(end, dict) else end.partition(".")[0])


def attitude(results: Results, body: str) -> Array:
    return (
        np.broadcast_to(np.eye(3), (len(results.time), 3, 3)) if body == "ground" else results.bodies[body]["rotation"]
    )


def position(results: Results, end: dict[str, Any]) -> Array:
    at = np.array(end["at"])
    if end["body"] == "ground":
        return np.broadcast_to(at, (len(results.time), 3))
    body = results.bodies[end["body"]]
    return np.asarray(body["position"] + body["rotation"] @ at)


def check_sensors(scene: dict[str, Any], results: Results) -> None:
    """M_P = M_O + (O - P) x F, in the columns of the body's attitude; open where some part of the sum is."""
    for name, sensor in scene["sensors"].items():
        block, _, source = sensor["of"].partition(".")
        whole, found = getattr(results, block)[source], results.sensors[name]
        P, R = position(results, sensor["point"]), attitude(results, sensor["axes"])
        for mine, its in [(found, whole), *((found["shares"][c], whole["shares"][c]) for c in found["shares"])]:
            F = np.asarray(its["force"])
            M = np.asarray(its["moment"]) + np.cross(np.asarray(whole["point"]) - P, F)
            for key, wanted in (("force", F), ("moment", M)):
                turned = np.einsum("tji,tj->ti", R, wanted)
                known = np.isfinite(turned) & np.isfinite(mine[key])
                assert np.isfinite(mine[key])[np.isfinite(turned)].all(), (name, key)
                scale = float(np.abs(np.nan_to_num(wanted)).max() + np.abs(np.nan_to_num(F)).max() + 1e-12)
                near(np.where(known, mine[key], 0.0), np.where(known, turned, 0.0), scale, 1e-12)
        near(found["point"], P, 10.0, 1e-12)


def check_bearings(scene: dict[str, Any], results: Results) -> int:
    """Both bearings together exert the joint's force, and its moment across the axis."""
    count = 0
    for name, joint in scene["joints"].items():
        whole, pair = results.joints[name], joint.get("bearings")
        if pair is None:
            continue
        n = attitude(results, body_of(joint["from"])) @ (np.array(joint["axis"]) / np.linalg.norm(joint["axis"]))
        first, second = (whole["bearings"][key] for key in ("0", "1"))
        for part in ("", *whole["shares"]):
            its = whole["shares"][part] if part else whole
            own = [x["shares"][part] if part else x for x in (first, second)]
            loads = [x["radial_force"] + x.get("axial", np.zeros(len(n)))[:, None] * n for x in own]
            arms = [np.asarray(x["point"]) - np.asarray(whole["point"]) for x in (first, second)]
            moment = np.asarray(its["moment"]) - np.sum(its["moment"] * n, axis=1)[:, None] * n
            if np.isnan(np.sum([*loads, its["force"], moment])):
                continue
            scale = float(np.abs(loads).max() + np.abs(moment).max() + 1e-12) * 10.0
            near(loads[0] + loads[1], its["force"], scale, 1e-13)
            near(np.cross(arms[0], loads[0]) + np.cross(arms[1], loads[1]), moment, scale, 1e-13)
            assert np.abs(np.sum(own[0]["radial_force"] * n, axis=1)).max() <= 1e-12 * scale
            count += 1
        assert [arm @ n[k] for arm, k in ((arms[0][0], 0), (arms[1][0], 0))] == pytest.approx(pair["at"], abs=1e-12)
        assert first["radial"] == pytest.approx(np.linalg.norm(first["radial_force"], axis=1), nan_ok=True)
    return count


@pytest.mark.parametrize(("kind", "seed"), CASES)
def test_a_reaction_moves_as_a_wrench(kind: str, seed: int) -> None:
    scene = instrumented(kind, seed)
    reports = frozenset({"joints", "sections", "motion", "shares"})
    results = solved(moving(scene, TIMES, 1e-9), requested_reports=reports)
    check_sensors(scene, results)
    check_bearings(scene, results)


def test_some_of_these_scenes_have_bearings() -> None:
    results = solved({**(scene := instrumented("tree", 1)), "analysis": {"type": "state"}},
                     requested_reports=frozenset({"joints", "motion", "shares"}))  # fmt: skip
    assert check_bearings(scene, results) > 1
