"""Where bodies of MuJoCo's start that an equality places: on the keyframe's side, in any pose of the joints."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve
from tests.shared.imported import imported
from tests.shared.scenes import near

mujoco = pytest.importorskip("mujoco", reason="needs the package mujoco: pip install -e '.[test]'")
pytestmark = pytest.mark.heavy

HEAD = '<mujoco><compiler angle="radian"/><option><flag contact="disable"/></option><worldbody>'
SLIDER = f"""{HEAD}<site name="w" pos="0 .3 0"/><body name="s" pos=".4 0 0">
<joint type="slide" axis="1 0 0"/><geom size=".1"/><site name="p"/></body></worldbody>
<tendon><spatial name="T"><site site="w"/><site site="p"/></spatial></tendon><equality><tendon tendon1="T"/></equality>
<keyframe><key name="left" qpos="-.8"/></keyframe></mujoco>"""
CUP = f"""{HEAD}<body name="arm" pos="0 0 1"><joint name="j" axis="0 1 0"/><geom size=".1" pos=".3 0 0"/></body>
<body name="cup" pos=".6 0 1"><freejoint/><geom size=".05" pos=".1 0 0"/></body></worldbody>
<equality><weld body1="arm" body2="cup"/></equality>
<keyframe><key name="typed" qpos=".5 .52655 0 .71234 .96891 0 .2474 0" qvel="1 0 0 0 0 0 0"/></keyframe></mujoco>"""


BELT = f"""{HEAD}
<body name="a"><joint name="j" axis="0 0 1" ref=".3"/><geom size=".1" pos=".3 0 0"/></body>
<body name="b" pos="1 0 0"><joint name="k" axis="0 0 1" ref="-.1"/><geom size=".1" pos=".3 0 0"/></body></worldbody>
<tendon><fixed name="belt"><joint joint="j" coef="1"/><joint joint="k" coef="-2"/></fixed></tendon>
<equality><tendon tendon1="belt"/></equality><keyframe><key name="typed" qpos=".5 .7"/></keyframe></mujoco>"""


def solved(text: str, keyframe: str | None = None, free: bool = False, **overrides: str):
    text = imported(text, keyframe=keyframe, free=free) + "\nanalysis: {type: state}\n" * free
    spec = load("m.yaml", text, overrides=overrides)
    return solve(spec, Options(requested_reports=frozenset({"motion", "joints"}))).results


def test_what_slides_in_a_loop_starts_on_the_side_of_the_keyframe():
    near(solved(SLIDER).bodies["s"]["center"][0], [0.4, 0, 0], 1.0, 1e-12)
    near(solved(SLIDER, "left").bodies["s"]["center"][0], [-0.4, 0, 0], 1.0, 1e-12)


def test_what_floats_goes_with_what_an_equality_welds_it_to():
    for results, angle in ((solved(CUP), 0.0), (solved(CUP, j="30 deg"), np.pi / 6), (solved(CUP, "typed"), 0.5)):
        near(results.bodies["cup"]["center"][0], [0.7 * np.cos(angle), 0, 1 - 0.7 * np.sin(angle)], 1.0, 1e-12)
    assert "its start velocities follow from its constraints" in imported(
        CUP.replace('1 0 0 0 0 0 0"/>', '1 0 0 0 0 1 0"/>'), keyframe="typed"
    )
    assert "near" not in imported(CUP.replace('<weld body1="arm" body2="cup"/>', ""))


@pytest.mark.parametrize("free", [False, True])
@pytest.mark.parametrize(("keyframe", "overrides"), [("typed", {}), (None, {"j": "0.9"})])
def test_a_fixed_tendon_of_length_zero_holds_whatever_the_start(
    free: bool, keyframe: str | None, overrides: dict[str, str]
) -> None:
    """A keyframe that violates the equality, or another angle of the leader, moves the follower as in MuJoCo."""
    results = solved(BELT, keyframe, free, **overrides)
    model = mujoco.MjModel.from_xml_string(BELT)
    data = mujoco.MjData(model)
    data.qpos[:] = [results.coordinates[name]["angle"][0] for name in "jk"] + model.qpos0
    assert abs(data.qpos[0] - model.qpos0[0]) > 0.1
    mujoco.mj_forward(model, data)
    assert data.ne == 1
    near(data.efc_pos[:1], [0.0], 1.0, 1e-12)
