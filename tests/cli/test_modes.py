"""`heun modes`: what it writes, and what it refuses."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest

from heuncli.analyses.modes.study import compute_spec_modes
from heuncli.base.errors import HeunError
from heuncli.scene.file_format.load import load
from tests.shared.command import Heun

SCENE = """\
heun: 1
title: A carriage with a pendulum
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0], W: [-1, 0, 0]}}
bodies:
  cart: {mass: 4, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}
  bob: {mass: 1, center: [0, 0, -1], inertia: [0.1, 0.1, 0.1], points: {a: [0, 0, 0], b: [0, 0, -1]}}
joints:
  rail: {type: slide, axis: [1, 0, 0], from: ground.O, to: cart.c}
  hinge: {type: pin, axis: [0, 1, 0], from: cart.c, to: bob.a}
"""
SPECS = sorted((Path(__file__).parents[2] / "specs").glob("*.yaml"))
ASKED = "analysis: {type: state}\n"


def with_force(text: str) -> str:
    return f"{SCENE}forces: {{f: {text}}}\n{ASKED}"


def test_json_keeps_to_the_contract(heun: Heun, folder: Path) -> None:
    spring = "{type: spring, from: ground.W, to: cart.c, stiffness: 90, length: 1}"
    (folder / "cart.yaml").write_text(with_force(spring))
    done = heun("modes", "cart.yaml", "--format", "json")
    found = json.loads(done.stdout)
    assert done.returncode == 0 and found["at"] == "state" and len(found["modes"]) == 2
    for mode in found["modes"]:
        assert {"frequency", "damping", "growth", "shape"} <= mode.keys()
        assert mode["shape"].keys() == {"rail.travel", "hinge.angle"}
        assert max(abs(complex(*x)) for x in mode["shape"].values()) == 1.0
        assert mode["growth"] == 0.0 and mode["damping"] == 0.0 and mode["frequency"] > 0.0
    rows = list(csv.DictReader(io.StringIO(heun("modes", "cart.yaml", "--format", "csv").stdout)))
    told = [float(row["value"]) for row in rows if row["quantity"] == "frequency"]
    assert told == [mode["frequency"] for mode in found["modes"]]


def test_a_table_names_what_is_free_and_what_is_unstable(heun: Heun, folder: Path) -> None:
    (folder / "cart.yaml").write_text(SCENE + ASKED)
    text = heun("modes", "cart.yaml").stdout
    assert "free: rail.travel: no restoring force" in text and "stable, except for unrestrained motions" in text
    (folder / "upright.yaml").write_text(SCENE.replace("center: [0, 0, -1]", "center: [0, 0, 1]") + ASKED)
    text = heun("modes", "upright.yaml").stdout
    assert "\n       unstable\n" in text and "unstable: mode" in text and "divergence" in text


def test_the_whole_thing_driven_has_none(heun: Heun, folder: Path) -> None:
    drives = "drives: {a: {joint: rail, travel: 0}, b: {joint: hinge, angle: 0}}\n"
    (folder / "driven.yaml").write_text(SCENE + drives + ASKED)
    done = heun("modes", "driven.yaml")
    assert done.returncode == 0 and "0 degrees of freedom, so no modes" in done.stdout


def test_a_table_names_the_friction_that_sticks(heun: Heun, folder: Path) -> None:
    frictions = "{rub: {type: friction, joint: rail, force: 10}, grip: {type: friction, joint: hinge, torque: 1}}"
    (folder / "held.yaml").write_text(f"{SCENE}forces: {frictions}\n{ASKED}")
    text = heun("modes", "held.yaml").stdout
    assert "\n       held by friction: forces.rub, forces.grip\n       0 degrees of freedom, so no modes\n" in text
    block = json.loads(heun("modes", "held.yaml", "--format", "json").stdout)
    assert block["held"] == ["forces.rub", "forces.grip"] and block["modes"] == []
    (folder / "half.yaml").write_text(with_force("{type: friction, joint: rail, force: 10}"))
    block = json.loads(heun("modes", "half.yaml", "--format", "json").stdout)
    assert block["held"] == ["forces.f"] and [mode["shape"]["rail.travel"] for mode in block["modes"]] == [[0.0, 0.0]]


# 4e-19 m off the root, where its slope would read as 8e9 N/m
NEAR_A_ROOT = with_force("{type: torque, joint: rail, value: '-10*sqrt(rail.travel + 4e-19)'}")


@pytest.mark.parametrize(
    ("text", "code", "said"),
    [
        (with_force("{type: force, on: bob.b, vector: [sin(t), 0, 0]}"), "no-modes", "forces.f depends on t"),
        (with_force("{type: force, on: bob.b, vector: [1, 0, 0]}"), "not-at-rest", "accelerates"),
        (
            with_force("{type: torque, joint: hinge, value: -3*sign(hinge.rate)}"),
            "no-modes",
            "forces.f has a jump or kink",
        ),
        (
            with_force("{type: torque, joint: hinge, value: -3*abs(hinge.angle)}"),
            "no-modes",
            "forces.f has a jump or kink",
        ),
        (with_force("{type: spring, from: ground.O, to: cart.c, stiffness: 9, length: 1}"), "no-modes", "no direction"),
        (NEAR_A_ROOT, "no-modes", "forces.f has no derivative there"),
    ],
)
def test_refused(text: str, code: str, said: str) -> None:
    with pytest.raises(HeunError) as caught:
        compute_spec_modes(load("scene.yaml", text))
    assert caught.value.problems[0].code == code and said in caught.value.problems[0].message
    assert caught.value.exit_code == 3


@pytest.mark.parametrize(
    "text",
    [
        with_force("{type: torque, joint: hinge, value: -3*hinge.rate*abs(hinge.rate)}"),
        with_force("{type: torque, joint: hinge, value: 'min(0, -hinge.angle**3)'}"),
        with_force("{type: torque, joint: hinge, value: -1e6*hinge.angle**2}"),
        with_force("{type: torque, joint: rail, value: -1e-3*tanh(rail.travel/1e-8)}"),
        with_force("{type: spring, from: ground.O, to: cart.c, stiffness: 9, length: 0}"),
    ],
)
def test_smooth_enough(text: str) -> None:
    """What bends in its second derivative only has a slope."""
    assert len(compute_spec_modes(load("scene.yaml", text)).modes) == 2


def test_a_stretched_chain_is_refused() -> None:
    bar = "{mass: 1, center: [0.5, 0, 0], inertia: [1, 1, 1], points: {a: [0, 0, 0], b: [1, 0, 0]}"
    scene = f"""\
