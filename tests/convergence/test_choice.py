"""`method: auto`: what it begins with, by the scene and the tolerance, and what it goes on with among many events."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.motion.integration.run.request import MotionTask, StoppingRules
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.queries.study import Study
from heuncli.study.workflow import describe, solve
from tests.shared.folders import SPECS
from tests.shared.scenes import near, study

# a ball that bounces some twenty times and lies still, beside a pendulum that swings on
BESIDE_A_PENDULUM = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {floor: [0, 0, 0], O: [3, 0, 0]}}
bodies:
  ball: {mass: 1, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {c: [0, 0, 0]}}
  bob: {mass: 1, center: [0, 0, -1], inertia: [0.1, 0.1, 0.1], points: {top: [0, 0, 0]}}
joints:
  guide: {type: slide, from: ground.floor, to: ball.c, axis: [0, 0, 1], initial: {travel: 0.1}}
  pivot: {type: pin, from: ground.O, to: bob.top, axis: [0, 1, 0], initial: {angle: 1, rate: 0}}
stops: {buffer: {joint: guide, travel: [0, null], restitution: 0.3}}
analysis: {duration: 20, samples: 21}
"""


def spec(name: str) -> str:
    return (SPECS / f"{name}.yaml").read_text()


def events(s: Study) -> list[str]:
    return [reason for reason in s.results.model["reasons"] if reason.startswith("events (")]


@pytest.mark.parametrize("name", ["bouncing_ball", "punch", "engine"])
def test_events_that_end_most_steps_are_met_by_a_method_of_few_stages(name: str) -> None:
    """In fewer evaluations, and to the same motion within the two estimates."""
    read = load(str(SPECS / f"{name}.yaml"))
    s, by_name = solve(read), solve(read, Options(method="DOP853"))
    assert s.results.model["method"] == "DOPRI5" and len(events(s)) == 1
    assert s.results.work["evaluations"] < 0.7 * by_name.results.work["evaluations"]
    off = max(
        np.abs(s.results.bodies[body]["center"] - by_name.results.bodies[body]["center"]).max()
        for body in s.results.bodies
    )
    told = sum(one.results.accuracy["estimate"]["motion"] for one in (s, by_name))
    assert told <= 1e-9
    assert off <= told * s.setup.scene.layout.size
    assert len(s.results.impulses) == len(by_name.results.impulses)


def test_where_events_become_rare_the_run_is_begun_anew() -> None:
    s = study(BESIDE_A_PENDULUM)
    assert s.results.model["method"] == "DOP853" and not events(s)
    by_name = study(BESIDE_A_PENDULUM, method="DOP853")
    assert s.results.work["evaluations"] == by_name.results.work["evaluations"]
    assert np.array_equal(s.results.coordinates["pivot"]["angle"], by_name.results.coordinates["pivot"]["angle"])


@pytest.mark.parametrize("name", ["press", "lamp", "door_closer", "friction", "struck_door"])
def test_looking_at_events_changes_no_bit(name: str) -> None:
    s = study(spec(name), method="DOP853")
    jumps = s.history.jumps
    runs = [
        s.setup.runner.run(MotionTask(s.results.time, 1e-9, discontinuities=jumps), StoppingRules(events=eventful))
        for eventful in (False, True)
    ]
    assert np.array_equal(runs[0].states, runs[1].states)
    assert np.array_equal(runs[0].ends, runs[1].ends)


@pytest.mark.parametrize(
    ("name", "tolerance", "method"),
    [
        ("double", 1e-9, "DOP853"), ("double", 3e-11, "DOP853"), ("double", 1e-11, "Verner98"),
        ("double", 1e-12, "Verner98"), ("struck_door", 1e-12, "DOP853"), ("press", 1e-12, "DOP853"),
        ("lamp", 1e-12, "DOP853"),
        ("whirling_rod", 1e-12, "none: each instant is solved separately"),
    ],
)  # fmt: skip
def test_small_tolerances_take_order_nine_where_nothing_ends_steps(name: str, tolerance: float, method: str) -> None:
    s = study(spec(name), tolerance=tolerance)
    assert s.results.model["method"] == method
    assert s.results.accuracy["estimate"]["motion"] <= tolerance
    if method == "Verner98":
        fine = study(spec(name), method="DOP853", tolerance=1e-13)
        size = s.setup.scene.layout.size
        for body in s.results.bodies:
            near(s.results.bodies[body]["center"], fine.results.bodies[body]["center"], size, 1.2 * tolerance)


@pytest.mark.parametrize("name", ["bouncing_ball", "punch", "double", "friction"])
def test_the_note_on_the_model_and_the_run_agree(name: str) -> None:
    assert describe(load("scene.yaml", spec(name)))["method"] == study(spec(name)).results.model["method"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("duration: 0.5", "short motion: "),
        ("duration: 600", "long and conservative, about 150 "),
    ],
)
def test_reasons_tell_the_kind_of_motion(change: str, words: str) -> None:
    swing = BESIDE_A_PENDULUM.replace("stops:", "# stops:").replace("duration: 20", change)
    reasons = describe(load("scene.yaml", swing))["reasons"]
    assert [reason for reason in reasons if reason.startswith(words)]
    assert "not expected to be stiff" in reasons[-1]
