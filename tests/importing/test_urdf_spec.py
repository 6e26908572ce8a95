"""What a URDF becomes: bodies, points, joints of every type, what holds them, what is repaired and left out."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve
from tests.shared import triangles
from tests.shared.imported import described, imported
from tests.shared.scenes import near

ROUND = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
BODY = f'<inertial><mass value="1"/>{ROUND}</inertial>'


def link(name: str, inner: str = BODY) -> str:
    return f'<link name="{name}">{inner}</link>'


def joint(name: str, parent: str, child: str, kind: str, inner: str = "") -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}{inner}</joint>'


def robot(*parts: str) -> str:
    return f"<robot name='r'>{''.join(parts)}</robot>"


def spec_of(text: str):
    return load("r.yaml", text)


def results_of(text: str):
    return solve(spec_of(text), Options(requested_reports=frozenset({"motion", "points", "joints"}))).results


def test_a_planar_joint_leaves_shifting_and_turning_in_its_plane():
    """On a slope without friction: what pushes is across it, the weight along it is left."""
    pose = '<origin xyz="0.1 0.2 0.3" rpy="0.4 0.3 0"/><axis xyz="0 0 2"/>'
    text = imported(robot(link("world", ""), link("sled"), joint("slope", "world", "sled", "planar", pose)))
    results = results_of(text)
    n = results.bodies["sled"]["rotation"][0] @ np.array(described_normal(0.4, 0.3))
    g = np.array([0.0, 0.0, -9.81])
    near(results.bodies["sled"]["position"][0], [0.1, 0.2, 0.3], 1.0, 1e-14)
    near(results.bodies["sled"]["center_acceleration"][0], g - (g @ n) * n, 9.81, 1e-13)
    near(results.bodies["sled"]["angular_acceleration"][0], np.zeros(3), 1.0, 1e-12)
    pushed = sum(results.joints[f"slope_{k}"]["force"][0] for k in (1, 2, 3))
    near(pushed, -(g @ n) * n, 9.81, 1e-13)


def test_what_shifts_in_a_plane_is_not_turned_over_where_the_plane_is_lifted():
    """Three points of it fit the plane upside down, too; behind a joint that turns the plane it is refused."""
    parts = [link("a"), link("b"), link("c")]
    parts.append(joint("pp", "b", "c", "planar", '<origin xyz="0.3 0 1" rpy="0.2 0.3 0.4"/><axis xyz="1 1 1"/>'))
    lifted = imported(robot(*parts, joint("j", "a", "b", "prismatic", '<axis xyz="1 0 0"/>')))
    for lift in ("0", "1.5", "-2"):
        found = solve(
            load("r.yaml", lifted, {"j": f"{lift} m"}), Options(requested_reports=frozenset({"motion"}))
        ).results
        near(found.bodies["c"]["quaternion"][0], [1, 0, 0, 0], 1.0, 1e-14)
    with pytest.raises(SpecError, match="a planar joint after j, which rotates its plane"):
        imported(robot(*parts, joint("j", "a", "b", "continuous", '<axis xyz="1 0 0"/>')))


def described_normal(roll: float, pitch: float) -> list[float]:
    """The z axis after a roll about x, then a pitch about y."""
    return [np.sin(pitch) * np.cos(roll), -np.sin(roll), np.cos(pitch) * np.cos(roll)]


def test_what_floats_falls_from_where_it_is_drawn():
    pose = '<origin xyz="0.1 0.2 0.3" rpy="0.4 0.3 0"/>'
    results = results_of(imported(robot(link("a"), link("b"), joint("go", "a", "b", "floating", pose))))
    near(results.bodies["b"]["position"][0], [0.1, 0.2, 0.3], 1.0, 1e-15)
    near(results.bodies["b"]["center_acceleration"][0], [0, 0, -9.81], 1.0, 1e-14)
    near(results.joints["a_on_ground"]["force"][0], [0, 0, 9.81], 1.0, 1e-14)


def test_a_free_root_falls_with_all_that_it_carries():
    text = imported(robot(link("a"), link("b"), joint("j", "a", "b", "revolute")), base_free=True)
    assert "a_on_ground" not in text
    near(results_of(text).bodies["a"]["center_acceleration"][0], [0, 0, -9.81], 1.0, 1e-14)


def test_free_joints_start_where_their_parameters_say_within_their_stops():
    parts = [link("a"), link("b"), joint("j", "a", "b", "revolute", '<limit lower="0.2" upper="1.5"/>')]
    spec = spec_of(imported(robot(*parts), free=True, limits=True))
    assert not spec.drives
    assert spec.joints["j"].angle == 0.2
    assert (spec.stops["limits_j"].low, spec.stops["limits_j"].high) == (0.2, 1.5)


def test_free_joints_start_within_the_stops_of_those_that_follow_them():
    """Position 0.1 - 2 * that of the leader lies between 0.5 and 0.9: the leader between -0.4 and -0.2."""
    mimic = '<mimic joint="j" multiplier="{}" offset="0.1"/><limit lower="0.5" upper="0.9"/>'
    lines = [link("a"), link("b"), link("c"), joint("j", "a", "b", "revolute", '<limit lower="-1" upper="1"/>')]
    spec = spec_of(imported(robot(*lines, joint("k", "b", "c", "revolute", mimic.format(-2))), free=True, limits=True))
    near([spec.joints["j"].angle, spec.joints["k"].angle], [-0.2, 0.5], 1.0, 1e-15)
    still = spec_of(imported(robot(*lines, joint("k", "b", "c", "revolute", mimic.format(0))), free=True, limits=True))
    assert list(still.stops) == ["limits_j"] and list(still.drives) == ["hold_k"]


def test_a_name_that_has_to_change_stays_as_a_label():
    text = imported(robot(link("base"), link("arm-1"), joint("yaw: 1", "base", "arm-1", "continuous")))
    assert spec_of(text).labels == {"bodies.arm_1": "arm-1", "joints.yaw_1": "yaw: 1"}
    assert "label" not in imported(robot(link("base"), link("arm"), joint("yaw", "base", "arm", "continuous")))


def test_links_without_mass_are_points_of_what_they_are_fixed_to():
    """Above a body, below it, between two; and of the ground."""
    up = '<origin xyz="0 0 1"/>'
    parts = [
        link("foot", ""), link("base", ""), link("mount"), link("hub", ""), link("arm"), link("tip", ""),
        joint("stand", "foot", "base", "fixed", up), joint("bolt", "base", "mount", "fixed", up),
        joint("turn", "mount", "hub", "continuous", up), joint("clamp", "hub", "arm", "fixed", up),
        joint("end", "arm", "tip", "fixed", up),
    ]  # fmt: skip
    spec = spec_of(imported(robot(*parts)))
    assert set(spec.bodies) == {"mount", "arm"}
    assert {name: one.kind for name, one in spec.joints.items()} == {"bolt": "weld", "turn": "pin"}
    assert dict(spec.ground.points) == {"base": (0, 0, 1), "bolt": (0, 0, 2)}
    assert dict(spec.bodies["arm"].points) == {"turn": (0, 0, -1), "tip": (0, 0, 1)}


def test_without_a_mass_above_it_a_group_is_carried_by_its_first_body():
    """A free root without mass, whose bodies branch off it."""
    up = '<origin xyz="0 1 0"/>'
    parts = [link("root", ""), link("a"), link("b"), joint("j", "root", "a", "fixed", up)]
    spec = spec_of(imported(robot(*parts, joint("k", "root", "b", "fixed", '<origin xyz="1 0 0"/>')), base_free=True))
    assert spec.bodies["a"].position == (0, 1, 0)
    assert dict(spec.bodies["a"].points) == {"k": (1, -1, 0)}


def test_a_mimic_is_driven_in_its_ratio_down_a_chain():
    """Metres a radian are a number with a point: a plain factor would be an angle."""
    follow = '<mimic joint="{}" multiplier="{}" offset="{}"/>'
    parts = [link(name) for name in "abcd"] + [
        joint("j", "a", "b", "revolute"),
        joint("k", "b", "c", "revolute", follow.format("j", -2, 0)),
        joint("l", "c", "d", "prismatic", follow.format("k", 1, 0.25)),
    ]
    text = imported(robot(*parts))
    assert '{joint: k, angle: "-2*j"}' in text
    assert '{joint: l, travel: "-2.0*j + 0.25"}' in text
    results = results_of(text.replace("j: 0 deg", "j: 0.5 rad"))
    assert results.coordinates["k"]["angle"][0] == pytest.approx(-1.0, abs=1e-15)
    assert results.coordinates["l"]["travel"][0] == pytest.approx(-0.75, abs=1e-15)


def test_repairs_change_as_little_as_they_can_and_say_so():
    def inertial(*moments):
        names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        words = " ".join(f'{name}="{value}"' for name, value in zip(names, (*moments, 0, 0, 0), strict=False))
        return f'<inertial><mass value="2"/><inertia {words}/></inertial>'

    parts = [
        link("a", inertial(1, 1, 3)), link("b", inertial(-1, 1, 1)), link("c", inertial(0, 0, 0)), link("d", ""),
        link("e", inertial(2, 2, 3, 1)), joint("j", "a", "b", "revolute"), joint("k", "b", "c", "revolute"),
        joint("l", "c", "d", "revolute"), joint("m", "d", "e", "revolute"),
        link("f", ""), joint("n", "e", "f", "revolute"),
    ]  # fmt: skip
    text = imported(robot(*parts), repair=frozenset({"triangle", "negative", "zero", "massless"}))
    bodies = spec_of(text).bodies
    assert np.diag(bodies["a"].inertia).tolist() == [1.5, 1.5, 3]
    assert np.diag(bodies["b"].inertia).tolist() == [0, 1, 1]
    assert not np.any(bodies["c"].inertia)
    assert bodies["d"].mass == 0 and bodies["f"].mass == 1e-6
    assert np.linalg.eigvalsh(bodies["e"].inertia).tolist() == pytest.approx([1, 3, 3])
    for told in (
        "repaired (triangle): principal moments 1.5, 1.5, 3; the file has 1, 1, 3",
        "repaired (negative): principal moments 0, 1, 1; the file has -1, 1, 1",
        "repaired (zero)", "repaired (massless)",
    ):  # fmt: skip
        assert text.count(told) == 1
    assert text.count("repaired") == 4


def test_a_tensor_that_is_not_diagonal_is_repaired_in_its_own_axes():
    inertia = '<inertia ixx="2" ixy="1" ixz="0" iyy="2" iyz="0" izz="6"/>'  # moments 1, 3, 6
    text = imported(
        robot(link("a", f'<inertial><mass value="1"/>{inertia}</inertial>')), repair=frozenset({"triangle"})
    )
    near(spec_of(text).bodies["a"].inertia, [[3, 1, 0], [1, 3, 0], [0, 0, 6]], 1.0, 1e-14)


def test_a_density_fills_collision_shapes_where_an_inertial_is_missing():
    """Along the world's axes; the visual elements where a collision is a mesh."""
    box = '<geometry><box size="0.1 0.2 0.3"/></geometry>'
    rod = '<geometry><cylinder radius="0.1" length="2"/></geometry>'
    ball = '<geometry><sphere radius="0.1"/></geometry>'
    mesh = '<geometry><mesh filename="a.stl"/></geometry>'
    turned = '<origin xyz="0 0 1" rpy="1.5707963267948966 0 0"/>'
    parts = [
        link("a", f"<collision>{turned}{box}</collision><visual>{rod}</visual>"),
        link("b", f"<collision>{turned}{rod}</collision>"),
        link("c", f"<collision>{mesh}</collision><visual>{ball}</visual>"), link("d"),
        joint("j", "a", "b", "fixed"), joint("k", "b", "c", "fixed"), joint("l", "c", "d", "fixed"),
    ]  # fmt: skip
    spec = spec_of(imported(robot(*parts), density=1000.0))
    (first,), (second,), (third,) = (spec.bodies[name].shapes for name in "abc")
    assert (first.type, first.center, first.size, first.density) == ("box", (0, 0, 1), (0.1, 0.3, 0.2), 1000)
    assert (second.type, second.from_, second.to, second.radius) == ("cylinder", (0, 1, 1), (0, -1, 1), 0.1)
    assert (third.type, third.center, third.radius) == ("sphere", (0, 0, 0), 0.1)
    assert spec.bodies["d"].mass == 1


