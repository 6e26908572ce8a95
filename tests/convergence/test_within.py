"""Other instants of a run already done: to the last bit what it would have given, whatever lies between and is kept."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from heuncli.motion.integration.check.singular_poses import find_singular_positions
from heuncli.motion.integration.integrated_scene import find_discontinuities
from heuncli.motion.integration.run import progress
from heuncli.motion.integration.run.request import MotionTask
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import Setup, set_up
from tests.oracle.published import START, andrews, windows
from tests.oracle.values import to_yaml
from tests.shared.one_freedom import One
from tests.shared.parallelogram import parallelogram
from tests.shared.scenes import moving, near, study

FOLDER = Path(__file__).parents[2]
SPECS = sorted((FOLDER / "specs").glob("*.yaml")) + sorted((FOLDER / "tests/bench/scenes").glob("*.yaml"))
JUMPS = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies: {b: {mass: 1, center: [0, 0, 0], inertia: [0.1, 0.2, 0.25], points: {end: [1, 0, 0]}}}
joints: {A: {type: pin, from: ground.O, to: b.end, axis: [0, 0, 1]}}
forces: {push: {type: torque, joint: A, value: "2*step(t - 0.31) - step(t - 0.72) + sign(t - 0.5)"}}
analysis: {duration: 1, samples: 51}
"""
# A triangle of bars on three balls, held by the ground: it folds as a chaotic loop.
FOLDING = """
heun: 1
gravity: [0.3, -0.2, -9.81]
ground: {points: {O: [0, 0, 0], Q: [1.1, 0.2, 0]}}
bodies:
  a: {mass: 1, center: [0, 0, -0.5], inertia: [0.09, 0.08, 0.01], points: {top: [0, 0, 0], end: [0, 0, -1]}}
  b: {mass: 0.7, center: [0.3, 0, 0], inertia: [0.01, 0.05, 0.05], points: {top: [0, 0, 0], end: [0.7, 0, 0]}}
  c: {mass: 0.5, center: [0, 0, -0.3], inertia: [0.03, 0.04, 0.01], points: {top: [0, 0, 0], end: [0, 0, -0.8]}}
joints:
  A: {type: ball, from: ground.O, to: a.top}
  B: {type: ball, from: a.end, to: b.top}
  C: {type: ball, from: b.end, to: c.end}
  D: {type: ball, from: ground.Q, to: c.top}
analysis: {duration: 8, samples: 33}
"""
ROPE = """
heun: 1
gravity: [0, -9.81, 0]
ground: {points: {O: [0, 0, 0]}}
bodies: {b: {mass: 1, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {c: [0, 0, 0]},
             position: [0, -1, 0], velocity: [5.5, 0, 0]}}
joints: {A: {type: rod, from: ground.O, to: b.c, tension_only: true}}
analysis: {duration: 3, samples: 31}
"""
EVENTS = One(0.7, {
    "spring": "-8*sign(shaft.angle)", "brake": "-0.3*shaft.rate if 0.1 < shaft.angle < 0.2 else 0",
    "cam": "3*max(0, cos(9*shaft.angle))", "blow": "5*exp(-((shaft.angle - 0.05)/1e-4)**2)", "pulse": "step(t - 2.5)",
}, 0.0, 3.0, "duration: 5, samples: 41", True).text()  # fmt: skip
BOUNCES = One(2.0, {"spring": "-5e4*guide.travel - 3*guide.speed if guide.travel < 0 else 0"}, 1.0, 0.0,
              "duration: 4, samples: 31", gravity=9.81).text()  # fmt: skip
