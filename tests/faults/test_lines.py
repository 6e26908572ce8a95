"""Loads along a line without length: refused with the instant, at the start and on the way, where they push."""

from __future__ import annotations

import re

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from tests.shared.scenes import near, solved

SCENE = """\
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  a: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}, position: [X, 0, 0], velocity: [V, 0, 0]}
joints: {guide: {type: slide, from: ground.O, to: a.c, axis: [1, 0, 0]}}
forces: {f: {LOAD, from: ground.O, to: a.c}}
ANALYSIS
"""
MOTION = "analysis: {duration: 3, samples: 5}"
ACTUATOR, SPRING = "type: actuator, value: 10", "type: spring, stiffness: 10, length: 1"
SOFT, DAMPED = "type: spring, stiffness: 10, length: 0", "type: spring, stiffness: 10, length: 0, damping: 1"


def scene(load: str, x: float, v: float, analysis: str = "") -> str:
    return SCENE.replace("LOAD", load).replace("X", str(x)).replace("V", str(v)).replace("ANALYSIS", analysis)


def refused(text: str) -> float:
    """The instant that the refusal tells."""
    with pytest.raises(SolveError) as caught:
        solved(text)
    (problem,) = caught.value.problems
    assert problem.code == "no-direction" and problem.hint
    found = re.match(r"at t = (\S+) s the points of forces.f coincide", problem.message)
    assert found is not None
    return float(found[1])


@pytest.mark.parametrize("analysis", ["", MOTION])
@pytest.mark.parametrize(("load", "v"), [
    (ACTUATOR, 0), (ACTUATOR, 1), ("type: actuator, value: 5*t", 0), (SPRING, 0), (SPRING, 1), (DAMPED, 1),
])  # fmt: skip
def test_at_the_start(load: str, v: float, analysis: str) -> None:
    assert refused(scene(load, 0, v, analysis)) == 0.0


@pytest.mark.heavy
@pytest.mark.parametrize(("load", "x", "v", "instant"), [
    # from x at v with -10 or what pulls: v t + x + a t²/2 = 0
    ("type: actuator, value: -10", -1, 0, np.sqrt(0.2)),
    (ACTUATOR, -1e-3, 1, (1 - np.sqrt(0.98)) / 10),
    ("type: actuator, value: 1 - t", -1, 2, None),
    (SPRING, -1.5, 4, None),
    (SPRING, 1e-3, -3, None),
])  # fmt: skip
def test_on_the_way(load: str, x: float, v: float, instant: float | None) -> None:
    found = refused(scene(load, x, v, MOTION))
    assert 0.0 < found < 3.0
    if instant is not None:
        assert found == pytest.approx(instant, rel=1e-8)


def test_a_spring_without_free_length_swings_through() -> None:
    found = solved(scene(SOFT, 0, 1, MOTION))
    near(found.coordinates["guide"]["travel"], np.sin(np.sqrt(10) * found.time) / np.sqrt(10), 1.0, 1e-8)
    assert found.forces["f"]["value"][0] == 0.0 and found.forces["f"]["rate"][0] == 1.0
    found = solved(scene(DAMPED, 0, 0))
    assert found.forces["f"]["value"][0] == 0.0 and found.coordinates["guide"]["acceleration"][0] == 0.0


def test_a_damped_one_goes_through_on_its_way() -> None:
    found = solved(scene(DAMPED, -1, 0, MOTION))
    w, t = np.sqrt(10 - 0.25), found.time
    near(found.coordinates["guide"]["travel"], -np.exp(-t / 2) * (np.cos(w * t) + np.sin(w * t) / (2 * w)), 1.0, 1e-7)


@pytest.mark.parametrize(("load", "x", "v"), [
    (ACTUATOR, -1, 1),  # turns back in time
    ("type: actuator, value: 0", -1, 1),
    ("type: actuator, value: 0*t", -1, 1),
    (SPRING, -1, 1),
])  # fmt: skip
def test_what_does_not_come_together_or_does_not_push_goes_on(load: str, x: float, v: float) -> None:
    assert solved(scene(load, x, v, MOTION)).status["code"] == "completed"


@pytest.mark.heavy
def test_passing_by_is_no_coincidence() -> None:
    """A free body passes the anchor of a spring at a centimetre."""
    text = re.sub("joints: .*\n", "", scene(SPRING, -0.5, 3, MOTION))
    assert solved(text.replace("position: [-0.5, 0, 0]", "position: [-0.5, 1e-2, 0]")).status["code"] == "completed"
