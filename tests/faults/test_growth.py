"""What grows without bound, and motions too fast to follow: told soon, with the instant and the name."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from heuncli.base.errors import HeunError, LimitError, Problem, SolveError
from heuncli.base.process import current_listener, progress_listener
from heuncli.base.tolerances import MOST_STEPS
from heuncli.motion.integration.run import supervision
from heuncli.motion.integration.run.progress import FIRST_LOOK, project_steps
from tests.shared.scenes import solved

SCENE = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  bar: {mass: 1, center: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1], points: {a: [0, 0, 0]}}
joints: {w: {type: JOINT, from: ground.O, to: bar.a, axis: [0, 1, 0]}}
LOAD
analysis: {duration: 2, samples: 5, method: METHOD}
"""
TORQUE = 'forces: {f: {type: torque, joint: w, value: "VALUE"}}'
DRIVE = 'drives: {d: {joint: w, angle: "VALUE"}}'


def scene(joint: str, load: str, method: str) -> str:
    return SCENE.replace("JOINT", joint).replace("LOAD", load).replace("METHOD", method)


def told(joint: str, load: str, method: str = "auto") -> tuple[HeunError, Problem]:
    with pytest.raises(HeunError) as raised:
        solved(scene(joint, load, method))
    (problem,) = raised.value.problems
    return raised.value, problem


def at(problem: Problem) -> float:
    found = re.search(r"at t = ([\d.e+-]+) s", problem.message)
    assert found is not None
    return float(found[1])


@pytest.mark.heavy
@pytest.mark.parametrize(("joint", "load", "value"), [
    ("pin", TORQUE, "exp(1000*t)"),
    ("slide", TORQUE, "exp(1000*t)"),
    ("pin", TORQUE, "exp(20*t)"),
    ("pin", DRIVE, "exp(1000*t)"),
    ("slide", TORQUE, "1000*w.travel + 1"),
    ("pin", TORQUE, "1000*w.rate + 1"),
    ("pin", TORQUE, "w.rate**2 + 1"),
])  # fmt: skip
def test_what_grows_is_named(joint: str, load: str, value: str) -> None:
    """It has grown a thousandfold since a quarter of the time, and the run has not gone on much beyond that."""
    error, problem = told(joint, load.replace("VALUE", value))
    assert isinstance(error, SolveError)
    assert problem.code == "no-value"
    assert problem.message.startswith(f"'{value}' grows without bound at t = ")
    assert problem.location is not None and problem.location.line == 7
    assert 0.0 < at(problem) < 2.0
    assert problem.hint


TOO_FAST = [
    ("f: {type: friction, joint: w, force: 10, speed: 1e-12}, g: {type: torque, joint: w, value: 3}", math.atanh(0.3)),
    ("f: {type: damper, joint: w, coefficient: 1e12}, g: {type: torque, joint: w, value: 3}", 3.0),
]


@pytest.mark.parametrize(("loads", "creeps"), TOO_FAST)
def test_an_implicit_method_steps_over_what_is_too_fast(loads: str, creeps: float) -> None:
    """The speed is at once that at which the resistance is 3 N: 1e-12 atanh(3/10), or 3e-12."""
    found = solved(scene("slide", f"forces: {{{loads}}}", "auto")).coordinates["w"]
    assert found["speed"][-1] == pytest.approx(1e-12 * creeps, rel=1e-6)
    assert found["travel"][-1] == pytest.approx(2e-12 * creeps, rel=1e-6)


@pytest.mark.heavy
@pytest.mark.parametrize("loads", [loads for loads, _ in TOO_FAST])
def test_what_is_too_fast_is_a_limit_at_once(loads: str) -> None:
    """Nothing grows: what would be needed is told after some thousands of the twenty million steps."""
    error, problem = told("slide", f"forces: {{{loads}}}", "DOP853")
    assert isinstance(error, LimitError)
    assert problem.code == "step-limit"
    found = re.match(r"(\d+) steps were done at t = .* for the whole run about (\S+) would be needed", problem.message)
    assert found is not None
    assert int(found[1]) <= 16 * FIRST_LOOK and float(found[2]) > MOST_STEPS


def test_a_load_beyond_all_measure_is_named() -> None:
    error, problem = told("pin", TORQUE.replace("VALUE", "1e59"))
    assert isinstance(error, SolveError)
    assert problem.code == "step-collapsed"
    assert "the largest load is forces.f, 1e+59" in (problem.hint or "")


@pytest.mark.parametrize(("instants", "last", "steps"), [
    (lambda n: n, 1e6, 1e6),  # a steady pace
    (np.sqrt, 1e3, 1e6),  # a rate in proportion to the time
    (lambda n: 5.0 + np.sqrt(n), 1005.0, 1e6),  # the same, begun later
    (np.log2, 20.0, 2.0**20),  # an exponential growth
    (lambda n: 1.0 - 1.0 / n, 1.0 - 1e-6, 1e6),  # a pole that lies beyond the end
    (lambda n: 1.0 - 1.0 / n, 2.0, math.inf),  # and one before it
])  # fmt: skip
def test_the_steps_projected(instants, last: float, steps: float) -> None:  # type: ignore[no-untyped-def]
    """Paces in closed form, told from their first 2,000 steps."""
    ends = instants(np.arange(1.0, FIRST_LOOK + 1.0))
    assert project_steps(ends, last) == pytest.approx(steps, rel=1e-6)


