"""From a file to the scene it means: every form of the format, resolved."""

from __future__ import annotations

import hashlib
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from heuncli.base.errors import SpecError
from heuncli.base.records import fields
from heuncli.scene.file_format import loads
from heuncli.scene.file_format import models as m
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.rules import references

POINT = "{mass: 1, center: [0, 0, 0], inertia: [0, 0, 0], points: {p: [0, 0, 0], q: [1, 2, 3]}}"


@pytest.fixture(autouse=True)
def whole_format(monkeypatch: pytest.MonkeyPatch) -> None:
    """The format is read whole, also what is not solved yet."""
    monkeypatch.setattr(references, "NOT_YET", ())


def scene(text: str, **overrides: str) -> m.Spec:
    return load("x.yaml", text=f"heun: 1\n{text}", overrides=overrides)


def body(text: str, space: str = "auto") -> m.Body[m.Vec, loads.Matrix]:
    return scene(f"space: {space}\nbodies: {{b: {text}}}\n").bodies["b"]


def joint(text: str) -> m.Joint[str, m.Vec]:
    top = f"ground: {{points: {{O: [0, 0, 0]}}}}\nbodies: {{a: {POINT}, b: {POINT}}}\n"
    return scene(f"{top}joints: {{j: {text}}}\n").joints["j"]


def force(text: str) -> Any:
    joints = (
        "joints: {shaft: {type: pin, from: ground.O, to: a.p, axis: [0, 0, 1]}, "
        "guide: {type: slide, from: ground.O, to: b.p, axis: [1, 0, 0]}}"
    )
    top = f"ground: {{points: {{O: [0, 0, 0]}}}}\nbodies: {{a: {POINT}, b: {POINT}}}\n{joints}\n"
    return scene(f"{top}forces: {{f: {text}}}\n").forces["f"]


def section(text: str, own: str = "shapes: [{type: rod, from: [0, 0, 0], to: [2, 0, 0], mass: 1}]") -> m.Section:
    text = f"bodies: {{b: {{{own}, points: {{p: [0, 0, 0], q: [2, 0, 0]}}}}}}\nsections: {{s: {text}}}\n"
    return scene(text).sections["s"]


def test_a_small_scene_with_all_its_defaults(tmp_path: Path) -> None:
    path = tmp_path / "x.yaml"
    path.write_text("heun: 1\nbodies: {b: {mass: 2, center: [0, 0, 1], inertia: [1, 1, 1]}}\n")
    found = load(path)
    assert found.title == ""
    assert found.path == str(path)
    assert found.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()
    assert (found.space, found.gravity, found.parameters) == ("auto", (0.0, 0.0, 0.0), {})
    assert found.report == m.ReportSettings()
    unit = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    assert fields(found.bodies["b"]) == fields(m.Body("b", 2.0, (0.0, 0.0, 1.0), unit, {}, *6 * [None], shapes=None))
    assert (found.ground.points, found.foundation.about, found.expect, found.warnings) == ({}, None, (), ())
    blocks = (found.joints, found.drives, found.forces, found.impulses, found.sections, found.tables)
    assert all(block == {} for block in blocks)
    assert found.analysis == m.Analysis("state", (0.0,), None, 1e-9, "auto", None)
    assert str(found.location("bodies.b.mass")) == f"{path}:2:10"
    assert str(found.location("nowhere")) == f"{path}:1:1"


@pytest.mark.parametrize(("text", "expected"), [
    ("inertia: [1, 2, 2.5]", [[1, 0, 0], [0, 2, 0], [0, 0, 2.5]]),
    ("inertia: [1, 2, 2.5], deviation: [0.1, 0.2, 0.3]", [[1, -0.3, -0.2], [-0.3, 2, -0.1], [-0.2, -0.1, 2.5]]),
    ("inertia: [[1, 0.1, 0], [0.1, 2, 0.2], [0, 0.2, 2.5]]", [[1, 0.1, 0], [0.1, 2, 0.2], [0, 0.2, 2.5]]),
    ("inertia: ['10 kg*cm^2', 2 g*m^2, 0.0025]", [[1e-3, 0, 0], [0, 2e-3, 0], [0, 0, 2.5e-3]]),
])  # fmt: skip
def test_inertia(text: str, expected: list[list[float]]) -> None:
    found = body(f"{{mass: 1, center: [0, 0, 0], {text}}}")
    np.testing.assert_allclose(found.inertia, expected, rtol=1e-15)


