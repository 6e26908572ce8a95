"""Wheels are drawn as they are: a disc about its axle with spokes, a ball; a body's own shapes stay."""

from __future__ import annotations

import numpy as np

from heuncli.output.machine_geometry.machine import make_machine
from heuncli.scene.file_format.load import load

SCENE = """
heun: 1
ground: {points: {road: [0, 0, 0]}}
bodies:
  disc: {mass: 1, center: [0, 0, 0], inertia: [1, 2, 1], points: {hub: [0.1, 0, 0]}}
  ball: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0.2, 0]}}
  drum: {shapes: [{type: cylinder, from: [0, -1, 0], to: [0, 1, 0], radius: 0.5, mass: 2}], points: {hub: [0, 0, 0]}}
rolling:
  rim: {wheel: disc.hub, axis: [0, 2, 0], radius: 0.3, on: ground.road, normal: [0, 0, 1]}
  foot: {wheel: ball.c, shape: sphere, radius: 0.4, on: ground.road, normal: [0, 0, 1]}
  hoop: {wheel: drum.hub, axis: [0, 1, 0], radius: 0.5, on: ground.road, normal: [0, 0, 1]}
analysis: {duration: 1}
"""


def test_discs_and_balls() -> None:
    """All corners of a disc are as far from its axle as its rim, those of a ball from its centre."""
    disc, ball, drum = make_machine(load("scene.yaml", SCENE)).bodies
    ((rim,), (sphere,), (hull,)) = (body.surfaces for body in (disc, ball, drum))
    away = np.hypot(rim.corners[:, 0] - 0.1, rim.corners[:, 2])
    assert np.all(np.isclose(away, 0.3) | np.isclose(away, 0.0))
    assert np.abs(rim.corners[:, 1]).max() < 0.1 * 0.3
    assert np.allclose(np.linalg.norm(sphere.corners - [0, 0.2, 0], axis=1), 0.4)
    assert np.abs(hull.corners[:, 1]).max() == 1.0
    for body in (disc, drum):
        radius = 0.3 if body is disc else 0.5
        assert [np.linalg.norm(line[1] - line[0]) for line in body.lines[-4:]] == [2 * radius] * 4
    assert ball.lines == ()
