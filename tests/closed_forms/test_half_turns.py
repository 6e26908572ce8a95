"""DOP853 with attitudes by Rodrigues' numbers: closed forms, and the half turns at which the global chart ends."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.base.errors import HeunError, SolveError
from heuncli.motion.integration.methods.method import load_method_by_name
from heuncli.motion.integration.run.request import MotionTask
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from tests.shared.bars import double
from tests.shared.folders import SPECS
from tests.shared.scenes import near, solved, study
from tests.shared.tops import PERIOD, free_top, heavy_top

GLOBAL, ANEW = "DOP853-rodrigues", "DOP853-recentred"
METHODS = (GLOBAL, ANEW)


def spinner(times: str, omega: str = "[0, 0, 1]", inertia: str = "[1, 2, 3]", start: str = "") -> str:
    """A free body in no field."""
    return f"""
heun: 1
bodies:
  wheel:
    {{mass: 1, center: [0, 0, 0], inertia: {inertia}, points: {{p: [1, 0, 0]}}, {start}
     angular_velocity: {{vector: {omega}, frame: body}}}}
analysis: {{times: {times}, tolerance: 1e-12}}
"""


def half_turn_of(scene: str, **options: object) -> SolveError:
    """How a run in the global chart ends."""
    with pytest.raises(SolveError) as caught:
        solved(scene, method=GLOBAL, **options)
    assert caught.value.problems[0].code == "half-turn"
    return caught.value


# manual/theory.md, "Limits of methods": unit spin about a fixed axis


def test_a_spin_comes_to_its_half_turn_at_pi() -> None:
    error = half_turn_of(spinner(f"[{2 * math.pi}]"), reduce=False)
    assert error.reached == pytest.approx(math.pi, abs=1e-11)
    assert (
        "at t = 3.14159265 s: wheel reaches half a revolution from its start orientation" in error.problems[0].message
    )
    assert "DOP853-recentred" in str(error.problems[0].hint)


def test_a_spin_goes_on_where_each_step_has_its_own_chart() -> None:
    """R(2 pi) = 1, relative change of L < 1e-10, and up to just before its half turn in the global one."""
    found = solved(spinner(f"[0, {math.pi}, {2 * math.pi}]"), method=ANEW, reduce=False).bodies["wheel"]
    near(found["rotation"][1:], [np.diag([-1, -1, 1]), np.eye(3)], 1.0, 1e-13)
    near(found["angular_velocity"][2], [0, 0, 1], 1.0, 1e-14)
    before = solved(spinner("[3.1415]"), method=GLOBAL, reduce=False).bodies["wheel"]["rotation"][0]
    near(before[:2, 0], [math.cos(3.1415), math.sin(3.1415)], 1.0, 1e-12)


# manual/theory.md, "Closed cases" 2


@pytest.mark.parametrize("joint", [True, False], ids=["on a ball", "free"])
def test_free_top(joint: bool) -> None:
    """Case 1 to its digits; in the global chart up to the half turn, which is where the quaternion's w is zero."""
    body = solved(free_top("[1, 6.078117841793404, 10]", joint), method=ANEW).bodies["top"]
    turning = np.einsum("tji,tj->ti", body["rotation"], body["angular_velocity"])
    near(turning[0], [0.4389935957999769, 0.7856746291223909, 1.002116988704977], 1.0, 1e-13)
    near(turning[1], [0.9, 0.0, 1.1], 1.0, 1e-12)
    near(turning[2], [-0.5286165061102699, -0.7283986473544353, 1.016437473160094], 1.0, 1e-12)
    first = solved(free_top("[1]", joint), method=GLOBAL).bodies["top"]
    near(first["rotation"][0].T @ first["angular_velocity"][0], turning[0], 1.0, 1e-13)
    ended = half_turn_of(free_top("[1, 10]", joint)).reached
    assert ended is not None
    w = solved(free_top(f"[{ended - 1e-9}, {ended}, {ended + 1e-9}]", joint)).bodies["top"]["quaternion"][:, 0]
    near(w, [0.5e-9 * np.linalg.norm(turning[0]), 0.0, 0.0], 1.0, 1e-9)
    assert w[0] * w[2] < 0.0 or abs(w[1]) < 1e-10