heun: 1
ground: {{points: {{A: [0, 0, 0], B: [2, 0, 0]}}}}
bodies:
  left: {bar}}}
  right: {bar}, position: [1, 0, 0]}}
joints:
  a: {{type: pin, axis: [0, 0, 1], from: ground.A, to: left.a}}
  k: {{type: pin, axis: [0, 0, 1], from: left.b, to: right.a}}
  b: {{type: pin, axis: [0, 0, 1], from: ground.B, to: right.b}}
"""
    with pytest.raises(HeunError) as caught:
        compute_spec_modes(load("scene.yaml", scene))
    assert "can move to first order only" in caught.value.problems[0].message


EXCITED = """
  push: {type: force, on: bob.b, vector: ["3*sin(5*t)", 0, 0]}
  k: {type: spring, from: ground.W, to: cart.c, stiffness: 90, length: 1}
  pull: {type: torque, joint: hinge, value: "cos(5*t)"}
"""


def test_without_what_excites(heun: Heun, folder: Path) -> None:
    """The modes of the scene in which those forces do not stand, to the bit, and what was left out is told."""
    spring = EXCITED.splitlines()[2]
    (folder / "free.yaml").write_text(f"{SCENE}forces:\n{spring}\n{ASKED}")
    (folder / "excited.yaml").write_text(f"{SCENE}forces:{EXCITED}{ASKED}")
    free = json.loads(heun("modes", "free.yaml", "--format", "json").stdout)
    for words in (["--without", "push,pull"], ["--without", "forces.push", "--without", "pull, push"]):
        found = json.loads(heun("modes", "excited.yaml", *words, "--format", "json").stdout)
        assert found.pop("without") == ["forces.push", "forces.pull"] and found == free
    assert "without forces.push, forces.pull\n" in heun("modes", "excited.yaml", "--without", "push,pull").stdout
    refused = heun("modes", "excited.yaml")
    assert refused.returncode == 3 and "--without push,pull leaves out the excitation" in refused.stderr


@pytest.mark.heavy
@pytest.mark.parametrize(
    ("drive", "rests"),
    [
        ("travel: 0.2*sin(20*t)", "travel: 0"),
        ("travel: 0.2*cos(20*t)", "travel: 0.2"),
        ("speed: 0.2*cos(20*t)", "speed: 0"),
        ("speed: 3", "speed: 0"),
    ],
)
@pytest.mark.parametrize("analysis", ["analysis: {type: rest}\n", "analysis: {duration: 1}\n"])
@pytest.mark.third
def test_a_drive_is_held_where_it_starts(heun: Heun, folder: Path, drive: str, rests: str, analysis: str) -> None:
    """A pendulum on a driven cart in a spring to the ground: that of a cart that stands there."""
    head = f"{SCENE}forces: {{k: {{type: spring, from: ground.W, to: bob.b, stiffness: 9, length: 1.5}}}}\n{analysis}"
    for name, value in (("shaken", drive), ("still", rests)):
        (folder / f"{name}.yaml").write_text(f"{head}drives: {{base: {{joint: rail, {value}}}}}\n")
    found = json.loads(heun("modes", "shaken.yaml", "--without", "base", "--format", "json").stdout)
    still = json.loads(heun("modes", "still.yaml", "--format", "json").stdout)
    assert found.pop("without") == ["drives.base"] and found == still
    if "sin" in drive or "cos" in drive:
        refused = heun("modes", "shaken.yaml")
        assert refused.returncode == 3 and "--without base" in refused.stderr


def test_a_name_left_out_is_one_of_the_scene(heun: Heun, folder: Path) -> None:
    drive = "drives: {push: {joint: rail, travel: 0}}\n"
    (folder / "excited.yaml").write_text(f"{SCENE}forces:{EXCITED}{drive}{ASKED}")
    done = heun("modes", "excited.yaml", "--without", "psh,forces.pusch", "--without", "push,rail")
    assert done.returncode == 2 and done.stderr.count("[bad-option]") == 4
    assert "did you mean forces.push?" in done.stderr
    assert "forces.push and drives.push have this name" in done.stderr
    (folder / "bare.yaml").write_text(SCENE + ASKED)
    assert "has no forces or drives" in heun("modes", "bare.yaml", "--without", "push").stderr


@pytest.mark.heavy
def test_a_motion_is_looked_at_about_the_pose_that_rests() -> None:
    """Drawn askew and let go, or looked for: the same pose, hanging, and the same frequencies as drawn so."""
    spring = "forces: {k: {type: spring, from: ground.W, to: cart.c, stiffness: 90, length: 1}}\n"
    drawn = SCENE.replace("b: [0, 0, -1]}}", "b: [0, 0, -1]}, orientation: {axis: [0, 1, 0], angle: 0.4}}") + spring
    hangs = compute_spec_modes(load("scene.yaml", SCENE + spring + ASKED))
    for analysis in ("analysis: {duration: 1, samples: 2}\n", "analysis: {type: rest}\n"):
        found = compute_spec_modes(load("scene.yaml", drawn + analysis))
        assert found.reference == "rest"
        for mode, wanted in zip(found.modes, hangs.modes, strict=True):
            assert abs(mode.frequency - wanted.frequency) <= 1e-12 * wanted.frequency
    with pytest.raises(HeunError) as caught:
        compute_spec_modes(load("scene.yaml", drawn + ASKED))
    assert caught.value.problems[0].code == "not-at-rest" and "type: rest" in str(caught.value.problems[0].hint)


@pytest.mark.parametrize("stiffness", [1e9, 1e13, 1e15])
def test_no_false_digits_beside_what_is_stiff(heun: Heun, folder: Path, stiffness: float) -> None:
    """A pendulum of 0.47529 Hz on a light carriage in an ever stiffer spring keeps its digits: K has them."""
    spring = f"{{type: spring, from: ground.W, to: cart.c, stiffness: {stiffness}, length: 1}}"
    (folder / "stiff.yaml").write_text(with_force(spring).replace("mass: 4", "mass: 0.1"))
    assert " 0.47529" in heun("modes", "stiff.yaml").stdout


@pytest.mark.heavy
@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.stem)
@pytest.mark.sixth
def test_every_spec_has_modes_or_a_reason(heun: Heun, path: Path) -> None:
    done = heun("modes", str(path))
    assert done.returncode == 0 or (done.returncode == 3 and "[no" in done.stderr and not done.stdout)
