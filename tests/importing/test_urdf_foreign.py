"""Robots as people have them: what other programs add to a URDF, masses without inertia, moments of rounding."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import pytest
import yaml

from heuncli.base.errors import SpecError
from tests.shared.imported import described, imported
from tests.shared.scenes import near

FINE = '<inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.02"/>'
MASS = f'<inertial><origin xyz="0 0 0.1"/><mass value="3"/>{FINE}</inertial>'
BOX = '<collision><origin xyz="0 0 -0.3"/><geometry><box size="0.1 0.2 0.4"/></geometry></collision>'
ROD = '<visual><origin xyz="0 0 1" rpy="0 1.5707963267948966 0"/><geometry><cylinder radius="0.1" length="3"/></geometry></visual>'  # noqa: E501
BALL = '<visual><geometry><sphere radius="0.5"/></geometry></visual>'


def robot(top: str = "", inner: str = "", part: str = "", leg: str = MASS, root: str = "") -> str:
    """A robot of two links: what stands beside them, in the joint, and in the second link."""
    axis = "" if "<axis" in inner else '<axis xyz="0 1 0"/>'
    return f"""<robot name="r" {root}>
{top}
<link name="base">{MASS}</link>
<link name="leg">{leg}{part}</link>
<joint name="hip" type="revolute"><parent link="base"/><child link="leg"/>{axis}{inner}</joint>
</robot>"""


def spec(text: str, **asked: Any) -> Any:
    return yaml.safe_load(imported(text, **asked))


PASSED = {  # what stands beside the links, in the joint, in the link; how it is listed
    "mujoco": ({"top": '<mujoco><compiler meshdir="m"/></mujoco>'}, "1 mujoco"),
    "drake": ({"top": '<drake:collision_filter_group name="g"></drake:collision_filter_group>'},
              "1 drake:collision_filter_group"),
    "declared": ({"top": '<d:ignore xmlns:d="http://x"/><d:ignore xmlns:d="http://x"/>'}, "2 d:ignore"),
    "old drake": ({"top": '<collision_filter_group name="g"/><frame name="f" link="leg"/>'},
                  "1 collision_filter_group, 1 frame"),
    "gazebo": ({"top": "<gazebo/><transmission/><gazebo/><ros2_control/>"},
               "2 gazebo, 1 transmission, 1 ros2_control"),
    "semantics": ({"top": '<passive_joint name="hip"/><disable_collisions/>'}, "1 passive_joint, 1 disable_collisions"),
    "words with others in them": ({"top": "<a:drawing/><a:property/><a:enforce/><a:forceTorqueSensor/>"},
                                  "1 a:drawing, 1 a:property, 1 a:enforce, 1 a:forceTorqueSensor"),
    "of a drone": ({"top": '<properties arm="0.04" kf="3e-10"/>'}, "1 properties"),
    "in a joint": ({"inner": "<safety_controller/><drake:color/>"},
                   "1 safety_controller in joints, 1 drake:color in joints"),
    "in a link": ({"part": "<contact/><drake:looks/><origin/>"},
                  "1 contact in links, 1 drake:looks in links, 1 origin in links"),
    "what is so anyway": ({"part": "<gravity>1</gravity><kinematic>0</kinematic>"},
                          "1 gravity in links, 1 kinematic in links"),
}  # fmt: skip


@pytest.mark.parametrize("name", PASSED)
def test_what_says_nothing_of_mechanics_is_passed_over_and_counted(name: str) -> None:
    parts, listed = PASSED[name]
    text = imported(robot(**parts))
    head = "\n".join(line.removeprefix("# ") for line in text.splitlines() if line.startswith("#"))
    assert f"Left out, as not relevant to the mechanics: {listed}." in head.replace("\n", " ")
    assert yaml.safe_load(text)["joints"] == spec(robot())["joints"]


REFUSED = {  # what stands there; words of the hint
    "loop": ({"top": '<loop_joint name="l"/>'}, "close the loop in the spec by a joint"),
    "constraint": ({"top": "<drake:ball_constraint/>"}, "close the loop in the spec by a joint"),
    "force": ({"top": "<force_element><linear_spring_damper/></force_element>"}, "add the load to the spec"),
    "spring": ({"top": "<linear_spring_damper/>"}, "add the load to the spec"),
    "bushing": ({"top": "<drake:linear_bushing_rpy/>"}, "add the load to the spec"),
    "camel case": ({"top": "<my:linearForce/>"}, "add the load to the spec"),
    "joint": ({"top": '<drake:joint name="j" type="ball"/>'}, "three revolute"),
    "screw": ({"inner": '<drake:screw_thread_pitch value="1"/>'}, "coupling to the spec"),
    "spring of a joint": ({"inner": "<springStiffness/>"}, "add the load to the spec"),
    "weightless": ({"part": "<gravity>0</gravity>"}, "correct the spec"),
    "rotor": ({"inner": "<drake:rotor_inertia/>"}, "correct the spec"),
    "force in a link": ({"part": "<thruster/>"}, "add the load to the spec"),
    "unknown": ({"top": "<whatever/>"}, "delete it if it says nothing of the mechanics"),
    "misspelt": ({"top": "<jointt/>"}, "did you mean joint?"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_changes_the_mechanics_is_refused_by_name(name: str) -> None:
    parts, words = REFUSED[name]
    with pytest.raises(SpecError) as refused:
        imported(robot(**parts))
    (problem,) = refused.value.problems
    assert problem.code == "import-part"
    assert words in problem.hint
    tag = next(iter(parts.values())).split()[0].split(">")[0].split("/")[0].strip("<")
    assert f"<{tag}>" in problem.message


def test_the_gravity_of_mujoco_is_warned_of() -> None:
    (problem,) = described(robot('<mujoco>\n<option gravity="0 0 -1.62"/></mujoco>')).left_out
    assert (problem.code, problem.location.line) == ("import-left-out", 3)
    assert 'gravity="0 0 -1.62"' in problem.message


@pytest.mark.parametrize(("inner", "damping"), [
    ('<joint_properties damping="0.0" friction="0.0"/>', None),
    ('<joint_properties damping="0.7"/>', 0.7),
    ('<joint_properties damping="0.7"/><dynamics damping="0.7"/>', 0.7),
    ('<joint_properties damping="0" friction="0"/><dynamics damping="0.7"/>', 0.7),
])  # fmt: skip
def test_joint_properties_are_the_old_dynamics(inner: str, damping: float | None) -> None:
    forces = spec(robot(inner=inner)).get("forces", {})
    assert [force["coefficient"] for force in forces.values()] == ([] if damping is None else [damping])


def test_joint_properties_that_differ_from_dynamics_are_refused() -> None:
    with pytest.raises(SpecError) as refused:
        imported(robot(inner='<joint_properties damping="0.7"/><dynamics damping="0.8"/>'))
    assert [problem.code for problem in refused.value.problems] == ["import-twice"]
    (problem,) = described(robot(inner='<joint_properties friction="2"/>')).left_out
    assert 'friction="2"' in problem.message


@pytest.mark.parametrize(("rpy", "axis"), [
    ("0 0 0", [0, 1, 0]), ("-0 1e-25 0", [0, 1, 0]), ("0 0 1.5707963267948966", [-1, 0, 0]),
    ("1.5707963267948966 0 0", [0, 0, 1]), ("0.5 0 0", [0, 0.8775825618903728, 0.479425538604203]),
])  # fmt: skip
def test_the_axis_is_turned_by_its_own_rpy(rpy: str, axis: list[float]) -> None:
    text = imported(robot(inner=f'<axis xyz="0 1 0" rpy="{rpy}"/>'))
    near(yaml.safe_load(text)["joints"]["hip"]["axis"], axis, 1.0)
    assert ("Axes turned by their own rpy" in text) == (axis != [0, 1, 0])


BARE = '<inertial><origin xyz="0 0 -0.2"/><mass value="2"/></inertial>'
NO_ORIGIN = '<inertial><mass value="2"/></inertial>'
MASSES = {  # the link, the options; its centre and inertia
    "point": (BARE, {"repair": frozenset({"point"})}, [0, 0, -0.2], [0, 0, 0]),
    "point at the origin": (NO_ORIGIN, {"repair": frozenset({"point"})}, [0, 0, 0], [0, 0, 0]),
    "point before shape": (BARE + BOX, {"repair": frozenset({"point", "shape"})}, [0, 0, -0.2], [0, 0, 0]),
    "box": (BARE + BOX, {"repair": frozenset({"shape"})}, [0, 0, -0.2], [0.2 / 6, 0.17 / 6, 0.05 / 6]),
    "box by density": (NO_ORIGIN + BOX, {"density": 5000.0}, [0, 0, -0.3], [0.2 / 6, 0.17 / 6, 0.05 / 6]),
    "turned rod": (NO_ORIGIN + ROD, {"repair": frozenset({"shape"})}, [0, 0, 1], [0.01, 1.505, 1.505]),
    "ball": (NO_ORIGIN + BALL, {"repair": frozenset({"shape"})}, [0, 0, 0], [0.2, 0.2, 0.2]),
    "two": (
        NO_ORIGIN + "".join(BALL.replace("<geo", f'<origin xyz="{x} 0 0"/><geo') for x in (1, -1)),
        {"repair": frozenset({"shape"})}, [0, 0, 0], [0.2, 2.2, 2.2],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", MASSES)
def test_a_mass_without_inertia_is_repaired_as_asked(name: str) -> None:
    link, asked, center, inertia = MASSES[name]
    text = imported(robot(leg=link), **asked)
    leg = yaml.safe_load(text)["bodies"]["leg"]
    assert leg["mass"] == 2
    near(leg["center"], center, 1.0)
    near(leg["inertia"], inertia, 1.0)
    assert f"repaired ({'point' if 'point' in name else 'shape'})" in text


@pytest.mark.parametrize(("link", "asked", "code", "words"), [
    (BARE, {}, "import-missing", "--repair point makes"),
    (BARE + BOX, {}, "import-missing", "--repair shape (or --density)"),
    (BARE, {"density": 1.0}, "import-missing", "--repair point"),
    (BARE + BOX.replace('box size="0.1 0.2 0.4"', "capsule"), {"density": 1.0}, "import-shape", "--repair point"),
    (BARE.replace('"2"', '"-2"'), {"repair": frozenset({"point"})}, "import-mass", "above 0"),
])  # fmt: skip
def test_a_mass_without_inertia_is_refused_with_the_ways_out(link: str, asked: Any, code: str, words: str) -> None:
    with pytest.raises(SpecError) as refused:
        imported(robot(leg=link), **asked)
    assert [problem.code for problem in refused.value.problems] == [code]
    assert words in refused.value.problems[0].hint


def moments(**given: str) -> str:
    named = dict.fromkeys(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), "0") | given
    values = " ".join(f'{name}="{value}"' for name, value in named.items())
    return f'<inertial><origin xyz="0 0 0.1"/><mass value="0.78"/><inertia {values}/></inertial>'


@pytest.mark.parametrize("given", [{"ixz": "2.4e-35"}, {"ixx": "-1e-24"}, {"iyz": "-3e-80"}])
def test_moments_of_rounding_are_zero(given: dict[str, str]) -> None:
    with pytest.raises(SpecError, match="all moments of inertia are 0"):
        imported(robot(leg=moments(**given)))
    assert spec(robot(leg=moments(**given)), repair=frozenset({"zero"}))["bodies"]["leg"]["inertia"] == [0, 0, 0]


def test_moments_of_a_small_robot_are_its_own() -> None:
    small = moments(ixx="2e-26", iyy="2e-26", izz="2e-26").replace("0 0 0.1", "0 0 1e-8").replace("0.78", "1e-6")
    assert "inertia: [2e-26, 2e-26, 2e-26]" in imported(robot(leg=small).replace("0 0 0.1", "0 0 1e-8"))


XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


@pytest.mark.parametrize("text", [
    robot(root=XACRO, top='<xacro:property name="a" value="1"/>'),
    robot(root=XACRO, part='<xacro:box_inertia mass="1"/>'),
    robot(root=XACRO, inner='<origin xyz="${a} 0 0"/>'),
    robot(root=XACRO, part='<visual><geometry><mesh filename="$(find r)/a.stl"/></geometry></visual>'),
    robot(root=XACRO.replace("xmlns:xacro", "xmlns:x"), part="<x:box_inertia/>"),
    robot(part="<xacro:box_inertia/>"),
])  # fmt: skip
def test_macros_are_refused_with_the_command_that_expands_them(text: str) -> None:
    for file, command in (
        ("a b.urdf.xacro", "xacro 'a b.urdf.xacro' > 'a b.urdf'"), ("r.urdf", "xacro r.urdf > r_expanded.urdf"),
    ):  # fmt: skip
        with pytest.raises(SpecError) as refused:
            described(text, file)
        assert [problem.code for problem in refused.value.problems] == ["import-xacro"]
        assert command in refused.value.problems[0].hint


def test_an_expanded_file_may_still_name_xacro() -> None:
    assert spec(robot(root=XACRO))["joints"] == spec(robot())["joints"]


@pytest.mark.parametrize("before", ["\n", "  ", "<!-- made by me -->\n"])
def test_a_declaration_that_is_not_first_is_told(before: str) -> None:
    declared = '<?xml version="1.0"?>\n' + robot()
    assert spec(declared)["joints"]
    with pytest.raises(SpecError) as refused:
        imported(before + declared)
    (problem,) = refused.value.problems
    assert problem.code == "not-xml"
    assert "not at the very beginning" in problem.message
    assert "blank lines" in problem.hint


def test_two_runs_say_the_same_in_the_same_order() -> None:
    """Sets have another order in each process; what is listed has not."""
    top = "".join(
        f"<{tag}/>" for tag in ("gazebo", "mujoco", "frame", "transmission", "camera", "group", "what", "why")
    )
    code = (
        "from tests.shared.imported import imported\nfrom heuncli.base.errors import SpecError\n"
        f"for text in ({robot(top=top)!r}, {robot(top=top.replace('<what/><why/>', ''), inner='<a:x/><a:y/>')!r}):\n"
        "    try:\n        print(imported(text))\n    except SpecError as error:\n        print(error.problems)\n"
    )
    texts = {
        subprocess.run([sys.executable, "-c", code], env={"PYTHONHASHSEED": seed, "PYTHONPATH": ":".join(sys.path)},
                       capture_output=True, check=True).stdout
        for seed in ("1", "2")
    }  # fmt: skip
    assert len(texts) == 1


def test_products_given_twice_are_read_once_and_must_agree() -> None:
    twice = FINE.replace("<inertia", '<inertia iyx="0" izx="0" izy="0"')
    assert spec(robot(leg=MASS.replace(FINE, twice))) == spec(robot())
    with pytest.raises(SpecError, match=r"ixy is 0, but iyx is 0\.001") as refused:
        imported(robot(leg=MASS.replace(FINE, twice.replace('iyx="0"', 'iyx="0.001"'))))
    assert refused.value.problems[0].code == "import-inertia" and "delete iyx" in refused.value.problems[0].hint


def test_a_joint_holds_to_the_world_that_is_not_a_link() -> None:
    weld = '<joint name="weld" type="fixed"><origin xyz="0 0 2"/><parent link="world"/><child link="base"/></joint>'
    assert spec(robot(weld)) == spec(robot(f'<link name="world"/>{weld}'))
