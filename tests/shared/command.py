"""Specs to run commands on, and what a command leaves behind when it runs in this process."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

HANGING = """\
heun: 1
title: A bar hangs at rest
gravity: [0, 0, -9.81]
parameters: {m: 1.0}
ground: {points: {O: [0, 0, 0]}}
bodies:
  bar: {mass: m, center: [0, 0, -0.5], inertia: [0.08, 0.08, 0.001], points: {top: [0, 0, 0]}}
joints:
  pivot: {type: ball, from: ground.O, to: bar.top}
"""
TURNED = HANGING.replace("top: [0, 0, 0]}", "top: [0, 0, 0]}, orientation: {axis: [1, 0, 0], angle: 60 deg}")
SPEC_TEXTS = {
    "hanging": HANGING,
    "swinging": TURNED + "analysis: {duration: 1, samples: 11}\n",
    "long": TURNED + "analysis: {duration: 100000, samples: 11}\n",
    "expecting": HANGING + "expect:\n  - {of: joints.pivot.force.z, is: 9.81, rel: 1e-9}\n",
    "failing": HANGING + "expect:\n  - {of: joints.pivot.force.z, is: 9.7, rel: 1e-9}\n",
    "wrong": HANGING.replace("type: ball", "type: bal").replace("mass: m", "mas: m"),
    "unbound": HANGING.replace("to: bar.top", "to: bar.tip"),
    "held": HANGING.replace("top: [0, 0, 0]}", "top: [0, 0, 0]}, position: [0, 0, 1]"),
    "unsound": HANGING.replace("[0.08, 0.08, 0.001]", "[0.0801, 0.08, 0.00005]"),
}


class Done(NamedTuple):
    """What a command left behind."""

    returncode: int
    stdout: str
    stderr: str


Heun = Callable[..., Done]