def test_angles_that_are_nearly_right_are_kept_and_told_or_taken_for_right():
    parts = robot(
        link("a"), link("b"), joint("j", "a", "b", "revolute", '<origin rpy="1.5708 0 0"/><axis xyz="0 0 1"/>')
    )
    kept, right = imported(parts), imported(parts, repair=frozenset({"right-angles"}))
    assert "Nearly right angles, such as 1.5708, are kept unchanged: joint j" in kept
    assert "read as right angles (--repair right-angles): joint j" in right
    assert "axis: [0, -1, 0]" in right
    (x, y, z) = spec_of(kept).joints["j"].axis
    assert (x, y) == (0, pytest.approx(-1)) and z == pytest.approx(np.cos(1.5708), rel=1e-9)


def test_damping_is_a_damper_and_friction_is_told_to_be_left_out():
    parts = robot(link("a"), link("b"), joint("j", "a", "b", "revolute", '<dynamics damping="0.5" friction="0.1"/>'))
    machine = described(parts)
    assert [(problem.code, problem.location.line) for problem in machine.left_out] == [("import-left-out", 1)]
    assert "damping_j: {type: damper, joint: j, coefficient: 0.5}" in imported(parts)
    assert '# Left out:\n# - joint j: friction="0.1" is left out\n' in imported(parts)


