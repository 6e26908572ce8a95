"""A bob on a rope winds round its sheave until no strand is left: refused by name, at the instant of the involute.

Without gravity the speed stays v and the free strand l turns at v/l, so that l dl = -R v dt: it ends at l0^2 / (2 R v).
"""

from __future__ import annotations

import re

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from tests.shared.scenes import solved


def tether(radius: float, strand: float, speed: float, more: str) -> str:
    return f"""
heun: 1
space: planar
ground: {{points: {{anchor: [-1, {radius!r}], wheel: [0, 0]}}}}
bodies:
  bob:
    {{mass: 1, center: [0, 0], inertia: 0.01, points: {{o: [0, 0]}}, position: [{radius!r}, {-strand!r}],
     velocity: [{-speed!r}, 0]}}
couplings:
  rope: {{type: rope, through: [ground.anchor, {{sheave: ground.wheel, radius: {radius!r}, side: over}}, bob.o]{more}}}
analysis: {{duration: {0.75 * strand**2 / (radius * speed)!r}, samples: 5}}
"""


@pytest.mark.parametrize(
    ("more", "digits"),
    [("", 1e-6), (", tension_only: true, restitution: 0", 1e-6), (", stiffness: 1e5, damping: 300", 2e-2)],
    ids=["constant", "slack", "stretching"],
)
@pytest.mark.parametrize("seed", range(4))
def test_a_rope_that_is_wound_up_is_refused_at_its_instant(seed: int, more: str, digits: float) -> None:
    rng = np.random.default_rng([seed, 1931])
    radius, speed = float(rng.uniform(0.05, 0.3)), float(rng.uniform(0.5, 3.0))
    strand = radius * float(rng.uniform(1.0, 3.5))  # less than a turn on the sheave
    with pytest.raises(SolveError) as caught:
        solved(tether(radius, strand, speed, more))
    (problem,) = caught.value.problems
    assert problem.code == "rope-off-sheave"
    found = re.match(r"at t = (\S+) s couplings\.rope winds up", problem.message)
    assert found is not None
    assert float(found[1]) == pytest.approx(strand**2 / (2.0 * radius * speed), rel=digits)


@pytest.mark.parametrize(
    "more",
    [
        "", ", tension_only: true, restitution: 0", ", stiffness: 1e5, damping: 300",
        ", tension_only: true, stiffness: 1e5, damping: 300", ", tension_only: true, stiffness: 1e4, damping: 30",
    ],
)  # fmt: skip
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.third
def test_an_arc_of_more_than_315_degrees_is_refused_at_its_instant(seed: int, more: str) -> None:
    """From a quarter of a turn on, l0 - l = R 225 deg more; a rope that vibrates may be slack there."""
    rng = np.random.default_rng([seed, 2017])
    radius, speed = float(rng.uniform(0.05, 0.3)), float(rng.uniform(0.5, 3.0))
    strand = radius * float(rng.uniform(4.5, 9.0))
    left = strand - 1.25 * np.pi * radius
    with pytest.raises(SolveError) as caught:
        solved(tether(radius, strand, speed, more))
    (problem,) = caught.value.problems
    assert problem.code == "rope-off-sheave"
    found = re.match(r"at t = (\S+) s couplings\.rope lies on a sheave over more than 315 deg", problem.message)
    assert found is not None, problem.message
    assert float(found[1]) == pytest.approx((strand**2 - left**2) / (2.0 * radius * speed), rel=2e-2)


@pytest.mark.parametrize("seed", range(6))
def test_a_slack_rope_whose_end_comes_to_the_rim_is_refused_at_its_instant(seed: int) -> None:
    """The bob flies freely until its centre is a radius away from the sheave's; the rope is too long to hold it."""
    rng = np.random.default_rng([seed, 2018])
    radius, speed, offset = float(rng.uniform(0.1, 0.3)), float(rng.uniform(0.5, 3.0)), float(rng.uniform(-0.8, 0.4))
    distance = float(rng.uniform(0.2, 1.0))
    y = offset * radius
    start = float(np.sqrt(radius**2 - y**2)) + distance
    with pytest.raises(SolveError) as caught:
        solved(f"""
heun: 1
space: planar
ground: {{points: {{anchor: [-1, {radius!r}], wheel: [0, 0]}}}}
bodies:
  bob:
    {{mass: 1, center: [0, 0], inertia: 0.01, points: {{o: [0, 0]}}, position: [{start!r}, {y!r}],
     velocity: [{-speed!r}, 0]}}
couplings:
  rope:
    type: rope
    through: [ground.anchor, {{sheave: ground.wheel, radius: {radius!r}, side: over}}, bob.o]
    length: {3.0 + 4.0 * (distance + radius)!r}
    tension_only: true
    stiffness: {float(10.0 ** rng.uniform(3.0, 5.0))!r}
    damping: 30
analysis: {{duration: {2.0 * distance / speed!r}, samples: 5}}
""")
    (problem,) = caught.value.problems
    assert problem.code == "rope-off-sheave"
    found = re.match(r"at t = (\S+) s couplings\.rope winds up", problem.message)
    assert found is not None, problem.message
    assert float(found[1]) == pytest.approx(distance / speed, rel=1e-6)
