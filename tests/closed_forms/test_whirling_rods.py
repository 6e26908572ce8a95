"""Rods that turn about a fixed axis: manual/theory.md, "Closed cases" 5, 9, and manual/references.md, "Rods"."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.results.results import Results
from tests.shared.scenes import near, solved

HEAD = "heun: 1\nground: {points: {O: [0, 0, 0], A: [0, 0, -0.25], B: [0, 0, 0.25]}}\n"


def whirl(rate: float, torque: float) -> Results:
    """2 kg, 1.5 m along body x on a pin about z, with a couple about it; cuts along, and at 0, L/2."""
    return solved(
        HEAD
        + f"""
bodies:
  rod:
    shapes: [{{type: rod, from: [0, 0, 0], to: [1.5, 0, 0], mass: 2}}]
    points: {{root: [0, 0, 0], tip: [1.5, 0, 0]}}
joints: {{hub: {{type: pin, from: ground.O, to: rod.root, axis: [0, 0, 1], initial: {{angle: 0.7, rate: {rate}}}}}}}
forces: {{motor: {{type: torque, joint: hub, value: {torque}}}}}
sections: {{run: {{body: rod, from: root, to: tip, count: 31}}}}
"""
    )


def test_case_5() -> None:
    """N = 1/2 m ω² L (1 − ξ²) at ω = 20: 600, 450 in the middle, 0 at the tip."""
    run = whirl(20, 0).sections["run"]
    xi = run["s"] / 1.5
    near(run["N"][0], 600 * (1 - xi**2), 600.0, 1e-14)
    near(run["N"][0, [0, 15, 30]], [600, 450, 0], 600.0, 1e-14)
    for name in ("Q1", "Q2", "T", "M1", "M2"):
        near(run[name], 0.0, 600.0, 1e-14)


def test_references_whirling_rod() -> None:
    """ω = 10, α = 5 by a couple of 7.5 N m: V = μ α (L² − r²)/2 and M = μ α (L − r)² (2 L + r)/6, of the usual book."""
    found = whirl(10, 7.5)
    near(found.coordinates["hub"]["acceleration"], 5.0, 5.0, 1e-14)
    run = found.sections["run"]
    near(run["N"][0, [0, 15]], [150, 112.5], 150.0, 1e-14)
    near(-run["Q1"][0, [0, 15]], [7.5, 5.625], 150.0, 1e-15)
    near(-run["M2"][0, [0, 15]], [7.5, 2.34375], 150.0, 1e-15)
    mu, r = 2 / 1.5, run["s"]
    near(-run["Q1"][0], mu * 5 * (1.5**2 - r**2) / 2, 150.0, 1e-15)
    near(-run["M2"][0], mu * 5 * (1.5 - r) ** 2 * (3 + r) / 6, 150.0, 1e-15)


def skew(mass: float, length: float, degrees: float, rate: float, bearings: bool) -> Results:
    """A rod centred on the axis z, leaning by an angle in the xz plane; on a pin there, or in two bearings."""
    b = math.radians(degrees)
    n = [math.sin(b), 0.0, math.cos(b)]
    half = [length / 2 * c for c in n]
    other = [-c for c in half]
    joints = "hub: {type: pin, from: ground.O, to: rod.c, axis: [0, 0, 1]}"
    if bearings:
        joints = "a: {type: ball, from: ground.A, to: rod.a}, "
        joints += "b: {type: line, from: ground.B, to: rod.b, axis: [0, 0, 1]}"
    return solved(
        HEAD
        + f"""
bodies:
  rod:
    shapes: [{{type: rod, from: {other}, to: {half}, mass: {mass}}}]
    points: {{c: [0, 0, 0], tip: {half}, q: {[c / 2 for c in half]}, a: [0, 0, -0.25], b: [0, 0, 0.25]}}
    angular_velocity: [0, 0, {rate}]
joints: {{{joints}}}
sections: {{run: {{body: rod, from: c, to: tip, count: 21}}}}
"""
    )


def test_case_9() -> None:
    """m = 3, L = .8, 40°, ω = 50: couple 196.9615506024416 N m, bearings .5 m apart bear 393.9231012048832 N each."""
    found = skew(3, 0.8, 40, 50, bearings=True)
    near(found.joints["b"]["radial"], 393.9231012048832, 400.0, 1e-14)
    near(np.abs(found.joints["a"]["force"][0]), [393.9231012048832, 0, 0], 400.0, 1e-14)
    near(found.joints["a"]["force"][0] + found.joints["b"]["force"][0], 0.0, 400.0, 1e-14)
    near(found.foundation["force"][0], 0.0, 400.0, 1e-14)
    near(np.abs(found.foundation["moment"][0]), [0, 196.9615506024416, 0], 200.0, 1e-14)
    assert np.isnan(found.foundation["axis"]["pitch"][0])  # a pure couple has no axis
    near(found.foundation["mass_effect"]["moment_spin"][0], -found.foundation["moment"][0], 200.0, 1e-14)


def test_references_skew_rod() -> None:
    """m = 2, L = 1.5, ω = 10, 30°: couple 16.23797632; M(0) 8.11898816, M(h/2) 2.53718380, N(0) 9.375."""
    found = skew(2, 1.5, 30, 10, bearings=False)
    near(np.abs(found.joints["hub"]["moment"][0]), [0, 16.23797632, 0], 10.0, 6e-10)
    run = found.sections["run"]
    bending = np.hypot(run["M1"][0], run["M2"][0])
    near(bending[[0, 10]], [8.11898816, 2.53718380], 10.0, 6e-10)
    near(run["N"][0, 0], 9.375, 10.0, 1e-14)
    s, h = run["s"], 0.75
    part = 2 / 1.5 * 100 * math.sin(math.radians(30)) * math.cos(math.radians(30))
    near(bending, part * (h**3 / 3 - s * h**2 / 2 + s**3 / 6), 10.0, 1e-14)
    near(run["N"][0], 2 / 1.5 * 100 * 0.25 * (h**2 - s**2) / 2, 10.0, 1e-14)


@pytest.mark.parametrize("rate", [1.0, 10.0, 100.0])
def test_all_of_it_grows_with_the_square_of_the_rate(rate: float) -> None:
    one, other = skew(2, 1.5, 30, 1, bearings=True), skew(2, 1.5, 30, rate, bearings=True)
    for joint in ("a", "b"):
        near(other.joints[joint]["force"] / rate**2, one.joints[joint]["force"], 1.0, 1e-14)
    for name in ("N", "Q1", "Q2", "M1", "M2"):
        near(other.sections["run"][name] / rate**2, one.sections["run"][name], 1.0, 1e-14)