DOUBLE = (FOLDER / "tests/bench/scenes/double.yaml").read_text()
RNG = np.random.default_rng(40)
WRITTEN: dict[str, str] = {
    "jumps": JUMPS,
    "folding loop": FOLDING,
    "rope": ROPE,
    "events": EVENTS,
    "bounces": BOUNCES,
    "double, 20 s": DOUBLE.replace("duration: 2", "duration: 20"),
    "two windows": to_yaml(moving(windows(2, 0.0, 1.0), np.linspace(0.0, 4.0, 41).tolist(), 1e-9)),
    "squeezer": to_yaml(moving(andrews(START, dict.fromkeys(START, 0.0)), np.linspace(0.0, 0.03, 31).tolist(), 1e-8)),
    **{f"flat poses, {rate:.3g}": parallelogram(rate, 3.0, 61) for rate in RNG.uniform(0.05, 4.0, 4).tolist()},
}
SCENES = {path.stem if path.parent.name == "specs" else f"bench/{path.stem}": str(path) for path in SPECS} | WRITTEN
LONG = {"engine", "crane", "jib", "bench/chain10", "bench/crank", "folding loop", "double, 20 s", "two windows",
        "squeezer", "chain", "friction"}  # fmt: skip


@cache
def scene(name: str) -> Setup:
    return set_up(load("scene.yaml", WRITTEN[name]) if name in WRITTEN else load(SCENES[name]))


@cache
def is_moving(name: str) -> bool:
    return name in WRITTEN or load(SCENES[name]).analysis.type == "motion"


MOVING = [pytest.param(name, marks=pytest.mark.heavy) if name in LONG else name for name in SCENES if is_moving(name)]


def asked(setup: Setup) -> Array:
    return np.array(setup.spec.analysis.times, dtype=float)


def jumps(setup: Setup) -> list[float]:
    return find_discontinuities(setup.scene.mechanism, float(asked(setup)[-1]))


def trajectory(setup: Setup, times: Array, tolerance: float | None = None) -> Trajectory:
    assert setup.method is not None
    tolerance = tolerance or setup.spec.analysis.tolerance
    return setup.runner.run(MotionTask(times, tolerance, discontinuities=jumps(setup), method=setup.method))


def others(setup: Setup, run: Trajectory) -> Array:
    """Instants of all sorts within a run: anywhere, at ends of steps and next to them, at jumps and on either side."""
    rng = np.random.default_rng(7)
    ends = rng.choice(run.ends, min(len(run.ends), 20)) if len(run.ends) else np.zeros(0)
    marks = np.concatenate([[0.0], ends, rng.choice(jumps(setup) or [0.0], 10)])
    around = [np.nextafter(marks, -np.inf), marks, np.nextafter(marks, np.inf)]
    times: Array = np.unique(np.concatenate([rng.uniform(0.0, run.times[-1], 40), *around]))
    return times[(times >= 0.0) & (times <= run.times[-1])]


KEEPING_FEW = [(name, 500) for name in SCENES if name in LONG or name in WRITTEN]  # many steps, and all sorts of them


