"""A value in time that is none when the run comes to it: named with its place, its text, the instant, the table."""

from __future__ import annotations

import re

import pytest

from heuncli.base.errors import Problem, SolveError, SpecError
from tests.shared.mechanisms import crank_rocker
from tests.shared.scenes import moving, solved

SCENE = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  a: {mass: 1, center: [1, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0], c: [1, 0, 0]}}
joints: {p: {type: pin, from: ground.O, to: a.o, axis: [0, 1, 0]}}
tables:
  g: {x: [0, 1], y: [0, 2]}
  h: {x: [0, 1], y: [0, 2]}
LOAD
analysis: {duration: 2, samples: 5}
"""
FORCE = 'forces: {f: {type: force, on: a.c, vector: ["VALUE", 0, 0]}}'
TORQUE = 'forces: {f: {type: torque, joint: p, value: "VALUE"}}'
DRIVE = 'drives: {d: {joint: p, angle: "VALUE"}}'


def told(load: str, value: str) -> Problem:
    with pytest.raises(SolveError) as raised:
        solved(SCENE.replace("LOAD", load.replace("VALUE", value)))
    (problem,) = raised.value.problems
    return problem


@pytest.mark.parametrize(("load", "value", "instant"), [
    (FORCE, "log(1.5 - t)", 1.5),
    (FORCE, "sqrt(1 - t)", 1.0),
    (FORCE, "asin(2*t)", 0.5),
    (FORCE, "1/p.rate", 0.0),
    (FORCE, "(-1)**t", 0.0),
    (FORCE, "1 if t < 1 else log(t - 2)", 1.0),
    (TORQUE, "log(1 - t)", 1.0),
    (DRIVE, "sqrt(1 - t)", 1.0),
])  # fmt: skip
def test_named_with_place_text_and_instant(load: str, value: str, instant: float) -> None:
    problem = told(load, value)
    assert problem.code == "no-value"
    assert problem.message.startswith(f"'{value}' has no finite value at t = ")
    assert at(problem) == pytest.approx(instant, abs=1e-6)
    key = {FORCE: "forces.f.vector.0", TORQUE: "forces.f.value", DRIVE: "drives.d.angle"}[load]
    assert problem.location is not None
    assert (problem.location.line, problem.location.column, problem.location.path) == (
        10,
        load.index('"VALUE') + 1,
        key,
    )
    assert problem.hint


@pytest.mark.parametrize(("value", "instant"), [("1/(t - 0.33)", 0.33), ("tan(pi*t)", 0.5)])
def test_a_pole_is_named(value: str, instant: float) -> None:
    """Its value is finite at every instant that the run can come to."""
    problem = told(FORCE, value)
    assert "grows without bound" in problem.message
    assert at(problem) == pytest.approx(instant, abs=1e-6)


@pytest.mark.parametrize(("load", "value", "instant", "table"), [
    (FORCE, "table(g, t)", 1.0, "g"),
    (FORCE, "table(h, t) + table(g, 2*t)", 0.5, "g"),
    (FORCE, "table(h, 2*t) + table(g, t)", 0.5, "h"),
    (DRIVE, "table(g, t)", 1.0, "g"),
])  # fmt: skip
def test_a_table_that_is_left_tells_its_range(load: str, value: str, instant: float, table: str) -> None:
    problem = told(load, value)
    assert at(problem) == pytest.approx(instant, abs=1e-6)
    assert problem.message.endswith(f"table {table} covers x from 0 to 1 (SI)")
    assert "period" in (problem.hint or "")


def test_coordinates_are_those_of_the_pose() -> None:
    problem = told(FORCE, "table(g, p.angle)")
    assert problem.message.endswith("s, p.angle = 1: table g covers x from 0 to 1 (SI)")
    problem = told(FORCE, "sqrt(0.2 - p.angle)")
    assert re.search(r"s, p\.angle = 0\.2(0000\d*)?$", problem.message)
    assert at(problem) > 0.1


def test_a_load_in_a_loop() -> None:
    scene = crank_rocker(0.5, 0.0)
    scene["forces"] = {"f": {"type": "torque", "joint": "A", "value": "1/A.rate"}}
    with pytest.raises(SolveError) as raised:
        solved(moving(scene, (0.0, 1.0)))
    assert "'1/A.rate' has no finite value at t = 0 s, A.rate = 0" in str(raised.value)


def test_one_instant_is_judged_as_a_run_is() -> None:
    scene = SCENE.replace("duration: 2, samples: 5", "type: state")
    with pytest.raises(SolveError) as raised:
        solved(scene.replace("LOAD", FORCE.replace("VALUE", "log(t)")))
    assert "forces.f.vector.0: 'log(t)' has no finite value at t = 0 s" in str(raised.value)


def test_each_that_fails_is_told() -> None:
    force = FORCE.replace('["VALUE", 0, 0]', '["log(1 - t)", 0, "3*log(1 - t)"]')
    with pytest.raises(SolveError) as raised:
        solved(SCENE.replace("LOAD", force))
    paths = [p.location.path for p in raised.value.problems if p.location]
    assert paths == ["forces.f.vector.0", "forces.f.vector.2"]


@pytest.mark.parametrize("value", ["table(g, 5)", "t*table(g, 5)", "table(g, 5) if 1 else 0"])
def test_a_constant_outside_its_table_is_told_when_read(value: str) -> None:
    with pytest.raises(SpecError) as raised:
        solved(SCENE.replace("LOAD", FORCE.replace("VALUE", value)))
    (problem,) = raised.value.problems
    assert (problem.code, problem.message) == ("not-computable", "table g covers x from 0 to 1 (SI), not 5")
    assert "period" in (problem.hint or "")


def test_a_branch_that_is_not_chosen_may_leave_its_table() -> None:
    text = SCENE.replace("LOAD", FORCE.replace("VALUE", "1 if t < 9 else table(g, 5)"))
    assert solved(text).status["code"] == "completed"


def at(problem: Problem) -> float:
    """The instant that is told."""
    found = re.search(r"t = ([\d.e+-]+) s", problem.message)
    assert found is not None
    return float(found[1])
