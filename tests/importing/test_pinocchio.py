"""Robots as imported, moved anyhow: their loads are those of Pinocchio, which reads the same file.

Pinocchio: inverse dynamics by rnea, forward by aba; no line of it is shared with heun.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heuncli.results.results import Results
from heuncli.scene.file_format.load import load
from heuncli.study.workflow import solve
from tests.shared.imported_robots import ImportedRobot, imported_robot
from tests.shared.pinocchio_answers import Answer, Asked, Robot, holding_with_mimics
from tests.shared.scenes import near, solved
from tests.shared.urdf_texts import MOVING, SHAPES, Wishes, drawn_robot

pytestmark = pytest.mark.heavy
pytest.importorskip("pinocchio", reason="pinocchio (pip install pin) is not installed")

ROBOTS = Path(__file__).parent / "robots"
DIGITS = 1e-11  # of the largest of each kind
LEAST = 1e-3  # of the weight [N], and of it times 1 m: where all of it falls, joints carry roundings
ZERO = frozenset({"zero"})  # frames at feet and grippers with a mass, of which the file has no moment


def agree(robot: ImportedRobot, found: Results, wanted: Answer, asked: Asked) -> None:
    """Where the bodies are; efforts, accelerations and reactions of all joints; mass, momentum, energies."""
    reach = 1.0 + max(float(np.abs(link.position).max()) for link in wanted.links.values())
    speed = 1.0 + max(float(np.abs(link.velocity).max()) for link in wanted.links.values())
    for old, name in robot.bodies.items():
        body, link = found.bodies[name], wanted.links[old]
        near(body["position"][0], link.position, reach, DIGITS)
        near(body["rotation"][0], link.rotation, 1.0, DIGITS)
        near(body["velocity"][0], link.velocity, speed, DIGITS)
    agree_in_joints(robot, found, wanted, asked)
    masses = {body.name: body.mass or 0.0 for body in robot.machine.bodies}
    near(sum(masses.values()), wanted.mass, wanted.mass, DIGITS)
    moments = sum((mass * found.bodies[name]["center"][0] for name, mass in masses.items()), np.zeros(3))
    near(moments / wanted.mass, wanted.center, reach, DIGITS)
    momentum = wanted.mass * speed
    near(found.momentum["total"][0], wanted.momentum, momentum, DIGITS)
    turned = found.momentum["moment_orbital"][0] + found.momentum["moment_spin"][0]
    near(turned, wanted.moment_of_momentum, momentum * reach, DIGITS)
    near(found.energy["kinetic"][0], wanted.kinetic, wanted.kinetic, DIGITS)
    near(found.energy["potential"][0], wanted.potential, 9.81 * wanted.mass * reach, DIGITS)


def agree_in_joints(robot: ImportedRobot, found: Results, wanted: Answer, asked: Asked) -> None:
    """Of every joint of one freedom effort, acceleration, force and moment, the effort counted in."""
    joints = wanted.joints
    least = LEAST * 9.81 * wanted.mass
    force = max(least, max(float(np.abs(one.force).max()) for one in joints.values()))
    moment = max(least, max(float(np.abs(one.moment).max()) for one in joints.values()))
    rate = max(1.0, max(abs(one.acceleration) for one in joints.values()))
    largest = max(least, max(abs(one.effort) for one in joints.values())) if asked.a else max(force, moment)
    for old, one in joints.items():
        name = robot.joints[old]
        joint = found.joints[name]
        drive = float(joint["drive"][0]) if asked.a else 0.0
        effort = drive - robot.damping(old) * asked.v[old]
        near(effort, one.effort, largest, DIGITS)
        near(found.coordinates[name]["acceleration"][0], one.acceleration, rate, DIGITS)
        total = joint["force"][0] + (effort * one.axis if one.slides else 0.0)
        turning = joint["moment"][0] + (0.0 if one.slides else effort * one.axis)
        near(total, one.force, force, DIGITS)
        near(turning + np.cross(joint["point"][0] - one.origin, total), one.moment, moment, DIGITS)


def agree_in_planes(robot: ImportedRobot, found: Results, wanted: Answer) -> None:
    """What is planar is held by three points in a plane: together they carry what Pinocchio's joint does."""
    for one in wanted.bases.values():
        planes = [found.joints[name] for name, joint in robot.spec["joints"].items() if joint["type"] == "plane"]
        force = sum((joint["force"][0] for joint in planes), np.zeros(3))
        arms = [np.cross(joint["point"][0] - one.origin, joint["force"][0]) for joint in planes]
        near(force, one.force, float(np.abs(one.force).max()) + 1.0, DIGITS)
        near(sum(arms, np.zeros(3)), one.moment, float(np.abs(one.moment).max()) + 1.0, DIGITS)