def test_damping_of_what_shifts_and_turns_is_told_to_be_left_out():
    rubs = '<dynamics damping="0.5"/>'
    for kind in ("planar", "floating"):
        machine = described(robot(link("a"), link("b"), joint("j", "a", "b", kind, rubs)))
        assert [problem.code for problem in machine.left_out] == ["import-left-out"]
    assert not described(robot(link("a"), link("b"), joint("j", "a", "b", "fixed", rubs))).left_out


def test_digits_stay_those_of_the_file_where_axes_turn_by_right_angles():
    """Seventeen digits, tiny numbers, and a turn that a double of pi/2 stands for."""
    numbers = (0.12345678901234566, 1e-7, -2.5e-05)
    text = f'<origin xyz="{" ".join(map(repr, numbers))}"/><mass value="0.30000000000000004"/>{ROUND}'
    turned = '<origin rpy="0 0 1.5707963267948966"/>'
    parts = robot(link("a"), link("b", f"<inertial>{text}</inertial>"), joint("j", "a", "b", "revolute", turned))
    found = imported(parts)
    assert "center: [-1e-07, 0.12345678901234566, -2.5e-05]" in found
    assert "mass: 0.30000000000000004" in found


def test_the_spec_says_where_it_comes_from_and_begins_with_what_runs_it():
    lines = imported(robot(link("a"))).splitlines()
    assert lines[0] == "# heun run model.yaml"
    assert "# Made by heun import from model.xml, URDF, sha256" in lines