def test_inertia_is_that_of_the_points_it_comes_from() -> None:
    rng = np.random.default_rng(0)
    x, masses = rng.normal(size=(20, 3)), rng.uniform(0.1, 1.0, 20)
    x -= masses @ x / masses.sum()
    moments = [float(masses @ (x[:, i] ** 2 + x[:, j] ** 2)) for i, j in ((1, 2), (2, 0), (0, 1))]
    deviation = [float(masses @ (x[:, i] * x[:, j])) for i, j in ((1, 2), (2, 0), (0, 1))]
    found = body(f"{{mass: 1, center: [0, 0, 0], inertia: {moments}, deviation: {deviation}}}")
    tensor = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(masses, x, strict=True))
    np.testing.assert_allclose(found.inertia, tensor, rtol=1e-13)


def test_inertia_in_the_plane() -> None:
    found = body("{mass: 1, center: [0, 0, 0], inertia: 3}", space="planar")
    assert found.inertia == ((1.5, 0.0, 0.0), (0.0, 1.5, 0.0), (0.0, 0.0, 3.0))


ANGLES = [0.3, -1.1, 2.2]


@pytest.mark.parametrize(("text", "expected"), [
    ("{axis: [1, 2, -2], angle: 70 deg}", Rotation.from_rotvec(math.radians(70) / 3 * np.array([1, 2, -2]))),
    ("{quaternion: [0.5, 0.5, -0.5, 0.5]}", Rotation.from_quat([0.5, -0.5, 0.5, 0.5])),
    ("{quaternion: [0.7071, 0.7071, 0, 0]}", Rotation.from_rotvec([math.pi / 2, 0, 0])),
    ("{rodrigues: [0.2, -0.4, 0.1]}", Rotation.from_quat([0.2, -0.4, 0.1, 1.0])),
    (f"{{euler: {ANGLES}, sequence: zyx}}", Rotation.from_euler("ZYX", ANGLES)),
    (f"{{euler: {ANGLES}, sequence: zxz}}", Rotation.from_euler("ZXZ", ANGLES)),
    (f"{{euler: {ANGLES}, sequence: xyz}}", Rotation.from_euler("XYZ", ANGLES)),
    ("{matrix: [[0, -1, 0], [1, 0, 0], [0, 0, 1]]}", Rotation.from_rotvec([0, 0, math.pi / 2])),
    ("{matrix: [[0.866, -0.5, 0], [0.5, 0.866, 0], [0, 0, 1]]}", Rotation.from_rotvec([0, 0, math.pi / 6])),
])  # fmt: skip
def test_orientations(text: str, expected: Rotation) -> None:
    found = body(POINT[:-1] + f", orientation: {text}, near: {{orientation: {text}}}}}")
    np.testing.assert_allclose(found.rotation, expected.as_matrix(), atol=2e-4 if "0.866" in text else 1e-15)
    np.testing.assert_allclose(np.array(found.rotation) @ np.array(found.rotation).T, np.eye(3), atol=1e-15)
    assert found.near_rotation is not None
    assert found.near_rotation == found.rotation


def test_rodrigues_is_the_axis_times_the_tangent_of_half_the_angle() -> None:
    k = math.tan(0.35)
    by_vector = body(POINT[:-1] + f", orientation: {{rodrigues: [0, {k}, 0]}}}}").rotation
    by_axis = body(POINT[:-1] + ", orientation: {axis: [0, 1, 0], angle: 0.7}}").rotation
    np.testing.assert_allclose(by_vector, by_axis, atol=1e-15)