@pytest.mark.parametrize("reduce", [True, False], ids=["spun less", "as drawn"])
def test_heavy_top(reduce: bool) -> None:
    """Case 2 to its digits, and in the global chart as long as it goes, which is longer where it spins less."""
    times = f"[0, {PERIOD / 2}, 1, {PERIOD}]"
    axis = solved(heavy_top(8, "60 deg", times), method=ANEW, reduce=reduce).bodies["top"]["rotation"][:, :, 2]
    near(axis[:, 2], [0.5, 0.3944487245360107, 0.4050295921774855, 0.5], 1.0, 2e-13)
    near(math.atan2(axis[3, 1], axis[3, 0]) - math.atan2(axis[0, 1], axis[0, 0]), 0.4259411370822, 1.0, 2e-12)
    ended = half_turn_of(heavy_top(8, "60 deg", times), reduce=reduce)
    assert ended.reached is not None
    short = heavy_top(8, "60 deg", f"[{0.5 * ended.reached}, {0.99 * ended.reached}]")
    in_chart, wanted = (solved(short, method=m, reduce=reduce).bodies["top"] for m in (GLOBAL, "DOP853"))
    near(in_chart["rotation"], wanted["rotation"], 1.0, 2e-12)
    assert ("--no-reduce" in str(ended.problems[0].hint)) == reduce


# what is told


def test_the_body_is_named_and_the_model_says_how_attitudes_are_held() -> None:
    error = half_turn_of(double("{duration: 2, samples: 3}"))
    assert "t = 1.9459297" in error.problems[0].message
    assert "upper reaches half a revolution" in error.problems[0].message
    found = study(double("{duration: 1, samples: 3}"), method=ANEW).results.model
    assert found["method"] == ANEW
    assert any("Rodrigues" in reason for reason in found["reasons"])


def test_without_balls_it_is_dop853() -> None:
    """A pendulum on a pin has no attitude to integrate: the same bits, and the model says so."""
    pin = """
heun: 1
gravity: [0, -9.81, 0]
bodies: {bar: {mass: 1, center: [0.5, 0, 0], inertia: [0.01, 0.1, 0.1], points: {o: [0, 0, 0]}}}
joints: {pin: {type: pin, from: {body: ground, at: [0, 0, 0]}, to: bar.o, axis: [0, 0, 1]}}
analysis: {duration: 2, samples: 5}
"""
    wanted = solved(pin).bodies["bar"]["rotation"]
    for method in METHODS:
        found = solved(pin, method=method)
        assert np.array_equal(found.bodies["bar"]["rotation"], wanted)
        assert any("so this equals DOP853" in reason for reason in found.model["reasons"])


# no luck


def passes(scene: str, tolerance: float, until: float) -> float | None:
    """The instant of the half turn at which the global chart ends, at a local tolerance; None where it does not."""
    runner = set_up(load("scene.yaml", scene), reduce=False).runner
    try:
        runner.run(MotionTask([0.0, until], tolerance, method=load_method_by_name(GLOBAL)))
    except SolveError as error:
        assert error.problems[0].code == "half-turn"
        return error.reached
    return None


@pytest.mark.parametrize("tolerance", [0.5, 0.1, 1e-2, 1e-4, 1e-8])
def test_no_step_jumps_over_a_half_turn(tolerance: float) -> None:
    """However coarse: steps that fit by luck on the far side of an infinite kappa are none; to the tolerance, pi."""
    for spin in (0.7, 1.0, 1.7, 3.1, 5.3, 11.0):
        assert passes(spinner("[1]", f"[0, 0, {spin}]"), tolerance, 9.0) == pytest.approx(math.pi / spin, rel=tolerance)


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(12))
def test_tops_at_random(seed: int) -> None:
    """The global chart ends where the quaternion's scalar part passes zero for the first time, and only there."""
    rng = np.random.default_rng(seed)
    omega, inertia = rng.normal(size=3) * 2.0, [1.0, *rng.uniform(1.0, 1.9, 2).tolist()]
    scene = spinner("[1]", str(omega.tolist()), str(inertia))
    setup = set_up(load("scene.yaml", scene), reduce=False)
    times = np.linspace(0.0, 6.0, 2001)
    run = setup.runner.run(MotionTask(times, 1e-12))
    at = int(setup.runner.layout.tables["bodies"][0]["attitude_at"])
    w: Array = run.states[:, at]
    crossed = np.flatnonzero(w[1:] * w[:-1] <= 0.0)
    for tolerance in (1e-3, 1e-10):
        ended = passes(scene, tolerance, 6.0)
        if not len(crossed):
            assert ended is None
        else:
            assert ended is not None
            beside = 1e-2 if tolerance == 1e-3 else 1e-9
            assert times[crossed[0]] - beside <= ended <= times[crossed[0] + 1] + beside


