"""The errors that a chart tells, against closed forms; its reference, against quadruple precision."""

from __future__ import annotations

import json
import math
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

from heuncli.analyses.work_precision import study as chart_runs
from heuncli.analyses.work_precision.plan import ChartOptions, make_motion
from heuncli.analyses.work_precision.reference import find_reference
from heuncli.analyses.work_precision.results import ChartResults, ChartRow, ChartRun
from heuncli.analyses.work_precision.study import ChartRunner, chart
from heuncli.motion.integration.check.runs import Runs
from heuncli.motion.integration.methods.explicit import DOP853
from heuncli.motion.integration.run.request import MotionTask
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.scene.file_format.load import load

SCENES = Path(__file__).parents[1] / "bench" / "scenes"
REFERENCE = json.loads((SCENES / "reference.json").read_text())
G, START = 9.81, math.radians(100.0)
PENDULUM = """\
heun: 1
title: A uniform rod swings
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  rod:
    shapes: [{type: rod, from: [0, 0, 0], to: [0, 0, -1], mass: 1}]
    points: {top: [0, 0, 0], tip: [0, 0, -1]}
joints:
  pivot: {type: pin, from: ground.O, to: rod.top, axis: [0, 1, 0], initial: {angle: 100 deg}}
sections:
  middle: {body: rod, at: [0, 0, -0.5], normal: [0, 0, -1]}
analysis: {duration: 4, samples: 161}
"""
TOLERANCES = (1e-4, 1e-6, 1e-8)


def swing(t: Any) -> tuple[Any, Any]:
    """Angle and rate of the rod, let go at START: sin(theta/2) = k cd(w t | k^2), w^2 = 3 g / 2 L."""
    k, w = math.sin(START / 2.0), math.sqrt(1.5 * G)
    m = k * k
    sn, cn, dn, _ = ellipj(w * t + ellipk(m), m)
    half = k * sn
    return 2.0 * np.arcsin(half), 2.0 * k * w * cn * dn / np.sqrt(1.0 - half**2)


def pivot_force(angle: Any, rate: Any) -> Any:
    """What the ground exerts on the rod, (n, 2) along x and z: m (a - g), a of the centre at half the length."""
    turning = -1.5 * G * np.sin(angle)
    out = np.stack([-np.sin(angle), -np.cos(angle)], axis=-1)  # towards the tip, for the angle about y is positive so
    across = np.stack([-np.cos(angle), np.sin(angle)], axis=-1)
    a = 0.5 * (turning[:, None] * across - rate[:, None] ** 2 * out)
    return a + np.array([0.0, G])


@pytest.fixture(scope="module")
def pendulum() -> ChartResults:
    return chart(load("pendulum.yaml", PENDULUM), ChartOptions(("DOP853",), TOLERANCES))


def test_the_errors_of_a_pendulum_are_those_of_the_closed_form(pendulum: ChartResults) -> None:
    """The tip's distance from where it should be, and the pivot's force."""
    motion = make_motion(load("pendulum.yaml", PENDULUM), None)
    angle, rate = swing(motion.times)
    wanted = pivot_force(angle, rate)
    size = motion.setup.scene.layout.size
    for run, tolerance in zip(pendulum.runs, TOLERANCES, strict=True):
        own = motion.setup.runner.run(MotionTask(motion.times, tolerance, method=DOP853))
        answers = motion.setup.runner.evaluate(motion.times, own.states)
        off = np.abs(answers.freedoms["q"][:, 0] - angle)
        tip = float(np.max(2.0 * np.sin(off / 2.0))) / size
        assert run.error["motion"] == pytest.approx(max(tip, off.max() / np.abs(angle).max()), rel=1e-3, abs=3e-13)
        force = np.linalg.norm(answers.bodies["joint_force"][:, 0][:, [0, 2]] - wanted, axis=1).max()
        assert run.error["reactions"] == pytest.approx(force / np.linalg.norm(wanted, axis=1).max(), rel=1e-3)