def test_a_limit_that_is_reached_tells_the_pace() -> None:
    with pytest.raises(LimitError) as raised:
        solved(scene("pin", "", "DOP853").replace("duration: 2,", "duration: 2e6,"), time_limit=0.5)
    (problem,) = raised.value.problems
    assert problem.code == "time-limit"
    found = re.search(r"reached at t = (\S+) s of 2e\+06 s; .* the rest would take about (\S+) s$", problem.message)
    assert found is not None
    assert 0.1 < float(found[2]) * float(found[1]) / 2e6 / 0.5 < 10.0  # it swings on at one pace


GIMBAL = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  outer: {mass: 1e-12, center: [0, 0, 0], inertia: [1e-14, 1e-14, 1e-14], points: {o: [0, 0, 0]}}
  ring: {mass: 1e-12, center: [0, 0, 0], inertia: [1e-14, 1e-14, 1e-14], points: {o: [0, 0, 0]}}
  rotor: {mass: 1, center: [0.1, 0, 0.05], inertia: [0.01, 0.02, 0.02], points: {o: [0, 0, 0]}}
joints:
  a: {type: pin, from: ground.O, to: outer.o, axis: [0, 0, 1]}
  b: {type: pin, from: outer.o, to: ring.o, axis: [0, 1, 0], initial: {angle: 1e-4, rate: -0.5}}
  c: {type: pin, from: ring.o, to: rotor.o, axis: [0, 0, 1], initial: {rate: 0.5}}
analysis: {duration: 1, samples: 11}
"""
SHEAVE = """\
heun: 1
space: planar
gravity: [0, -9.81]
ground: {points: {A: [-0.1, 2], B: [0.1, 2.5]}}
bodies:
  sheave: {mass: 1e-9, center: [0, 0], inertia: 1e-12, points: {o: [0, 0]}}
  load: {mass: 1, center: [0, -1], inertia: 1e-2, points: {o: [0, -0.9]}}
couplings:
  r: {type: rope, through: [ground.A, {sheave: sheave.o, radius: 0.1}, ground.B], stiffness: 1e5}
  q: {type: rope, through: [sheave.o, load.o], stiffness: 1e5}
analysis: {duration: 1, samples: 11}
"""
PINNED = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 2]}}
bodies:
  sheave: {mass: 1e-9, center: [0, 0, 2], inertia: [1e-12, 1e-12, 1e-12], points: {o: [0, 0, 2]}}
  l: {mass: 1, center: [0.1, 0, 0], inertia: [1e-2, 1e-2, 1e-2], points: {o: [0.1, 0, 0]}}
  m: {mass: 1.2, center: [-0.1, 0, 0], inertia: [1e-2, 1e-2, 1e-2], points: {o: [-0.1, 0, 0]}}
joints:
  p: {type: pin, from: ground.O, to: sheave.o, axis: [0, 1, 0]}
  gl: {type: slide, from: {body: ground, at: [0.1, 0, 0]}, to: l.o, axis: [0, 0, 1]}
  gm: {type: slide, from: {body: ground, at: [-0.1, 0, 0]}, to: m.o, axis: [0, 0, 1]}
couplings: {r: {type: rope, through: [l.o, {sheave: sheave.o, radius: 0.1}, m.o], stiffness: 1e5}}
analysis: {duration: 1, samples: 11}
"""


@pytest.mark.heavy
@pytest.mark.parametrize(("text", "reasons"), [
    (GIMBAL, (r"because of bodies\.(outer|ring) \(1e-12 kg, 1e-14", r"joints\.a and joints\.c are 1\.\de-05 rad")),
    (SHEAVE, (r"because of bodies\.sheave \(1e-09 kg, 1e-12", r"at 2\.\de\+07 1/s, resisted by an inertia of only 1e")),
])  # fmt: skip
def test_a_run_that_is_given_up_names_the_light_body(text: str, reasons: tuple[str, ...]) -> None:
    """A ring of a gimbal near lock; a sheave between ropes: sqrt((2 k + k + ...) / m) is some 1e7 1/s."""
    with pytest.raises(LimitError) as raised:
        solved(text)
    for reason in reasons:
        assert re.search(reason, raised.value.problems[0].message)


class Heard(Exception):
    """What was announced."""


@pytest.mark.heavy
def test_a_long_run_says_so_while_it_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    """A sheave of 1e-9 kg on a pin, whose spin answers to rounding of the rope's pull: named, with the reason."""
    monkeypatch.setattr(supervision, "PATIENCE", 0.5)
    monkeypatch.setattr(supervision, "LONG_RUN", 1.0)

    def hear(text: str) -> None:
        raise Heard(text)

    with (
        pytest.raises(Heard, match=r"long run: .*bodies\.sheave \(1e-09 kg.*rounding.*--time-limit"),
        progress_listener(hear),
    ):
        solved(PINNED)
    assert current_listener() is None
