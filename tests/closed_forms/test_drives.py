"""What a drive prescribes is met exactly, value, rate and acceleration; its torque or force and its power by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.shared.drive_laws import LAWS, LOAD, MOVED, ROPE, TIMES, G, Law, energy_is_kept, nut, run, winch
from tests.shared.scenes import near

ROUNDING = 1e-13


ARM = "  arm: {mass: 2, center: [0.4, 0, 0], inertia: [0.1, 0.2, 0.3], points: {O: [0, 0, 0], E: [1, 0, 0]}}\n"
SHAFT = "  shaft: {type: pin, from: ground.O, to: arm.O, axis: [0, 0, 1]}\n"
TWO = ARM + ("  hand: {mass: 1, center: [0.3, 0, 0], inertia: [0.01, 0.05, 0.06], points: {E: [0, 0, 0]},"
             " orientation: {axis: [0, 0, 1], angle: 0.4}}\n")  # fmt: skip
ELBOW = "  elbow: {type: pin, from: arm.E, to: hand.E, axis: [0, 0, 1]}\n"


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_angle(law: Law) -> None:
    """An arm on a driven pin: drive = (I + m c²) φ̈ + m g c cos φ on the arm, and no moment of the pin's own."""
    found = run(ARM, SHAFT, f"{{joint: shaft, angle: '{law.source}'}}")
    c = found.coordinates["shaft"]
    phi, rate, acceleration = law.value(TIMES), law.first(TIMES), law.second(TIMES)
    for what, wanted in (("angle", phi), ("rate", rate), ("acceleration", acceleration)):
        near(c[what], wanted, max(1.0, float(np.abs(wanted).max())), ROUNDING)
    torque = (0.3 + 2 * 0.16) * acceleration + 2 * G * 0.4 * np.cos(phi)
    largest = 8000.0 if law is LAWS["steady"] else 20.0  # m c φ̇² is what the pin carries then
    near(found.joints["shaft"]["drive"], torque, largest, ROUNDING)
    near(found.joints["shaft"]["moment"][:, 2], 0.0, 1.0, 1e-15)
    near(found.foundation["elements"]["motor"]["moment"][:, 2], -torque, largest, ROUNDING)
    energy_is_kept(found)
    work = 0.5 * 0.62 * (rate**2 - rate[0] ** 2) + 2 * G * 0.4 * (np.sin(phi) - np.sin(phi[0]))
    near(found.energy["work"], work, max(1.0, float(np.abs(work).max()), float(np.max(rate**2))), MOVED)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_travel_of_a_slide(law: Law) -> None:
    """A block pushed up an incline: drive = m (s̈ + g sin α) along the axis, on the block."""
    along = np.array([math.cos(0.4), math.sin(0.4), 0.0])
    found = run("  block: {mass: 3, center: [0, 0.1, 0], inertia: [0.1, 0.1, 0.1], points: {P: [0, 0, 0]}}\n",
                f"  way: {{type: slide, from: ground.O, to: block.P, axis: {along.tolist()}}}\n",
                f"{{joint: way, travel: '{law.source}'}}")  # fmt: skip
    c, s = found.coordinates["way"], law.value(TIMES)
    for what, wanted in (("travel", s), ("speed", law.first(TIMES)), ("acceleration", law.second(TIMES))):
        near(c[what], wanted, max(1.0, float(np.abs(wanted).max())), ROUNDING)
    near(found.bodies["block"]["position"], s[:, None] * along, max(1.0, float(s.max())), ROUNDING)
    near(found.joints["way"]["drive"], 3 * (law.second(TIMES) + G * math.sin(0.4)), 50.0, ROUNDING)
    near(found.joints["way"]["force"] @ along, 0.0, 30.0, 1e-15)
    element = found.foundation["elements"]["motor"]
    near(element["force"], -found.joints["way"]["drive"][:, None] * along, 50.0, ROUNDING)
    energy_is_kept(found)


def test_travel_of_a_cylinder_with_its_turning_free() -> None:
    """Mixed driven and free."""
    law, found = LAWS["harmonic"], nut()
    c = found.coordinates["spindle"]
    near(c["travel"], law.value(TIMES), 1.0, ROUNDING)
    near(c["speed"], law.first(TIMES), 2.1, ROUNDING)
    near(c["acceleration"], law.second(TIMES), 14.7, ROUNDING)
    near(c["rate"], 5 * np.exp(-0.8 / 0.4 * TIMES), 5.0, MOVED)
    near(c["angular_acceleration"], -10 * np.exp(-2 * TIMES), 10.0, MOVED)
    near(c["angle"], 2.5 * (1 - np.exp(-2 * TIMES)), 2.5, MOVED)
    near(found.joints["spindle"]["drive"], 2 * (law.second(TIMES) + G) + 3 * law.first(TIMES), 60.0, MOVED)


@pytest.mark.parametrize("law", [LAWS["harmonic"], LAWS["composed"]], ids=["harmonic", "composed"])
def test_length_of_a_rod(law: Law) -> None:
    """Tension m (g − l̈); the drive is the rod's own force, pushing positive."""
    found = winch(law)
    length = law.value(TIMES)
    near(found.points["load.P"]["position"], np.outer(length, [0, -1, 0]), 1.0, MOVED)
    near(found.points["load.P"]["velocity"], np.outer(law.first(TIMES), [0, -1, 0]), 2.1, MOVED)
    near(found.points["load.P"]["acceleration"], np.outer(law.second(TIMES), [0, -1, 0]), 15.0, MOVED)
    tension = 5 * (G - law.second(TIMES))
    near(found.joints["rope"]["tension"], tension, 100.0, MOVED)
    near(found.joints["rope"]["drive"], -tension, 100.0, MOVED)
    near(found.joints["rope"]["force"], np.outer(tension, [0, 1, 0]), 100.0, MOVED)