def test_sections_stand_where_there_are_some(pendulum: ChartResults) -> None:
    assert pendulum.kinds == ("motion", "reactions", "sections")
    for run in pendulum.runs:
        motion, sections = run.error["motion"] or 0.0, run.error["sections"] or 0.0
        assert 0.01 * motion < sections < 100.0 * motion


@pytest.mark.parametrize("name", ["double", "top", "chain10", "crank"])
def test_a_reference_is_as_good_as_it_says(name: str) -> None:
    """The end states of the benchmark scenes are known in quadruple precision, to 1e-13 m."""
    motion = make_motion(load(str(SCENES / f"{name}.yaml")), None)
    found = find_reference(motion)
    scene, run = motion.setup.scene, found.comparison.reference
    bodies = motion.setup.runner.evaluate(run.times[-1:], run.states[-1:]).bodies[0]
    own = found.reference.error["motion"]
    assert own is not None and own < 1e-9
    for i, body in enumerate(scene.mechanism.bodies):
        k = scene.layout.place[i]
        centre = bodies["r"][k] + bodies["R"][k] @ (body.center - scene.layout.reference[k])
        off = np.linalg.norm(centre - REFERENCE[name]["center"][body.name])
        assert off <= own * scene.layout.size + 1e-13


FREE = """\
heun: 1
title: A free top
bodies: {top: {mass: 1, center: [0, 0, 0], inertia: [1, 2, 2.5], angular_velocity: [0.9, 0, 1.1]}}
analysis: {times: [1, 10]}
"""


def test_a_free_top_has_no_reactions_and_turns_as_it_should() -> None:
    """Momentum stays: what the chart calls the error of the motion is that of where the axes point."""
    found = chart(load("free.yaml", FREE), ChartOptions(("DOP853",), (1e-4, 1e-8)))
    assert found.kinds == ("motion",)
    coarse, fine = (run.error["motion"] or 0.0 for run in found.runs)
    assert fine < 1e-5 and coarse > 1e3 * fine


BALL = """\
heun: 1
title: A ball falls onto a stop
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  ball: {mass: 1, center: [0, 0, 0], inertia: [0.01, 0.01, 0.01], points: {c: [0, 0, 0]}, position: [0, 0, 1]}
joints:
  guide: {type: slide, from: ground.O, to: ball.c, axis: [0, 0, 1]}
stops: {floor: {joint: guide, travel: [0, null], restitution: 0.8}}
analysis: {duration: 1.5, samples: 151}
"""


def test_strikes_are_met_by_all_and_errors_do_not_see_the_jump() -> None:
    found = chart(load("ball.yaml", BALL), ChartOptions(("DOP853",), (1e-4, 1e-8)))
    for run in found.runs:
        assert run.status == "completed" and (run.error["motion"] or 1.0) < 1e-10


def test_references_that_part_are_judged_up_to_where_they_agree() -> None:
    """manual/theory.md, "Chaos": growth of about 1.9 a second; a bar beside another, from (2.5, 2.5) at rest."""
    scene = """\
heun: 1
title: Two bars, chaotic
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  a: {shapes: [{type: rod, from: [0, 0, 0], to: [0, 0, -1], mass: 1}], points: {o: [0, 0, 0], e: [0, 0, -1]}}
  b: {shapes: [{type: rod, from: [0, 0, 0], to: [0, 0, -1], mass: 1}], points: {o: [0, 0, 0], e: [0, 0, -1]}}
joints:
  p: {type: pin, axis: [0, 1, 0], from: ground.O, to: a.o, initial: {angle: 2.5}}
  q: {type: pin, axis: [0, 1, 0], from: a.e, to: b.o, initial: {angle: 0}}
analysis: {duration: 20, samples: 401}
"""
    found = chart(load("chaotic.yaml", scene), ChartOptions(("DOP853",), (1e-6, 1e-12)))
    reference = found.reference
    assert reference.horizon is not None and 12.0 < reference.horizon < 18.0
    assert (
        0.4 * reference.horizon < reference.last_time < reference.horizon and (reference.error["motion"] or 1) <= 1e-8
    )
    assert "allows no comparison" in reference.notes[0]
    coarse, fine = (run.error["motion"] or 0.0 for run in found.runs)
    assert coarse > 1e-3 > fine