BAR = triangles.box([0, -10, -15], [400, 10, 15])


def meshed(name: str, scale: str = "0.001 0.001 0.001", pose: str = "") -> str:
    """A model whose one link is a mesh."""
    geometry = f'<collision>{pose}<geometry><mesh filename="{name}" scale="{scale}"/></geometry></collision>'
    return robot(link("a"), link("b", geometry), joint("j", "a", "b", "revolute", '<axis xyz="0 0 1"/>'))


@pytest.mark.parametrize(
    "name", ["bar.stl", "package://robots/meshes/bar.stl", "package://other/bar.stl", "file://FOLDER/bar.stl"]
)
@pytest.mark.parametrize("mirrored", [False, True])
def test_a_density_fills_meshes(name: str, mirrored: bool, tmp_path: Path) -> None:
    """In mm, turned and shifted; mirrored it is as heavy, on the other side."""
    folder = tmp_path / "robots" / "urdf"
    for place in (folder, tmp_path / "robots" / "meshes", tmp_path / "other"):
        place.mkdir(parents=True, exist_ok=True)
        (place / "bar.stl").write_bytes(triangles.binary_stl(BAR))
    pose = '<origin xyz="0.1 0 0" rpy="0 0 1.5707963267948966"/>'
    text = meshed(name.replace("FOLDER", str(folder)), f"{'-' if mirrored else ''}0.001 0.001 0.001", pose)
    body = spec_of(imported(text, density=7850.0, file=str(folder / "model.urdf"))).bodies["b"]
    m = 7850 * 0.4 * 0.02 * 0.03
    along = (0.4**2 + 0.03**2) / 12, (0.02**2 + 0.03**2) / 12, (0.4**2 + 0.02**2) / 12
    near(body.mass, m, 1.0, 1e-7)
    near(body.center, [0.1, -0.2 if mirrored else 0.2, 0.0], 1.0, 1e-7)
    near(body.inertia, np.diag([m * x for x in along]), 1.0, 1e-7)


def test_meshes_that_are_no_solids_are_told(tmp_path: Path) -> None:
    (tmp_path / "open.stl").write_bytes(triangles.binary_stl(BAR[1:]))
    for name, told in (
        ("open.stl", "3 edges are open"), ("none.stl", "file not found"), ("package://x/open.stl", "file not found"),
    ):  # fmt: skip
        with pytest.raises(SpecError, match=told) as refused:
            imported(meshed(name), density=1.0, file=str(tmp_path / "model.urdf"))
        assert [problem.code for problem in refused.value.problems] == ["import-shape"]
        assert all(problem.hint and problem.location for problem in refused.value.problems)
    (tmp_path / "bar.stl").write_bytes(triangles.binary_stl(BAR))
    with pytest.raises(SpecError, match="scale is 0"):
        imported(meshed("bar.stl", "1 0 1"), density=1.0, file=str(tmp_path / "model.urdf"))
