"""The numbers of a solved scene in Python: arrays with instants, units and errors; what is open or not claimed."""

from __future__ import annotations

import copy
import math
import pickle
from typing import Any

import numpy as np
import pytest

import heuncli

SWINGING: dict[str, Any] = {
    "heun": 1,
    "title": "Bar",
    "gravity": [0, 0, -9.81],
    "parameters": {"m": 1.0, "phi": "60 deg"},
    "ground": {"points": {"O": [0, 0, 0]}},
    "bodies": {
        "bar": {
            "shapes": [{"type": "rod", "from": [0, 0, 0], "to": [0, 0, -1], "mass": "m"}],
            "points": {"top": [0, 0, 0], "end": [0, 0, -1]},
        }
    },
    "joints": {"pivot": {"type": "pin", "axis": [0, 1, 0], "from": "ground.O", "to": "bar.top",
                         "initial": {"angle": "phi"}}},
    "sections": {"web": {"body": "bar", "from": "top", "to": "end", "count": 5}},
    "analysis": {"duration": 1, "samples": 5},
}  # fmt: skip
CHAOTIC = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  upper: {mass: 1, center: [0, 0, -1], inertia: [0.1, 0.1, 0.1], orientation: {axis: [0, 1, 0], angle: 120 deg}}
  lower: {mass: 1, center: [0, 0, -1], inertia: [0.1, 0.1, 0.1], orientation: {axis: [0, 1, 0], angle: 170 deg}}
joints:
  pivot: {type: pin, axis: [0, 1, 0], from: ground.O, to: {body: upper, at: [0, 0, 0]}}
  elbow: {type: pin, axis: [0, 1, 0], from: {body: upper, at: [0, 0, -1]}, to: {body: lower, at: [0, 0, 0]}}
analysis: {duration: 60, samples: 7, tolerance: 1e-6}
"""
DOOR = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {A: [0, 0, 0], B: [0, 0, 2]}}
bodies:
  door: {mass: 10, center: [0.5, 0, 1], inertia: [3, 4, 1], points: {a: [0, 0, 0], b: [0, 0, 2]}}
joints:
  bottom: {type: ball, from: ground.A, to: door.a}
  top: {type: ball, from: ground.B, to: door.b}
"""


@pytest.fixture(scope="module")
def study() -> heuncli.Solved:
    return heuncli.solve(SWINGING)


def test_a_vector_over_the_instants(study: heuncli.Solved) -> None:
    force = study["joints.pivot.force"]
    assert (force.unit, force.label, force.components) == ("N", "joints.pivot.force [N]", ("x", "y", "z"))
    assert force.values.shape == force.shape == (5, 3) and len(force) == 5
    assert np.array_equal(force.times, study.time) and not force.open.any() and not force.beyond.any()
    assert 0.0 < force.error < 1e-6
    assert np.array_equal(study["joints.pivot.force.z"], force[:, 2])
    for numbers in (force.values, force.times, study.time):
        assert numbers is not None
        with pytest.raises(ValueError, match="read-only"):
            numbers[0] = 1.0


def test_it_is_an_array_to_numpy(study: heuncli.Solved) -> None:
    force, drop = study["joints.pivot.force"], study["energy.potential"]
    assert np.max(force) == force.values.max() and np.asarray(force, dtype=np.float32).dtype == np.float32
    total = study["energy.kinetic"] + drop
    assert isinstance(total, np.ndarray) and np.ptp(total) < 1e-8
    assert np.allclose(np.linalg.norm(force, axis=1), np.sqrt((force**2).sum(axis=1)))
    assert float(study["accuracy.estimate.motion"]) > 0.0
    with pytest.raises(TypeError, match="15 numbers"):
        float(force)


def test_other_instants_of_the_same_run(study: heuncli.Solved) -> None:
    """In any order and shape; the numbers are those of a run that was asked for them."""
    angle = study["coordinates.pivot.angle"]
    assert angle.at(0.5) == angle[2] and angle.at(0.5).shape == ()
    anew = heuncli.solve(SWINGING, at=[0.1, 0.3, 0.7])
    assert angle.at([[0.7, 0.1], [0.3, 0.1]]) == pytest.approx(
        anew["coordinates.pivot.angle"][[[2, 0], [1, 0]]], abs=1e-9
    )
    assert study.at([0.7, 0.1])["sections.web.M2"].shape == (2, 5)
    assert anew["joints.pivot.force"].at(0.5) == pytest.approx(study["joints.pivot.force"][2], abs=1e-7)
    assert angle.at([]).shape == (0,)
    for late in (1.5, math.nan):
        with pytest.raises(heuncli.UsageError, match="the run goes from 0 to 1 s"):
            angle.at(late)
    with pytest.raises(heuncli.UsageError, match="does not depend on time"):
        study["foundation.about"].at(0.5)


