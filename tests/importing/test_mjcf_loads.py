"""Loads of small models with something of their own: what drives hold is what MuJoCo's inverse dynamics says."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.scene.file_format.load import load
from heuncli.scene.importers.spec_text import format_spec
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve
from tests.shared.imported import described
from tests.shared.scenes import near

mujoco = pytest.importorskip("mujoco", reason="needs the package mujoco: pip install -e '.[test]'")
pytestmark = pytest.mark.heavy


def arm(joint: str = "", body: str = "", more: str = "", rest: str = "", flags: str = "") -> str:
    """A bar on a hinge, turning at 1 rad/s, and one on a slide at its end, at 2 m/s."""
    return f"""<mujoco><compiler angle="radian"/><option><flag contact="disable" {flags}/></option><worldbody>
      <site name="wall" pos="0 1 0"/><site name="wall2" pos="0 2 0"/>
      <body name="arm" {body}><joint name="turn" axis="0 1 0" {joint}/><geom size=".1" pos=".4 .1 0"/>
        <site name="tip" pos="1 0 0"/><site name="mid" pos=".5 0 0"/>
        <body name="rod" pos="1 0 0"><joint name="way" type="slide" axis="0 .6 .8" {joint}/>
          <geom size=".1" pos="0 .3 .2"/><site name="end"/></body></body>{more}</worldbody>
      {rest}<keyframe><key name="k" qpos="0.3 0.2" qvel="1 2"/></keyframe></mujoco>"""


MODELS = {
    "negative": arm('stiffness="-3" springref="0.1" damping="-2"'),
    "whole": arm('stiffness="5" springref="2" damping="3"'),
    "weight taken off": arm(body='gravcomp="1"', flags='spring="disable"'),
    "not without springs and dampers": arm(body='gravcomp="1"', flags='spring="disable" damper="disable"'),
    "weight taken off by motors": arm('actuatorgravcomp="true"', 'gravcomp="1"'),
    "tendons within a body": arm(
        rest="""<tendon><spatial stiffness="3"><site site="wall"/><site site="wall2"/></spatial>
        <spatial stiffness="3" damping="1"><site site="tip"/><site site="mid"/></spatial>
        <spatial name="t" stiffness="7" damping="1" springlength="0.4"><site site="wall"/><site site="end"/></spatial>
        </tendon>"""
    ),
    "damping of motors": arm(
        'damping="0.5"',
        rest='<actuator><motor joint="turn" damping="3" gear="2"/></actuator>',
        flags='spring="disable"',
    ),
    "fixed tendon": arm(
        'ref="0.1"',
        rest="""<tendon><fixed name="f" stiffness="3" damping="2"><joint joint="turn" coef="2"/>
        <joint joint="way" coef="-0.7"/></fixed></tendon>""",
    ),
    "slack ranges": arm(
        rest="""<tendon><fixed stiffness="3" springlength="-1 0.1"><joint joint="turn" coef="2"/></fixed>
        <fixed stiffness="3" springlength="1 2"><joint joint="way" coef="-.5"/></fixed>
        <fixed stiffness="-30" springlength="0 9"><joint joint="way" coef="1"/></fixed>
        <spatial stiffness="7" springlength="0 0.4"><site site="wall"/><site site="end"/></spatial>
        <spatial stiffness="7" springlength="4 5"><site site="wall2"/><site site="end"/></spatial>
        <spatial stiffness="-7" damping="-2" springlength="4"><site site="wall2"/><site site="end"/></spatial></tendon>
        <actuator><motor tendon="g" damping="2" gear="3"/></actuator>""".replace("<fixed st", '<fixed name="g" st', 1),
    ),
}


@pytest.mark.parametrize("name", MODELS)
def test_drives_hold_what_mujoco_says(name):
    model = mujoco.MjModel.from_xml_string(MODELS[name])
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_inverse(model, data)
    machine = described(MODELS[name], keyframe="k")
    assert not machine.left_out
    results = solve(
        load("m.yaml", format_spec(machine, "m.yaml")), Options(requested_reports=frozenset({"joints"}))
    ).results
    found = [results.joints[joint]["drive"][0] for joint in ("turn", "way")]
    near(found, data.qfrc_inverse, float(np.abs(data.qfrc_inverse).max()), 1e-13)


def test_a_weight_that_some_motors_take_off_is_told():
    shared = MODELS["weight taken off by motors"].replace('actuatorgravcomp="true"', "", 1)
    told = shared.replace('gravcomp="1"', "").replace('<body name="rod"', '<body name="rod" gravcomp="1"')
    (problem,) = described(told).left_out
    assert "actuatorgravcomp" in problem.message and "body rod" in problem.message
    (force,) = described(told, free=True).forces
    assert force.keys["type"] == "force" and not described(told, free=True).left_out
    (own,) = described(shared).forces  # of the arm, which is carried by the joint that has it not
    assert own.name == "gravcomp_arm" and not described(shared).left_out


def test_joints_that_follow_each_other_do_not_fall():
    """Of a circle one leads; what follows a joint that a loop places is held by itself."""
    circle = arm(
        rest="""<equality><joint joint1="turn" joint2="way" polycoef="0 2 0 0 0"/>
        <joint joint1="way" joint2="turn" polycoef="0 0.5 0 0 0"/></equality>"""
    )
    machine = described(circle)
    assert [problem.message.split(": ")[-1] for problem in machine.left_out] == [
        "turn follows a joint that nothing else drives"
    ]
    assert [one.keys["joint"] for one in machine.drives] == ["turn", "way"]
    assert machine.drives[1].keys["travel"] == "0.5*turn"
    placed = '<body name="lid" pos="1 0 0"><joint name="lid" axis="0 1 0"/><geom size=".1"/></body>'
    rest = '<equality><weld body1="arm"/><joint joint1="lid" joint2="turn"/></equality>'
    machine = described(arm(more=placed, rest=rest).replace('qpos="0.3 0.2" qvel="1 2"', ""))
    assert len(machine.left_out) == 1 and [one.keys["joint"] for one in machine.drives] == ["way", "lid"]
