"""A spec written as MJCF accelerates in MuJoCo as in heun, and moves as before when it is read again."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.output.mjcf import MjcfText, write_mjcf
from heuncli.results.results import Results
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.options import Options
from heuncli.study.model.setup import set_up
from heuncli.study.workflow import solve
from tests.shared.imported import imported
from tests.shared.mjcf_trees import random_tree, words
from tests.shared.scenes import near

mujoco = pytest.importorskip("mujoco", reason="needs the package mujoco: pip install -e '.[test]'")
pytestmark = pytest.mark.heavy
REPORTS = Options(requested_reports=frozenset({"motion", "joints"}))


def exported(spec: Spec) -> MjcfText:
    return write_mjcf(spec, set_up(spec, reduce=False, find_rest=False).scene)


def solved(text: str) -> Results:
    return solve(load("m.yaml", text), REPORTS).results


def compare_with_mujoco(text: str, results: Results) -> int:
    """Compare the first instant of results with MuJoCo at the start of a model; returns the number of bodies."""
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    mujoco.mj_rnePostConstraint(model, data)
    size, seen = float(np.abs(data.qacc).max()), 0
    for body in range(1, model.nbody):
        block = results.bodies[model.body(body).name]
        found, moving = np.zeros(6), np.zeros(6)
        mujoco.mj_objectAcceleration(model, data, mujoco.mjtObj.mjOBJ_BODY, body, found, 0)
        mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_BODY, body, moving, 0)
        near(block["center"][0], data.xipos[body], 10.0, 1e-12)
        near(block["angular_velocity"][0], moving[:3], 10.0, 1e-11)
        near(block["center_velocity"][0], moving[3:], 10.0, 1e-11)
        near(block["angular_acceleration"][0], found[:3], size, 1e-9)
        near(block["center_acceleration"][0], found[3:] + model.opt.gravity, size, 1e-9)
        seen += 1
    return seen


@pytest.mark.parametrize("seed", range(8))
def test_random_models_read_and_written_again_accelerate_in_mujoco_as_in_heun(seed: int) -> None:
    """Stacked joints, balls, free bodies and frames askew: heun's carriers become stacked joints again."""
    rng = np.random.default_rng(400 + seed)
    tree = random_tree(rng, 3 + seed, ("hinge", "slide", "ball", "free"), loads=False)
    model = mujoco.MjModel.from_xml_string(tree.model())
    q, v = np.array(model.qpos0), rng.normal(size=model.nv)
    mujoco.mj_integratePos(model, q, rng.normal(size=model.nv), 1.0)
    rest = f'<keyframe><key name="start" qpos="{words(q)}" qvel="{words(v)}"/></keyframe>'
    text = imported(tree.model(rest=rest), keyframe="start", free=True)
    made = exported(load("tree.yaml", text))
    assert not made.notes
    assert compare_with_mujoco(made.text, solved(text)) > 2


