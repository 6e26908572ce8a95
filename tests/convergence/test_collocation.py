"""Methods by collocation: their numbers against what defines them, their order, and stiff motions by them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.base import tolerances
from heuncli.base.errors import LimitError, SolveError
from heuncli.motion.integration.methods.collocation import GAUSS4, GAUSS6, RADAU5, RADAU9
from heuncli.motion.integration.methods.method import Method, load_method_by_name
from heuncli.motion.integration.run.request import MotionTask
from heuncli.results.results import Array, Results
from tests.bench.stiff import STIFF_SCENES
from tests.shared.bars import double
from tests.shared.event_scenes import EVENTS
from tests.shared.folders import SPECS
from tests.shared.scenes import solved, study
from tests.shared.slopes import fitted

METHODS = [GAUSS4, GAUSS6, RADAU5, RADAU9]
NAMES = ["Radau5", "Radau9"]
ROUNDING = 1e-12  # of sums of some ten terms as large as 30


def full(method: Method) -> tuple[Array, Array, Array]:
    """Nodes, coefficients and weights as arrays."""
    s = len(method.stages)
    A = np.zeros((s, s))
    for i, row in enumerate(method.stages):
        for stage, c in row:
            A[i, stage - 1] = c
    b = np.zeros(s)
    for stage, c in method.solution:
        b[stage - 1] = c
    return np.array(method.nodes[1:]), A, b


# The numbers


@pytest.mark.parametrize("method", METHODS, ids=lambda m: m.name)
def test_powers_are_integrated(method: Method) -> None:
    """C(s) and B(p): sum a_ij c_j^(k-1) = c_i^k / k for k <= s, sum b_j c_j^(k-1) = 1 / k for k <= p and no more."""
    c, A, b = full(method)
    for k in range(1, len(c) + 1):
        assert A @ c ** (k - 1) == pytest.approx(c**k / k, abs=1e-15)
    for k in range(1, method.order + 1):
        assert b @ c ** (k - 1) == pytest.approx(1.0 / k, abs=1e-15)
    assert abs(b @ c**method.order - 1.0 / (method.order + 1)) > 1e-6


@pytest.mark.parametrize("method", METHODS, ids=lambda m: m.name)
def test_what_the_iteration_takes(method: Method) -> None:
    """A^-1 = T L T^-1, the end of a step from its stages, and an estimate that a polynomial's own derivative passes."""
    c, A, b = full(method)
    s, of = len(c), method.collocation
    assert of is not None
    T, into = (np.reshape(of[name], (s, s)) for name in ("back", "into"))
    L, first = np.zeros((s, s)), s % 2
    if first:
        L[0, 0] = of["real"]
    for k, (x, y) in enumerate(zip(of["parts"][0::2], of["parts"][1::2], strict=True)):
        j = first + 2 * k
        L[j : j + 2, j : j + 2] = [[x, -y], [y, x]]
    assert T @ into == pytest.approx(np.eye(s), abs=ROUNDING)
    assert T @ L @ into == pytest.approx(np.linalg.inv(A), abs=ROUNDING)
    assert of["end"] @ A == pytest.approx(b, abs=1e-14)
    for k in range(1, s + 1):  # Z of the motion t^k, k t^(k-1) at the start
        assert float(k == 1) + of["error"] @ c**k == pytest.approx(0.0, abs=ROUNDING)
    assert abs(of["error"] @ c ** (s + 1)) > 1e-5


def slope_of_pendulum(t: float, y: Array) -> Array:
    """A pushed pendulum: smooth, not linear, and it knows the time."""
    return np.array([y[1], -np.sin(y[0]) + 0.3 * np.cos(1.7 * t)])


def fixed_steps(method: Method, count: int, until: float = 3.0) -> Array:
    """The end of a pushed pendulum's motion, the stages found by repetition."""
    c, A, b = full(method)
    y, h = np.array([1.0, 0.5]), until / count
    for n in range(count):
        K = np.tile(slope_of_pendulum(n * h, y), (len(c), 1))
        for _ in range(60):
            K = np.array([slope_of_pendulum((n + x) * h, y + h * row @ K) for x, row in zip(c, A, strict=True)])
        y = y + h * b @ K
    return y


@pytest.mark.heavy
@pytest.mark.parametrize("method", METHODS, ids=lambda m: m.name)
def test_order_with_fixed_steps(method: Method) -> None:
    counts = np.array([4, 5, 6, 8] if method.order == 9 else [10, 12, 14, 17])
    exact = fixed_steps(RADAU9, 60)
    errors = np.array([np.abs(fixed_steps(method, n) - exact).max() for n in counts])
    assert errors.min() > 1e-13
    assert fitted(counts, errors) == pytest.approx(method.order, abs=0.5)


# Motions by them


def places(results: Results) -> Array:
    return np.concatenate([body["center"] for body in results.bodies.values()], axis=1)


@pytest.mark.heavy
@pytest.mark.parametrize("scene", ["governor, 10 s", "friction of 1e-6"])
@pytest.mark.parametrize("method", NAMES)
@pytest.mark.third
def test_what_is_told_of_a_stiff_motion_is_right(scene: str, method: str) -> None:
    """The true error is below the one told, which is below the tolerance asked for; sizes are 1 m."""
    exact = places(solved(STIFF_SCENES[scene], method="Radau9", tolerance=1e-13))
    for tolerance in (1e-4, 1e-6, 1e-9):
        found = solved(STIFF_SCENES[scene], method=method, tolerance=tolerance)
        told = found.accuracy["estimate"]["motion"]
        assert np.abs(places(found) - exact).max() <= 2.0 * told  # the size is up to twice a metre
        assert told <= tolerance
        assert found.accuracy["horizon"] is None


