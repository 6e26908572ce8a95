"""Bodies with two points on paths, and paths that close a chain: rods on rings, trammels, what passes a crossing."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from tests.shared.cams import table
from tests.shared.scenes import near, solved

ROUND = f", period: {2.0 * math.pi}"
RING = [table(f, 0.0, 2.0 * math.pi, 240, ROUND) for f in (np.sin, lambda s: -np.cos(s))]
EIGHT = [table(f, 0.0, 2.0 * math.pi, 48, ROUND) for f in (np.sin, lambda s: 0.5 * np.sin(2.0 * s))]
ROUNDED = (2.0 * math.pi / 240) ** 2 / 12.0  # of a ring by splines: what its curvature is off by


def rod(first: str, second: str, tables: str, start: str, more: str = "", times: str = "[0, 0.3, 0.9, 2]") -> str:
    """A rod of 2 kg, a metre long, whose two ends run on paths."""
    return f"""
heun: 1
space: planar
gravity: [0, -9.81]
tables: {{{tables}}}
ground: {{points: {{O: [0, 0]}}}}
bodies:
  rod: {{mass: 2, center: [0.5, 0], inertia: 0.3, points: {{A: [0, 0], B: [1, 0]}}}}
joints:
  one: {{type: curve, from: ground.O, to: rod.A, {first}, initial: {{{start}}}}}
  two: {{type: curve, from: ground.O, to: rod.B, {second}}}
{more}
analysis: {{times: {times}, tolerance: 1e-11}}
"""


def test_a_rod_whose_ends_run_on_a_ring() -> None:
    """It is a pendulum about the ring's centre; its ends go round and round, and press it across the ring."""
    tables, on = f"x: {RING[0]}, y: {RING[1]}", "x: x, y: y"
    found = solved(
        rod(on, f"{on}, initial: {{travel: {math.pi / 6.0}}}", tables, f"travel: {-math.pi / 6.0}, speed: 7")
    )
    arm, inertia = math.sqrt(0.75), 0.3 + 2.0 * 0.75
    angle = found.coordinates["one"]["travel"] + math.pi / 6.0
    assert angle[-1] > 2.0 * math.pi
    square = 49.0 - 2.0 * 2.0 * 9.81 * arm * (1.0 - np.cos(angle)) / inertia
    near(found.coordinates["one"]["speed"] ** 2, square, 49.0, ROUNDED)
    near(found.coordinates["two"]["travel"] - found.coordinates["one"]["travel"], math.pi / 3.0, 1.0, ROUNDED)
    near(found.coordinates["two"]["speed"], found.coordinates["one"]["speed"], 7.0, ROUNDED)
    turning = -2.0 * 9.81 * arm * np.sin(angle) / inertia
    near(found.coordinates["two"]["acceleration"], turning, 40.0, 4.0 * ROUNDED)
    # inward m (v^2/arm + g cos), of both ends cos 30 deg; forward what turns it, of their difference sin 30 deg
    inward = 2.0 * (arm * square + 9.81 * np.cos(angle))
    along = 2.0 * (arm * turning + 9.81 * np.sin(angle))
    half = inward / (2.0 * arm)
    for name, size in (("one", half + along), ("two", half - along)):
        s = found.coordinates[name]["travel"]
        wanted = np.stack([-np.sin(s), np.cos(s), 0.0 * s], axis=-1) * size[:, None]
        near(found.joints[name]["force"], wanted, 200.0, 4.0 * ROUNDED)


@cache
def trammel() -> Any:
    straight = "{x: [-2, -1, 1, 2], y: [-2, -1, 1, 2], interpolation: cubic}"
    return solved(rod("x: way", "y: way", f"way: {straight}", "travel: 0.8, speed: 5"))