MACHINE = """heun: 1
title: A machine & its <parts>
gravity: [0.5, 0, -9.81]
ground: {points: {o: [0.1, 0.2, 0.3], far: [2, 0, 0], up: [0, 0, 3]}}
bodies:
  swing:
    mass: 2
    center: [0.1, 0.05, -0.3]
    inertia: [[0.1, 0.01, 0], [0.01, 0.12, 0.02], [0, 0.02, 0.09]]
    points: {top: [0.05, 0, 0.02], end: [0, 0.1, -0.6], mark: [0.1, 0.1, 0.1]}
    orientation: {axis: [1, 0.2, 0], angle: 0.4}
  tilted: {mass: 0.5, center: [0.1, 0, 0], inertia: [0.01, 0.02, 0.015], points: {a: [0, 0, 0.1]},
           orientation: {euler: [0.3, -0.5, 0.8], sequence: zyx}}
  sled: {mass: 0.7, center: [0, 0, 0.1], inertia: [0.01, 0.01, 0.01], points: {s: [0.02, 0, 0], u: [0.3, 0, 0.1]},
         orientation: {axis: [1, 2, 3], angle: 40 deg}}
  fan: {mass: 0.3, center: [0, 0.05, 0], inertia: [0.002, 0.003, 0.004], points: {f: [0, 0, 0.1], e: [0.1, 0, 0]}}
  world:
    shapes:
      - {type: box, center: [0, 0, 0.1], size: [0.2, 0.3, 0.1], mass: 3, orientation: {axis: [0, 0, 1], angle: 0.3}}
      - {type: cylinder, from: [0, 0, 0], to: [0.3, 0.1, 0], radius: 20 mm, mass: 0.4}
      - {type: sphere, center: [0, 0.2, 0], radius: 50 mm, mass: 0.2}
    points: {b: [0, 0, 0], c: [0.3, 0.1, 0]}
  bob: {mass: 0.4, center: [0, 0.1, 0], inertia: [0.004, 0.003, 0.004], points: {k: [0, 0, 0.1]}}
  rotor: {mass: 0.6, center: [0.02, 0, 0], inertia: [0.01, 0.02, 0.03], points: {r: [0, 0, 0]}}
  cross: {mass: 0.6, center: [0.02, 0, 0], inertia: [0.01, 0.02, 0.03], points: {r: [0, 0, 0.1]}}
  free: {mass: 1, center: [0.2, 0, 0], inertia: [0.1, 0.12, 0.1], position: [0, 5, 0], velocity: [1, 2, 3],
         orientation: {axis: [0, 1, 0], angle: 0.7}, angular_velocity: [1, -2, 0.5], points: {g: [0, 0, 0.3]}}
joints:
  hinge: {type: pin, from: swing.top, to: ground.o, axis: [1, 0.2, 0], initial: {rate: 2}}
  glue: {type: weld, from: swing.end, to: tilted.a}
  rail: {type: slide, from: sled.s, to: swing.end, axis: [0.1, 0, 1], initial: {speed: 0.3, travel: 0.1}}
  skew: {type: pin, from: sled.s, to: fan.f, axis: [0, 0, 1], to_axis: [0, 0.6, 0.8], initial: {rate: -1}}
  foot: {type: slide, from: ground.far, to: world.b, axis: [1, 0, 0], initial: {travel: -2}}
  knob: {type: ball, from: bob.k, to: world.c}
  screw: {type: cylinder, from: free.g, to: rotor.r, axis: [0, 1, 1],
          initial: {angle: 0.4, rate: 3, travel: 0.05, speed: 0.2}}
  cardan: {type: universal, from: cross.r, to: fan.e, axis: [0, 0, 1], to_axis: [1, 0, 0]}
forces:
  drag: {type: damper, joint: hinge, coefficient: 0.4}
  slow: {type: damper, joint: rail, coefficient: 3}
  loose: {type: damper, joint: knob, coefficient: 0.02}
  both: {type: damper, joint: screw, coefficient: 0.1, sliding: 2}
  coil: {type: turn_spring, joint: hinge, stiffness: 5, angle: 0.3, damping: 0.1}
  coil_2: {type: turn_spring, joint: hinge, stiffness: 2, angle: -1}
  twist: {type: turn_spring, joint: screw, stiffness: 2, angle: -1}
  pull: {type: spring, from: world.c, to: swing.mark, stiffness: 30, length: 0.2, damping: 2}
  push: {type: force, on: world.c, vector: [0, 0, 1]}
stops: {travel: {joint: foot, travel: [-3, 2]}}
analysis: {duration: 0.2, samples: 3, tolerance: 1e-10}
"""
PUSH = "  push: {type: force, on: world.c, vector: [0, 0, 1]}\n"


def compare_motion(text: str, bodies: tuple[str, ...], tolerance: float = 1e-8) -> MjcfText:
    """Compare the motion of a spec with that of the spec that its MJCF is read as."""
    made = exported(load("m.yaml", text))
    again = imported(made.text, free=True, keyframe="start")
    one, other = solved(text), solved(again + "\nanalysis: {duration: 0.2, samples: 3, tolerance: 1e-10}\n")
    for name in bodies:
        near(other.bodies[name]["center"], one.bodies[name]["center"], 3.0, tolerance)
        near(other.bodies[name]["center_velocity"], one.bodies[name]["center_velocity"], 3.0, 10 * tolerance)
        near(other.bodies[name]["angular_velocity"], one.bodies[name]["angular_velocity"], 3.0, 10 * tolerance)
    return made


