"""Every method on scenes at random, whole and reduced, on contacts and conditions: it errs by no more than it tells.

The truth is that of DOP853 at 1e-13, which tells how well it is known. A method may refuse, by name.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from heuncli.base import tolerances
from heuncli.base.errors import SolveError, SpecError
from heuncli.base.method_rows import METHODS, MethodRow
from heuncli.motion.integration.check.run_comparison import MotionPoints, is_between_impulses
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array
from heuncli.study.queries.study import Study
from tests.bench.honesty import told
from tests.shared.event_scenes import EVENTS
from tests.shared.folders import SPECS
from tests.shared.scenes import study

pytestmark = pytest.mark.heavy  # with the compiled kernel, which has the same bits

OWN = [row for row in METHODS if row.kind != "SciPy"]
FOREIGN = [row for row in METHODS if row.kind == "SciPy"]
TREES_AND_LOOPS = (0, 1, 3, 6)
DURATION = 0.5  # s, that random scenes move for at most
SHARES = 0.4  # of the mean step that DOP853 takes at 1e-7: the given steps
REFUSED = ("half-turn", "stages-unsolved", "method-scene", "closure-lost", "not-a-number")
TOLERANCE = 1e-6
INSTANTS = 50
# A pendulum that falls against a stop, with a condition that ends its run and one that is watched.
UNTIL = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  bar: {mass: 1, center: [0, 0, -0.5], inertia: [0.08, 0.08, 0.001], points: {top: [0, 0, 0], end: [0, 0, -1]}}
joints:
  pivot: {type: pin, axis: [0, 1, 0], from: ground.O, to: bar.top, initial: {angle: 1.2, rate: 0}}
stops: {wall: {joint: pivot, angle: [-0.5, null], restitution: 0.6}}
analysis: {duration: 5, samples: 21, until: pivot.angle > 0.3 and t > 1, events: {hangs: pivot.angle < 0}}
"""
WRITTEN = {
    **{name: EVENTS[name] for name in ("branches", "strikes", "catches", "rope")}, "until": UNTIL,
    "struck": (SPECS / "hammered_four_bar.yaml").read_text().partition("\nexpect:")[0],
}  # fmt: skip


@cache
def truth(scene: int | str, *, reduce: bool) -> Study:
    return study(text_of(scene), method="DOP853", tolerance=1e-13, reduce=reduce)


@cache
def text_of(scene: int | str) -> Any:
    if isinstance(scene, str):
        return WRITTEN[scene]
    made = told(scene).scene
    made["analysis"]["duration"] = min(made["analysis"]["duration"], DURATION)
    return made


@cache
def mean_step(scene: int | str, *, reduce: bool) -> float:
    run = run_of(study(text_of(scene), method="DOP853", tolerance=1e-7, reduce=reduce))
    return float(run.times[-1]) / run.steps


def run_of(one: Study) -> Trajectory:
    assert one.history.checked_run is not None
    return one.history.checked_run.run


def bodies(one: Study, times: Array) -> Any:
    runner, run = one.setup.runner, run_of(one)
    return runner.evaluate(times, runner.resample(run, times), holding=run.find_holding(times)).bodies


def require_honest(row: MethodRow, scene: int | str, *, reduce: bool) -> None:
    """No point is off by more than is told, at any instant before the horizon."""
    h = SHARES * mean_step(scene, reduce=reduce) * (0.3 if row.order == 1 else 1.0)
    given = {"step": h} if row.steps == "fixed" else {"tolerance": TOLERANCE}
    try:
        found = study(text_of(scene), method=row.name, reduce=reduce, **given)
    except (SolveError, SpecError) as error:
        assert error.problems[0].code in REFUSED
        return
    exact = truth(scene, reduce=reduce)
    runs = run_of(exact), run_of(found)
    checked = found.history.checked_run
    assert checked is not None and exact.history.checked_run is not None
    horizon = np.inf if checked.horizon is None else checked.horizon
    times = np.linspace(0.0, min(float(run.times[-1]) for run in runs), INSTANTS)
    times = times[(times < horizon) & ~is_between_impulses(runs, times)]
    layout = found.setup.runner.layout
    apart = MotionPoints(layout).find_max_distance(bodies(exact, times), bodies(found, times)) / layout.size
    bound = min(checked.motion, tolerances.CLAIMED) if checked.horizon is not None else checked.motion
    assert float(apart.max(initial=0.0)) <= bound + exact.history.checked_run.motion
    if checked.horizon is None:
        assert len(runs[0].impulse_events) == len(runs[1].impulse_events)


@pytest.mark.parametrize("seed", TREES_AND_LOOPS)
@pytest.mark.parametrize("row", OWN, ids=lambda row: row.name)
@pytest.mark.third
def test_trees_and_loops(row: MethodRow, seed: int) -> None:
    require_honest(row, seed, reduce=True)


@pytest.mark.parametrize("seed", TREES_AND_LOOPS[1:3])
@pytest.mark.parametrize("row", OWN, ids=lambda row: row.name)
@pytest.mark.third
def test_the_whole_of_the_scene(row: MethodRow, seed: int) -> None:
    """Nothing left out, nothing moved in the plane alone."""
    require_honest(row, seed, reduce=False)


@pytest.mark.parametrize("seed", TREES_AND_LOOPS[:2])
@pytest.mark.parametrize("row", FOREIGN, ids=lambda row: row.name)
def test_independent_checks(row: MethodRow, seed: int) -> None:
    require_honest(row, seed, reduce=True)


@pytest.mark.parametrize("scene", WRITTEN)
@pytest.mark.parametrize("row", [*OWN, FOREIGN[0]], ids=lambda row: row.name)
@pytest.mark.sixth
def test_contacts_blows_and_conditions(row: MethodRow, scene: str) -> None:
    require_honest(row, scene, reduce=True)


@pytest.mark.parametrize("row", OWN[1:], ids=lambda row: row.name)
def test_a_condition_ends_the_run_at_its_instant(row: MethodRow) -> None:
    """By every method to what it tells of that instant."""
    given: dict[str, Any] = {"step": 5e-3} if row.steps == "fixed" else {"tolerance": TOLERANCE}
    found = study(UNTIL, method=row.name, **given).results
    exact = truth("until", reduce=True).results
    assert [list(found.events["hangs"]["to"])] == [list(exact.events["hangs"]["to"])]
    for name, block in found.events.items():
        off = np.abs(np.asarray(block["time"]) - np.asarray(exact.events[name]["time"]))
        assert np.all(off <= np.asarray(block["error"]) + np.asarray(exact.events[name]["error"]))
