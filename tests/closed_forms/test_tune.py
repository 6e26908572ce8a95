"""`heun tune` against what is known: counterweights, and optima in closed form."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heuncli.results.results import Array
from tests.shared.command import Heun
from tests.shared.folders import ROOT

# A crank with its counterweight, a connecting rod, and a piston, turned evenly.
CRANK, ROD, PISTON, R_CRANK, R_WEIGHT, W = 0.5, 0.3, 0.4, 0.04, 0.05, 300.0
ENGINE = f"""\
heun: 1
title: Single-cylinder engine with a counterweight
parameters: {{l: 0.14, m: 0.1 kg}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  crank:
    shapes:
      - {{type: rod, from: [0, 0, 0], to: [{R_CRANK}, 0, 0], mass: {CRANK}}}
      - {{type: point, at: [{-R_WEIGHT}, 0, 0], mass: m}}
    points: {{main: [0, 0, 0], pin: [{R_CRANK}, 0, 0]}}
  rod:
    shapes: [{{type: rod, from: [0, 0, 0], to: [l, 0, 0], mass: {ROD}}}]
    points: {{big: [0, 0, 0], small: [l, 0, 0]}}
  piston: {{mass: {PISTON}, center: [0, 0, 0], inertia: [1e-4, 1e-4, 1e-4], points: {{pin: [0, 0, 0]}}}}
joints:
  main: {{type: pin, from: ground.O, to: crank.main, axis: [0, 0, 1]}}
  big: {{type: line, from: crank.pin, to: rod.big, axis: [0, 0, 1]}}
  small: {{type: pin, from: rod.small, to: piston.pin, axis: [0, 0, 1]}}
  guide: {{type: slide, from: ground.O, to: piston.pin, axis: [1, 0, 0]}}
drives: {{motor: {{joint: main, angle: {W}*t}}}}
analysis: {{duration: 2*pi/{W}, samples: 13}}
"""
ROTATING = CRANK * R_CRANK / 2.0 + ROD * R_CRANK / 2.0  # kg m, of a slender rod half is at each end, but for its spin
RECIPROCATING = (PISTON + ROD / 2.0) * R_CRANK


def shaking_force(m: float, length: float, phi: Array) -> Array:
    """Its size at crank angles: rotating masses, and r cos φ + sqrt(l² - r² sin² φ) of what goes to and fro."""
    s, c, r = np.sin(phi), np.cos(phi), R_CRANK
    root = np.sqrt(length**2 - (r * s) ** 2)
    second = -r * c - r**2 * (c**2 - s**2) / root - r**4 * (s * c) ** 2 / root**3  # d²x/dφ²
    turning = ROTATING - m * R_WEIGHT
    x = W**2 * (turning * c - (PISTON + ROD / 2.0) * second)
    return np.asarray(np.hypot(x, W**2 * turning * s))


def least_largest(length: float) -> tuple[float, float]:
    """The weight for which the largest shaking force is least, and that force: by halving thirds, it is convex in m.

    Between angles 1.6e-4 apart the largest is missed by 3e-9 of it at most.
    """
    phi = np.linspace(0.0, math.pi, 20_001)
    low, high = 0.0, 3.0
    while high - low > 1e-10:
        a, b = low + (high - low) / 3.0, high - (high - low) / 3.0
        if shaking_force(a, length, phi).max() < shaking_force(b, length, phi).max():
            high = b
        else:
            low = a
    return low, float(shaking_force(low, length, phi).max())


def tuned(heun: Heun, *words: str) -> dict[str, Any]:
    done = heun("tune", *words, "--jobs", "1", "--format", "json", "--quiet")
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found


@pytest.mark.heavy
@pytest.mark.long
def test_counterweight_of_an_engine(heun: Heun, folder: Path) -> None:
    """The least largest shaking force, and its weight, against a dense scan of the closed form."""
    (folder / "engine.yaml").write_text(ENGINE)
    found = tuned(heun, "engine.yaml", "m=0:3kg", "--minimise", "max foundation.force", "--evaluations", "120")
    weight, force = least_largest(0.14)
    assert found["ended"] == "converged" and found["constraints"] == []
    best = found["goal"]["best"]["value"]
    assert abs(best - force) <= max(2.0 * found["goal"]["floor"], 1e-6 * force)
    (m,) = found["variables"]
    assert m["value"] == pytest.approx(weight, abs=1e-6) and m["active"] is None
    before = shaking_force(0.1, 0.14, np.linspace(0.0, math.pi, 200_001)).max()
    assert found["goal"]["before"]["value"] == pytest.approx(before, rel=1e-8)


@pytest.mark.heavy
@pytest.mark.long
def test_half_of_what_goes_to_and_fro(heun: Heun, folder: Path) -> None:
    """With a long rod the weight balances what rotates and half of what reciprocates, as all books have it."""
    (folder / "engine.yaml").write_text(ENGINE)
    words = ["m=0:3kg", "--set", "l=40", "--minimise", "max foundation.force", "--evaluations", "120"]
    found = tuned(heun, "engine.yaml", *words)
    expected = (ROTATING + RECIPROCATING / 2.0) / R_WEIGHT
    assert found["converged"] and found["variables"][0]["value"] == pytest.approx(expected, rel=2.0 * R_CRANK / 40.0)


@pytest.mark.heavy
@pytest.mark.long
def test_a_four_bar_balanced_in_force(heun: Heun) -> None:
    """Berkof and Lowen's weights are found from others: 8 and 20 kg mm leave no force, over any part of a turn."""
    spec = str(ROOT / "specs" / "four_bar_balanced.yaml")
    words = [
        "U1=2:15kg*mm",
        "U3=3:44kg*mm",
        "--set",
        "U1=3 kg*mm",
        "--set",
        "U3=40 kg*mm",
        "--set",
        "analysis.samples=7",
        "--set",
        "analysis.duration=T/4",
    ]
    found = tuned(heun, spec, *words, "--minimise", "max foundation.force", "--evaluations", "500")
    assert found["converged"]
    assert [one["value"] for one in found["variables"]] == pytest.approx([8.0, 20.0], abs=2e-5)
    assert found["goal"]["best"]["value"] <= 5.0 * found["goal"]["floor"] < 1e-5 * found["goal"]["before"]["value"]
    assert found["variables"][0]["moves"]["hundredth"] == [None, None]  # of nothing


# A bracket: a weight m at distance L, held up by an arm whose own weight, ρ L, lies at the wall.
BRACKET = """\
heun: 1
title: Bracket
gravity: [0, 0, -10]
parameters: {L: 1 m, m: 1 kg, rho: 4 kg/m}
ground: {points: {O: [0, 0, 0]}}
bodies:
  arm:
    shapes:
      - {type: point, at: [0, 0, 0], mass: rho*L}
      - {type: point, at: [L, 0, 0], mass: m}
      - {type: box, center: [0, 0, 0], size: [1, 1, 1], mass: 1e-9}
    points: {a: [0, 0, 0]}
joints:
  wall: {type: weld, from: ground.O, to: arm.a}
"""


def test_the_lightest_bracket_for_a_moment(heun: Heun, folder: Path) -> None:
    """g (m + ρ L) is least with g m L >= 10 N m at L = sqrt(1/ρ) = 0.5 m, m = sqrt(ρ) = 2 kg: 40 N."""
    (folder / "bracket.yaml").write_text(BRACKET)
    words = ["L=200:2000mm", "m=0.5:5kg", "--minimise", "joints.wall.force.z"]
    found = tuned(heun, "bracket.yaml", *words, "--subject-to", "joints.wall.moment >= 0.01 kN*m")
    assert found["converged"] and found["feasible"]
    assert found["goal"]["best"]["value"] == pytest.approx(40.0, abs=2e-4)
    assert found["variables"][0]["value"] == pytest.approx(500.0, rel=5e-3)
    assert found["variables"][1]["value"] == pytest.approx(2.0, rel=5e-3)
    (moment,) = found["constraints"]
    assert moment["active"] and moment["met"] and moment["limit"] == 10.0 and 0.0 <= moment["left"] < 1e-3
    assert moment["best"]["value"] >= 10.0


@pytest.mark.long
def test_the_greatest_moment_of_a_weight(heun: Heun, folder: Path) -> None:
    """g m L is greatest with g (m + ρ L) <= 80 N at m = 4 kg, L = 1 m: 40 N m; a bound on L = 0.8 m makes it 38.4."""
    (folder / "bracket.yaml").write_text(BRACKET)
    words = ["m=0.5:9kg", "--maximise", "joints.wall.moment", "--subject-to", "joints.wall.force < 80 N"]
    found = tuned(heun, "bracket.yaml", "L=0.2:2", *words)
    assert found["converged"] and found["goal"]["best"]["value"] == pytest.approx(40.0, abs=4e-4)
    found = tuned(heun, "bracket.yaml", "L=0.2:0.8", *words)
    assert found["converged"] and found["goal"]["best"]["value"] == pytest.approx(38.4, abs=4e-4)
    assert [one["active"] for one in found["variables"]] == ["high", None]
    assert found["variables"][0]["value"] == 0.8 and found["constraints"][0]["active"]