def same(text: str, seed: int, *, driven: bool = True, **options: Any) -> None:
    """A drawn state of a robot is the same to both."""
    robot, other = imported_robot(text, **options), Robot(text, base_free=options.get("base_free", False))
    asked = other.drawn(seed)
    if not driven:
        resisted = {name: -robot.damping(name) * rate for name, rate in asked.v.items()}
        asked = Asked(asked.q, asked.v, {}, asked.bases, resisted)
    wanted = other.answer(asked)
    found = solved(robot.moved(asked, wanted.links))
    agree(robot, found, wanted, asked)
    agree_in_planes(robot, found, wanted)


PUBLIC = ("human", "panda", "so101", "qbmove_2dof", "double_pendulum", "quadruped", "simple_humanoid")


@pytest.mark.parametrize("name", PUBLIC)
def test_a_public_robot_needs_the_efforts_of_pinocchio(name: str) -> None:
    text = (ROBOTS / f"{name}.urdf").read_text()
    for seed in range(3):
        same(text, seed, repair=ZERO)


@pytest.mark.parametrize("name", ["quadruped", "simple_humanoid"])
def test_a_robot_on_no_ground_falls_as_pinocchio_says(name: str) -> None:
    text = (ROBOTS / f"{name}.urdf").read_text()
    for seed in range(3):
        same(text, seed, repair=ZERO, base_free=True)


@pytest.mark.parametrize("name", ["double_pendulum", "quadruped", "so101"])
def test_a_public_robot_that_is_let_go_accelerates_as_pinocchio_says(name: str) -> None:
    text = (ROBOTS / f"{name}.urdf").read_text()
    for seed in range(2):
        same(text, seed, repair=ZERO, free=True, driven=False)
        same(text, seed, repair=ZERO, free=True, base_free=True, driven=False)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.third
def test_drawn_trees_need_the_efforts_of_pinocchio(shape: str) -> None:
    for seed in range(12):
        text = drawn_robot(seed, Wishes(links=4 + seed * 2, shape=shape)).text
        same(text, seed)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.third
def test_joints_that_are_let_go_accelerate_as_pinocchio_says(shape: str) -> None:
    """All of them free: forward dynamics, by aba there."""
    for seed in range(100, 110):
        text = drawn_robot(seed, Wishes(links=12, shape=shape, mimics=0.0, bare_root=0.0)).text
        same(text, seed, free=True, driven=False)
        same(text, seed, free=True, base_free=True, driven=False)


@pytest.mark.parametrize("first", ["floating", "planar"])
def test_what_floats_or_shifts_in_a_plane_goes_on_as_pinocchio_says(first: str) -> None:
    """Its joints driven, its base pushed by nothing."""
    for seed in range(200, 210):
        text = drawn_robot(seed, Wishes(links=10, first=first, bare_root=seed % 2)).text
        same(text, seed)


def test_what_is_followed_takes_what_its_followers_take() -> None:
    """In Pinocchio one coordinate moves a joint and those that mimic it: its effort is theirs by their factors."""
    wishes = Wishes(links=12, mimics=0.5, kinds={"revolute": 2.0, "prismatic": 1.0, "fixed": 1.0})
    followed = 0
    for seed in range(30):
        drawn = drawn_robot(seed, wishes)
        leaders = [joint.name for joint in drawn.moving]
        efforts = holding_with_mimics(drawn.text, seed, leaders)
        if efforts is None:  # of a tree whose order Pinocchio does not take
            continue
        robot = imported_robot(drawn.text)
        values = {robot.joints[name]: repr(position) for name, (position, _) in efforts.items()}
        found = solve(load("robot.yaml", robot.text, overrides=values)).results.joints
        drives = {
            joint.name: found[robot.joints[joint.name]]["drive"][0] for joint in drawn.joints if joint.kind in MOVING
        }
        largest = max(abs(effort) for _, effort in efforts.values())
        for name, (_, effort) in efforts.items():
            follow = [
                (joint.mimic[1], drives[joint.name]) for joint in drawn.joints if joint.mimic and joint.mimic[0] == name
            ]
            near(drives[name] + sum(factor * drive for factor, drive in follow), effort, largest + 1.0, DIGITS)
            followed += len(follow)
    assert followed > 10
