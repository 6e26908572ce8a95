"""No singular pose is said to be passed where there is none: scenes that stand still in or near one, links of 1e-12 kg.

How near a pose is to a singular one is geometry alone: masses have no part in it, nor has rounding of what stands.
"""

from __future__ import annotations

import math

import pytest

from tests.shared.scenes import solved
from tests.shared.stretched_chain import KINDS, stretched_chain

RUN = "analysis: {duration: 2, samples: 5}"


def passed(text: str) -> list[str]:
    return [warning for warning in solved(text).warnings if "two motions are possible there" in warning]


@pytest.mark.parametrize("kinds", KINDS)
@pytest.mark.parametrize("h", [0.0, 1e-12, 1e-9, 1e-6, 1e-3])
@pytest.mark.parametrize("mass", [1.0, 1e-12])
@pytest.mark.third
def test_what_stands_still_passes_nothing(kinds: str, h: float, mass: float) -> None:
    """Straight, or next to it, pulled along itself by its weight or not at all."""
    light = stretched_chain(h, "[0, 0, 0]", kinds, RUN).replace("mass: 1,", f"mass: {mass!r},")
    light = light.replace("[0.01, 0.08, 0.08]", f"[{0.01 * mass!r}, {0.08 * mass!r}, {0.08 * mass!r}]")
    assert passed(light) == []
    if h == 0.0:
        assert passed(f"{light}gravity: [-9.81, 0, 0]\n") == []


def four_bar(short: float, mass: float) -> str:
    """A driven crank of 0.25 m, a coupler of 1 m and `mass`, a rocker of 0.5 m: it folds but for `short`."""
    ground, turn = 1.25 - short, 1.0
    x, y = 0.25 * math.cos(turn), 0.25 * math.sin(turn)
    return f"""
heun: 1
space: planar
gravity: [0, -9.81, 0]
ground: {{points: {{A: [0, 0, 0], D: [{ground!r}, 0, 0]}}}}
bodies:
  crank: {{mass: 1, center: [0.1, 0, 0], inertia: 0.01, points: {{a: [0, 0, 0], b: [0.25, 0, 0]}}}}
  coupler:
    mass: {mass!r}
    center: [0.5, 0, 0]
    inertia: {0.08 * mass!r}
    points: {{a: [0, 0, 0], b: [1, 0, 0]}}
    near: {{position: [{x!r}, {y!r}, 0], orientation: {{axis: [0, 0, 1], angle: 0.4}}}}
  rocker:
    mass: 1
    center: [0.2, 0, 0]
    inertia: 0.02
    points: {{a: [0, 0, 0], b: [0.5, 0, 0]}}
    near: {{position: [{ground!r}, 0, 0], orientation: {{axis: [0, 0, 1], angle: 1.5}}}}
joints:
  A: {{type: pin, from: ground.A, to: crank.a}}
  B: {{type: pin, from: crank.b, to: coupler.a}}
  C: {{type: pin, from: coupler.b, to: rocker.b}}
  D: {{type: pin, from: ground.D, to: rocker.a}}
drives: {{m: {{joint: A, angle: "1 + 6*t"}}}}
{RUN}
"""


@pytest.mark.parametrize("short", [1e-1, 1e-3, 1e-5])
@pytest.mark.parametrize("mass", [1.0, 1e-12])
def test_beside_a_fold_nothing_is_passed(short: float, mass: float) -> None:
    """Twice it comes near to lying flat, and does not: whatever the coupler weighs."""
    assert passed(four_bar(short, mass)) == []


@pytest.mark.heavy
def test_a_fold_is_passed_whatever_the_coupler_weighs() -> None:
    assert passed(four_bar(0.0, 1.0)) and passed(four_bar(0.0, 1e-6))