def test_a_swinging_load_on_a_winch() -> None:
    """The sway is free: l φ̈ + 2 l̇ φ̇ + g sin φ = 0, tension m (g cos φ + l φ̇² − l̈)."""
    law = LAWS["polynomial"]
    found = run(LOAD.format(more="inertia: [0, 0, 0], position: [0.12, -0.16, 0]"),
                ROPE, f"{{joint: rope, length: '{law.source}'}}")  # fmt: skip
    P = found.points["load.P"]
    x, v, a = P["position"], P["velocity"], P["acceleration"]
    length, rate = law.value(TIMES), law.first(TIMES)
    size = float(np.abs(v).max())
    near(np.linalg.norm(x, axis=1), length, float(length.max()), ROUNDING)
    n = x / length[:, None]
    near(np.sum(n * v, axis=1), rate, size, ROUNDING)
    turn = np.stack([-n[:, 1], n[:, 0], 0 * length], axis=1)
    sway, sin, cos = np.sum(turn * v, axis=1) / length, n[:, 0], -n[:, 1]
    across = np.sum(turn * a, axis=1)  # l φ̈ + 2 l̇ φ̇
    near(across, -G * sin, 10.0, MOVED)
    near(found.joints["rope"]["tension"], 5 * (G * cos + length * sway**2 - law.second(TIMES)), 100.0 * size, MOVED)
    energy_is_kept(found)


def test_where_the_angle_is_zero() -> None:
    """Where the axes of the bodies agree; at the assembled start with `to_axis`, or if asked for."""
    joint = "  shaft: {type: pin, from: ground.O, to: arm.O, axis: [0, 0, 1]"
    turned = ARM.replace("points", "orientation: {axis: [0, 0, 1], angle: 0.7}, points")
    cases = ((", to_axis: [0, 0, 1]}\n", ""), ("}\n", ", zero: assembled"))
    for more, zero in cases:
        found = run(turned, joint + more, f"{{joint: shaft, angle: '2*t'{zero}}}")
        near(found.coordinates["shaft"]["angle"], 2 * TIMES, 2.4, ROUNDING)
        R = found.bodies["arm"]["rotation"]
        near(R[:, 0, 0], np.cos(0.7 + 2 * TIMES), 1.0, ROUNDING)
    found = run(ARM, SHAFT, "{joint: shaft, angle: '0.7 + 2*t'}")
    near(found.bodies["arm"]["rotation"][:, 1, 0], np.sin(0.7 + 2 * TIMES), 1.0, ROUNDING)


def test_angles_are_counted_over_many_turns() -> None:
    found = run(ARM, SHAFT, "{joint: shaft, angle: '1500*rpm*t'}")
    near(found.coordinates["shaft"]["angle"], 50 * np.pi * TIMES, 190.0, 1e-15)


def test_units() -> None:
    """A drive is an angle or a length of its own dimension: numbers with units, in expressions the constants."""
    arm = run(ARM, SHAFT, "{joint: shaft, angle: 30 deg}")
    near(arm.coordinates["shaft"]["angle"], np.pi / 6, 1.0, ROUNDING)
    near(arm.joints["shaft"]["drive"], 2 * G * 0.4 * math.cos(math.pi / 6), 8.0, ROUNDING)


@pytest.mark.parametrize("swapped", [False, True])
def test_driven_and_free_in_one_chain(swapped: bool) -> None:
    """The shoulder is driven and the elbow hangs free, or the other way round: Lagrange's equations of two links."""
    law = LAWS["harmonic"]
    bodies = TWO
    if swapped:
        bodies = bodies.replace(", orientation: {axis: [0, 0, 1], angle: 0.4}", "")
        bodies = bodies.replace("points: {O", "orientation: {axis: [0, 0, 1], angle: 0.1}, points: {O")
    found = run(bodies, SHAFT + ELBOW, f"{{joint: {'elbow' if swapped else 'shaft'}, angle: '{law.source}'}}")
    one, two = found.coordinates["shaft"], found.coordinates["elbow"]
    driven, free = (two, one) if swapped else (one, two)
    near(driven["angle"], law.value(TIMES), 1.0, ROUNDING)
    near(driven["acceleration"], law.second(TIMES), 15.0, ROUNDING)
    q1, q2 = one["angle"], one["angle"] + two["angle"]
    w1, w2 = one["rate"], one["rate"] + two["rate"]
    a1, a2 = one["acceleration"], one["acceleration"] + two["acceleration"]
    coupling = 1.0 * 1.0 * 0.3  # mass of the hand, length of the arm, its centre
    cos, sin = np.cos(q2 - q1), np.sin(q2 - q1)
    first = (0.3 + 2 * 0.16 + 1.0) * a1 + coupling * (cos * a2 - sin * w2**2) + G * np.cos(q1) * (2 * 0.4 + 1.0)
    second = (0.06 + 0.09) * a2 + coupling * (cos * a1 + sin * w1**2) + G * np.cos(q2) * 0.3
    size = 100.0
    drive = found.joints["elbow" if swapped else "shaft"]["drive"]
    if swapped:  # the elbow's torque acts on the hand, the opposite on the arm
        near(second, drive, size, MOVED)
        near(first, -drive, size, MOVED)
    else:
        near(first, drive, size, MOVED)
        near(second, 0.0, size, MOVED)
    assert float(np.ptp(free["angle"])) > 0.3
    energy_is_kept(found)
