"""What becomes of a model of MuJoCo's: joints, loads, remarks; what is left out is told, what is wrong is refused."""

from __future__ import annotations

import builtins
import os
import re
import sys

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.scene.file_format.load import load
from heuncli.study.workflow import solve
from tests.shared.imported import described, imported
from tests.shared.scenes import near

mujoco = pytest.importorskip("mujoco", reason="needs the package mujoco: pip install -e '.[test]'")
pytestmark = pytest.mark.heavy

LEG = """<mujoco model="leg">
<compiler angle="degree"/>
<option gravity="0 0 -9.81"/>
<default><geom contype="0" conaffinity="0"/></default>
<worldbody>
 <body name="post"><geom size=".1" mass="3"/><site name="mark" pos="0 0 .2"/></body>
 <body name="thigh" pos="0 0 1">
  <joint name="hip-x" axis="1 0 0" range="-25 5" limited="true" stiffness="2" springref="10" damping="0.5"/>
  <joint name="hip_y" axis="0 1 0" ref="10"/>
  <inertial pos="0 0 -.2" mass="3" diaginertia=".02 .02 .01"/>
  <body name="shin" pos="0 0 -.4">
   <joint axis="0 1 0"/>
   <inertial pos="0 0 -.2" mass="2" diaginertia=".02 .02 .01"/>
   <body name="foot" pos="0 0 -.4"><inertial pos=".1 0 0" mass="1" diaginertia=".001 .002 .002"/>
    <body name="toe" pos=".2 0 0"><site pos="0 0 .01"/></body></body>
  </body>
 </body>
</worldbody>
<actuator><motor name="knee" joint="shin" gear="3"/></actuator>
<keyframe><key name="bent" qpos="0.05 0.5 -1"/><key qpos="0 0 0"/></keyframe>
</mujoco>""".replace('<joint axis="0 1 0"/>', '<joint name="shin" axis="0 1 0"/>')


def scene(bodies: str = "", rest: str = "", option: str = "") -> str:
    body = '<body name="arm"><joint name="elbow"/><geom name="bar" size=".1" pos="1 0 0"/><site name="tip"/></body>'
    still = '<default><geom contype="0" conaffinity="0"/></default>'
    return f"<mujoco>\n{still}\n<option {option}/>\n<worldbody>{body}\n{bodies}</worldbody>\n{rest}</mujoco>"


def test_the_spec_of_a_leg():
    text = imported(LEG)
    spec = load("leg.yaml", text)
    assert not spec.warnings
    assert spec.title == "leg" and spec.gravity == (0.0, 0.0, -9.81)
    assert list(spec.bodies) == ["hip_x_carrier", "thigh", "shin", "foot"]
    assert {name: joint.kind for name, joint in spec.joints.items()} == {
        "hip_x": "pin", "hip_y": "pin", "shin": "pin", "foot_weld": "weld"
    }  # fmt: skip
    assert spec.bodies["foot"].points["toe"] == (0.2, 0.0, 0.0)
    assert spec.ground.points["mark"] == (0.0, 0.0, 0.2)
    assert '  hip_x: 0 deg # joint "hip-x"; limits' in text
    assert "  hip_y: 10 deg" in text
    assert "motor" not in text and "# actuator 'knee', gear 3" in text
    assert "spring_hip_x: {type: turn_spring, joint: hip_x, stiffness: 2, angle: 0.17453292519943295}" in text
    assert "damping_hip_x: {type: damper, joint: hip_x, coefficient: 0.5}" in text
    assert "their 3 kg are not in the load on the foundation" in text


