"""SDF: the spec of the same robot in URDF, poses in any form against kinematics of their own, and what is refused."""

from __future__ import annotations

import re

import numpy as np
import pytest
import yaml

from heuncli.base.errors import SpecError
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve
from tests.shared.imported import described, imported
from tests.shared.scenes import near
from tests.shared.sdf_trees import scattered_sdf_text, sdf_text
from tests.shared.urdf_trees import (
    MOVED,
    center_of,
    frames_at,
    holding_efforts,
    inertia_of,
    of_rpy,
    random_robot,
    turn,
    urdf_text,
)

REPORTS = frozenset({"motion", "points", "joints"})
MASS = "<inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial>"


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.third
def test_a_robot_gives_the_same_spec_from_both_formats(seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot = random_robot(rng, 3 + 4 * seed, right=seed % 3 == 2)
    specs = [yaml.safe_load(imported(text)) for text in (urdf_text(robot), sdf_text(robot))]
    assert specs[0] == specs[1]


@pytest.mark.parametrize("seed", range(12))
def test_poses_in_any_form_are_where_kinematics_has_them(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    robot = random_robot(rng, 3 + 2 * seed, right=seed % 3 == 2)
    model = np.eye(4)
    model[:3, 3] = rng.normal(size=3)
    model[:3, :3] = turn(rng.normal(size=3), float(rng.uniform(-3, 3))) if seed % 2 else np.eye(3)
    text = imported(scattered_sdf_text(robot, rng, model))
    q = {part.name: float(rng.uniform(-2, 2)) for part in robot.movable}
    spec = load("robot.yaml", text, overrides={f"to_{name}": f"{value!r}" for name, value in q.items()})
    results = solve(spec, Options(requested_reports=REPORTS)).results
    frames = frames_at(robot, q)
    size = max(float(np.abs(frame.origin).max()) for frame in frames.values()) + 3.0
    efforts = holding_efforts(robot, frames)
    heaviest = max(map(abs, efforts.values()), default=0.0) + 1.0
    M, t = model[:3, :3], model[:3, 3]
    for part in (robot.root, *robot.parts):
        if part.mass is None:
            (place,) = [block for name, block in results.points.items() if name.endswith(f".{part.name}")]
            near(place["position"][0], t + M @ frames[part.name].origin, size, 1e-13)
            continue
        body, block = spec.bodies[part.name], results.bodies[part.name]
        near(block["center"][0], t + M @ center_of(part, frames), size, 1e-13)
        R = block["rotation"][0]
        near(R @ np.array(body.inertia) @ R.T, M @ inertia_of(part, frames) @ M.T, 0.05, 1e-13)
        if part.kind in MOVED and part is not robot.root:
            near(results.joints[part.joint]["drive"][0], efforts[part.name], heaviest, 1e-12)


def model(
    inner: str = "", joint: str = "", axis: str = "<xyz>0 1 0</xyz>", kind: str = "revolute", leg: str = MASS
) -> str:
    return f"""<sdf version="1.9"><model name="m">
<link name="base">{MASS}</link>
<link name="leg"><pose>0 0 1 0 0 0</pose>{leg}</link>
<joint name="hip" type="{kind}"><parent>base</parent><child>leg</child>{joint}<axis>{axis}</axis></joint>
{inner}</model></sdf>"""


def test_springs_limits_and_unlimited_joints() -> None:
    axis = """<xyz>0 1 0</xyz><limit><lower>-1e16</lower><upper>inf</upper><effort>-1</effort></limit>
<dynamics><damping>0.5</damping><spring_stiffness>3</spring_stiffness><spring_reference>0.2</spring_reference></dynamics>"""
    text = imported(model(axis=axis))
    assert "# continuous" in text and "limits" not in text
    assert yaml.safe_load(text)["forces"] == {
        "damping_hip": {"type": "damper", "joint": "hip", "coefficient": 0.5},
        "spring_hip": {"type": "turn_spring", "joint": "hip", "stiffness": 3, "angle": 0.2},
    }
    slide = axis.replace("-1e16", "-0.1").replace("inf", "0.2")
    spec = yaml.safe_load(imported(model(axis=slide, kind="prismatic"), free=True, limits=True))
    assert spec["forces"]["spring_hip"]["value"] == "-3*(hip.travel - 0.2)"
    assert spec["stops"]["limits_hip"]["travel"] == [-0.1, 0.2]


def test_nested_models_keep_their_names_apart() -> None:
    inner = f"""<model name="tool"><pose relative_to="leg">0.5 0 0 0 0 0</pose>
<link name="base">{MASS}</link><link name="jaw"><pose>0.1 0 0 0 0 0</pose>{MASS}</link>
<joint name="grip" type="prismatic"><parent>base</parent><child>jaw</child><axis><xyz>1 0 0</xyz></axis></joint></model>
<joint name="mount" type="fixed"><parent>leg</parent><child>tool::base</child></joint>"""
    machine = described(model(inner))
    assert [body.name for body in machine.bodies] == ["base", "leg", "tool_base", "tool_jaw"]
    points = {f"{body.name}.{point.name}": point.place for body in machine.bodies for point in body.points}
    assert points["leg.mount"] == (0.5, 0, 0) and points["tool_base.tool_grip"] == (0.1, 0, 0)


def points_of(text: str) -> dict[str, tuple[float, ...]]:
    machine = described(text)
    return {f"{body.name}.{point.name}": point.place for body in machine.bodies for point in body.points}


@pytest.mark.parametrize(("canonical", "place"), [("", (0.5, 0, 0)), (' canonical_link="leg"', (0.5, 0, -1))])
def test_a_frame_of_the_model_is_a_point_of_its_canonical_link(canonical: str, place: tuple[float, ...]) -> None:
    body = "leg" if canonical else "base"
    tip = f"""<frame name="f"><pose>0.5 0 0 0 0 0</pose></frame><link name="tip">{MASS}</link>
<joint name="wrist" type="revolute"><parent>f</parent><child>tip</child><axis><xyz>0 1 0</xyz></axis></joint>"""
    text = model(tip).replace('name="m"', f'name="m"{canonical}')
    assert points_of(text)[f"{body}.f"] == place
    assert next(one for one in described(text).joints if one.name == "wrist").keys["from"] == f"{body}.wrist"


def test_a_frame_of_a_nested_model_of_models_is_fixed_to_the_first_link_in_it() -> None:
    inner = f"""<model name="a"><frame name="f"><pose>0 0 2 0 0 0</pose></frame><model name="b">
<link name="l"><pose>0 0 1 0 0 0</pose>{MASS}</link></model></model>
<joint name="j" type="fixed"><parent>leg</parent><child>a::b::l</child></joint>"""
    assert points_of(model(inner))["a_b_l.a_f"] == (0, 0, 1)


def test_names_that_the_import_adds_leave_those_of_the_file_alone() -> None:
    away = "<pose>0 0 0.5 0 0 0</pose>"  # so that links hip_frame, hip_mount and arm_on_ground would be added
    more = f"""<link name="tip">{MASS}</link><frame name="hip_frame"/><frame name="f"/>
<joint name="hip_mount" type="revolute"><parent>leg</parent><child>tip</child><axis><xyz>0 0 1</xyz></axis></joint>
<link name="end">{MASS}</link>
<joint name="f_mount" type="revolute"><parent>tip</parent><child>end</child><axis><xyz>0 0 1</xyz></axis></joint>
<link name="last">{MASS}</link>
<joint name="base_on_ground" type="revolute"><parent>end</parent><child>last</child>
<axis><xyz>0 0 1</xyz></axis></joint>
<pose>0 0 3 0 0 0</pose>"""
    machine = described(model(more, joint=away))
    assert [one.name for one in machine.joints if one.keys["type"] == "pin"] == [
        "hip", "hip_mount", "f_mount", "base_on_ground",
    ]  # fmt: skip
    assert [body.name for body in machine.bodies] == ["base", "leg", "tip", "end", "last"]
    assert {"base.f", "base.hip_frame"} <= set(points_of(model(more, joint=away)))


def test_poses_in_a_link_may_be_relative_to_it_in_a_nested_model_too() -> None:
    box = "<geometry><box><size>0.1 0.2 1</size></box></geometry>"
    shape = f"<collision name='c'><pose relative_to='l'>0 0 0.5 0 0 0</pose>{box}</collision>"
    mass = MASS.replace("<mass>", '<pose relative_to="l">0 0 0.25 0 0 0</pose><mass>')
    nested = """<model name="n"><link name="l">{}</link></model>
<joint name="j" type="fixed"><parent>leg</parent><child>n::l</child></joint>"""
    assert described(model(nested.format(mass))).bodies[2].center == (0, 0, 0.25)
    assert described(model(nested.format(shape)), density=1000.0).bodies[2].shapes[0].keys["center"] == (0, 0, 0.5)


def test_a_link_without_inertial_has_the_mass_of_the_format_or_that_of_its_shape() -> None:
    box = "<geometry><box><size>0.1 0.2 1</size></box></geometry>"
    shape = f"<collision name='c'><pose>0 0 0.5 0 0 0</pose>{box}</collision>"
    machine = described(model(leg=shape))
    assert machine.bodies[1].mass == 1.0 and "Mass or inertia left out" in "".join(machine.header_lines)
    filled = described(model(leg=shape), density=1000.0).bodies[1].shapes[0].keys
    assert filled["size"] == (0.1, 0.2, 1.0) and filled["center"] == (0.0, 0.0, 0.5) and filled["density"] == 1000.0


FOUR_BAR = """
heun: 1
title: four bar
gravity: [0, 0, -9.81]
ground: {points: {a: [0.1, 0, 0.2], d: [0.9, 0, 0.2]}}
bodies:
  crank: {mass: 1, center: [0.1, 0, 0.02], inertia: [0.001, 0.004, 0.004], points: {a: [0, 0, 0], b: [0.2, 0, 0]}}
  coupler: {mass: 2, center: [0.2, 0, 0.2], inertia: [0.001, 0.02, 0.02],
            points: {b: [0, 0, 0], c: [0.4, 0, 0.3]}}
  rocker: {mass: 1.5, center: [-0.1, 0, 0.1], inertia: [0.001, 0.01, 0.01],
           points: {d: [0, 0, 0], c: [-0.2, 0, 0.3]}}
joints:
  a: {type: pin, from: ground.a, to: crank.a, axis: [0, 1, 0]}
  b: {type: pin, from: crank.b, to: coupler.b, axis: [0, 1, 0]}
  d: {type: pin, from: ground.d, to: rocker.d, axis: [0, 1, 0]}
  c: {type: pin, from: coupler.c, to: rocker.c, axis: [0, 1, 0]}
analysis: {duration: 1}
"""


def four_bar_sdf(order: tuple[str, ...], rng: np.random.Generator) -> str:
    """The same four-bar; every link has a frame turned at random, the joints stand in any order and at any frame."""
    centers = {"crank": (0.2, 0, 0.22), "coupler": (0.5, 0, 0.4), "rocker": (0.8, 0, 0.3)}
    masses = {"crank": (1, 0.001, 0.004), "coupler": (2, 0.001, 0.02), "rocker": (1.5, 0.001, 0.01)}
    places = {"a": (0.1, 0, 0.2), "b": (0.3, 0, 0.2), "c": (0.7, 0, 0.5), "d": (0.9, 0, 0.2)}
    ends = {"a": ("world", "crank"), "b": ("crank", "coupler"), "c": ("coupler", "rocker"), "d": ("world", "rocker")}
    parts = []
    for name, (mass, Ix, Iyz) in masses.items():
        rpy, place = rng.uniform(-1.5, 1.5, 3), rng.normal(size=3)
        R = of_rpy(rpy)
        I = R.T @ np.diag([Ix, Iyz, Iyz]) @ R
        moments = "".join(
            f"<i{'xyz'[i]}{'xyz'[j]}>{I[i, j]!r}</i{'xyz'[i]}{'xyz'[j]}>" for i in range(3) for j in range(i, 3)
        )
        center = R.T @ (np.array(centers[name]) - place)
        parts.append(
            f"<link name='{name}'><pose>{' '.join(map(repr, map(float, (*place, *rpy))))}</pose><inertial>"
            f"<pose>{' '.join(map(repr, map(float, center)))} 0 0 0</pose><mass>{mass}</mass>"
            f"<inertia>{moments.replace('np.float64(', '').replace(')', '')}</inertia></inertial></link>"
        )
    for name in order:
        pose = " ".join(map(str, (*places[name], *rng.uniform(-1, 1, 3))))
        axis = '<axis><xyz expressed_in="__model__">0 1 0</xyz></axis>'
        parent, child = ends[name]
        pose = f"<pose relative_to='__model__'>{pose}</pose>"
        parts.append(
            f"<joint name='{name}' type='revolute'>{pose}<parent>{parent}</parent><child>{child}</child>{axis}</joint>"
        )
    return f"<sdf version='1.9'><model name='m'>{''.join(parts)}</model></sdf>"


@pytest.mark.parametrize("order", ["abcd", "dcba", "cdab", "acbd"])
def test_a_loop_is_closed_by_its_last_joint_and_moves_as_the_spec_by_hand(order: str) -> None:
    text = imported(four_bar_sdf(tuple(order), np.random.default_rng(len(order))))
    assert text.count("closes a loop") == 1 and "hold_" not in text
    results = [
        solve(load("m.yaml", one), Options(requested_reports=REPORTS)).results
        for one in (FOUR_BAR, f"{text}\nanalysis: {{duration: 1}}\n")
    ]
    for name in ("crank", "coupler", "rocker"):
        near(results[1].bodies[name]["center"], results[0].bodies[name]["center"], 1.0, 1e-8)
    for name in "abcd":
        force = results[0].joints[name]["force"][:, (0, 2)]
        near(results[1].joints[name]["force"][:, (0, 2)], force, float(np.abs(force).max()), 1e-7)


@pytest.mark.parametrize("kind", ["universal", "revolute2"])
def test_a_joint_of_two_axes_turns_about_both(kind: str) -> None:
    """One axis after the other: as two joints with a link of no mass between, where that link is written."""
    limits = "<limit><lower>-1</lower><upper>1</upper></limit>"
    axes = f"<axis><xyz>0 0 1</xyz></axis><axis{{}}><xyz>0 1 0</xyz>{limits}</axis{{}}>"
    links = f'<link name="base">{MASS}</link><link name="leg"><pose>1 0 0 0 0 0</pose>{MASS}</link>'
    ends = "<pose>-0.2 0 0 0 0.3 0</pose><parent>{}</parent><child>{}</child>"
    own = f"<joint name='a' type='{kind}'>{ends.format('base', 'leg')}{axes.format(2, 2)}</joint>"
    first, second = axes.split("<axis{}>")
    by_hand = (
        '<link name="a_cross"><pose relative_to="leg">-0.2 0 0 0 0.3 0</pose>'
        "<inertial><mass>0</mass><inertia><ixx>0</ixx><iyy>0</iyy><izz>0</izz></inertia></inertial></link>"
        f"<joint name='a' type='revolute'><parent>base</parent><child>a_cross</child>{first}</joint>"
        f"<joint name='a_2' type='revolute'>{ends.format('a_cross', 'leg')}<axis>{second.format('')}</joint>"
    )
    head = f'<sdf version="1.9"><model name="m">{links}'
    specs = [yaml.safe_load(imported(f"{head}{text}</model></sdf>")) for text in (own, by_hand)]
    assert specs[0]["joints"] == specs[1]["joints"] and specs[0]["drives"] == specs[1]["drives"]
    assert [joint["type"] for joint in specs[0]["joints"].values()] == ["weld", "pin", "pin"]
    near(specs[0]["joints"]["a"]["axis"], [np.sin(0.3), 0, np.cos(0.3)], 1.0, 1e-14)
    assert specs[0]["bodies"]["a_cross"]["mass"] == 0 and specs[0]["bodies"]["leg"] == specs[1]["bodies"]["leg"]


LEAD = 0.02


@pytest.mark.parametrize(
    ("value", "hand"),
    [
        (f"<screw_thread_pitch>{LEAD}</screw_thread_pitch>", 1),
        (f"<thread_pitch>{-2 * np.pi / LEAD!r}</thread_pitch>", 1),
        (f"<thread_pitch>7</thread_pitch><screw_thread_pitch>{-LEAD}</screw_thread_pitch>", -1),
    ],
)
@pytest.mark.parametrize("pose", ["", "<pose>0.3 0.1 -0.2 0 0 0.7</pose>"])
def test_a_screw_falls_as_its_thread_lets_it(value: str, hand: int, pose: str) -> None:
    """(J + m r^2) alpha = -m g r on a vertical axis through the centre, r = lead/2 pi: right-handed, it falls turning
    backward.
    """
    on_axis = MASS.replace("<inertial>", f"<inertial>{pose.replace('-0.2', '0.4')}") if pose else MASS
    text = imported(model(axis="<xyz>0 0 2</xyz>", kind="screw", joint=pose + value, leg=on_axis), free=True)
    results = solve(load("s.yaml", f"{text}\nanalysis: {{duration: 0.2, samples: 3}}")).results
    r, J, m, g, t = hand * LEAD / (2 * np.pi), 0.1, 2.0, 9.81, results.time
    turned = -0.5 * m * g * r / (J + m * r * r) * t**2
    near(results.coordinates["hip"]["angle"], turned, 0.1, 1e-9)
    near(results.coordinates["hip_2"]["travel"], r * turned, 1e-3, 1e-9)
    assert results.bodies["leg"]["center"][-1, 2] < results.bodies["leg"]["center"][0, 2]


WHEELS = """<sdf version="1.10"><model name="m"><link name="arm">{mass}</link>
<link name="one"><pose>0 0 0 0.4 0 0</pose>{heavy}</link><link name="two"><pose>1 0 0 0 0 0</pose>{mass}</link>
<joint name="a" type="revolute"><parent>{a[0]}</parent><child>{a[1]}</child>{first}</joint>
<joint name="b" type="revolute"><parent>{b[0]}</parent><child>{b[1]}</child>{second}</joint>
<joint name="gear" type="gearbox"><parent>one</parent><child>two</child>
<axis><xyz expressed_in="arm">0 1 0</xyz></axis><axis2><xyz expressed_in="arm">0 1 0</xyz></axis2>
<gearbox_ratio>{ratio}</gearbox_ratio><gearbox_reference_body>{reference}</gearbox_reference_body></joint>
</model></sdf>"""


def wheels(ratio: float = 2.5, ends: tuple[str, str] = ("arm one", "arm two"), signs: tuple[int, int] = (1, 1), **more):
    """Two wheels on an arm, the first with its centre beside its axis."""
    axes = [f'<axis><xyz expressed_in="arm">0 {sign} 0</xyz>{{}}</axis>' for sign in signs]
    a, b = (end.split() for end in ends)
    texts = {"first": axes[0].format(""), "second": axes[1].format(""), "reference": "arm"} | more
    heavy = MASS.replace("<inertial>", "<inertial><pose>0.2 0 0 0 0 0</pose>")
    return WHEELS.format(mass=MASS, heavy=heavy, a=a, b=b, ratio=ratio, **texts)


@pytest.mark.parametrize("ratio", [2.5, -0.4])
@pytest.mark.parametrize("signs", [(1, 1), (1, -1), (-1, 1)])
@pytest.mark.parametrize("ends", [("arm one", "arm two"), ("arm one", "two arm"), ("one arm", "arm two")])
def test_a_gearbox_couples_the_angles_from_its_reference(
    ratio: float, signs: tuple[int, int], ends: tuple[str, str]
) -> None:
    """theta_2 = -ratio theta_1, each the angle of a wheel in the arm about the arm's y, whatever the joints count."""
    results = solve(load("s.yaml", f"{imported(wheels(ratio, ends, signs), free=True)}\n"
                                   "analysis: {duration: 0.3, samples: 4}")).results  # fmt: skip

    def angle_in_arm(name: str) -> np.ndarray:
        own = np.einsum("nji,njk->nik", results.bodies["arm"]["rotation"], results.bodies[name]["rotation"])
        own = np.einsum("nij,kj->nik", own, own[0])
        return np.arctan2(own[:, 0, 2], own[:, 0, 0])

    assert abs(angle_in_arm("one")[-1]) > 0.05
    near(angle_in_arm("two"), -ratio * angle_in_arm("one"), 1.0, 1e-9)


def test_values_of_other_kinds_in_a_joint_are_passed_over() -> None:
    extra = "<thread_pitch>1</thread_pitch><gearbox_ratio>1</gearbox_ratio>"
    assert yaml.safe_load(imported(model(joint=extra))) == yaml.safe_load(imported(model()))


def test_a_loop_without_a_root_hangs_on_its_first_link() -> None:
    text = four_bar_sdf(tuple("abcd"), np.random.default_rng(1)).replace("<parent>world", "<parent>rocker", 1)
    text = text.replace("<parent>world</parent><child>rocker", "<parent>rocker</parent><child>crank")
    spec = imported(text, base_free=True)
    assert spec.count("type: pin") == 4 and spec.count("closes a loop") == 2 and "position: [" in spec


def test_a_ball_joint_stays_one() -> None:
    assert yaml.safe_load(imported(model(kind="ball", axis="")))["joints"]["hip"]["type"] == "ball"


def test_a_world_gives_its_gravity_and_its_one_model_that_moves() -> None:
    robot = re.sub("</?sdf[^>]*>", "", model())
    world = f"""<sdf version="1.9"><world name="w"><include><uri>model://sun</uri></include><gravity>0 0 -1.62</gravity>
<model name="ground"><static>true</static><link name="l"/></model>{robot}</world></sdf>"""
    machine = described(world)
    assert machine.gravity == (0.0, 0.0, -1.62) and len(machine.bodies) == 2
    with pytest.raises(SpecError) as refused:
        described(world.replace("<static>true</static>", ""))
    assert refused.value.problems[0].message == "the file has 2 models that move: ground, m"
    assert described(world.replace("<static>true</static>", ""), model="m").title == "m"
    with pytest.raises(SpecError, match="a world, and a model outside it"):
        described(world.replace("</world>", f"</world>{robot}"))
    with pytest.raises(SpecError, match="several worlds"):
        described(world.replace("</sdf>", '<world name="v"/></sdf>'))
    with pytest.raises(SpecError, match="there is no model 'n'"):
        described(world, model="n")


@pytest.mark.parametrize(("version", "axis"), [("1.4", (0.0, 1.0, 0.0)), ("1.5", (0.0, 0.0, 1.0))])
def test_axes_are_along_the_model_up_to_version_1_4(version: str, axis: tuple[float, ...]) -> None:
    turned = model().replace("<pose>0 0 1 0 0 0</pose>", "<pose>0 0 1 1.5707963267948966 0 0</pose>")
    (joint,) = [one for one in described(turned.replace("1.9", version)).joints if one.name == "hip"]
    assert joint.keys["axis"] == axis


REFUSED = {
    "no such frame": (model('<frame name="f"><pose relative_to="lag">0 0 0 0 0 0</pose></frame>'),
                      "import-tree", "leg"),
    "poses in a circle": (
        model('<frame name="f"><pose relative_to="g"/></frame><frame name="g"><pose relative_to="f"/></frame>'),
        "import-tree", "relative to the model",
    ),
    "attached to nothing": (model('<frame name="f" attached_to="lag"><pose relative_to="leg"/></frame>'),
                            "import-tree", "leg"),
    "attached in a circle": (
        model('<frame name="f" attached_to="g"><pose relative_to="leg"/></frame>'
              '<frame name="g" attached_to="f"><pose relative_to="leg"/></frame>'),
        "import-tree", "to a link",
    ),
    "no canonical link": (model().replace('name="m"', 'name="m" canonical_link="lag"'), "import-tree", "leg"),
    "no canonical link inside": (
        model(f'<model name="n" canonical_link="x"><link name="l">{MASS}</link></model>'), "import-tree", "n::l",
    ),
    "pose of a shape": (
        model(leg='<inertial><pose relative_to="base">0 0 0 0 0 0</pose></inertial>'), "import-tree", "relative_to",
    ),
    "old pose": (model('<frame name="f"><pose frame="leg">0 0 0 0 0 0</pose></frame>'), "import-attribute", "gz sdf"),
    "not six": (model('<frame name="f"><pose>0 0 0</pose></frame>'), "import-number", "numbers"),
    "screw without lead": (model(kind="screw"), "import-missing", "screw_thread_pitch"),
    "screw of lead 0": (model(kind="screw", joint="<thread_pitch>0</thread_pitch>"), "import-missing", "metres"),
    "no such joint": (model(kind="gear"), "import-joint", "gearbox"),
    "gearbox with one axis": (model(kind="gearbox"), "import-missing", "axis2"),
    "gearbox of ratio 0": (wheels(0.0), "import-joint", "ratio"),
    "gearbox without joints": (wheels(reference="one"), "import-joint", "revolute joint"),
    "gearbox of other axes": (wheels(first="<axis><xyz>1 0 0</xyz></axis>"), "import-joint", "axis2"),
    "gearbox of followers": (
        wheels(first='<axis><xyz expressed_in="arm">0 1 0</xyz><mimic joint="b"/></axis>',
               second='<axis><xyz>0 1 0</xyz><mimic joint="a"/></axis>'), "import-mimic", "gearbox",
    ),
    "universal with one axis": (model(kind="universal"), "import-missing", "axis2"),
    "no axis": (model().replace("<axis><xyz>0 1 0</xyz></axis>", ""), "import-missing", "axis"),
    "unknown part": (model("<jiont/>"), "import-part", "joint"),
    "another file": (model("<include><uri>model://x</uri></include>"), "import-part", "gz sdf"),
    "two parents": (
        model(f'<link name="other">{MASS}</link>'
              '<joint name="b" type="fixed"><parent>other</parent><child>leg</child></joint>'),
        "import-tree", "joint of type fixed",
    ),
    "mimic in a loop": (
        model('<joint name="b" type="revolute"><parent>base</parent><child>leg</child>'
              '<axis><xyz>0 1 0</xyz><mimic joint="a"/></axis></joint>'),
        "import-mimic", "ratio",
    ),
    "a link of the world": (model(f'<link name="world">{MASS}</link>'), "import-tree", "parent world"),
    "no such link": (model('<joint name="b" type="fixed"><parent>base</parent><child>lag</child></joint>'),
                     "import-tree", "leg"),
    "two names": (model(f'<link name="leg">{MASS}</link>'), "import-twice", "own name"),
    "word": (model(leg=MASS.replace(">2<", ">two<")), "import-number", "plain numbers"),
    "bad moments": (model(leg=MASS.replace("<ixx>0.1", "<ixx>0.3")), "import-inertia", "--repair triangle"),
    "automatic": (model(leg='<inertial auto="true"/>'), "import-missing", "--density"),
    "static": ('<sdf version="1.9"><model name="m"><static>1</static></model></sdf>', "import-tree", "one"),
    "too old": ('<sdf version="1.2"/>', "import-format", "gz sdf"),
    "no version": ('<sdf version="new"/>', "import-attribute", "1.9"),
    "nothing": ("<sdf/>", "import-tree", "one model"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_read_is_refused_with_what_to_do(name: str) -> None:
    text, code, hint = REFUSED[name]
    with pytest.raises(SpecError) as refused:
        imported(text)
    problem = refused.value.problems[0]
    assert problem.code == code and hint in problem.hint, problem
    assert problem.location.line >= 1