def test_a_trammel() -> None:
    """Ends on two lines that cross: the middle runs on a circle, theta'' = -m g cos(theta) / (2 (J + m/4))."""
    found = trammel()
    x, y = (found.coordinates[name]["travel"] for name in ("one", "two"))
    near(x * x + y * y, 1.0, 1.0, 1e-9)
    assert x.min() < 0.0 < x.max()
    square = np.sum(found.bodies["rod"]["angular_velocity"] ** 2, axis=1)
    start = (5.0 / y[0]) ** 2
    near(square, start + 2.0 * 9.81 * (y[0] - y) / (0.3 + 0.5), start, 1e-9)
    turning = found.bodies["rod"]["angular_acceleration"][:, 2]
    # the force of a line is across it: of the horizontal one upward, of the upright one sideways
    a = found.bodies["rod"]["center_acceleration"]
    near(found.joints["one"]["force"][:, 1], 2.0 * (a[:, 1] + 9.81), 200.0, 1e-8)
    near(found.joints["two"]["force"][:, 0], 2.0 * a[:, 0], 200.0, 1e-8)
    near(turning, -0.5 * 2.0 * 9.81 * -x / (0.3 + 0.5), 100.0, 1e-8)


STAGE = f"""
heun: 1
space: planar
gravity: [0, -9.81]
tables: {{x: {EIGHT[0]}, y: {EIGHT[1]}}}
ground: {{points: {{O: [0, 0]}}}}
bodies:
  cart: {{mass: 0.5, center: [0, 0], inertia: 0.1, points: {{c: [0, 0]}}}}
  bead: {{mass: 2, center: [0, 0], inertia: 0.1, points: {{P: [0, 0]}}}}
joints:
  wire: {{type: curve, from: ground.O, to: bead.P, x: x, y: y, initial: {{travel: 2.6, speed: 6}}}}
  across: {{type: slide, from: ground.O, to: cart.c, axis: [1, 0]}}
  up: {{type: slide, from: cart.c, to: bead.P, axis: [0, 1]}}
forces:
  drag: {{type: damper, joint: wire, coefficient: 0.4}}
  rub: {{type: friction, joint: wire, force: 0.5, speed: 0.01}}
  MORE
analysis: {{times: [0, 0.2, 0.5, 1, 2], tolerance: 1e-11}}
"""


def test_whether_a_path_is_a_joint_of_the_tree_or_closes_a_loop() -> None:
    """Round an eight and through its crossing, on a stage whose two slides a load names, and so are not cut."""
    names = "pull: {type: force, on: bead.P, vector: ['0*up.travel*across.travel', 0]}"
    tree, loop = (solved(STAGE.replace("MORE", more)) for more in ("", names))
    s = tree.coordinates["wire"]["travel"]
    assert s[-1] > 3.0 * math.pi  # past both of its ways through
    for what in ("travel", "speed", "acceleration"):
        one, other = (found.coordinates["wire"][what] for found in (tree, loop))
        near(other, one, 1.0 + np.abs(one).max(), 1e-8)
    for joint in ("wire", "across", "up"):
        for what in ("force", "moment"):
            near(loop.joints[joint][what], tree.joints[joint][what], 200.0, 1e-8)
    for force in ("drag", "rub"):
        near(loop.forces[force]["power"], tree.forces[force]["power"], 20.0, 1e-8)


def test_the_end_of_a_path_that_closes_a_loop() -> None:
    """Told as of any other path."""
    short = "{x: [-1, 0, 1, 2], y: [-0.5, 0, 0.5, 1.0], interpolation: cubic}"
    tables = f"way: {{x: [-2, -1, 1, 2], y: [-2, -1, 1, 2], interpolation: cubic}}, short: {short}"
    with pytest.raises(SolveError, match="joint two leaves its path, which covers travel from -1 to 2 m") as told:
        solved(rod("x: way", "y: short", tables, "travel: 0.8, speed: 5"))
    (problem,) = told.value.problems
    assert problem.code == "path-ends" and problem.hint
    assert "two.travel < -1" in problem.hint or "two.travel > 2" in problem.hint


def test_both_travels_of_a_loop_are_not_named() -> None:
    """One of the two is found from the pose: what names, drives or limits both is refused."""
    straight = "way: {x: [-2, -1, 1, 2], y: [-2, -1, 1, 2], interpolation: cubic}"
    both = "stops: {a: {joint: one, travel: [-1, 1]}, b: {joint: two, travel: [-1, 1]}}"
    with pytest.raises(SolveError, match="is limited by a stop") as told:
        solved(rod("x: way", "y: way", straight, "travel: 0.8", both))
    assert told.value.problems[0].code == "over-driven"