def test_every_joint_and_load_that_mjcf_knows_acts_in_mujoco_as_in_heun() -> None:
    text = MACHINE.replace(PUSH, "")
    made = compare_motion(text, ("swing", "sled", "fan", "bob", "rotor", "cross", "free", "tilted"))
    results = solved(text)
    results.bodies["world_"] = results.bodies["world"]  # MuJoCo keeps the name for its ground
    assert compare_with_mujoco(made.text, results) == 9
    assert made.notes == ("MuJoCo's limits are soft, without the restitution of stops",)
    assert exported(load("m.yaml", MACHINE)).notes[0] == "forces left out: push"
    model = mujoco.MjModel.from_xml_string(made.text)
    assert model.ngeom == 3 and model.site("swing.mark").pos.tolist() == [0.1, 0.1, 0.1]
    near(model.joint("foot").range, [-3, 2], 1.0, 0.0)


LOOSE = """heun: 1
gravity: [0.5, 0, -9.81]
ground: {points: {far: [2, 0, 0], up: [0, 0, 3]}}
bodies:
  bead: {mass: 0.6, center: [0.02, 0.1, 0], inertia: [0.01, 0.02, 0.02], points: {k: [0, 0, 0.1], k2: [0.1, 0, 0.3]},
         near: {position: [0.4, 0.2, 2.9], orientation: {axis: [1, 1, 0], angle: 0.4}}, angular_velocity: [1, 0.5, -2]}
  pole: {mass: 0.6, center: [0, 0.1, 0], inertia: [0.01, 0.02, 0.02], points: {a: [0, 0, 0.1]},
         near: {position: [2, 0, 0.3], orientation: {axis: [1, 1, 0], angle: 0.3}}, angular_velocity: [1, 0.5, -2]}
  foot_2: {mass: 0.6, center: [0.02, 0.1, 0], inertia: [0.01, 0.02, 0.02], points: {k: [0, 0.2, 0.1]},
         near: {position: [2, 1, 0]}, angular_velocity: [1, 2, -2]}
  plate: {mass: 0.6, center: [0.02, 0.1, 0], inertia: [0.01, 0.02, 0.02], points: {a: [0, 0.2, 0.1]},
         near: {position: [0, 0, 3]}, angular_velocity: [0.3, 0.2, -1]}
joints:
  thread: {type: line, from: ground.up, to: bead.k, axis: [1, 0.5, 0]}
  mast: {type: line, from: pole.a, to: ground.far, axis: [0.2, 0, 1]}
  slab: {type: plane, from: ground.far, to: foot_2.k, normal: [0.1, 0, 1]}
  lid: {type: plane, from: plate.a, to: bead.k2, normal: [0, 1, 0.2]}
analysis: {duration: 0.2, samples: 3, tolerance: 1e-10}
"""


def test_points_on_lines_and_planes_slide_and_turn_in_mujoco_as_in_heun() -> None:
    made = compare_motion(LOOSE, ("bead", "pole", "foot_2", "plate"))
    assert compare_with_mujoco(made.text, solved(LOOSE)) == 4


CLOSED = (
    MACHINE.replace(PUSH, "")
    .replace(
        "  hinge: {",
        """  strut: {type: rod, from: ground.up, to: world.c}
  loop: {type: pin, from: ground.o, to: arm.a, axis: [0, 1, 0]}
  hook: {type: pin, from: link.a, to: arm.b, axis: [0, 1, 0]}
  close: {type: pin, from: link.b, to: ground.far, axis: [0, 1, 0]}
  door: {type: pin, from: ground.up, to: leaf.a, axis: [0, 0, 1], initial: {angle: 0.2}}
  door_2: {type: slide, from: ground.up, to: wing.a, axis: [0, 0, 1]}
  hinge: {""",
    )
    .replace(
        "  free:",
        """  arm: {mass: 1, center: [0.3, 0, 0], inertia: [0.1, 0.1, 0.1], points: {a: [0, 0, 0], b: [0.6, 0, 0]},
        near: {position: [0.1, 0.2, 0.3], orientation: {axis: [0, 1, 0], angle: -1}}}
  link: {mass: 1, center: [0.8, 0, 0], inertia: [0.1, 0.1, 0.1], points: {a: [0, 0.2, 0], b: [1.7, 0, 0]},
        near: {position: [0.5, 0, 0.8]}}
  leaf: {mass: 1, center: [0.3, 0, 0], inertia: [0.1, 0.1, 0.1], points: {a: [0, 0, 0]}}
  wing: {mass: 1, center: [0.3, 0, 0], inertia: [0.1, 0.1, 0.1], points: {a: [0, 0, 0]}}
  free:""",
    )
    .replace("stops:", "couplings: {gear: {type: ratio, of: [door, door_2], factors: [1, -2]}}\nstops:")
)


