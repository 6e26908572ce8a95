"""What cannot be solved is told where it stands in the spec: joint, body, load or stop at fault, by file and line."""

from __future__ import annotations

import re

import pytest

from tests.shared.command import Heun

SOLID = "mass: 1, center: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1], points: {top: [0, 0, 0], end: [1, 0, 0]}"
SCENE = f"""\
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0], P: [3, 0, 0]}}}}
bodies:
  bar: {{{SOLID}}}
joints:
  pivot: {{type: pin, from: ground.O, to: bar.top, axis: [0, 1, 0]}}
"""
BALL = SCENE.replace("type: pin", "type: ball").replace(", axis: [0, 1, 0]", "")
TWO = SCENE.replace("joints:\n", f"  arm: {{{SOLID}}}\njoints:\n")
ELBOW = "  elbow: {type: pin, from: bar.end, to: arm.top, axis: [0, 1, 0]}\n"
TRIANGLE = TWO.replace("P: [3", "P: [2") + ELBOW + "  post: {type: pin, from: ground.P, to: arm.end, axis: [0, 1, 0]}\n"
MOTION = "analysis: {duration: 1, samples: 3}\n"
CASES = [  # the command, the scene, what is told: line, path and code
    ("run", SCENE + "  stay: {type: rod, from: ground.P, to: bar.end, length: 1}\n",
     "8:3: joints.stay: .*does-not-fit"),
    ("run", BALL.replace("bar: {", "bar: {position: [0, 0, 1], "), "7:3: joints.pivot: .*does-not-fit"),
    ("run", SCENE.replace("bar: {", "bar: {position: [0, 0, 1], orientation: {axis: [0, 1, 0], angle: 0}, "),
     "7:3: joints.pivot: .*held-conflict"),
    ("run", BALL.replace("bar: {", "bar: {velocity: [0, 0, 1], angular_velocity: [0, 0, 0], "),
     "7:3: joints.pivot: .*rates-do-not-fit"),
    ("model", SCENE + "  stay: {type: rod, from: ground.O, to: bar.top}\n", "8:3: joints.stay: .*no-length"),
    ("run", BALL.replace("inertia: [0.1, 0.1, 0.1]", "inertia: [0, 0.1, 0.1]")
     + "forces: {twist: {type: couple, on: bar, vector: [1, 0, 0]}}\n",
     "5:3: bodies.bar: .*no-inertia"),
    ("run", SCENE + "forces:\n  ram: {type: actuator, from: ground.O, to: bar.top, value: 5}\n",
     "9:3: forces.ram: .*no-direction"),
    ("run", SCENE + "forces:\n  f: {type: torque, joint: pivot, value: 1/t}\n", "9:42: forces.f.value: .*no-value"),
    ("run", TWO.replace("P: [3", "P: [2.5") + ELBOW + "  stay: {type: rod, from: ground.P, to: arm.end, length: 1}\n"
     "drives:\n  m: {joint: pivot, angle: 2*t}\n" + MOTION, "10:3: joints.stay: .*closure-lost"),
    ("run", TRIANGLE + "drives:\n"
     + "".join(f"  m{k}: {{joint: {j}, angle: 0}}\n" for k, j in enumerate(("pivot", "elbow", "post"))),
     "[789]:3: joints.(pivot|elbow|post): .*over-driven"),
    ("run", SCENE.replace("type: pin", "type: slide") + "analysis: {type: rest}\n"
     "forces: {f: {type: torque, joint: pivot, value: 5}}\n", "7:3: joints.pivot: .*no-rest-pose"),
    ("run", SCENE + "stops:\n  s: {joint: pivot, angle: [1, 2]}\n", "9:3: stops.s: .*beyond-stop"),
    ("modes", SCENE + "forces:\n  f: {type: torque, joint: pivot, value: sin(t)}\n", "9:3: forces.f: .*no-modes"),
    ("modes", SCENE + "analysis: {type: state}\n", "8:1: analysis: .*not-at-rest|7:3: joints.pivot: .*not-at-rest"),
    ("chart", SCENE.replace("type: pin", "type: weld").replace(", axis: [0, 1, 0]", "") + MOTION,
     "8:1: analysis: .*nothing-to-chart"),
    ("probe", BALL.replace("bar: {", "bar: {position: [0, 0, 1], ") + MOTION, "7:3: joints.pivot: .*does-not-fit"),
]  # fmt: skip


@pytest.mark.heavy
@pytest.mark.parametrize(("command", "scene", "told"), CASES, ids=lambda word: word.split(" ")[-1][-24:])
def test_what_cannot_be_solved_is_told_where_it_stands(heun: Heun, command: str, scene: str, told: str) -> None:
    done = heun(command, "-", text=scene)
    first = done.stderr.splitlines()[0]
    assert (done.returncode, done.stdout) == (3, ""), done.stderr
    assert re.match(r"<stdin>:\d+:\d+: ", first) and re.search(rf"<stdin>:.*{told}", first), first
    assert "\n  hint: " in done.stderr