CREEP = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies: {block: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {p: [0, 0, 0]}}}
joints: {guide: {type: slide, from: ground.O, to: block.p, axis: [1, 0, 0], initial: {travel: 0, speed: 1}}}
forces:
  rub: {type: friction, joint: guide, force: 3, speed: 1e-6}
  push: {type: torque, joint: guide, value: 1}
analysis: {times: [0, 0.5, 2]}
"""


@pytest.mark.parametrize("method", NAMES)
def test_friction_that_sticks(method: str) -> None:
    """2 v' = 1 - 3 tanh(v / s): v falls by 1 a second, and then creeps at s artanh(1/3), to ten digits."""
    guide = solved(CREEP, method=method).coordinates["guide"]
    assert guide["speed"][1] == pytest.approx(0.5, abs=1e-9)
    assert guide["speed"][2] == pytest.approx(1e-6 * math.atanh(1.0 / 3.0), rel=1e-9)
    assert guide["travel"][2] == pytest.approx(0.5, abs=2e-5)  # v^2 / 2, and what it creeps


@pytest.mark.heavy
@pytest.mark.parametrize("method", NAMES)
@pytest.mark.parametrize("scene", EVENTS)
@pytest.mark.third
def test_events_and_contacts(scene: str, method: str) -> None:
    """Branches that turn, pulses, stops and ropes are met as by an explicit method."""
    ours, theirs = (solved(EVENTS[scene], method=name) for name in (method, "DOP853"))
    assert ours.time.tolist() == pytest.approx(theirs.time.tolist(), abs=1e-9)
    told = ours.accuracy["estimate"]["motion"] + theirs.accuracy["estimate"]["motion"]
    assert np.abs(places(ours) - places(theirs)).max() <= 20.0 * told  # of some metres
    assert len(ours.impulses) == len(theirs.impulses)


@pytest.mark.heavy
@pytest.mark.parametrize("scene", ["bricard", "engine", "jib", "top", "trolley", "punch"])
def test_specs_by_a_stiff_method(scene: str) -> None:
    """Closed chains, drives, springs, tables, ropes: what the specs expect, and no more error than is told."""
    text = (SPECS / f"{scene}.yaml").read_text(encoding="utf-8").replace("file: ", f"file: {SPECS}/")
    ours, theirs = (solved(text, method=name) for name in ("Radau9", "DOP853"))
    told = ours.accuracy["estimate"]["motion"] + theirs.accuracy["estimate"]["motion"]
    assert np.abs(places(ours) - places(theirs)).max() <= 20.0 * told


@pytest.mark.parametrize("method", NAMES)
def test_done_again_it_has_the_same_bits(method: str) -> None:
    """Which instants are asked for changes nothing of the steps; others than those are the run's own."""
    runner, times = study(STIFF_SCENES["friction of 1e-6"]).setup.runner, np.linspace(0.0, 1.0, 37)
    few, many = (runner.run(MotionTask(at, 1e-7, method=load_method_by_name(method))) for at in (times[[0, -1]], times))
    assert few.ends.tolist() == many.ends.tolist()
    assert np.array_equal(runner.resample(few, times), many.states)
    assert np.array_equal(runner.resample(few, times[[17]]), many.states[[17]])


@pytest.mark.parametrize(("step", "code"), [(0.02, None), (0.5, "stages-unsolved")])
def test_too_long_a_given_step_is_refused(step: float, code: str | None) -> None:
    """Newton's iteration contracts in short steps; where it does not, the run ends with its instant."""
    text = double("{duration: 2, samples: 3}")
    if code is None:
        assert solved(text, method="Gauss6", step=step).status["code"] == "completed"
    else:
        with pytest.raises(SolveError) as refused:
            solved(text, method="Gauss6", step=step)
        assert refused.value.problems[0].code == code


def test_too_large_a_state_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Dense equations take the cube of its numbers; what solves none takes any."""
    monkeypatch.setattr(tolerances, "MOST_SOLVED", 10)
    text = double("{duration: 0.1, samples: 3}")
    with pytest.raises(LimitError, match="too-many-states"):
        solved(text, method="Radau9")
    assert solved(text, method="DOP853").status["code"] == "completed"


KEPLER = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  ball:
    {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], position: [1, 0, 0], velocity: [0, 1.2, 0.3],
     points: {c: [0, 0, 0]}}
forces: {pull: {type: spring, from: ground.O, to: ball.c, stiffness: 3, length: 0.5}}
analysis: {duration: 200, samples: 401}
"""


@pytest.mark.heavy
@pytest.mark.parametrize(("method", "swing"), [("Gauss4", 1e-4), ("Gauss6", 1e-6)])
def test_long_runs_drift_nowhere(method: str, swing: float) -> None:
    """Some 60 revolutions by steps of 1/30 of one: x × v, quadratic, stays to rounding; the energy only swings."""
    found = solved(KEPLER, method=method, step=0.1)
    x, v = found.bodies["ball"]["center"], found.bodies["ball"]["center_velocity"]
    spin = np.cross(x, v)
    assert np.abs(spin - spin[0]).max() <= 1e-12
    energy = found.energy["kinetic"] + found.energy["potential"]
    off = np.abs(energy - energy[0])
    assert 0.0 < off.max() <= swing
    assert off[-100:].max() <= 1.5 * off[:100].max()  # no drift
