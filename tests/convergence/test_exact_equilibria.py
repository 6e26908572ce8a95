"""Motions that stay exactly in equilibrium between drives and loads take few steps: only rounding moves them."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.motion.integration.run.request import MotionTask
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up

DISH = """
heun: 1
parameters: {{n: {rate} rad/s, beta: 30 deg}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  fork: {{mass: {frame}, center: [0, 0, 0], inertia: [{frame}, {frame}, {frame}], points: {{o: [0, 0, 0]}}}}
  ring: {{mass: {frame}, center: [0, 0, 0], inertia: [{frame}, {frame}, {frame}], points: {{o: [0, 0, 0]}}}}
  dish: {{mass: 10, center: [0, 0, 0], inertia: [2, 2, 3], points: {{o: [0, 0, 0]}}}}
joints:
  yaw: {{type: pin, from: ground.O, to: fork.o, axis: [0, 0, 1]}}
  pitch: {{type: pin, from: fork.o, to: ring.o, axis: [0, 1, 0]}}
  roll: {{type: pin, from: ring.o, to: dish.o, axis: [1, 0, 0], initial: {{rate: 0}}}}
drives: {{turn: {{joint: yaw, rate: n}}, tilt: {{joint: pitch, angle: beta}}}}
forces:
  spring: {{type: turn_spring, joint: roll, stiffness: {stiffness}}}
  {more}
analysis: {{duration: 2, samples: 5}}
"""


def dish(rate: float = 1.5, frame: float = 0.0, stiffness: float = 50.0, more: str = "") -> str:
    """A dish on three axes, driven about the first two; the spring of the third holds it at angle 0."""
    return DISH.format(rate=rate, frame=frame, stiffness=stiffness, more=more)


# A pendulum that hangs inwards on a rotor: the equilibrium is unstable.
ROTOR = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  arm: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0], p: [0.7, 0, 0]}}
  bob: {mass: 3, center: [-0.3, 0, 0], inertia: [0.1, 0.2, 0.3], points: {o: [0, 0, 0]}}
joints:
  hub: {type: pin, from: ground.O, to: arm.o, axis: [0, 0, 1]}
  swing: {type: pin, from: arm.p, to: bob.o, axis: [0, 0, 1], initial: {rate: 0}}
drives: {d: {joint: hub, rate: 7 rad/s}}
analysis: {duration: 0.2, samples: 5}
"""
SPRINGS = """
heun: 1
ground: {points: {O: [0, 0, 0], L: [-1.1, 0, 0], R: [1.1, 0, 0]}}
bodies: {b: {mass: 3, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0], l: [-0.1, 0, 0], r: [0.3, 0, 0]}}}
joints: {s: {type: slide, from: ground.O, to: b.o, axis: [1, 0, 0]}}
forces:
  a: {type: spring, from: ground.L, to: b.l, stiffness: 7.7e6, length: 0.9}
  c: {type: spring, from: ground.R, to: b.r, stiffness: 7.7e6, length: 0.7}
analysis: {duration: 0.2, samples: 5}
"""
FORCES = """
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{b: {{mass: 3, center: [0, 0, 0], inertia: [1, 1, 1], points: {{o: [0, 0, 0]}}}}}}
joints: {{s: {{type: slide, from: ground.O, to: b.o, axis: [1, 0.3, 0]}}}}
forces:
{forces}
analysis: {{duration: 0.2, samples: 5}}
"""


def star(size: str) -> str:
    """Seven turning forces in balance."""
    angles = [f"{k}*2*pi/7 + 0.3 + t" for k in range(7)]
    lines = [
        f'  f{k}: {{type: force, on: b.o, vector: ["{size}*cos({a})", "{size}*sin({a})", 0]}}'
        for k, a in enumerate(angles)
    ]
    return FORCES.format(forces="\n".join(lines))


RUB = "rub: {type: friction, joint: roll, torque: 3, speed: 1e-2}"
SCENES = {
    "dish": (dish(), 20),
    "dish, light frames": (dish(frame=1e-3), 20),
    "dish, fast": (dish(rate=1e3), 400),  # 2000 rad
    "dish, unstable": (dish(stiffness=0.5), 20),
    "dish, smoothed friction": (dish(more=RUB), 60),
    "dish, friction that sticks": (dish(more="rub: {type: friction, joint: roll, torque: 3}"), 20),
    "rotor": (ROTOR, 10),
    "springs": (SPRINGS, 150),  # 450 rad of its own oscillation
    "forces": (star("1e6"), 20),
    "forces that rise from 0": (star("1e6*sin(t)"), 30),
}


@pytest.mark.parametrize("name", SCENES)
def test_what_rests_between_drives_and_loads_takes_few_steps(name: str) -> None:
    """In units of rounding they took 200 to 1,000,000."""
    text, most = SCENES[name]
    setup = set_up(load("scene.yaml", text))
    last = 2.0 if "duration: 2" in text else 0.2
    run = setup.runner.run(MotionTask(np.linspace(0.0, last, 5), 1e-10))
    assert run.steps <= most
    assert np.abs(run.states[:, 0]).max() < 1e-6
