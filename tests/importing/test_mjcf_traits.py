"""Small models of MuJoCo's, each with one trait of the format: drives hold what MuJoCo's inverse dynamics says."""

from __future__ import annotations

from pathlib import Path

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


def model(
    joint: str = "", arm: str = "", part: str = "", compiler: str = "", head: str = "", rest: str = "", key: str = ""
) -> str:
    """Two bars; joint: attributes of the first hinge; arm: of its body; part: in it; head: before the bodies."""
    key = key or '<keyframe><key name="k" qpos="0.4 0.2" qvel="1.5 -2"/></keyframe>'
    return f"""<mujoco><compiler {compiler}/>{head}<option><flag contact="disable"/></option><worldbody>
      <body name="arm" pos="0.1 0.2 0.3" {arm}><joint name="turn" axis="0.2 1 0" {joint}/>{part or BAR}
        <body name="rod" pos="1 0 0"><joint name="way" type="slide" axis="0 .6 .8"/>{BAR}</body></body></worldbody>
      {rest}{key}</mujoco>"""


BAR = '<geom type="box" size=".3 .1 .05" pos=".3 .1 0" contype="0" conaffinity="0"/>'
MESH = """v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"""
TRAITS = {
    "degrees": model('ref="20" springref="-30" stiffness="3"'),
    "radians": model('ref="0.3" springref="-0.5" stiffness="3"', compiler='angle="radian"'),
    "euler": model(arm='euler="30 40 50"'),
    "euler in radians": model(arm='euler="0.3 0.4 0.5"', compiler='angle="radian"'),
    "euler sequence": model(arm='euler="30 40 50"', compiler='eulerseq="zyx"'),
    "fixed euler sequence": model(arm='euler="30 40 50"', compiler='eulerseq="XYZ"'),
    "axisangle": model(arm='axisangle="1 2 3 40"'),
    "xyaxes": model(arm='xyaxes="1 1 0 0 1 1"'),
    "zaxis": model(arm='zaxis="1 2 3"'),
    "quaternion not of length 1": model(arm='quat="2 0 1 0"'),
    "fromto": model(part='<geom type="capsule" size=".1" fromto="0 0 0 1 0.3 0.2"/>'),
    "ellipsoid": model(part='<geom type="ellipsoid" size=".1 .2 .3" euler="10 20 30"/>'),
    "mass": model(part=BAR.replace("/>", ' mass="7"/>')),
    "density": model(part=BAR.replace("/>", ' density="70"/>')),
    "several geoms": model(part=BAR + '<geom size=".1" pos="0 0 1"/>'),
    "inertial beside geoms": model(part='<inertial pos="1 0 0" mass="2" diaginertia=".1 .2 .2"/>' + BAR),
    "inertia from geoms": model(
        part='<inertial pos="1 0 0" mass="2" diaginertia=".1 .2 .2"/>' + BAR, compiler='inertiafromgeom="true"'
    ),
    "full inertia": model(part='<inertial pos="1 0 0" mass="2" fullinertia=".2 .3 .3 .01 .02 .03"/>'),
    "turned inertia": model(part='<inertial pos="1 0 0" euler="1 2 3" mass="2" diaginertia=".1 .2 .2"/>'),
    "balanced inertia": model(
        part='<inertial pos="1 0 0" mass="2" diaginertia=".1 .2 .5"/>', compiler='balanceinertia="true"'
    ),
    "bounds of mass": model(
        part='<inertial pos="1 0 0" mass="2" diaginertia=".1 .2 .2"/>', compiler='boundmass="3" boundinertia="0.3"'
    ),
    "total mass": model(compiler='settotalmass="11"'),
    "groups of geoms": model(part=BAR + '<geom size=".2" group="4"/>', compiler='inertiagrouprange="0 3"'),
    "default": model(head='<default><geom density="300"/><joint damping="2"/></default>'),
    "class": model(
        'class="b"', head='<default><default class="b"><joint damping="5" stiffness="2"/></default></default>'
    ),
    "childclass": model(
        arm='childclass="c"',
        head='<default><default class="c"><geom density="300"/><joint damping="2" axis="1 0 0"/></default></default>',
    ),
    "class in a class": model(
        'class="d"',
        head='<default><joint damping="1"/><default class="c"><joint stiffness="4"/><default class="d">'
        '<joint springref="9"/></default></default></default>',
    ),
    "frame": model(
        part=f'<frame pos="1 0 0" euler="0 30 0"><geom size=".1"/><frame euler="9 0 0">{BAR}</frame></frame>'
    ),
    "frame with a class": model(
        part=f'<frame pos="1 0 0" childclass="c">{BAR}</frame>',
        head='<default><default class="c"><geom density="300"/></default></default>',
    ),
    "replicate": model(part=f'<replicate count="3" offset="0 0 .4" euler="0 20 0">{BAR}</replicate>'),
    "mesh": model(part='<geom type="mesh" mesh="m"/>', head='<asset><mesh name="m" file="m.obj"/></asset>'),
    "scaled mesh": model(
        part='<geom type="mesh" mesh="m" pos=".1 .2 .3" euler="10 20 30"/>',
        head='<asset><mesh name="m" file="m.obj" scale=".1 .2 .3"/></asset>',
    ),
    "mirrored mesh": model(
        part='<geom type="mesh" mesh="m" density="500"/>',
        head='<asset><mesh name="m" file="m.obj" scale=".1 -.2 .3"/></asset>',
    ),
    "mesh in its folder": model(
        part='<geom type="mesh" mesh="m"/>', head='<asset><mesh file="m.obj"/></asset>', compiler='meshdir="parts"'
    ),
    "place of a joint": model('pos="0.3 -0.2 0.1"'),
    "axis not of length 1": model().replace('axis="0.2 1 0"', 'axis="2 10 0"'),
    "gravity": model().replace("<option>", '<option gravity="1 2 3">'),
    "no gravity": model().replace("<flag ", '<flag gravity="disable" '),
    "no springs": model('stiffness="9" damping="2"').replace("<flag ", '<flag spring="disable" '),
    "no dampers": model('stiffness="9" damping="2"').replace("<flag ", '<flag damper="disable" '),
    "gravity compensation": model(arm='gravcomp="0.7"'),
    "motor": model(rest='<actuator><motor joint="turn" gear="5" ctrlrange="-1 1"/></actuator>'),
    "general": model(rest='<actuator><general joint="turn" gainprm="5" damping="2" gear="-3"/></actuator>'),
    "body without mass": model(
        part=f'<body name="in" pos="0 1 0" euler="0 0 30"><body name="deep">{BAR}</body></body>'
    ),
    "user data": model(head='<size nuser_body="2"/><custom><numeric name="n" data="1 2"/></custom>'),
}


@pytest.mark.parametrize("name", TRAITS)
def test_drives_hold_what_mujoco_says(name: str, tmp_path: Path) -> None:
    text = TRAITS[name]
    (tmp_path / "parts").mkdir()
    for folder in (tmp_path, tmp_path / "parts"):
        (folder / "m.obj").write_text(MESH)
    (tmp_path / "m.xml").write_text(text)
    compiled = mujoco.MjModel.from_xml_path(str(tmp_path / "m.xml"))
    data = mujoco.MjData(compiled)
    mujoco.mj_resetDataKeyframe(compiled, data, 0)
    mujoco.mj_inverse(compiled, data)
    machine = described(text, str(tmp_path / "m.xml"), keyframe="k")
    assert not machine.left_out
    spec = load("m.yaml", format_spec(machine, "m.yaml") + "\nanalysis: {type: state}\n")
    results = solve(spec, Options(requested_reports=frozenset({"joints"}))).results
    found = [results.joints[joint]["drive"][0] for joint in ("turn", "way")]
    near(found, data.qfrc_inverse, float(np.abs(data.qfrc_inverse).max()), 1e-12)
