"""Two bars on ball joints that swing in a plane but for one thing, which leaves it by a given part of its size."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from heuncli.multibody.mechanism.build import build
from heuncli.multibody.reduction.compose import Reduction
from heuncli.multibody.reduction.plane.step import step
from heuncli.multibody.tree.prepare import prepare
from heuncli.scene.file_format.load import load

REACH = 4.0  # [m] about: the scene's size, twice the farthest point's distance from the mean of all, and coordinates

SWING = """
heun: 1
gravity: [0, {gravity!r}, -1]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  upper: {{mass: 1, center: [0.0, {center!r}, -0.5], inertia: [1, 1, 0.5], deviation: [{deviation!r}, 0, 0],
          points: {{top: [0, 0, 0], end: [0, 0, -1]}}, position: [0, 0, 0],
          orientation: {{axis: [0, 1, 0], angle: 0}}, angular_velocity: [{turning!r}, 1, 0]}}
  lower: {{mass: 1, center: [0, 0, -0.5], inertia: [1, 1, 0.5], points: {{top: [0, 0, 0], end: [0, 0, -1]}},
          position: [0, 0, -1], orientation: {{axis: [0, 1, 0], angle: 60 deg}}}}
joints:
  pivot: {{type: ball, from: ground.O, to: upper.top}}
  elbow: {{type: universal, axis: [{axis!r}, 1, 0], to_axis: [1, 0, 0], from: upper.end, to: lower.top}}
forces:
  push: {{type: force, on: {{body: lower, at: [0, {at!r}, -1]}}, vector: ["2*t", {force!r}, 1], frame: {frame}}}
  turn: {{type: couple, on: lower, vector: [{couple!r}, 1, 0]}}
impulses: {{blow: {{on: lower.end, vector: [1, {blow!r}, 0], time: 0.5}}}}
analysis: {{duration: 1, samples: 3}}
"""
PARTS = ("gravity", "center", "deviation", "turning", "axis", "at", "force", "couple", "blow")


def swing(**given: Any) -> str:
    """The scene with some of its parts."""
    parts = dict.fromkeys(PARTS, 0.0) | {"frame": "world"} | given
    return SWING.format(**parts)


def judged(text: str) -> str:
    """Whether a scene is flat; else what is told of it."""
    found = step(prepare(build(load("scene.yaml", text), {})))
    if isinstance(found, Reduction):
        return "flat"
    return "told" if found else "in space"


def leaving(part: str) -> Callable[[float], str]:
    """Whether the scene is flat of which one part leaves the plane."""

    def seen(x: float) -> str:
        size = REACH if part in ("center", "at") else 1.0
        return "flat" if judged(swing(**{part: x * size})) == "flat" else "not flat"

    return seen


def drawn_askew(x: float) -> str:
    """A centre and a turn leave the plane by so much: whether that is told."""
    return judged(swing(center=x * REACH, turning=x))