def test_loops_and_ratios_are_equalities_that_are_read_again() -> None:
    made = compare_motion(CLOSED, ("world", "arm", "link", "leaf", "wing"))
    assert any("equalities softly" in note for note in made.notes)
    assert any("pins that close loops" in note for note in made.notes)
    model = mujoco.MjModel.from_xml_string(made.text)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    near(np.array(data.efc_pos)[: data.ne], np.zeros(data.ne), 1.0, 1e-9)
    assert data.ne == 6 + 1 + 1  # a pin, the strut, the gear


ON_A_RAIL = """heun: 1
gravity: [0, 0, -9.81]
ground: {points: {o: [0, 0, 0], rail: [0.2, 0, 0.1]}}
bodies:
  crank: {mass: 1, center: [0.1, 0, 0], inertia: [0.01, 0.02, 0.02], points: {a: [0, 0, 0], b: [0.3, 0, 0]},
          orientation: {axis: [0, 1, 0], angle: -40 deg}}
  block: {mass: 2, center: [0, 0, 0.05], inertia: [0.02, 0.03, 0.04], points: {s: [0.1, 0, 0], e: [0, 0.05, 0.02]},
          position: [1.1, 0, 0.1]}
  flag: {mass: 0.1, center: [0, 0, 0.1], inertia: [0.001, 0.001, 0.001], points: {f: [0, 0, 0], g: [0, 0, 0.2]}}
joints:
  shaft: {type: pin, from: ground.o, to: crank.a, axis: [0, 1, 0], initial: {rate: 3}}
  guide: {type: line, from: ground.rail, to: block.s, axis: [1, 0, 0]}
  mast: {type: pin, from: block.e, to: flag.f, axis: [0, 1, 0], initial: {rate: 1}}
  coupler: {type: rod, from: crank.b, to: flag.g}
analysis: {duration: 0.2, samples: 3, tolerance: 1e-10}
"""


@pytest.mark.parametrize("ends", ["from: ground.rail, to: block.s", "from: block.s, to: ground.rail"])
def test_a_rod_to_what_slides_on_a_line_keeps_its_length(ends: str) -> None:
    """MuJoCo counts its length from where all joints are at 0: on a line, that is where the point starts."""
    text = ON_A_RAIL.replace("from: ground.rail, to: block.s", ends)
    made = exported(load("m.yaml", text))
    model = mujoco.MjModel.from_xml_string(made.text)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    assert data.ne == 1
    near([data.efc_pos[0], data.efc_vel[0]], [0.0, 0.0], 1.0, 1e-12)
    if ends.startswith("from: ground"):
        compare_motion(text, ("crank", "block", "flag"))
    else:  # of a ball in a loop the file's rates are not read
        again = imported(made.text, free=True, keyframe="start")
        assert "its start velocities follow from its constraints" in again
        results = solved(again + "\nanalysis: {type: state}\n")
        near(results.bodies["flag"]["center"][0], solved(text).bodies["flag"]["center"][0], 1.0, 1e-9)


FOUR_BAR = """heun: 1
space: planar
ground: {points: {o: [0, 0], p: [3, 0]}}
bodies:
  crank: {mass: 1, center: [0.5, 0], inertia: 0.1, points: {a: [0, 0], b: [1, 0]},
          orientation: {axis: [0, 0, 1], angle: 60 deg}}
  link: {mass: 1, center: [1.5, 0], inertia: 0.3, points: {a: [0, 0], b: [3, 0]}}
  rocker: {mass: 1, center: [0.9, 0], inertia: 0.2, points: {a: [0, 0], b: [1.8, 0]},
           near: {orientation: {axis: [0, 0, 1], angle: 80 deg}}}
joints:
  one: {type: pin, from: ground.o, to: crank.a}
  two: {type: pin, from: crank.b, to: link.a}
  three: {type: pin, from: link.b, to: rocker.b}
  four: {type: pin, from: rocker.a, to: ground.p}
analysis: {duration: 0.2, samples: 3, tolerance: 1e-10}
"""