def test_extremes_are_those_between_the_samples(study: heuncli.Solved) -> None:
    pull = study["joints.pivot.force"]
    most = pull.largest()
    assert most > np.linalg.norm(pull, axis=1).max() and most.at is not None and 0.0 < most.at < 1.0
    assert np.linalg.norm(pull.at(most.at)) == pytest.approx(most, rel=1e-9)
    assert most == study.measure("max abs joints.pivot.force") == pull.highest()
    assert (most.unit, most.is_open, most.horizon) == ("N", False, None) and most.error < 1e-6
    assert 2 * most == 2 * float(most) and f"{most:.3f}" == f"{float(most):.3f}" and str(most) == repr(float(most))
    along = study["sections.web.N"].highest()
    assert (along.s, along.side, along.cut) == (0.0, "beyond", 0) and repr(along).startswith(
        f"{float(along)!r} N at t = "
    )
    assert pickle.loads(pickle.dumps(most)).at == most.at


def test_a_run_of_cuts(study: heuncli.Solved) -> None:
    web = study["sections.web.force"]
    assert web.shape == (5, 5, 3) and [cut.s for cut in web.cuts] == pytest.approx([0, 0.25, 0.5, 0.75, 1])
    assert web.components[:4] == ("0.x", "0.y", "0.z", "1.x")
    assert np.array_equal(study["sections.web.M2@0.25"], study["sections.web.M2"][:, 1])
    assert study["energy.kinetic"].cuts == [] and study["sections.web.M2@end"].cuts == []


def test_what_is_open_is_nan_and_says_so() -> None:
    study = heuncli.solve(text=DOOR)
    lift = study["joints.top.force"]
    assert lift.open.tolist() == [[False, False, True]] and np.isnan(lift.values[0, 2])
    found = study.measure("joints.top.force.z")
    assert math.isnan(found) and found.is_open and "(open)" in repr(found)
    assert study["certain_sums.0.value"].unit == "N" and float(study["certain_sums.0.value"]) == pytest.approx(98.1)
    assert "1 open" in repr(lift)


@pytest.mark.heavy
def test_nothing_is_claimed_beyond_the_horizon() -> None:
    with pytest.warns(heuncli.HeunWarning, match="tolerance 1e-06 not reached"):
        study = heuncli.solve(text=CHAOTIC)
    angle = study["coordinates.elbow.angle"]
    assert study.horizon is not None and 0.0 < study.horizon < 60.0
    assert np.array_equal(angle.beyond, study.time >= study.horizon) and angle.beyond.any()
    assert np.array_equal(np.isnan(angle), angle.beyond) and not np.isnan(angle.computed).any()
    assert not angle.open.any() and np.array_equal(study["time"], study.time)
    assert np.isnan(angle.at([0.1, 60.0])).tolist() == [False, True]
    last = study.measure("final coordinates.elbow.angle")
    assert math.isnan(last) and last.horizon == study.horizon and not last.is_open
    assert "past the horizon" in repr(angle)


def test_paths_are_those_that_lead_to_numbers(study: heuncli.Solved) -> None:
    paths = study.paths("joints.pivot")
    assert paths[:3] == [f"joints.pivot.{name}" for name in ("point", "force", "moment")]
    assert len(study) == len(study.paths()) == len(set(study)) and "energy.kinetic" in study
    assert study.get("energy.none") is None and study._ipython_key_completions_() == study.paths()
    assert all(math.isnan(signal.error) or signal.error >= 0.0 for signal in study.values())
    with pytest.raises(KeyError) as caught:
        study["pivot.Fz"]
    assert isinstance(caught.value, heuncli.SpecError)
    assert str(caught.value).endswith("[unknown-path]\n  hint: did you mean joints.pivot.force.z?")


def test_what_was_left_out_is_named(study: heuncli.Solved) -> None:
    some = heuncli.solve(SWINGING, only="joints")
    assert [*some.results.bodies] == [] and np.array_equal(some["joints.pivot.force"], study["joints.pivot.force"])
    with pytest.raises(heuncli.UnknownPath, match="only= leaves them out"):
        some["bodies.bar.center"]
    assert 3 not in some and "joints.pivot.force" in some
    with pytest.raises(heuncli.UnknownPath, match="3 is not a result path"):
        some[3]  # type: ignore[index]
    with pytest.raises(heuncli.UsageError, match="no instants"):
        some.at([])


def test_by_cause_and_other_axes() -> None:
    study = heuncli.solve(SWINGING, by_cause=True, axes="to")
    whole = study["joints.pivot.force"]
    parts = [study[f"joints.pivot.shares.{cause}.force"].values for cause in ("gravity", "motion")]
    assert sum(parts) == pytest.approx(whole.values, abs=1e-9)


def test_a_solved_scene_is_one_thing(study: heuncli.Solved) -> None:
    assert copy.copy(study) is study and copy.deepcopy(study) is study and study == study and hash(study)
    with pytest.raises(TypeError, match="to_json"):
        pickle.dumps(study)


def test_blows_and_events(study: heuncli.Solved) -> None:
    struck = heuncli.solve(
        SWINGING | {"impulses": {"blow": {"on": "bar.end", "vector": [1, 0, 0], "time": 0.5}}},
        set={"analysis.events": {"level": {"of": "coordinates.pivot.angle", "below": 0.5}}},
    )
    jump = struck["impulses.0.joints.pivot.force"]
    assert (jump.times, jump.unit, jump.shape) == (None, "N·s", (3,)) and struck["impulses.0.time"].values == 0.5
    assert struck["events.level.time"].values[0] < 0.5 and struck["events.level.time"].unit == "s"
    assert "impulses.0.joints.pivot.force" in struck.paths("impulses.0")
