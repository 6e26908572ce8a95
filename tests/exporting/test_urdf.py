"""A spec written as URDF and read again moves as before; what URDF cannot say is refused by name or noted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.output.urdf import UrdfText, write_urdf
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.options import Options
from heuncli.study.model.setup import set_up
from heuncli.study.workflow import solve
from tests.shared.command import Heun
from tests.shared.imported import described, imported
from tests.shared.scenes import near
from tests.shared.urdf_trees import MOVED, random_robot, urdf_text

REPORTS = frozenset({"motion", "joints"})


def exported(spec: Spec) -> UrdfText:
    return write_urdf(spec, set_up(spec, reduce=False, find_rest=False).scene)


@pytest.mark.parametrize("seed", range(10))
def test_a_robot_that_is_written_and_read_again_holds_itself_with_the_same_efforts(seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot = random_robot(rng, 3 + 2 * seed, right=seed % 3 == 2)
    q = {part.name: float(rng.uniform(-2, 2)) for part in robot.movable}
    values = {f"to_{name}": f"{value!r}" for name, value in q.items()}
    first = imported(urdf_text(robot))
    again = imported(exported(load("robot.yaml", first)).text)
    one = solve(load("r.yaml", first, overrides=values), Options(requested_reports=REPORTS)).results
    moved = {name: next(iter(block.values()))[0] for name, block in one.coordinates.items()}  # followers, too
    overrides = {name: f"{float(value)!r}" for name, value in moved.items()}
    other = solve(load("r.yaml", again, overrides=overrides), Options(requested_reports=REPORTS)).results
    size = max(float(np.abs(block["center"]).max()) for block in one.bodies.values()) + 3.0
    for name, block in one.bodies.items():
        near(other.bodies[name]["center"], block["center"], size, 1e-12)
        near(other.bodies[name]["center_acceleration"], block["center_acceleration"], 1.0, 1e-9)
    efforts = {part.joint: one.joints[part.joint]["drive"][0] for part in robot.parts if part.kind in MOVED}
    largest = max(map(abs, efforts.values()), default=0.0) + 1.0
    for joint, effort in efforts.items():
        near(other.joints[joint]["drive"][0], effort, largest, 1e-11)


MACHINE = """heun: 1
title: A machine & its <parts>
gravity: [0, 0, -9.81]
ground: {points: {o: [0.1, 0.2, 0.3], far: [2, 0, 0]}}
bodies:
  swing:
    mass: 2
    center: [0.1, 0.05, -0.3]
    inertia: [[0.1, 0.01, 0], [0.01, 0.12, 0.02], [0, 0.02, 0.09]]
    points: {top: [0.05, 0, 0.02], end: [0, 0.1, -0.6], mark: [0.1, 0.1, 0.1]}
    orientation: {axis: [1, 0.2, 0], angle: 0.4}
  tilted: {mass: 0.5, center: [0.1, 0, 0], inertia: [0.01, 0.02, 0.015], points: {a: [0, 0, 0.1]},
           orientation: {euler: [0.3, -0.5, 0.8], sequence: zyx}}
  sled: {mass: 0.7, center: [0, 0, 0.1], inertia: [0.01, 0.01, 0.01], points: {s: [0.02, 0, 0]},
         orientation: {axis: [1, 2, 3], angle: 40 deg}}
  fan: {mass: 0.3, center: [0, 0.05, 0], inertia: [0.002, 0.003, 0.004], points: {f: [0, 0, 0.1]}}
  base:
    shapes:
      - {type: box, center: [0, 0, 0.1], size: [0.2, 0.3, 0.1], mass: 3, orientation: {axis: [0, 0, 1], angle: 0.3}}
      - {type: cylinder, from: [0, 0, 0], to: [0.3, 0.1, 0], radius: 20 mm, mass: 0.4}
      - {type: sphere, center: [0, 0.2, 0], radius: 50 mm, mass: 0.2}
    points: {b: [0, 0, 0], c: [0.3, 0.1, 0]}
  free: {mass: 1, center: [0.2, 0, 0], inertia: [0.1, 0.1, 0.1], position: [0, 5, 0],
         orientation: {axis: [0, 1, 0], angle: 0.7}}