ROD = """heun: 1
gravity: [0, 0, -9.81]
ground: {points: {o: [0, 0, 0]}}
bodies: {a: {mass: 1, center: [0.5, 0, 0], inertia: [0, 0.1, 0.1], points: {p: [0, 0, 0]}, angular_velocity: [0, 1, 2]}}
joints: {j: {type: ball, from: ground.o, to: a.p}}
analysis: {type: state}
"""


def test_thin_rods_and_point_masses_get_moments_that_change_nothing() -> None:
    point = ROD.replace("[0, 0.1, 0.1]", "[0, 0, 0]")
    for text in (ROD, point):
        made = exported(load("m.yaml", text))
        assert any("small ones in the file, as MuJoCo refuses 0: a" in note for note in made.notes)
        assert compare_with_mujoco(made.text, solved(text)) == 1


def test_what_acts_in_a_joint_is_not_lost_where_it_could_close_the_loop() -> None:
    """A joint with a damper, a spring, a stop or a ratio is in the tree, where MJCF can say it; the rest is noted."""
    last = "  four: {type: pin, from: rocker.a, to: ground.p}\n"
    loads = """forces:
  rub: {type: damper, joint: three, coefficient: 2}
  coil: {type: turn_spring, joint: three, stiffness: 3, angle: 0.2}
stops: {end: {joint: three, angle: [-3, 3]}}
"""
    made = compare_motion(FOUR_BAR.replace(last, last + loads), ("crank", "link", "rocker"))
    assert 'name="three" type="hinge"' in made.text and 'damping="2.0" stiffness="3.0"' in made.text
    all_loaded = "".join(f"  rub_{k}: {{type: damper, joint: {k}, coefficient: 2}}\n" for k in ("one", "two", "four"))
    text = FOUR_BAR.replace(last, last + loads.replace("stops:", f"{all_loaded}stops:"))
    (note,) = [note for note in exported(load("m.yaml", text)).notes if "forces left out" in note]
    assert "rub" in note


def test_a_planar_machine_is_closed_by_points_and_a_weld_by_one() -> None:
    made = compare_motion(FOUR_BAR, ("crank", "link", "rocker"))
    assert made.text.count("<connect") == 1 and "planar" in made.notes[0]
    tip = "  tip: {mass: 1, center: [0, 0.1], inertia: 0.1, points: {a: [0, 0]}, near: {position: [3, 1.8]}}\njoints:"
    weld = "  five: {type: weld, from: link.b, to: tip.a}\n  three: {type: pin, from: tip.a"
    welded = FOUR_BAR.replace("joints:", tip).replace("  three: {type: pin, from: link.b", weld)
    assert compare_motion(welded, ("crank", "link", "rocker", "tip")).text.count("<weld") == 1


@pytest.mark.parametrize(("old", "new", "said"), [
    ("type: ball", "type: cv, axis: [0, 0, 1]", "joint knob (cv) has no counterpart in MJCF"),
    ("type: ratio, of: [door, door_2], factors: [1, -2]", "type: screw, of: [door, door_2], lead: 0.1",
     "a coupling of type screw"),
    ("  bob: {mass: 0.4, center: [0, 0.1, 0], inertia: [0.004, 0.003, 0.004]", "  bob: {mass: 0, center: [0, 0, 0.1],"
     " inertia: [0, 0, 0]", "body bob has no mass"),
])  # fmt: skip
def test_what_mjcf_cannot_say_is_refused_at_its_place(old: str, new: str, said: str) -> None:
    spec = load("m.yaml", CLOSED.replace(old, new))
    with pytest.raises(SpecError) as refused:
        exported(spec)
    problem = refused.value.problems[0]
    assert problem.code == "export-mjcf" and said in problem.message and problem.hint
    assert problem.location is not None and problem.location.line > 1