def test_the_start_is_the_models_zero_or_a_keyframe():
    """The knee's torque in the pose that MuJoCo calls bent."""
    study = solve(load("leg.yaml", imported(LEG, keyframe="bent")))
    model = mujoco.MjModel.from_xml_string(LEG)
    data = mujoco.MjData(model)
    data.qpos[:] = model.key_qpos[0]
    mujoco.mj_inverse(model, data)
    near(
        [study.results.joints[name]["drive"][0] for name in ("hip_x", "hip_y", "shin")], data.qfrc_inverse, 30.0, 1e-13
    )
    assert imported(LEG, keyframe="1") != imported(LEG, keyframe="bent")
    with pytest.raises(SpecError, match="there is no keyframe 'bend'") as refused:
        imported(LEG, keyframe="bend")
    assert "bent" in refused.value.problems[0].hint


def test_limits_are_stops_of_free_joints():
    spec = load("leg.yaml", imported(LEG, free=True, limits=True))
    stop = spec.stops["limits_hip_x"]
    near((stop.low, stop.high), np.radians([-25, 5]), 1.0, 1e-15)
    assert not spec.drives and spec.joints["hip_x"].angle == 0.0
    beyond = LEG.replace("-25 5", "10 25").replace(' ref="10"', ' ref="10" range="-90 5" limited="true"')
    spec = load("leg.yaml", imported(beyond, free=True, limits=True))
    near((spec.joints["hip_x"].angle, spec.joints["hip_y"].angle), np.radians([10, -5]), 1.0, 1e-15)