joints:
  hinge: {type: pin, from: swing.top, to: ground.o, axis: [1, 0.2, 0]}
  glue: {type: weld, from: swing.end, to: tilted.a}
  rail: {type: slide, from: sled.s, to: swing.end, axis: [0.1, 0, 1]}
  skew: {type: pin, from: sled.s, to: fan.f, axis: [0, 0, 1], to_axis: [0, 0.6, 0.8]}
  foot: {type: slide, from: ground.far, to: base.b, axis: [1, 0, 0]}
forces:
  drag: {type: damper, joint: hinge, coefficient: 0.4}
  slow: {type: damper, joint: rail, coefficient: 3}
  push: {type: force, on: base.c, vector: [0, 0, 1]}
stops: {travel: {joint: foot, travel: [-3, 2]}}
analysis: {duration: 0.4, samples: 5, tolerance: 1e-10}
"""


def test_a_machine_with_joints_either_way_and_turned_bodies_moves_as_before() -> None:
    text = MACHINE.replace("  push: {type: force, on: base.c, vector: [0, 0, 1]}\n", "")
    made = exported(load("m.yaml", text))
    again = imported(made.text, free=True) + "\nanalysis: {duration: 0.4, samples: 5, tolerance: 1e-10}\n"
    one = solve(load("m.yaml", text), Options(requested_reports=REPORTS)).results
    start = {name: f"{float(next(iter(block.values()))[0])!r}" for name, block in one.coordinates.items()}
    assert abs(float(start["hinge"]) + 0.4) < 1e-12  # of the ground in the axes of the swing
    other = solve(load("m.yaml", again, overrides=start), Options(requested_reports=REPORTS)).results
    for name in ("swing", "sled", "fan", "base", "free"):
        near(other.bodies[name]["center"], one.bodies[name]["center"], 3.0, 1e-8)
        near(other.bodies[name]["center_velocity"], one.bodies[name]["center_velocity"], 3.0, 1e-7)
    assert "forces left out" not in made.text and '<limit lower="-3.0" upper="2.0"' in made.text


def test_shapes_points_and_what_is_left_out_stand_in_the_file() -> None:
    made = exported(load("m.yaml", MACHINE))
    assert made.notes == (
        "forces left out: push",
        "URDF needs limits of slides: 1e+16 m stands for none: rail",
        "start coordinates left out: hinge, foot, rail",
    )
    assert made.text.count("<visual>") == 3 and '<box size="0.2 0.3 0.1"/>' in made.text
    assert '<link name="swing.mark"/>' in made.text and '<link name="swing.top"/>' not in made.text
    machine = described(made.text)
    assert machine.title == "A machine + its (parts)"
    before, _, rest = made.text.partition('<link name="base">')
    bare = before + '<link name="base">' + rest.partition("</inertial>")[2]
    masses = described(bare, density=1000.0)
    (base,) = [body for body in masses.bodies if body.name == "base"]
    cylinder = next(shape.keys for shape in base.shapes if shape.keys["type"] == "cylinder")
    ends = sorted([cylinder["from"], cylinder["to"]])
    near(np.array(ends), np.array([[0, 0, 0], [0.3, 0.1, 0]]), 0.3, 1e-12)


@pytest.mark.parametrize(("old", "new", "words"), [
    ("type: weld", "type: ball", "a joint of type ball has no counterpart"),
    ("  foot: {", "  loop: {type: pin, from: swing.top, to: ground.o, axis: [1, 0.2, 0]}\n  foot: {", "closes a loop"),
    ("stops:", "couplings: {g: {type: ratio, of: [hinge, skew], factors: [1, 2]}}\nstops:", "a coupling of type ratio"),
])  # fmt: skip
def test_what_urdf_cannot_say_is_refused_at_its_place(old: str, new: str, words: str) -> None:
    spec = load("m.yaml", MACHINE.replace(old, new))
    with pytest.raises(SpecError) as refused:
        exported(spec)
    problem = refused.value.problems[0]
    assert problem.code == "export-urdf" and words in problem.message and problem.hint
    assert problem.location is not None and problem.location.line > 1


def test_a_planar_model_is_written_with_a_note() -> None:
    text = """heun: 1
