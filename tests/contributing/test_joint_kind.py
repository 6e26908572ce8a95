"""A kind of joint that holds and turns in known ways is a row and a class of its keys."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from tests.contributing.addition import Addition, Edit, after, answers, heun

SLED = Addition(  # face on face: it slides on a plane and turns about the normal
    "A kind of joint",
    {
        "heuncli/base/joint_kinds.py": (
            after("""            synonyms=("cylindrical",),
        ),
""", """        JointKind(
            "sled", PLANE, ABOUT_AXIS, "forward", axis_key="normal", motions=("sliding",), weaker_kinds=("plane",),
            synonyms=("face",),
        ),
"""),
        ),
        "heuncli/scene/file_format/format_joints.py": (
            Edit("JointEntry = (\n", """class SledJoint(AnyJoint):
    type: Literal["sled"]
    normal: Direction


JointEntry = (
    SledJoint |
"""),
            after("JOINTS: dict[str, type[JointEntry]] = {\n", """    "sled": SledJoint,
"""),
        ),
    },
)  # fmt: skip
SLOPE = 0.3
ARM = 0.1  # of the centre beyond the point that slides, down the slope
SCENE = f"""\
heun: 1
gravity: [0, 0, -10]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  crate:
    mass: 2
    center: [{ARM * math.cos(SLOPE)}, 0, {-ARM * math.sin(SLOPE)}]
    inertia: [1, 1, 1]
    points: {{foot: [0, 0, 0]}}
joints: {{floor: {{type: TYPE, from: ground.O, to: crate.foot, normal: [{math.sin(SLOPE)}, 0, {math.cos(SLOPE)}]}}}}
analysis: {{times: [0, 1]}}
"""


def test_a_joint_kind(tmp_path: Path) -> None:
    """A crate slides down a slope: its way, the pressure, the moment that keeps it from tilting; and its words."""
    folder = SLED.made_in(tmp_path)
    scene = SCENE.replace("TYPE", "sled")
    wanted = {
        "final bodies.crate.position.x": 5.0 * math.sin(SLOPE) * math.cos(SLOPE),
        "final bodies.crate.position.z": -5.0 * math.sin(SLOPE) ** 2,
        "first joints.floor.axial": 20.0 * math.cos(SLOPE),
        "first joints.floor.radial": 0.0,
        "first joints.floor.tilting": 20.0 * math.cos(SLOPE) * ARM,
        "final bodies.crate.angular_velocity.y": 0.0,
    }
    assert answers(folder, scene, list(wanted)) == pytest.approx(list(wanted.values()), abs=1e-9)
    assert "for 'face' write type: sled" in heun(folder, "validate", "-", text=SCENE.replace("TYPE", "face")).stderr


def test_its_list() -> None:
    assert SLED.is_as_listed()
