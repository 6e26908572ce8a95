"""`method: auto` on stiff scenes and on others: which method, why, and what it says of its error."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.motion.integration.run.request import MotionTask, StoppingRules
from heuncli.scene.file_format.load import load
from heuncli.study.workflow import describe
from tests.bench.stiff import FRICTION, STIFF_SCENES, WIRE
from tests.shared.folders import SPECS
from tests.shared.published import course
from tests.shared.scenes import near, study

GOVERNOR = STIFF_SCENES["governor, 10 s"]
TRAVEL = course("governor", "coordinates.sleeve.travel")  # 8 digits


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-9])
def test_governor_for_ten_seconds(tolerance: float) -> None:
    """Within the estimate, and that within the tolerance; in a few hundred steps where explicit ones are 7,600."""
    found = study(GOVERNOR, tolerance=tolerance).results
    assert found.model["method"] == ("Radau5" if tolerance > 1e-5 else "Radau9")
    assert found.model["reasons"][-1].startswith("stiff: spring `strut_")
    assert found.work["steps"] < 500
    estimate = found.accuracy["estimate"]["motion"]
    assert estimate <= tolerance
    size = 2.0  # of the scene, and half of it is no less than 1
    for k, t in enumerate(found.time.tolist()[1:], 1):
        near(found.coordinates["sleeve"]["travel"][k], TRAVEL[t], 1.0, estimate * size + 2e-8)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-6, 1e-9])
def test_friction_that_sticks(tolerance: float) -> None:
    """It sticks after 0.9 s and creeps then: tanh(rate/speed) carries the weight's moment but for inertia."""
    found = study(FRICTION, tolerance=tolerance).results
    assert found.model["method"].startswith("Radau")
    assert "friction `rub`" in found.model["reasons"][-1]
    assert found.accuracy["estimate"]["motion"] <= tolerance
    angle, rate = (found.coordinates["pivot"][name][-1] for name in ("angle", "rate"))
    # m g l/2 sin a against 5 N m; what is left of the inertia is a part of 1e-6
    creeping = -1e-6 * math.atanh(2.0 * 9.81 * 0.5 * math.sin(angle) / 5.0)
    near(rate, creeping, abs(creeping), max(1e-5, 30.0 * found.accuracy["estimate"]["motion"]))


def test_it_may_stick_later_only() -> None:
    """The friction of specs/friction.yaml, a thousand times as sharp: let go for 3.5 s, stuck from then on."""
    text = (SPECS / "friction.yaml").read_text().split("expect:")[0].replace("speed: 1e-3", "speed: 1e-6")
    s = study(text, tolerance=1e-6)
    assert s.results.model["method"] == "Radau9"
    fine = study(text, tolerance=1e-10).results
    off = np.abs(s.results.coordinates["pivot"]["angle"] - fine.coordinates["pivot"]["angle"]).max()
    assert off <= s.results.accuracy["estimate"]["motion"] <= 1e-6


@pytest.mark.parametrize("name", ["double", "trolley", "door_closer", "crane_load", "swing", "top", "friction"])
def test_others_stay_explicit(name: str) -> None:
    """So also specs/friction.yaml, at 1e-3: what is left when it sticks is less than to begin anew."""
    found = study((SPECS / f"{name}.yaml").read_text()).results
    assert found.model["method"] == "DOP853"
    assert not any(reason.startswith("stiff") for reason in found.model["reasons"])


def test_what_swings_and_is_to_be_followed_stays_explicit() -> None:
    """A wire without damping: an implicit method takes as short steps, each at a higher price."""
    found = study(WIRE.replace("DAMPING", "0").replace("duration: 2", "duration: 0.2"), tolerance=1e-6).results
    assert found.model["method"] == "DOP853"


def test_a_method_by_name_is_kept() -> None:
    text = STIFF_SCENES["governor, 1 s"]
    found = study(text, method="DOP853", tolerance=1e-6).results
    assert found.model["method"] == "DOP853"
    assert found.work["steps"] > 700


def test_the_note_on_the_model_tells_it() -> None:
    model = describe(load("governor.yaml", GOVERNOR))
    assert model["method"] == "Radau9"
    assert "by Radau9, an implicit method of order 9" in model["integrates"][0]


@pytest.mark.parametrize("name", ["double", "friction", "door_closer"])
def test_watching_changes_no_bit(name: str) -> None:
    """Where nothing is begun anew; in `friction` an implicit method is tried on the way, or is not worth trying."""
    s = study((SPECS / f"{name}.yaml").read_text())
    request = MotionTask(s.results.time, 1e-9)
    runs = [s.setup.runner.run(request, StoppingRules(stiffness=watched)) for watched in (False, True)]
    assert np.array_equal(runs[0].states, runs[1].states)
    assert np.array_equal(runs[0].ends, runs[1].ends)


DRAGGED = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies: {block: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}}
joints: {guide: {type: slide, from: ground.O, to: block.c, axis: [1, 0, 0], initial: {travel: 0, speed: 1}}}
forces: {oil: {type: damper, joint: guide, coefficient: 1e6}}
analysis: {duration: 1, samples: 11}
"""


@pytest.mark.parametrize("method", ["Gauss4", "Gauss6"])
@pytest.mark.parametrize("step", [0.1, 0.01])
def test_what_gauss_keeps_alive_is_told_as_an_error(method: str, step: float) -> None:
    """A block is stopped within a microsecond, x = (1 - exp(-c t)) / c, and Gauss's methods let it go on at any step:
    the energy that they tell is no more than its error, which quarters of the step alone do not show."""
    found = study(DRAGGED, method=method, step=step).results
    told, energy = found.accuracy["estimate"], found.energy["kinetic"]
    assert energy[1] > 0.3  # of 0.5 J, where nothing is left
    assert told["energy"] * energy.max() > energy[1:].max()
    assert told["foundation"] > 1.0
    off = np.abs(found.bodies["block"]["center"][1:, 0] - 1e-6).max()
    assert off <= told["motion"] * study(DRAGGED).setup.runner.size