LEFT = {  # what is left out, and what the warning says of it
    "armature": (scene('<body><joint name="a" armature=".1"/><geom size=".1"/></body>'), "armature.*joint a"),
    "friction": (scene('<body><joint name="f" frictionloss=".1"/><geom size=".1"/></body>'), "frictionloss.*joint f"),
    "ball spring": (scene('<body><joint name="b" type="ball" stiffness="1"/><geom size=".1"/></body>'), "springs.*b"),
    "free damping": (
        scene('<body><joint name="r" type="free" damping="1"/><geom size=".1"/></body>'), "damping of free.*joint r",
    ),
    "servo": (scene(rest='<actuator><position name="p" joint="elbow"/></actuator>'), "actuators with.*actuator p"),
    "muscle": (scene(rest='<actuator><muscle name="m" joint="elbow" lengthrange="0 1"/></actuator>'), "actuators"),
    "fluid": (scene(option='density="1.2"'), "fluid forces"),
    "contact": (
        scene('<body><joint/><geom size=".1" contype="1"/><geom size=".1"/></body><geom size="1" conaffinity="1"/>'),
        "contacts are left out: 2 of 4 geoms",
    ),
    "pair": (
        scene('<body><joint/><geom name="x" size=".1"/></body>', '<contact><pair geom1="x" geom2="bar"/></contact>'),
        "contacts are left out: 2 of 2",
    ),
    "mocap": (scene('<body name="hand" mocap="true"/>'), "mocap.*body hand"),
    "bent tendon": (
        scene('<site name="w" pos="0 1 0"/><site name="v" pos="0 2 0"/>', '<tendon><spatial name="t" stiffness="3">'
              '<site site="tip"/><site site="w"/><site site="v"/></spatial></tendon>'),
        "tendons are left out unless they are fixed, or run straight.*tendon t",
    ),
    "yielding tendon": (
        scene(rest='<tendon><fixed name="t" stiffness="3 2"><joint joint="elbow" coef="1"/></fixed></tendon>'),
        "nonlinear parts.*springs and dampers are in the spec: tendon t",
    ),
    "rotor": (
        scene(rest='<actuator><motor name="m" joint="elbow" armature="1"/></actuator>'), "rotor inertia of actuators.*m"
    ),
    "curved damping": (
        scene(rest='<actuator><motor name="m" joint="elbow" damping="1 2"/></actuator>'), "damping of actuators.*m"
    ),
    "curved coupling": (
        scene('<body><joint name="b"/><geom size=".1"/></body>', '<tendon><fixed name="f"><joint joint="elbow" coef="1"'
              '/></fixed><fixed name="g"><joint joint="b" coef="1"/></fixed></tendon>'
              '<equality><tendon name="q" tendon1="f" tendon2="g" polycoef="0 1 2 0 0"/></equality>'),
        "equality 'q': a spec can couple fixed tendons only, and in a fixed ratio",
    ),
    "limited tendon": (
        scene('<site name="w" pos="0 1 0"/>', '<tendon><spatial name="t" stiffness="3" range="0 2"><site site="tip"/>'
              '<site site="w"/></spatial></tendon>'),
        "limits, friction and armature of tendons.*springs and dampers are in the spec: tendon t",
    ),
    "soft": (
        scene(rest='<equality><joint name="s" joint1="elbow" solref="0.5 1"/></equality>'), "softness.*equality s",
    ),
    "twice": (
        scene(rest='<equality><joint joint1="elbow"/><joint name="s" joint1="elbow" polycoef="1 0 0 0 0"/></equality>'),
        "equality 's': elbow follows two joints",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", LEFT)
def test_what_has_no_counterpart_is_told(name):
    text, said = LEFT[name]
    machine = described(text)
    (problem,) = machine.left_out
    assert problem.code == "import-left-out" and problem.hint
    assert re.search(said, problem.message), problem.message
    assert problem.location is None or problem.location.line >= 1
    assert f"# - {problem.message}" in imported(text)


def test_soft_limits_are_told_where_they_become_stops():
    soft = LEG.replace('limited="true"', 'limited="true" solreflimit="-100 -5"')
    assert not described(soft, free=True).left_out
    (problem,) = described(soft, free=True, limits=True).left_out
    assert "softness of limits" in problem.message and "joint hip-x" in problem.message


def test_controls_of_a_keyframe_are_told_where_they_would_move_joints():
    text = LEG.replace('qpos="0 0 0"', 'qpos="0 0 0" ctrl="2"')
    assert not described(text, keyframe="1").left_out and not described(text, free=True, keyframe="bent").left_out
    (problem,) = described(text, free=True, keyframe="1").left_out
    assert "controls (ctrl)" in problem.message


def test_a_motor_is_no_loss():
    assert not described(scene(rest='<actuator><motor joint="elbow"/></actuator>')).left_out
    assert not described(scene(rest='<sensor><jointpos joint="elbow"/></sensor>')).left_out


LATIN = '<?xml version="1.0" encoding="latin-1"?><mujoco model="\xe4"/>'.encode("latin-1")
REFUSED = {
    "schema": ("<mujoco>\n<worldbody>\n<bod/></worldbody></mujoco>", "import-mjcf", 3, "unrecognized element"),
    "no mass": ("<mujoco><worldbody><body>\n<joint/></body></worldbody></mujoco>", "import-mjcf", 1, "mass and"),
    "no file": ('<mujoco><asset><mesh file="x.stl"/></asset></mujoco>', "import-mjcf", None, "x.stl"),
    "nan": ('<mujoco><option gravity="nan 0 0"/></mujoco>', "import-number", 1, "gravity"),
    "device": ('<mujoco><asset>\n<mesh file="/dev/zero"/></asset></mujoco>', "import-file", 2, "not a regular file"),
    "included device": ('<mujoco>\n<include file="/dev/zero"/></mujoco>', "import-file", 2, "not a regular file"),
    "replicas": (
        '<mujoco><worldbody><replicate count="10000"><replicate count="10000"/></replicate></worldbody></mujoco>',
        "too-large", 1, "100,000,000",
    ),
    "texture": ('<mujoco><asset><texture width="99999" height="99999"/></asset></mujoco>', "too-large", 1, "texture"),
    "latin": (LATIN, "not-xml", 1, "UTF-8"),
    "nothing moves": ("<mujoco/>", "import-mass", 1, "nothing can move"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_refused_with_a_place(name):
    text, code, line, said = REFUSED[name]
    with pytest.raises(SpecError) as refused:
        imported(text)
    (problem,) = refused.value.problems
    assert problem.code == code and said in problem.message and problem.hint
    assert line is None or problem.location.line == line


def test_files_are_named_from_the_models_folder(heun, folder):
    (folder / "parts").mkdir()
    body = '<body name="q"><joint name="qj"/><geom size=".1" mass="7" contype="0"/></body>'
    (folder / "parts" / "a.xml").write_text(f"<mujocoinclude><worldbody>{body}</worldbody></mujocoinclude>")
    (folder / "m.xml").write_text('<mujoco model="m"><include file="parts/a.xml"/></mujoco>')
    done = heun("import", "m.xml", "-q")
    assert done.returncode == 0 and "mass: 7" in done.stdout
    done = heun("import", "m.xml", "-o", "parts/a.xml")
    assert done.returncode == 2 and "would overwrite a part of the model" in done.stderr
    (folder / "parts" / "a.xml").write_text('<!DOCTYPE a [<!ENTITY b "c">]><mujocoinclude/>')
    done = heun("import", "m.xml", "-q")
    assert done.returncode == 2 and "a.xml:1" in done.stderr and "xml-entities" in done.stderr


def test_two_included_files_of_one_name_are_not_taken_for_one(folder):
    body = "<body><joint/><geom size='.1' mass='{}' contype='0'/></body>"
    for place, mass in (("one", 3), ("two", 4)):
        (folder / place).mkdir()
        (folder / place / "b.xml").write_text('<mujocoinclude><include file="c.xml"/></mujocoinclude>')
        (folder / place / "c.xml").write_text(
            f"<mujocoinclude><worldbody>{body.format(mass)}</worldbody></mujocoinclude>"
        )
    text = '<mujoco><include file="one/b.xml"/><include file="two/b.xml"/></mujoco>'
    with pytest.raises(SpecError, match=r"c\.xml is the name of two files") as refused:
        described(text, str(folder / "m.xml"))
    assert refused.value.problems[0].code == "import-file"
    (machine,) = described('<mujoco><include file="two/b.xml"/></mujoco>', str(folder / "m.xml")).bodies
    assert machine.mass == 4.0
    hidden = '<mujoco><compiler meshdir="two"/><include file="c.xml"/></mujoco>'  # no place of models
    with pytest.raises(SpecError, match=r"c\.xml"):
        described(hidden, str(folder / "m.xml"))


def test_strict_writes_nothing_where_something_is_left_out(heun, folder):
    (folder / "m.xml").write_text(LEFT["servo"][0])
    done = heun("import", "m.xml", "--strict", "-o", "m.yaml")
    assert done.returncode == 1 and "import-left-out" in done.stderr and not (folder / "m.yaml").exists()
    assert heun("import", "m.xml", "-o", "m.yaml").returncode == 0
    assert heun("run", "m.yaml").returncode == 0
    assert not (folder / "MUJOCO_LOG.TXT").exists()
    done = heun("import", "m.xml", "--density", "7850")
    assert done.returncode == 2 and "--density: not available for MJCF" in done.stderr


def test_without_mujoco_the_command_says_how_to_get_it(monkeypatch):
    def importing(name, *rest, **more):
        if name == "mujoco":
            raise ImportError
        return real(name, *rest, **more)

    real = builtins.__import__
    monkeypatch.setattr(builtins, "__import__", importing)
    monkeypatch.delitem(sys.modules, "mujoco")
    with pytest.raises(SpecError, match="which is not installed") as refused:
        imported(LEG)
    assert refused.value.problems[0].code == "missing-extra"
    assert 'pip install "heuncli[mujoco]"' in refused.value.problems[0].hint


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes here")
def test_a_pipe_is_not_waited_for(heun, folder):
    os.mkfifo(folder / "p.stl")
    (folder / "m.xml").write_text('<mujoco><asset><mesh file="p.stl"/></asset></mujoco>')
    done = heun("import", "m.xml")
    assert done.returncode == 2 and "p.stl is not a regular file" in done.stderr