@pytest.mark.parametrize(("text", "words"), [
    ("{}", "empty"),
    ("{axis: [0, 0, 1]}", "has no angle"),
    ("{angle: 1}", "has no axis"),
    ("{axis: [0, 0, 0], angle: 1}", "no direction"),
    ("{euler: [1, 2, 3]}", "has no sequence"),
    ("{euler: [1, 2, 3], sequence: zzy}", "'zzy'"),
    ("{euler: [1, 2, 3], sequence: ZYX}", "'ZYX'"),
    ("{quaternion: [1, 1, 0, 0]}", "length 1.41421"),
    ("{quaternion: [0, 0, 0, 0]}", "length 0"),
    ("{matrix: [[1, 0, 0], [0, 1, 0], [0, 0, -1]]}", "reflection"),
    ("{matrix: [[1, 0, 0], [0, 1, 1], [0, 0, 1]]}", "perpendicular"),
    ("{axis: [0, 0, 1], angle: 1, rodrigues: [0, 0, 0]}", "axis and rodrigues"),
])  # fmt: skip
def test_orientations_that_are_none(text: str, words: str) -> None:
    with pytest.raises(SpecError) as caught:
        body(POINT[:-1] + f", orientation: {text}}}")
    (problem,) = caught.value.problems
    assert problem.code == "orientation"
    assert words in problem.message


def test_starts() -> None:
    found = body(POINT[:-1] + ", position: [1, 2, 3 mm], velocity: [1, 0, 36 km/h], near: {position: [0, 1, 0]}, "
                 "angular_velocity: {vector: [0, 0, 60 rpm], frame: body}}")  # fmt: skip
    assert found.position == (1.0, 2.0, 0.003)
    assert fields(found.velocity) == {"vector": (1.0, 0.0, 10.0), "in_body": False}
    assert fields(found.angular_velocity) == {"vector": (0.0, 0.0, 2.0 * math.pi), "in_body": True}
    assert (found.near_position, found.near_rotation) == ((0.0, 1.0, 0.0), None)


