"""What `heun model` advises, done: the joints it names replaced as it says, and the scene solved again."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from heuncli.results.results import Results
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.source import parse_source
from heuncli.study.model.options import Options
from heuncli.study.workflow import describe, solve
from tests.oracle.published import four_bar, windows
from tests.oracle.read import state_at
from tests.oracle.transforms import turned
from tests.oracle.turns import random_rotation
from tests.oracle.values import to_yaml
from tests.shared.doubles import redundant_scene
from tests.shared.folders import SPECS
from tests.shared.redundant_supports import door
from tests.shared.scenes import near

KEPT = (2003, 2005, 2021, 2041, 2048, 2056, 2065, 2086, 2096)  # of the random scenes: some that have an advice
REPLACED = re.compile(r"(\w+) of type (\w+)(?: \((to_axis|axis) (\[[^]]*\])\))?")


def advice(text: str) -> str:
    """The last note of the model."""
    return describe(load("scene.yaml", text))["notes"][-1]


def done(text: str, note: str) -> Results:
    """With every replacement that a note names; what the new kind does not know is left out."""
    scene = parse_source("scene.yaml", text, "").data
    replaced = REPLACED.findall(note)
    giving_way = re.findall(r"stiffness: \{moment: 0\} on (\w+)", note)
    assert replaced or giving_way
    for name in giving_way:
        scene["joints"][name]["stiffness"] = {"moment": 0}
    for name, kind, key, direction in replaced:
        joint = scene["joints"][name]
        joint["type"] = kind
        for old in {"axis", "to_axis"} & joint.keys():
            if kind == "ball" or (kind == "line" and old == "to_axis"):
                del joint[old]
        if key:
            joint[key] = json.loads(direction)
    return at_start(json.dumps(scene))


def at_start(text: str) -> Results:
    return solve(load("scene.yaml", text), Options()).results


def left_of(results: Results) -> int:
    """How many conditions hold what others hold, and do not give way."""
    return int(results.model["redundant"]) - int(results.model.get("given_way", 0))


def start_of(name: str) -> str:
    """A spec without what is asked of it."""
    return re.split("\n(?:analysis|report|expect):", (SPECS / f"{name}.yaml").read_text())[0] + "\n"


def tried(text: str) -> str:
    """Assert that the advice keeps its word; gives it back."""
    before, note = at_start(text), advice(text)
    found = done(text, note)
    assert found.model["freedoms"] == before.model["freedoms"]
    if note.startswith("statically determinate"):
        assert left_of(found) == 0
        assert all(block["open"] == [] for block in found.joints.values())
    else:
        left, of = map(int, re.search(r", (\d+) of (\d+) redundant constraints remain", note).groups())  # type: ignore[union-attr]
        assert (left, of) == (left_of(found), before.model["redundant"])
        assert left < of
    F = max(float(np.nanmax(np.abs(b["force"]), initial=1.0)) for r in (before, found) for b in r.joints.values())
    for name, body in before.bodies.items():
        for key in ("center", "center_velocity", "center_acceleration", "angular_velocity", "angular_acceleration"):
            near(found.bodies[name][key], body[key], max(1.0, float(np.abs(body[key]).max())))
    for name, block in before.joints.items():
        for part in ("force", "moment"):
            certain = ~np.isnan(block[part][0]) & ~np.isnan(found.joints[name][part][0])
            near(found.joints[name][part][0][certain], block[part][0][certain], F)
    return note


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("door", "top of type line (axis [0, 0, 1])"),
        ("slider_crank_pins", "big of type line"),
        ("flat_four_bar", "C of type line"),
        ("bricard", "P1 of type universal (to_axis [1, 0, 0])"),
    ],
)
def test_of_the_specs(name: str, said: str) -> None:
    note = tried(start_of(name))
    assert note == f"statically determinate with {said}: same motion, no open reactions"


@pytest.mark.parametrize("name", ["crankshaft", "table"])
def test_nothing_looser_for_one_body_on_many_supports(name: str) -> None:
    note = advice(start_of(name))
    assert note.startswith("joint types with fewer constraints do not help") and "stiffness" in note


def test_no_advice_where_nothing_is_held_twice() -> None:
    for name in ("slider_crank", "engine", "double"):
        notes = describe(load(SPECS / f"{name}.yaml"))["notes"]
        assert not any("determinate with" in note or "fewer constraints" in note for note in notes)


@pytest.mark.parametrize("seed", range(4))
def test_a_ball_gives_way_along_the_line_that_is_open(seed: int) -> None:
    """However the door is hung: its line is found, and told to all digits."""
    scene = door()
    full = state_at(at_start(to_yaml(scene)).bodies, 0)["body"]
    scene["bodies"]["body"] |= {"orientation": {"matrix": full.rotation.tolist()}}
    scene["ground"] = {"points": {}}
    Q = random_rotation(np.random.default_rng(seed))
    note = tried(to_yaml(turned(scene, Q)))
    axis = np.array([float(x) for x in REPLACED.findall(note)[0][3].strip("[]").split(",")])
    near(np.abs(axis / np.linalg.norm(axis) @ Q[:, 2]), 1.0, 1.0, 1e-12)


@pytest.mark.parametrize("windows_", [2, 4])
def test_step_by_step(windows_: int) -> None:
    """More loops than are tried together."""
    note = tried(to_yaml(windows(windows_, 0.3, 1.0)))
    assert note.startswith("statically determinate") and note.count(" of type ") == windows_


@pytest.mark.parametrize("seed", KEPT)
@pytest.mark.third
def test_of_random_scenes(seed: int) -> None:
    """Every kind and place; what is only partly told is partly so."""
    tried(to_yaml(redundant_scene(seed)[1]))


def test_in_the_plane() -> None:
    """A beam on two pins: one of them gives way along the beam."""
    beam = {"mass": 2.0, "center": [1, 0, 0], "inertia": [0.1, 0.7, 0.7], "points": {"a": [0, 0, 0], "b": [2, 1, 0]}}
    pin = {"type": "pin", "axis": [0, 0, 1]}
    ends = {name: {"from": {"body": "ground", "at": at}, "to": f"beam.{name}"} for name, at in beam["points"].items()}
    joints = {name: {**pin, **end} for name, end in ends.items()}
    scene = {"space": "planar", "gravity": [0, -9.81, 0], "bodies": {"beam": beam}, "joints": joints}
    assert tried(to_yaml(scene)) == (
        "statically determinate with a of type line (axis [1, 0.5, 0]): same motion, no open reactions"
    )


def with_(joint: Mapping[str, Any], **more: Any) -> dict[str, Any]:
    scene = four_bar(1.0, 0.3, 1.4, (1, 2, 1.2, 2), (0, 0, 0))
    for body in scene["bodies"].values():
        for key in ("velocity", "angular_velocity"):
            del body[key]
    for name in ("coupler", "rocker"):
        for key in ("position", "orientation"):
            body = scene["bodies"][name]
            body["near"] = {**body.get("near", {}), key: body.pop(key)}
    for name, entry in joint.items():
        scene["joints"][name] |= entry
    return {**scene, **more}


@pytest.mark.parametrize(
    ("joint", "more"),
    [
        ({"B": {"initial": {"rate": 0.5}}}, {}),
        ({}, {"forces": {"worn": {"type": "damper", "joint": "B", "coefficient": 0.1}}}),
        ({}, {"forces": {"push": {"type": "force", "on": "crank.end", "vector": ["B.angle", 0, 0]}}}),
        ({}, {"stops": {"buffer": {"joint": "B", "angle": [None, 7], "restitution": 0.5}}}),
        ({}, {"analysis": {"duration": 1, "events": {"far": "B.angle > 1"}}}),
        ({}, {"analysis": {"duration": 1, "until": "B.rate > 9"}}),
    ],
)
def test_a_joint_in_use_keeps_its_kind(joint: dict[str, Any], more: dict[str, Any]) -> None:
    """B would be advised, but for the start value, damper, stop, force or condition that needs it as a pin."""
    assert tried(to_yaml(with_({}))).startswith("statically determinate with B")
    assert tried(to_yaml(with_(joint, **more))).startswith("statically determinate with C")