space: planar
bodies: {b: {mass: 1, center: [0, 0], inertia: 0.1, points: {p: [0, 0]}}}
ground: {points: {o: [0, 0]}}
joints: {j: {type: pin, from: ground.o, to: b.p}}
"""
    made = exported(load("m.yaml", text))
    assert 'type="continuous"' in made.text and "planar" in made.notes[-1]


def test_a_body_called_world_stays_a_body() -> None:
    text = MACHINE.replace("base", "world")
    assert [body.name for body in described(exported(load("m.yaml", text)).text).bodies].count("world") == 1


def test_slides_without_stops_get_none_when_read_again() -> None:
    stops = described(exported(load("m.yaml", MACHINE)).text, free=True, limits=True).stops
    assert [(stop.keys["joint"], stop.keys["travel"]) for stop in stops] == [("foot", (-3.0, 2.0))]


def test_a_damper_with_a_law_is_left_out_and_said() -> None:
    made = exported(load("m.yaml", MACHINE.replace("coefficient: 0.4", 'torque: "-2*rate*abs(rate)"')))
    assert "forces left out: drag, push" in made.notes and made.text.count("damping=") == 1


def test_start_values_and_names_that_are_taken_are_not_lost() -> None:
    text = MACHINE.replace("axis: [1, 0.2, 0]}", "axis: [1, 0.2, 0], initial: {rate: 2}}", 1)
    text = text.replace("[0, 5, 0],", "[0, 5, 0], velocity: [1, 0, 0],").replace("  glue:", "  free_free:")
    for old, new in (("tilted", "world"), ("sled", "world_"), ("fan", "world__")):
        text = text.replace(old, new)
    made = exported(load("m.yaml", text))
    assert made.notes[2:] == (
        "start coordinates left out: hinge, foot, rail",
        "start velocities left out: swing, world, world_, world__, free",
    )
    assert '<link name="world___"/>' in made.text and '<joint name="free_free_" type="floating">' in made.text
    assert len(described(made.text).bodies) == 6
    endless = "URDF needs limits of slides: 1e+16 m stands for none: one"
    still = "bodies:{}joints: {{one: {{type: slide, from: ground.o, to: b.p, axis: [1, 0, 0]}}}}\n".format(
        " {b: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {p: [0, 0, 0]}}}\n"
    )
    for place, notes in (("0", (endless,)), ("2", (endless, "start coordinates left out: one"))):
        ground = f"ground: {{points: {{o: [{place}, 0, 0]}}}}\n"
        assert exported(load("m.yaml", f"heun: 1\ngravity: [0, 0, -9.81]\n{ground}{still}")).notes == notes


def test_the_command_writes_the_file_and_says_what_is_left_out(heun: Heun, tmp_path: Path) -> None:
    spec, out = tmp_path / "m.yaml", tmp_path / "m.urdf"
    spec.write_text(MACHINE)
    done = heun("export", "urdf", str(spec), "-o", str(out))
    assert done.returncode == 0 and "forces left out: push" in done.stderr and not done.stdout
    assert heun("import", str(out)).returncode == 0
    for option in (("--body", "fan"), ("--at", "0"), ("--units", "N,mm,t"), ("--case", "all")):
        refused = heun("export", "urdf", str(spec), *option)
        assert refused.returncode == 2 and "bad-option" in refused.stderr, option
