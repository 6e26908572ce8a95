"""A drive that pushes a closed loop against a stop is told as that, at the instant of the closed form."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from tests.shared.scenes import solved

CRANK, COUPLER, ROCKER = 0.3, 0.9, 0.6  # of a crank and rocker whose pins at the ground are 1 m apart
SAMPLES = 20_000


def four_bar(start: float, rate: float, stop: str, restitution: float) -> str:
    """The crank is driven evenly; the rocker's angle is 0 where it stands upright."""
    return f"""
heun: 1
space: planar
ground: {{points: {{A: [0, 0], D: [1, 0]}}}}
bodies:
  crank: {{mass: 1, center: [0.1, 0], inertia: 0.01, points: {{a: [0, 0], b: [{CRANK}, 0]}}}}
  rod: {{mass: 1, center: [0.5, 0], inertia: 0.1, points: {{b: [0, 0], c: [{COUPLER}, 0]}}}}
  rocker: {{mass: 1, center: [0, 0.3], inertia: 0.1, points: {{d: [0, 0], c: [0, {ROCKER}]}}}}
joints:
  A: {{type: pin, from: ground.A, to: crank.a}}
  B: {{type: pin, from: crank.b, to: rod.b}}
  C: {{type: pin, from: rod.c, to: rocker.c}}
  D: {{type: pin, from: ground.D, to: rocker.d}}
drives: {{motor: {{joint: A, angle: "{start!r} + {rate!r}*t"}}}}
stops: {{block: {{joint: D, angle: {stop}, restitution: {restitution!r}}}}}
analysis: {{duration: 4, samples: 3}}
"""


def rocker_angle(crank_angle: np.ndarray) -> np.ndarray:
    """From two triangles: over the diagonal between the crank's end and the rocker's pin."""
    x, y = CRANK * np.cos(crank_angle) - 1.0, CRANK * np.sin(crank_angle)
    diagonal = np.hypot(x, y)
    corner = np.arccos((diagonal**2 + ROCKER**2 - COUPLER**2) / (2.0 * diagonal * ROCKER))
    return np.asarray((np.arctan2(y, x) % (2.0 * math.pi)) - corner - 0.5 * math.pi)


def first_passage(start: float, rate: float, limit: float, sign: float) -> float | None:
    """When the rocker first passes a limit upwards (sign 1) or downwards, by halving."""
    t = np.linspace(0.0, 4.0, SAMPLES)
    over = sign * (rocker_angle(start + rate * t) - limit) > 0.0
    if not over.any():
        return None
    low, high = t[int(np.argmax(over)) - 1], t[int(np.argmax(over))]
    for _ in range(60):
        middle = 0.5 * (low + high)
        is_over = sign * (rocker_angle(np.array([start + rate * middle]))[0] - limit) > 0.0
        low, high = (low, middle) if is_over else (middle, high)
    return float(low)


@pytest.mark.parametrize("seed", range(16))
def test_it_is_told_as_a_drive_against_a_stop(seed: int) -> None:
    rng = np.random.default_rng([seed, 1909])
    start, rate = float(rng.uniform(0.0, 6.0)), float(rng.choice([-1.0, 1.0]) * rng.uniform(0.8, 5.0))
    sign, restitution = float(rng.choice([-1.0, 1.0])), float(rng.choice([0.0, 0.5, 1.0]))
    course = rocker_angle(start + rate * np.linspace(0.0, 4.0, SAMPLES))
    most = float((sign * course).max())
    first = float(sign * course[0])
    limit = sign * (first + (most - first) * float(rng.choice([0.2, 0.7, 1.5])) + 0.01)
    when = first_passage(start, rate, limit, sign)
    text = four_bar(start, rate, f"[-2, {limit!r}]" if sign > 0.0 else f"[{limit!r}, 2]", restitution)
    if when is None:
        assert solved(text).time[-1] == 4.0
        return
    with pytest.raises(SolveError) as caught:
        solved(text)
    (problem,) = caught.value.problems
    assert problem.code == "stop-contradicts"
    found = re.fullmatch(
        r"at t = (\S+) s the drive \(motor\) pushes against the stop block of joints\.D", problem.message
    )
    assert found is not None
    assert float(found[1]) == pytest.approx(when, abs=2e-9 + 2e-9 * when)


@pytest.mark.parametrize(
    ("law", "is_refused"),
    [("t", True), ("-t", False), ("0.5*t**2", True), ("-t**2", False), ("max(t - 0.2, 0)", True),
     ("-max(t - 0.2, 0)", False), ("max(t - 0.2, 0)**2", True), ("-max(t - 0.2, 0)**2", False), ("0", False),
     ("t**3", True), ("-t**3", False), ("1e-9*t**3", True), ("-1e-9*t**3", False), ("max(t - 0.2, 0)**3", True),
     ("-max(t - 0.2, 0)**3", False), ("t**5", True), ("-t**5", False)],
)  # fmt: skip
@pytest.mark.parametrize("gravity", [0.0, -9.81])
@pytest.mark.third
def test_a_drive_that_starts_at_the_stop(law: str, is_refused: bool, gravity: float) -> None:
    """A parallelogram that touches its stop: it may rest there, and move away, however slowly.

    It is asked at an instant at which a gap that opens as t**3 or t**5 is still rounding.
    """
    text = f"""
heun: 1
space: planar
gravity: [0, {gravity!r}, 0]
ground: {{points: {{A: [0, 0], D: [1, 0]}}}}
bodies:
  crank: {{mass: 1, center: [0.2, 0], inertia: 0.01, points: {{a: [0, 0], b: [1, 0]}}}}
  rod: {{mass: 1, center: [0.5, 0], inertia: 0.1, points: {{b: [0, 0], c: [1, 0]}}}}
  rocker: {{mass: 1, center: [0, 0.3], inertia: 0.1, points: {{d: [0, 0], c: [1, 0]}}}}
joints:
  A: {{type: pin, from: ground.A, to: crank.a}}
  B: {{type: pin, from: crank.b, to: rod.b}}
  C: {{type: pin, from: rod.c, to: rocker.c}}
  D: {{type: pin, from: ground.D, to: rocker.d}}
drives: {{motor: {{joint: A, angle: "1 + {law}"}}}}
stops: {{block: {{joint: D, angle: [-1, 1]}}}}
analysis: {{times: [0, 0.0001, 0.4]}}
"""
    if not is_refused:
        moment = solved(text).stops["block"]["moment"]
        assert np.isnan(moment[0]) == (law not in ("-t", "-t**2"))  # while it touches, drive and stop may press
        assert np.isnan(moment[-1]) == (law == "0")
        return
    with pytest.raises(SolveError) as caught:
        solved(text)
    assert [problem.code for problem in caught.value.problems] == ["stop-contradicts"]