def row(found: ChartResults, local: float) -> ChartRun:
    return next(run for run in found.runs if run.row.local == local)


def test_a_row_that_would_take_too_long_is_not_run() -> None:
    motion = make_motion(load("pendulum.yaml", PENDULUM), None)
    charting = ChartRunner(motion, find_reference(motion), lambda done, of, what: None)
    found = charting.run_row(ChartRow("DOP853", "quaternion", True, 1e-9))
    assert isinstance(found, ChartRun) and found.status == "not run" and found.code == "too-long"
    assert found.reason.startswith("about 4e9 steps") and found.seconds is not None and found.seconds > 1.0


def charting_of(text: str) -> ChartRunner:
    motion = make_motion(load("scene.yaml", text), None)
    return ChartRunner(motion, find_reference(motion), lambda done, of, what: None)


def test_what_a_coarser_tolerance_did_not_finish_is_not_run_at_a_finer_one() -> None:
    charting = charting_of(PENDULUM)
    charting.limit = -1.0
    first, second = (charting.run_row(ChartRow("DOP853", "quaternion", False, local)) for local in (1e-4, 1e-6))
    assert isinstance(first, ChartRun) and first.code == "unfinished"
    assert isinstance(second, ChartRun) and second.code == "too-long" and "0.0001 did not finish" in second.reason


def test_a_run_may_take_its_time_where_the_machine_does_other_work(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a limit of 40 ms on the clock 80 ms are slept away: no part of it, so that the run is done once more."""
    charting = charting_of(PENDULUM)
    run, slept = ChartRunner.run, []

    def interrupted(self: ChartRunner, row: ChartRow, runs: Runs) -> Trajectory:
        if not slept:
            time.sleep(0.08)
            slept.append(row)
        return run(self, row, runs)

    monkeypatch.setattr(ChartRunner, "run", interrupted)
    charting.limit = 0.04
    found = charting.run_row(ChartRow("DOP853", "quaternion", False, 1e-6))
    assert slept and not isinstance(found, ChartRun) and found.chart_run.status == "completed"


def test_no_import_is_in_the_time_of_a_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """What SciPy takes to load, half a second, would else be all of the first row's time."""
    done: list[str] = []
    monkeypatch.setattr(chart_runs, "import_module", lambda name: done.append(name))
    run = ChartRunner.run
    monkeypatch.setattr(ChartRunner, "run", lambda self, row, runs: done.append("run") or run(self, row, runs))
    charting_of(PENDULUM).run_row(ChartRow("SciPy-BDF", "quaternion", False, 1e-3))
    assert done[:2] == ["scipy.integrate", "run"]


def test_a_run_that_is_lost_has_lost_its_reactions() -> None:
    """RK4 in steps of 9e4 time constants ends 1e122 sizes off: what its joint would carry then is no rounding."""
    scene = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies: {bar: {mass: 1, center: [0, 0, -0.5], inertia: [0.1, 0.1, 0.01], points: {top: [0, 0, 0]}}}
joints: {pivot: {type: pin, from: ground.O, to: bar.top, axis: [0, 1, 0], initial: {angle: 1.2, rate: 1}}}
forces: {oil: {type: damper, joint: pivot, coefficient: 1e5}}
analysis: {duration: 2, samples: 21}
"""
    found = chart(load("scene.yaml", scene), ChartOptions(methods=("RK4",), steps=(0.3,)))
    (run,) = found.runs
    assert run.error["motion"] is not None and run.error["motion"] > 1.0
    assert run.error["reactions"] is not None and run.error["reactions"] > 1.0
