"""SciPy's integrators as independent checks: the same motions, to what both tell of their errors; or a refusal."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.errors import LimitError, SolveError, SpecError
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve
from tests.shared.bars import double
from tests.shared.scenes import study

METHODS = ["SciPy-Radau", "SciPy-BDF", "SciPy-LSODA"]
BAR = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bar: {{mass: 1, center: [0, 0, -0.5], inertia: [0.08, 0.08, 0.001], points: {{top: [0, 0, 0], end: [0, 0, -1]}}}}
joints:
  pivot: {{type: pin, axis: [0, 1, 0], from: ground.O, to: bar.top}}
{more}
analysis: {{duration: 1, samples: 21, tolerance: 1e-7}}
"""
FOUR_BAR = """\
heun: 1
gravity: [0, -9.81, 0]
ground: {points: {A: [0, 0, 0], D: [2, 0, 0]}}
bodies:
  crank: {mass: 1, center: [0, 0.5, 0], inertia: [0.1, 0.01, 0.1], points: {a: [0, 0, 0], b: [0, 1, 0]}}
  rod:
    mass: 2
    center: [1.1, 0.2, 0]
    inertia: [0.1, 0.8, 0.9]
    points: {b: [0, 0, 0], c: [2.1, 0.5, 0]}
    position: [0, 1, 0]
  rocker:
    mass: 1
    center: [0.05, 0.7, 0]
    inertia: [0.2, 0.01, 0.2]
    points: {d: [0, 0, 0], c: [0.1, 1.5, 0]}
    position: [2, 0, 0]
joints:
  A: {type: pin, axis: [0, 0, 1], from: ground.A, to: crank.a}
  B: {type: pin, axis: [0, 0, 1], from: crank.b, to: rod.b}
  C: {type: pin, axis: [0, 0, 1], from: rod.c, to: rocker.c}
  D: {type: pin, axis: [0, 0, 1], from: ground.D, to: rocker.d}
analysis: {duration: 1, samples: 21, tolerance: 1e-7}
"""
SCENES = {
    "two balls": double("{duration: 1, samples: 21, tolerance: 1e-7}"),
    "a loop": FOUR_BAR,
    "a load that jumps in time": BAR.format(
        more="forces: {push: {type: force, on: bar.end, vector: [5*step(t - 0.43), 0, 0]}}"
    ),
    "stiff": BAR.format(more="forces: {brake: {type: damper, joint: pivot, coefficient: 2e4}}"),
}


@pytest.mark.heavy
@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("method", METHODS)
def test_the_motion_is_the_kernels(name: str, method: str) -> None:
    spec = load("scene.yaml", SCENES[name])
    own, other = (solve(spec, Options(method=m, reduce=m == "auto")).results for m in ("auto", method))
    assert other.model["method"] == method
    size = study(SCENES[name]).setup.runner.size
    bound = own.accuracy["estimate"]["motion"] + other.accuracy["estimate"]["motion"]
    assert bound < 1e-5
    for body, block in own.bodies.items():
        assert float(np.abs(block["center"] - other.bodies[body]["center"]).max()) <= bound * size


@pytest.mark.heavy
@pytest.mark.parametrize("method", METHODS)
def test_between_the_asked_instants(method: str) -> None:
    """Dense output within the steps; at the asked instants what was told."""
    spec = load("scene.yaml", SCENES["a load that jumps in time"])
    run = solve(spec, Options(method=method))
    asked = np.array(spec.analysis.times)
    times = np.sort(np.concatenate([asked, 0.5 * (asked[1:] + asked[:-1])]))
    finer, own = run.resample(times), solve(spec).resample(times)
    assert np.array_equal(finer.bodies["bar"]["center"][::2], run.results.bodies["bar"]["center"])
    assert np.abs(finer.bodies["bar"]["center"] - own.bodies["bar"]["center"]).max() < 1e-6


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ("stops: {buffer: {joint: pivot, angle: [-1, 1]}}", "the stop buffer"),
        ("impulses: {blow: {on: bar.end, vector: [1, 0, 0], time: 0.5}}", "the impulse blow"),
        ("forces: {push: {type: torque, joint: pivot, value: 'sign(pivot.rate)'}}", "sign(pivot.rate)"),
        ("drives: {turn: {joint: pivot, rate: '1 if t < 0.5 else 2'}}", "the drive turn, whose rate jumps"),
    ],
)
def test_what_they_do_not_run_is_refused_by_name(more: str, told: str) -> None:
    """By an option before anything moves; written in the spec by its place, where validate sees it."""
    text = BAR.format(more=more)
    with pytest.raises(SpecError, match="SciPy-BDF does not support") as caught:
        solve(load("scene.yaml", text), Options(method="scipy-bdf"))
    assert told in caught.value.problems[0].message
    with pytest.raises(SpecError, match="SciPy-BDF cannot handle") as read:
        load("scene.yaml", text.replace("analysis: {", "analysis: {method: SciPy-BDF, "))
    assert told in read.value.problems[0].message
    assert read.value.problems[0].location is not None


@pytest.mark.heavy
@pytest.mark.parametrize("method", METHODS)
def test_what_grows_without_bound_is_no_result(method: str, capfd: pytest.CaptureFixture[str]) -> None:
    """A rate that feeds itself reaches infinity at t = 0.4: an error that says when, and nothing on standard output."""
    spec = load("scene.yaml", BAR.format(more="forces: {push: {type: torque, joint: pivot, value: pivot.rate**3 + 5}}"))
    with pytest.raises((SolveError, LimitError)):
        solve(spec, Options(method=method, tolerance=1e-5, time_limit=10))
    assert capfd.readouterr().out == ""


@pytest.mark.heavy
@pytest.mark.parametrize("method", METHODS)
def test_a_pulse_that_they_pass_over_is_told_as_an_error(method: str) -> None:
    """A blow of 1 N s within a hundredth of a second: SciPy's steps are longer by then, and see nothing of it."""
    push = "1/(0.01*sqrt(pi))*exp(-((t - 0.5123)/0.01)**2)"
    text = BAR.format(more=f"forces: {{push: {{type: torque, joint: pivot, value: {push}}}}}").replace("-9.81", "0")
    spec = load("scene.yaml", text)
    right, run = solve(spec, Options(tolerance=1e-12)).results, solve(spec, Options(method=method))
    found, size = run.results, run.setup.runner.size
    known = found.time < (found.accuracy["horizon"] or np.inf)
    off = np.linalg.norm(found.bodies["bar"]["center"] - right.bodies["bar"]["center"], axis=1)
    told = found.accuracy["estimate"]["motion"] + right.accuracy["estimate"]["motion"]
    assert np.all(off[known] <= min(told, 1e-3) * size)
