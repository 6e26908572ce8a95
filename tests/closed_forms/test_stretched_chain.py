"""A chain pulled straight between two supports: loads across it have no answer there; with some sag their tension has.

Two bars of 1 m, each half of the way, a sag h below the line of the supports: a load F across at the middle is held by
F/(2 sin) in each, sin = h/L. At rest in the line itself nothing moves and nothing finite holds it. Nor is there a
motion of loops that lie flat, where loads push both branches at once.
"""

from __future__ import annotations

import math

import pytest

from heuncli.base.errors import SolveError
from heuncli.results.results import Results
from tests.shared.scenes import near, solved
from tests.shared.stretched_chain import KINDS, stretched_chain

STRAIGHT = [0.0, 1e-16, 1e-13, 1e-10, 3e-10]


def refused(text: str) -> None:
    with pytest.raises(SolveError) as refusal:
        solved(text)
    (problem,) = refusal.value.problems
    assert problem.code == "singular-pose"
    assert "no finite force resists it" in problem.message and problem.message.startswith("at t = 0 s")
    assert problem.hint is not None and "sag" in problem.hint


@pytest.mark.parametrize("kinds", KINDS)
@pytest.mark.parametrize("h", STRAIGHT)
def test_straight_and_pushed_across_is_refused(kinds: str, h: float) -> None:
    """Also where what is typed is straight but for rounding."""
    refused(stretched_chain(h, "[0, 0, -100]", kinds))


@pytest.mark.parametrize("more", ["gravity: [0, 0, -9.81]", "analysis: {duration: 1, samples: 3}"])
def test_so_is_a_run_from_there_and_by_weight(more: str) -> None:
    """Before a step is done: what would be done goes wrong at first by the fourth power of the time."""
    refused(stretched_chain(0.0, "[0, 0, -100]", more=more))


@pytest.mark.parametrize("kinds", ["pins", "pins and a line"])
@pytest.mark.parametrize("h", [2e-9, 1e-8, 1e-6, 1e-4, 1e-2, 0.5])
def test_with_a_sag_the_tension_grows_as_its_inverse(kinds: str, h: float) -> None:
    """F/(2 sin), whatever the sag that can be told from none."""
    found = solved(stretched_chain(h, "[0, 0, -100]", kinds))
    tension = 50.0 / h
    near(found.joints["C"]["force"][0, 0], -tension, tension, 1e-15 / h + 1e-13)
    near(found.joints["A"]["force"][0, 2], 50.0, tension, 1e-13)


@pytest.mark.parametrize("kinds", KINDS)
def test_pulled_along_it_stands(kinds: str) -> None:
    """How much each half carries is open, the sum is not; and without a load all is at rest."""
    found = solved(stretched_chain(0.0, "[3, 0, 0]", kinds))
    assert any(w.startswith("singular position") for w in found.warnings)
    near(found.foundation["force"][0], [3.0, 0.0, 0.0], 3.0, 1e-13)
    near(found.bodies["l"]["center_acceleration"][0], 0.0, 3.0, 1e-13)
    near(solved(stretched_chain(0.0, "[0, 0, 0]", kinds)).foundation["force"][0], 0.0, 1.0, 1e-13)


def test_it_may_swing_about_its_ends_where_they_hang() -> None:
    """Straight down between supports, pulled by its weight along itself."""
    found = solved(stretched_chain(0.0, "[0, 0, 0]", "balls", "gravity: [-9.81, 0, 0]"))
    near(found.foundation["force"][0], [-2 * 9.81, 0, 0], 20.0, 1e-13)


def test_a_weight_on_two_ropes() -> None:
    """Rods without mass: straight they hold nothing across; 10 µm of sag on 1 m make 490 kN of 9.81 N."""
    rods = """
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{A: [-1, 0, 0], B: [1, 0, 0]}}}}
bodies: {{w: {{mass: 1, center: [0, 0, {z}], inertia: [0, 0, 0], points: {{p: [0, 0, {z}]}}}}}}
joints: {{l: {{type: rod, from: ground.A, to: w.p}}, r: {{type: rod, from: ground.B, to: w.p}}}}
"""
    refused(rods.format(z=0))
    found = solved(rods.format(z="-1.0e-5"))
    near(found.joints["l"]["tension"][0], 9.81 / 2 * math.hypot(1, 1e-5) / 1e-5, 5e5, 1e-10)


def parallelogram(weights: tuple[float, float]) -> str:
    """Flat, cranks of 0.2 m on the same side, pushed down at their ends."""
    return f"""
heun: 1
ground: {{points: {{A: [0, 0, 0], B: [1, 0, 0]}}}}
bodies:
  crank: {{mass: 1, center: [0.1, 0, 0], inertia: [0.01, 0.01, 0.01], points: {{a: [0, 0, 0], b: [0.2, 0, 0]}}}}
  rod: {{mass: 1, center: [0.7, 0, 0], inertia: [0.01, 0.1, 0.1], points: {{b: [0.2, 0, 0], c: [1.2, 0, 0]}}}}
  rocker: {{mass: 1, center: [1.1, 0, 0], inertia: [0.01, 0.01, 0.01], points: {{d: [1, 0, 0], c: [1.2, 0, 0]}}}}
joints:
  A: {{type: pin, from: ground.A, to: crank.a, axis: [0, 0, 1]}}
  B: {{type: line, from: crank.b, to: rod.b, axis: [0, 0, 1]}}
  C: {{type: pin, from: rod.c, to: rocker.c, axis: [0, 0, 1]}}
  D: {{type: pin, from: ground.B, to: rocker.d, axis: [0, 0, 1]}}
forces:
  f: {{type: force, on: crank.b, vector: [0, {-weights[0]}, 0]}}
  g: {{type: force, on: rocker.c, vector: [0, {-weights[1]}, 0]}}
"""


def test_a_flat_parallelogram_pushed_along_no_branch() -> None:
    """Cranks turn together or, as an antiparallelogram, against each other: pushed otherwise it has no acceleration."""
    refused(parallelogram((1.0, 2.0)))
    found: Results = solved(parallelogram((1.0, 1.0)))
    one, other = (found.bodies[name]["angular_acceleration"][0] for name in ("crank", "rocker"))
    near(one, other, 10.0, 1e-12)
    near(found.bodies["rod"]["angular_acceleration"][0], 0.0, 10.0, 1e-12)
    near(one[2], -2 * 0.2 / (2 * (0.01 + 0.01) + 0.2**2), 10.0, 1e-12)