@pytest.mark.parametrize(
    ("name", "kept"),
    [pytest.param(*case, marks=pytest.mark.heavy) if case[0] in LONG else case
     for case in [*((name, 20_000_000) for name in SCENES if is_moving(name)), *KEEPING_FEW]],
)  # fmt: skip
@pytest.mark.third
def test_the_run_itself(name: str, kept: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """States at other instants are those of a run that was asked for them; which are asked changes no step."""
    monkeypatch.setattr(progress, "MAX_RECORD_NUMBERS", kept)
    setup = scene(name)
    times = asked(setup)
    run, bare = trajectory(setup, times), trajectory(setup, times[[0, -1]])
    assert len(run.records) <= max(2, kept // run.records.records.shape[1]) + len(
        run.impulse_events
    )  # what follows a blow is kept
    more = others(setup, run)
    whole = trajectory(setup, np.unique(np.concatenate([more, times])))
    for one in (run, whole):
        for column in ("ends", "pivots", "is_projected"):
            np.testing.assert_array_equal(getattr(one, column), getattr(bare, column))
    wanted = whole.states[np.searchsorted(whole.times, more)]
    np.testing.assert_array_equal(setup.runner.resample(run, more), wanted)
    np.testing.assert_array_equal(setup.runner.resample(bare, more), wanted)
    np.testing.assert_array_equal(setup.runner.resample(bare, run.times), run.states)
    for pick in (slice(0, None, 7), slice(-1, None), slice(0, 1)):
        np.testing.assert_array_equal(setup.runner.resample(run, more[pick]), wanted[pick])


@pytest.mark.parametrize("name", MOVING)
@pytest.mark.third
def test_each_instant_is_recovered_by_itself(name: str) -> None:
    """The same bits whatever is asked with it: alone, among others, after one far away."""
    setup = scene(name)
    run = trajectory(setup, asked(setup))
    whole = setup.runner.evaluate(run.times, run.states)
    count = len(run.times)
    for pick in ([count // 2], [0], [count - 1], [count // 3, 0, count - 1], list(range(count))[::-3]):
        found = setup.runner.evaluate(run.times[pick], run.states[pick])
        for part in ("states", "bodies", "freedoms", "loads", "rows", "gap", "massless_count", "pivot"):
            np.testing.assert_array_equal(getattr(found, part), getattr(whole, part)[pick], err_msg=part)


def test_the_flat_poses_are_those_of_the_run_whatever_is_asked() -> None:
    setup = scene("flat_four_bar")
    wanted = find_singular_positions(setup.runner, trajectory(setup, asked(setup)))
    assert len(wanted) == 2
    assert find_singular_positions(setup.runner, trajectory(setup, np.array([0.0, 2.0]))) == wanted


@pytest.mark.heavy
def test_a_chaotic_run_has_its_energy_at_every_instant() -> None:
    """Far beyond the horizon no number is that of the pendulum, but every one is that of one run, with its energy."""
    text = DOUBLE.replace("duration: 2, samples: 201", "duration: 200, samples: 3")
    s = study(text, requested_reports=frozenset({"energy"}))
    assert s.history.checked_run is not None
    run = s.history.checked_run.run
    found = s.compute_reports(s.search_times, frozenset({"energy"})).energy
    total = found["kinetic"] + found["potential"]
    near(total, np.full(len(total), total[0]), float(np.ptp(found["potential"])), 1e-6)
    own = trajectory(s.setup, s.search_times, run.local)
    assert np.array_equal(s.setup.runner.resample(run, s.search_times), own.states)


def pendulum(kind: str, instants: Sequence[float]) -> str:
    return f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  b: {{mass: 1, center: [0, 0, 0], inertia: [0.1, 0.2, 0.25], points: {{end: [0, 0, 1]}}, position: [1, 0, 0],
      orientation: {{axis: [0, 1, 0], angle: -90 deg}}}}
joints: {{A: {{{kind}}}}}
analysis: {{times: {list(instants)}}}
"""


@pytest.mark.parametrize(
    "kind",
    [
        "type: pin, axis: [0, 1, 0], from: ground.O, to: b.end",
        "type: ball, from: ground.O, to: b.end",
        "type: rod, from: ground.O, to: {body: b, at: [0, 0, 0]}",
    ],
)
def test_an_ordinary_pendulum(kind: str) -> None:
    """Any instant of a long run asked at two: no error, and the energy of the first."""
    s = study(pendulum(kind, [0.0, 50.0]))
    found = s.resample(np.unique(np.concatenate([np.linspace(0.0, 50.0, 500), s.search_times])))
    total = found.energy["kinetic"] + found.energy["potential"]
    near(total, np.full(len(total), total[0]), 9.81, 1e-7)


def test_a_singular_pose_between_does_no_harm() -> None:
    """The instants next to a flat pose, where a run begun there could not go on."""
    s = study((FOLDER / "specs/flat_four_bar.yaml").read_text().partition("\nexpect:")[0])
    assert s.history.checked_run is not None
    ends = s.history.checked_run.run.ends
    flat = 1.2152618
    times = np.sort(np.concatenate([flat + np.array([-1e-3, -1e-6, -1e-9, 0.0, 1e-9, 1e-6]), ends[20:25]]))
    found = s.resample(times)
    tip = found.points["left.top"]["position"]
    near(np.sum(tip * tip, axis=1), np.ones(len(times)), 1.0, 1e-12)
    near(found.points["right.top"]["position"] - tip, np.tile([1.0, 0.0, 0.0], (len(times), 1)), 1.0, 1e-8)