def test_shapes() -> None:
    found = body("""{shapes: [
        {type: rod, from: [0, 0, 0], to: [1, 0, 0], line_density: 2 kg/m},
        {type: cylinder, from: [0, 0, 0], to: [1, 0, 0], radius: 2, inner_radius: 1, density: 7850},
        {type: cone, from: [0, 0, 0], to: [1, 0, 0], radius: 2, to_radius: 0, mass: 3},
        {type: box, center: [1, 1, 1], size: [1, 2, 3], mass: 4, orientation: {axis: [0, 0, 1], angle: 90 deg}},
        {type: box, center: [1, 1, 1], size: [1, 2, 3], mass: 4},
        {type: sphere, center: [0, 0, 0], radius: 1, mass: 5},
        {type: point, at: [1, 2, 3], mass: 6}]}""")
    assert found.shapes is not None
    rod, cylinder, cone, turned, box, sphere, point = found.shapes
    x, zero = (1.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    assert rod == m.Shape("rod", line_density=2.0, from_=zero, to=x)
    assert cylinder == m.Shape("cylinder", density=7850.0, from_=zero, to=x, radius=2.0, inner_radius=1.0)
    assert cone == m.Shape("cone", mass=3.0, from_=zero, to=x, radius=2.0, to_radius=0.0)
    assert turned.rotation is not None
    np.testing.assert_allclose(turned.rotation, [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15)
    assert box.rotation == (x, (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    assert sphere == m.Shape("sphere", mass=5.0, center=zero, radius=1.0)
    assert point == m.Shape("point", mass=6.0, at=(1.0, 2.0, 3.0))
    assert (found.mass, found.center, found.inertia) == (0.0, zero, (zero, zero, zero))  # until they are summed up


ENDS = "from: ground.O, to: b.q"


@pytest.mark.parametrize(("text", "expected"), [
    (f"{{type: ball, {ENDS}}}", {}),
    (f"{{type: pin, {ENDS}, axis: [0, 0, 2], to_axis: [0, 1, 0], initial: {{angle: 90 deg, rate: 60 rpm}}}}",
     {"axis": (0.0, 0.0, 2.0), "to_axis": (0.0, 1.0, 0.0), "angle": math.pi / 2, "rate": 2.0 * math.pi}),
    (f"{{type: pin, {ENDS}, axis: [0, 0, 1], bearing: {{diameter: 20 mm, width: 50 mm}}}}",
     {"axis": (0.0, 0.0, 1.0), "bearing": 0.02 * 0.05}),
    (f"{{type: slide, {ENDS}, axis: [1, 0, 0], initial: {{travel: 1 mm, speed: 2}}}}",
     {"axis": (1.0, 0.0, 0.0), "travel": 1e-3, "speed": 2.0}),
    (f"{{type: cylinder, {ENDS}, axis: [1, 0, 0], initial: {{travel: 1, rate: 2}}}}",
     {"axis": (1.0, 0.0, 0.0), "travel": 1.0, "rate": 2.0}),
    (f"{{type: universal, {ENDS}, axis: [1, 0, 0], to_axis: [0, 1, 0]}}",
     {"axis": (1.0, 0.0, 0.0), "to_axis": (0.0, 1.0, 0.0)}),
    (f"{{type: weld, {ENDS}, stiffness: 2e8}}", {"stiffness": ((2e8, 2e8, 2e8), (math.inf, math.inf, math.inf))}),
    (f"{{type: weld, {ENDS}, stiffness: {{force: [1, 2, 3], moment: 4}}}}",
     {"stiffness": ((1.0, 2.0, 3.0), (4.0, 4.0, 4.0))}),
    (f"{{type: line, {ENDS}, axis: [1, 0, 0]}}", {"axis": (1.0, 0.0, 0.0)}),
    (f"{{type: plane, {ENDS}, normal: [1, 0, 0]}}", {"axis": (1.0, 0.0, 0.0)}),
    (f"{{type: rod, {ENDS}}}", {}),
    (f"{{type: rod, {ENDS}, length: 2, tension_only: true}}", {"length": 2.0, "tension_only": True}),
    (f"{{type: rod, {ENDS}, tension_only: true, restitution: 0.3}}", {"tension_only": True, "restitution": 0.3}),
])  # fmt: skip
def test_joints(text: str, expected: dict[str, Any]) -> None:
    found = joint(text)
    kind: Any = text.split()[1].rstrip(",")
    none = dict.fromkeys(("angle", "rate", "travel", "speed", "length", "stiffness", "drive", "restitution"))
    none |= dict.fromkeys(("bearing", "bearings", "path")) | {"path_index": -1, "one_sided": False}
    ends = {"a": "ground", "p": (0.0, 0.0, 0.0), "p_name": "O", "b": "b", "q": (1.0, 2.0, 3.0), "q_name": "q"}
    axis = expected.get("axis", (0.0, 0.0, 1.0))
    axes = {"axis": axis, "to_axis": axis, "to_axis_given": "to_axis" in expected, "tension_only": False}
    assert fields(found) == {"name": "j", "kind": kind, **none, **axes, **ends, **expected}


def test_an_end_by_its_place() -> None:
    found = joint("{type: ball, from: {body: a, at: [1, 0, '1 mm']}, to: {body: ground, at: [0, 0, 1]}}")
    assert (found.a, found.p, found.p_name) == ("a", (1.0, 0.0, 0.001), None)
    assert (found.b, found.q, found.q_name) == ("ground", (0.0, 0.0, 1.0), None)


def test_forces() -> None:
    push = force("{type: force, on: a.q, vector: ['5*sin(t)', 1 kN, shaft.rate], frame: body}")
    assert (push.type, push.on, push.frame) == ("force", m.End("a", (1.0, 2.0, 3.0), "q"), "body")
    assert [v.constant for v in push.vector] == [None, 1000.0, None]
    assert [v.time_dependent for v in push.vector] == [True, False, False]
    assert push.vector[2].uses == (("shaft", "rate"),)
    assert str(push.vector[2].location).startswith("x.yaml:5:")
    twist = force("{type: couple, on: a, vector: [0, 0, 1 N*m]}")
    assert (twist.type, twist.body, twist.on, twist.frame) == ("couple", "a", None, "world")
    assert force("{type: couple, on: a.q, vector: [0, 0, 1]}").on == m.End("a", (1.0, 2.0, 3.0), "q")
    motor = force("{type: torque, joint: shaft, value: 3 N*m}")
    assert (motor.type, motor.joint, motor.value.constant) == ("torque", "shaft", 3.0)
    ram = force("{type: actuator, from: ground.O, to: a.q, value: '2*t'}")
    assert (ram.type, ram.from_.body, ram.to.body, ram.value.value(2.0)) == ("actuator", "ground", "a", 4.0)
    spring = force("{type: spring, from: b.p, to: a.q, stiffness: 2 N/mm, length: 10 cm, damping: 3 N*s/m}")
    assert (spring.type, spring.stiffness, spring.length, spring.damping) == ("spring", 2000.0, 0.1, 3.0)
    assert force("{type: spring, from: b.p, to: a.q, stiffness: 2, length: 0}").damping == 0.0
    assert force("{type: damper, joint: shaft, coefficient: 2 N*m*s}") == loads.Damper("shaft", 2.0, None)
    assert force("{type: damper, joint: guide, coefficient: 2 N*s/m}") == loads.Damper("guide", 2.0, None)
    rubbing = force("{type: friction, joint: shaft, torque: 2, speed: 1 rpm}")
    assert (rubbing.joint, rubbing.torque.constant, rubbing.force, rubbing.speed) == ("shaft", 2.0, None, math.pi / 30)
    rubbing = force("{type: friction, joint: guide, force: 2, speed: 1 mm/s}")
    assert (rubbing.joint, rubbing.torque, rubbing.force.constant, rubbing.speed) == ("guide", None, 2.0, 1e-3)


def test_drives_and_impulses() -> None:
    guide = f"joints: {{j: {{type: slide, {ENDS}, axis: [1, 0, 0]}}}}\n"
    top = f"ground: {{points: {{O: [0, 0, 0]}}}}\nbodies: {{b: {POINT}}}\n{guide}"
    drive = scene(top + "drives: {d: {joint: j, travel: '1 mm', zero: assembled}}\n").drives["d"]
    assert (drive.name, drive.joint, drive.quantity, drive.value.constant) == ("d", "j", "travel", 1e-3)
    assert (drive.zero_assembled, drive.by_rate, drive.from_start) == (True, False, False)
    found = scene(top + "impulses: {i: {on: b.q, vector: [0, 1 N*s, 0]}, k: {body: b, couple: [0, 0, 1], time: 0.5, "
                  "frame: body}}\nanalysis: {duration: 1}\n").impulses  # fmt: skip
    at = (1.0, 2.0, 3.0)
    assert fields(found["i"]) == fields(m.AppliedImpulse("i", "b", at, (0.0, 1.0, 0.0), False, 0.0, "impulse"))
    assert fields(found["k"]) == fields(m.AppliedImpulse("k", "b", None, (0.0, 0.0, 1.0), True, 0.5, "couple"))
    at_point = scene(top + "impulses: {i: {on: b.q, couple: [0, 0, 1]}, k: {on: b, couple: [0, 0, 1]}}\n").impulses
    assert fields(at_point["i"]) == fields(m.AppliedImpulse("i", "b", at, (0.0, 0.0, 1.0), False, 0.0, "couple"))
    assert fields(at_point["k"]) == fields(m.AppliedImpulse("k", "b", None, (0.0, 0.0, 1.0), False, 0.0, "couple"))


def test_stops() -> None:
    joints = f"joints: {{j: {{type: cylinder, {ENDS}, axis: [1, 0, 0]}}, r: {{type: rod, from: ground.Q, to: b.q}}}}\n"
    top = f"ground: {{points: {{O: [0, 0, 0], Q: [9, 0, 0]}}}}\nbodies: {{b: {POINT}}}\n{joints}"
    found = scene(
        top
        + """stops:
  near: {joint: j, travel: [-1 mm, null]}
  turned: {joint: j, angle: [-90 deg, 90 deg], restitution: 0.5}
  far: {joint: r, length: [null, 1 m], restitution: 1}
"""
    ).stops
    assert fields(found["near"]) == fields(m.Stop("near", "j", "travel", -1e-3, None, 0.0))
    assert fields(found["turned"]) == fields(m.Stop("turned", "j", "angle", -math.pi / 2, math.pi / 2, 0.5))
    assert fields(found["far"]) == fields(m.Stop("far", "r", "length", None, 1.0, 1.0))


def test_sections() -> None:
    x = (1.0, 0.0, 0.0)
    assert fields(section("{body: b, at: [1, 0, 0], normal: [1, 0, 0]}")) == fields(m.Section("b", x, at=x))
    named = section("{body: b, at: q, normal: [1, 0, 0], side: before, first_axis: [0, 1, 0], reduce_to: centroid, "
                    "properties: {circle: {radius: 10 mm}}, strength: 200 MPa}")  # fmt: skip
    assert fields(named) == fields(m.Section(
        "b", x, at=(2.0, 0.0, 0.0), side="before", first_axis=(0.0, 1.0, 0.0), reduce_to="centroid",
        properties=m.Properties("circle", {"radius": 0.01}), strength=2e8,
    ))  # fmt: skip
    run = section("{body: b, from: p, to: [1, 0, 0], count: 5, reduce_to: b.q}")
    assert fields(run) == fields(m.Section(
        "b", x, from_=(0.0, 0.0, 0.0), to=x, count=5, reduce_to=m.End("b", (2.0, 0.0, 0.0), "q")
    ))  # fmt: skip
    by_place = section("{body: b, at: p, normal: [1, 0, 0], reduce_to: {body: ground, at: [0, 0, 9]}}")
    assert by_place.reduce_to == m.End("ground", (0.0, 0.0, 9.0))
    for text, kind in (
        ("tube: {radius: 2, inner_radius: 1}", "tube"),
        ("rectangle: {width: 1, height: 2}", "rectangle"),
        ("area: 1, I1: 2, I2: 3, J: 4, c1: 5, c2: 6", "general"),
    ):
        found = section(f"{{body: b, at: p, normal: [1, 0, 0], properties: {{{text}}}}}").properties
        assert found is not None
        assert found.kind == kind
    piece = "piece: {mass: 1, center: [1, 0, 0], inertia: [0, 1, 1]}"
    expected = m.MassProperties(1.0, x, ((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    lumps = "mass: 2, center: [1, 0, 0], inertia: [0, 2, 2]"
    assert section(f"{{body: b, at: p, normal: [1, 0, 0], {piece}}}", lumps).piece == expected
    assert section("{body: b, at: p, normal: [1, 0, 0]}", f"{lumps}, {piece}").piece == expected


@pytest.mark.parametrize(("text", "kind", "times", "duration"), [
    ("{duration: 1, samples: 5}", "motion", (0.0, 0.25, 0.5, 0.75, 1.0), 1.0),
    ("{duration: 100 ms, samples: 2}", "motion", (0.0, 0.1), 0.1),
    ("{times: [0, 1 ms, '1/3']}", "motion", (0.0, 1e-3, 1 / 3), 1 / 3),
    ("{type: motion, times: [0.5]}", "motion", (0.5,), 0.5),
    ("{}", "state", (0.0,), None),
    ("{type: state}", "state", (0.0,), None),
    ("{tolerance: 1e-6}", "state", (0.0,), None),
])  # fmt: skip
def test_analysis(text: str, kind: str, times: tuple[float, ...], duration: float | None) -> None:
    found = scene(f"bodies: {{b: {POINT}}}\nanalysis: {text}\n").analysis
    assert (found.type, found.times, found.duration) == (kind, times, duration)


def test_analysis_by_default() -> None:
    found = scene(f"bodies: {{b: {POINT}}}\nanalysis: {{duration: 2}}\n").analysis
    assert (len(found.times), found.times[100], found.times[-1]) == (201, 1.0, 2.0)
    blow = "impulses: {i: {on: b.q, vector: [0, 1, 0]}}\n"
    assert scene(f"bodies: {{b: {POINT}}}\n{blow}").analysis.type == "impulse"
    asked = "analysis: {duration: 2, tolerance: 1e-6, method: rk4, step: 1 ms}"
    found = scene(f"bodies: {{b: {POINT}}}\n{asked}\n").analysis
    assert (found.tolerance, found.method, found.step) == (1e-6, "RK4", 1e-3)


@pytest.mark.parametrize(("text", "about"), [
    ("", None), ("foundation: {}", None), ("foundation: {about: [0, 0, 1 mm]}", (0.0, 0.0, 0.001)),
    ("foundation: {about: ground.O}", (1.0, 2.0, 3.0)), ("foundation: {about: O}", (1.0, 2.0, 3.0)),
])  # fmt: skip
def test_foundation(text: str, about: m.Vec | None) -> None:
    assert scene(f"ground: {{points: {{O: [1, 2, 3]}}}}\nbodies: {{b: {POINT}}}\n{text}\n").foundation.about == about


def test_expectations() -> None:
    found = scene(f"""bodies: {{b: {POINT}}}
joints: {{}}
analysis: {{duration: 1}}
report: [motion, energy]
expect:
  - {{of: bodies.b.position, at: 0.5, is: [0, null, 2], rel: 1e-6}}
  - {{of: energy.kinetic, peak: max, is: 3.25, abs: 1e-9}}
  - {{of: foundation.force.z, at: 1, is: null}}
  - {{of: points.b.q.velocity.x, at: 1, is: 0}}
  - {{of: model.freedoms, is: 6}}
""")
    assert found.report == m.ReportSettings(results=("motion", "energy"))
    first, second, third, fourth, fifth = found.expect
    assert first[:6] == ("bodies.b.position", 0.5, None, (0.0, None, 2.0), 1e-6, None)
    assert second[:6] == ("energy.kinetic", None, "max", 3.25, None, 1e-9)
    assert (third.is_, fourth.is_, fifth.is_) == (None, 0.0, 6.0)
    assert str(second.location) == "x.yaml:8:5"


def test_parameters_in_any_order() -> None:
    top = "parameters: {a: 2*b, b: c + 1, c: 5 mm/s^2, n: 1500 rpm, d: 'sqrt(a)', r: 30*deg}\n"
    found = scene(f"{top}gravity: [0, 0, -a]\nbodies: {{b: {POINT}}}\n")
    assert found.parameters["a"] == pytest.approx(2.01)
    assert found.parameters["n"] == pytest.approx(157.0796, rel=1e-6)
    assert found.parameters["d"] == pytest.approx(math.sqrt(2.01))
    assert list(found.parameters) == ["a", "b", "c", "n", "d", "r"]
    assert found.gravity == (0.0, 0.0, -found.parameters["a"])


def test_a_long_chain_of_parameters() -> None:
    names = [f"p{i}" for i in range(3000)]
    chain = ", ".join(f"{a}: {b} + 1" for a, b in zip(names, [*names[1:], "0"], strict=True))
    assert scene(f"parameters: {{{chain}}}\nbodies: {{b: {POINT}}}\n").parameters["p0"] == 3000.0


@pytest.mark.parametrize(("given", "found"), [
    ({"L": "1.2"}, lambda s: s.parameters["L"] == 1.2),
    ({"L": "2 mm"}, lambda s: s.parameters["L"] == 0.002),
    ({"L": "2*K"}, lambda s: s.parameters["L"] == 6.0),
    ({"analysis.duration": "3"}, lambda s: s.analysis.times[-1] == 3.0),
    ({"analysis.tolerance": "1e-6"}, lambda s: s.analysis.tolerance == 1e-6),
    ({"bodies.b.mass": "2 kg"}, lambda s: s.bodies["b"].mass == 2.0),
    ({"bodies.b.center.1": "L"}, lambda s: s.bodies["b"].center == (0.0, 1.0, 0.0)),
    ({"bodies.b.center": "[1, 2, 3]"}, lambda s: s.bodies["b"].center == (1.0, 2.0, 3.0)),
    ({"bodies.b.points.q": "[0, 0, 0]"}, lambda s: s.bodies["b"].points["q"] == (0.0, 0.0, 0.0)),
    ({"joints.j.initial.angle": "90 deg"}, lambda s: s.joints["j"].angle == math.pi / 2),
    ({"gravity": "[0, 0, -L]"}, lambda s: s.gravity == (0.0, 0.0, -1.0)),
    ({"gravity.2": "-9.81"}, lambda s: s.gravity == (0.0, 0.0, -9.81)),
    ({"title": "other"}, lambda s: s.title == "other"),
    ({"foundation.about": "[1, 1, 1]"}, lambda s: s.foundation.about == (1.0, 1.0, 1.0)),
    ({"parameters.L": "7"}, lambda s: s.parameters["L"] == 7.0),
])  # fmt: skip
def test_overrides(given: dict[str, str], found: Any) -> None:
    text = f"""parameters: {{L: 1, K: 3}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{b: {POINT}}}
joints: {{j: {{type: pin, {ENDS}, axis: [0, 0, 1]}}}}
analysis: {{duration: 1}}
"""
    if "gravity.2" in given:
        text += "gravity: [0, 0, 0]\n"
    assert found(scene(text, **given))


@pytest.mark.parametrize(("key", "value", "code", "words"), [
    ("M", "1", "no-such-key", "parameter 'M'"),
    ("bodies.c.mass", "1", "no-such-key", "body 'c'"),
    ("bodies.b.points.z", "[0, 0, 0]", "no-such-key", "point 'z'"),
    ("bodies.b.masss", "1", "unknown-key", "mass"),
    ("bodies.b.mass.x", "1", "no-such-key", "without keys"),
    ("bodies.b.center.7", "1", "no-such-key", "no entry 7"),
    ("bodies.b.mass", "1 m", "dimension", "a length"),
    ("bodies.b.mass", "[", "not-yaml", "not YAML"),
    ("bodies.b.mass", "", "expression-syntax", "empty"),
    ("L", "x", "unknown-name", "'x'"),
    ("nothing.at.all", "1", "unknown-key", "nothing"),
    ("", "1", "no-such-key", "parameter ''"),
])  # fmt: skip
def test_overrides_that_have_no_place(key: str, value: str, code: str, words: str) -> None:
    with pytest.raises(SpecError) as caught:
        scene(f"parameters: {{L: 1}}\nbodies: {{b: {POINT}}}\n", **{key: value})
    (problem,) = caught.value.problems
    assert problem.code == code
    assert words in f"{problem.message} {problem.hint}"
    assert problem.location is not None
    assert problem.location.file == f"--set {key}={value}"


def test_the_file_is_not_changed_by_overrides() -> None:
    text = f"parameters: {{L: 1}}\nbodies: {{b: {POINT}}}\n"
    assert scene(text, L="2").sha256 == scene(text).sha256


def test_standard_input_looks_for_tables_where_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "f.csv").write_text("0,1\n1,2\n")
    monkeypatch.chdir(tmp_path)
    found = load("-", text=f"heun: 1\nbodies: {{b: {POINT}}}\ntables: {{f: {{file: f.csv}}}}\n")
    assert found.path == "<stdin>"
    assert list(found.tables["f"].y) == [1.0, 2.0]


def test_the_numeric_part_can_know_the_types_without_yaml_and_pydantic() -> None:
    code = (
        "import sys, heuncli.scene.file_format.models, heuncli.scene.expressions.programs; "
        "print([m for m in ('yaml', 'pydantic', 'numpy', 'scipy', 'rich', 'typer') if m in sys.modules])"
    )
    assert subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout == "[]\n"


def test_reading_needs_neither_numpy_nor_scipy_where_there_are_no_tables() -> None:
    text = "heun: 1\\nbodies: {b: {mass: 1, center: [0, 0, 0], inertia: [0, 0, 0]}}\\n"
    code = (
        f"import sys; from heuncli.scene.file_format.load import load; load('x.yaml', text='{text}'); "
        "print([m for m in ('numpy', 'scipy', 'rich', 'typer') if m in sys.modules])"
    )
    assert subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout == "[]\n"