def test_a_pendulum_that_turns_back_beside_its_half_turn() -> None:
    """On a ball, released at rest 1e-4 rad beside upright: with a kappa of 2e4 it goes as quaternions do."""
    scene = """
heun: 1
gravity: [0, 0, -9.81]
bodies:
  bar: {mass: 1, center: [0, 0, -1], inertia: [0.1, 0.1, 0.01], points: {o: [0, 0, 0]},
        orientation: {axis: [1, 0, 0], angle: 3.1414926535897932}}
joints: {pivot: {type: ball, from: {body: ground, at: [0, 0, 0]}, to: bar.o}}
analysis: {times: [0, 1, 2, 3], tolerance: 1e-9}
"""
    found, wanted = (solved(scene, method=m, reduce=False).bodies["bar"]["rotation"] for m in (GLOBAL, "DOP853"))
    near(found, wanted, 1.0, 1e-8)


@pytest.mark.heavy
@pytest.mark.parametrize("method", METHODS)
def test_a_crane_that_starts_from_rest(method: str) -> None:
    """Closed chains, ropes, drives, and a first step so long that its stages are wild: as with quaternions."""
    text = (SPECS / "crane.yaml").read_text(encoding="utf-8").partition("\nexpect:")[0]
    found, wanted = (solved(text, method=m).bodies["load"]["position"] for m in (method, "DOP853"))
    near(found, wanted, 36.0, 2e-9)


# replays


@pytest.mark.parametrize("method", METHODS)
def test_other_instants_are_the_runs_own(method: str) -> None:
    """Asked for with others or alone: the same bits, of the steps, too."""
    runner = set_up(load("double.yaml", double("{duration: 1}"))).runner
    times = np.linspace(0.0, 1.0, 57)
    few = runner.run(MotionTask(times[::8], 1e-10, method=load_method_by_name(method)))
    many = runner.run(MotionTask(times, 1e-10, method=load_method_by_name(method)))
    assert np.array_equal(few.ends, many.ends)
    assert np.array_equal(runner.resample(few, times), many.states)


def test_a_start_at_a_half_turn_is_refused_at_once() -> None:
    upright = "orientation: {axis: [1, 2, 3], angle: 180 deg},"
    error = half_turn_of(spinner("[1]", start=upright), reduce=False)
    assert error.reached == 0.0
    with pytest.raises(HeunError, match="t = 0 s"):
        solved(spinner("[1]", start=upright), method=GLOBAL, reduce=False)
    solved(spinner("[1]", start=upright), method=ANEW, reduce=False)


@pytest.mark.parametrize("tolerance", [1e-1, 1e-2, 1e-3])
def test_steps_that_the_chart_bounds_err_by_no_more_than_is_said(tolerance: float) -> None:
    """45 turns: a finer run in the same chart takes the same steps, and errs alike."""
    scene = spinner("[0, 0.5, 1, 1.5, 2]", omega="[90, 10, 110]")
    run, right = study(scene, method=ANEW, tolerance=tolerance), solved(scene)
    found, size = run.results, run.setup.runner.size
    known = found.time < (found.accuracy["horizon"] or math.inf)
    p = [1.0, 0.0, 0.0]
    off = np.linalg.norm((found.bodies["wheel"]["rotation"] - right.bodies["wheel"]["rotation"]) @ p, axis=1)[known]
    assert off.max() <= min(found.accuracy["estimate"]["motion"], 1e-3 if not known.all() else 1.0) * size
