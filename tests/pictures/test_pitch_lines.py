"""Pitch circles and lines stand where wheels meet, in their bodies' axes; belts run as their pulleys turn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from heuncli.output.machine_geometry.discs import make_pitch_geometry
from heuncli.output.machine_geometry.machine import make_machine
from heuncli.scene.file_format.load import load

SCENE = """heun: 1
ground: {points: {O: [0, 0, 0], G: [0, -0.05, 0]}}
bodies:
  pinion: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}
  rack: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {g: [0.1, 0.2, 0.3]}TURNED}
joints:
  pin: {type: pin, from: ground.O, to: pinion.c, axis: [0, 0, 1]}
  way: {type: slide, from: ground.G, to: rack.g, axis: [1, 0, 0]}
couplings: {teeth: {type: gear, of: [pin, way], ratio: 25}}
analysis: {duration: 1}
"""
RING = """heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  arm: {mass: 1, center: [0, 0, 0], inertia: [1e-4, 1e-4, 1e-4], points: {o: [0, 0, 0], p: [0.1, 0, 0]}}
  planet: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}
joints:
  out: {type: pin, from: ground.O, to: arm.o, axis: [0, 0, 1]}
  pivot: {type: pin, from: arm.p, to: planet.o, axis: [0, 0, 1]}
couplings: {ring: {type: gear, of: [pivot, out], teeth: [20, 60], internal: true}}
analysis: {duration: 1}
"""
BELT = """heun: 1
ground: {points: {A: [0, 0, 0], B: [1, 0, 0]}}
bodies:
  one: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}
  two: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}
joints:
  a: {type: pin, FIRST, axis: [0, 0, 1]}
  b: {type: pin, from: ground.B, to: two.o, axis: [0, 0, 1]}
couplings: {belt: {type: belt, of: [a, b], radii: [0.1, 0.2], pretension: 1}}
analysis: {duration: 1}
"""


@pytest.mark.parametrize("turned", ["", ", orientation: {axis: [0, 0, 1], angle: 90 deg}"])
def test_a_racks_line_touches_the_wheels_circle(tmp_path: Path, turned: str) -> None:
    (tmp_path / "a.yaml").write_text(SCENE.replace("TURNED", turned))
    found = make_pitch_geometry(load(tmp_path / "a.yaml"))
    (disc,), (line,) = found.discs["pinion"], found.racks["rack"]
    radius = 1.0 / 25.0
    assert not found.belts and np.allclose(np.linalg.norm(disc.rim, axis=1), radius)
    R = np.array([(0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)]) if turned else np.eye(3)
    there = (line - [0.1, 0.2, 0.3]) @ R.T + [0.0, -0.05, 0.0]
    assert np.allclose(there, [(-np.pi * radius, -radius, 0.0), (np.pi * radius, -radius, 0.0)])


def test_a_fixed_ring_is_a_circle_on_the_ground_and_its_planet_a_disc_with_spokes() -> None:
    machine = make_machine(load("ring.yaml", RING))
    (ring,), (arm, planet) = machine.paths, machine.bodies
    assert np.allclose(np.linalg.norm(ring, axis=1), 0.15)
    assert not arm.surfaces and len(arm.bars) == 1
    assert np.isclose(np.hypot(*planet.surfaces[0].corners.T[:2]).max(), 0.05)
    assert [float(np.linalg.norm(b - a)) for a, b in planet.lines] == pytest.approx([0.1] * 4)


@pytest.mark.parametrize("first", ["from: ground.A, to: one.o", "from: one.o, to: ground.A"])
def test_a_belts_strands_run_as_the_rim_of_its_first_pulley_does(first: str) -> None:
    """For a pulley that turns counter-clockwise the upper strand runs to the left, whichever way its joint counts."""
    (belt,) = make_pitch_geometry(load("belt.yaml", BELT.replace("FIRST", first))).belts
    sense = 1.0 if first.startswith("from: ground") else -1.0  # of the joint's angle
    turned = 0.3  # of the pulley, against the ground
    ran = float(belt.compute_travel({"a": {"angle": np.array([sense * turned])}})[0])
    for begin, end in belt.strands:
        way = (end - begin) / np.linalg.norm(end - begin)
        at = min(begin, end, key=lambda place: float(np.linalg.norm(place)))  # on the first pulley
        assert ran * way == pytest.approx(turned * np.cross([0.0, 0.0, 1.0], at))
