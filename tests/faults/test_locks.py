"""Drives that a loop cannot follow any more: told at their first instant, by name, wherever the steps end."""

from __future__ import annotations

import math
import re

import pytest

from heuncli.base.errors import Problem, SolveError
from tests.shared.locking_crank import LOCKING_CRANK
from tests.shared.scenes import solved

# two cranks of 1 m, 2 m apart, and a coupler of 2 m
PARALLELOGRAM = """\
heun: 1
space: planar
gravity: [0, -9.81, 0]
ground: {points: {A: [0, 0, 0], B: [2, 0, 0]}}
bodies:
  l: {mass: 1, center: [0, 0.5, 0], inertia: 0.1, points: {a: [0, 0, 0], b: [0, 1, 0]}}
  r: {mass: 1, center: [2, 0.5, 0], inertia: 0.1, points: {a: [2, 0, 0], b: [2, 1, 0]}}
  c: {mass: 1, center: [1, 1, 0], inertia: 0.1, points: {a: [0, 1, 0], b: [2, 1, 0]}}
joints:
  A: {type: pin, from: ground.A, to: l.a}
  B: {type: pin, from: ground.B, to: r.a}
  C: {type: pin, from: l.b, to: c.a}
  D: {type: pin, from: c.b, to: r.b}
drives: {left: {joint: A, angle: "0.5*t"}, right: {joint: B, angle: "0.5*t + (MORE)"}}
analysis: {duration: 1, samples: 5}
"""
# a bar of 1 m that a driven rod draws away from a point 3 m off
ROD = """\
heun: 1
space: planar
ground: {points: {A: [0, 0, 0], B: [3, 0, 0]}}
bodies:
  bar:
    {mass: 1, center: [0.5, 0, 0], inertia: 0.1, points: {a: [0, 0, 0], b: [1, 0, 0]},
     near: {orientation: {axis: [0, 0, 1], angle: 0.5}}}
joints:
  A: {type: pin, from: ground.A, to: bar.a}
  R: {type: rod, from: ground.B, to: bar.b}
drives: {draw: {joint: R, length: "LENGTH"}}
analysis: {duration: 2, samples: 3}
"""


def told(text: str) -> tuple[float, Problem]:
    """The instant and the problem."""
    with pytest.raises(SolveError) as raised:
        solved(text)
    (problem,) = raised.value.problems
    assert problem.code == "closure-lost"
    found = re.match(r"at t = (\S+) s: the closed loop at .* cannot be assembled after this instant", problem.message)
    assert found is not None
    return float(found[1]), problem


@pytest.mark.parametrize(("more", "instant"), [
    ("0.1*max(t - 0.3, 0)**2", 0.3),
    ("0.1*max(t - 0.3, 0)**3", 0.3),
    ("0.1*max(t - 0.437, 0)**2", 0.437),
    ("0.1*(max(t - 0.3, 0)*max(0.5 - t, 0))**2", 0.3),  # at 0.5 s, where a step ends, they agree again
    ("(max(t - 0.31, 0)*max(0.33 - t, 0))**2", 0.31),  # between the instants that are asked for
])  # fmt: skip
def test_two_drives_that_part(more: str, instant: float) -> None:
    """From there on the cranks are no longer parallel."""
    t, problem = told(PARALLELOGRAM.replace("MORE", more))
    assert t == pytest.approx(instant, abs=2e-9)
    assert "the closed loop at joint D (pin)" in problem.message
    assert (problem.hint or "").startswith("the drives left and right contradict each other there")


def test_two_drives_that_agree() -> None:
    assert solved(PARALLELOGRAM.replace("MORE", "0*t")).status["code"] == "completed"


@pytest.mark.heavy
@pytest.mark.parametrize(("travel", "instant"), [
    ("2.9 + 0.2*t", 0.5),
    ("2.9 + 0.1*t**2", 1.0),
    ("2.9 + 0.15*sin(t)", math.asin(2 / 3)),
    ("2.9 - 2.1*t", 1.9 / 2.1),  # crank and rod over each other
])  # fmt: skip
def test_a_slide_driven_beyond_its_reach(travel: str, instant: float) -> None:
    """Stretched at 3 m, folded at 1 m; the rates grow without bound on the way there."""
    t, problem = told(LOCKING_CRANK.replace("DRIVES", f'push: {{joint: G, travel: "{travel}"}}'))
    assert t == pytest.approx(instant, abs=3e-9)
    assert (problem.hint or "").startswith("the drive push exceeds the range of the loop")


@pytest.mark.heavy
def test_a_crank_driven_against_its_slide() -> None:
    """The slide follows the crank for 0.4 s, and then a little less."""
    x = "cos(0.5 + t) + sqrt(4 - sin(0.5 + t)**2)"
    drives = f'turn: {{joint: A, angle: "0.5 + t"}}, push: {{joint: G, travel: "{x} - 0.01*max(t - 0.4, 0)**3"}}'
    t, problem = told(LOCKING_CRANK.replace("DRIVES", drives))
    assert t == pytest.approx(0.4, abs=3e-9)
    assert "the drives turn and push" in (problem.hint or "")


@pytest.mark.heavy
@pytest.mark.parametrize("speed", [0.7, 1.0, 3.3])
def test_a_rod_drawn_beyond_reach(speed: float) -> None:
    t, problem = told(ROD.replace("LENGTH", f"3 + {speed}*t"))
    assert t == pytest.approx(1.0 / speed, abs=2e-9)
    assert "the closed loop at joint R (rod)" in problem.message
    assert "the drive draw" in (problem.hint or "")


def test_two_driven_ropes_that_end_the_run_at_its_start() -> None:
    """There is no step to look along for where the drives part."""
    found = solved("""\
heun: 1
gravity: [0, 0, 9.81]
ground: {points: {A: [-1, 0, 0], B: [1, 0, 0]}}
bodies: {load: {mass: 1, center: [0, 0, -2], inertia: [0.1, 0.1, 0.1], points: {a: [-0.5, 0, -2], b: [0.5, 0, -2]}}}
joints:
  a: {type: rod, from: ground.A, to: load.a, tension_only: true}
  b: {type: rod, from: ground.B, to: load.b, tension_only: true}
drives: {up: {joint: a, length: "hypot(2, 0.5) - 0.1*t"}, down: {joint: b, length: "hypot(2, 0.5) - 0.1*t"}}
analysis: {duration: 1, samples: 3}
""")
    assert found.time.tolist() == [0.0]
    assert "would have to push" in found.status["message"]
