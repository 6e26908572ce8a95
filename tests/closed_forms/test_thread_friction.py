"""Friction of threads by the textbook's laws: torques up and down, efficiencies, self-locking, and where it jams."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest

import heuncli
from heuncli.base.errors import SolveError, SpecError
from heuncli.results.results import Results
from heuncli.scene.file_format.load import load
from tests.oracle.values import to_yaml
from tests.shared.scenes import near, solved
from tests.shared.screw_jack import LEAD, SLOPE, R, W, jack

ROUNDING = 1e-12


def told(found: Results) -> tuple[float, float, float]:
    """Thrust ON the nut along z; the torque that goes into the spindle as it turns; the efficiency."""
    own, turning = found.couplings["thread"], found.coordinates["spin"]["rate"][0]
    into = -own["on"]["spindle"]["moment"][0] @ found.bodies["spindle"]["angular_velocity"][0] / abs(turning)
    near(found.joints["spin"]["drive"][0] * turning, into * abs(turning), W, ROUNDING)
    return float(own["on"]["nut"]["force"][0, 2]), float(into), float(own["efficiency"][0])


@pytest.mark.parametrize("mu", [0.99 * SLOPE, 1.01 * SLOPE, 0.3])
@pytest.mark.parametrize("sides", [*itertools.product((1, -1), repeat=2)])
@pytest.mark.third
def test_a_jack_up_and_down(mu: float, sides: tuple[int, int]) -> None:
    """F r tan(lambda +- rho) on whichever side, of either hand; below the slope the load drives, above it holds."""
    slope, rho = math.atan(SLOPE), math.atan(mu)
    for axes, hand, rate in itertools.product([(1, 1), (1, -1)], (1, -1), (5.0, -5.0)):
        found = solved(jack(mu, axes, sides, hand * LEAD, rate=rate))
        thrust, torque, efficiency = told(found)
        near(thrust, W, W, ROUNDING)
        if found.bodies["nut"]["velocity"][0, 2] > 0.0:
            near(torque, W * R * math.tan(slope + rho), W, ROUNDING)
            near(efficiency, SLOPE / math.tan(slope + rho), 1.0, ROUNDING)
        else:
            near(torque, W * R * math.tan(rho - slope), W, ROUNDING)
            near(efficiency, max(math.tan(slope - rho) / SLOPE, 0.0), 1.0, ROUNDING)
            assert (torque > 0.0) == (mu > SLOPE)


def test_a_trapezoidal_flank_and_an_efficiency() -> None:
    """mu / cos(beta) in place of mu; an efficiency is met in full sliding, of turning into thrust."""
    for key, value in (("flank_angle", math.radians(15)), ("efficiency", 0.4)):
        scene = jack(0.12, rate=5.0, **{key: value})
        rho = math.atan(0.12 / math.cos(math.radians(15)))
        if key == "efficiency":
            del scene["couplings"]["thread"]["friction"]["coefficient"]
            rho = math.atan(SLOPE / 0.4) - math.atan(SLOPE)
        _, torque, efficiency = told(solved(scene))
        near(torque, W * R * math.tan(math.atan(SLOPE) + rho), W, ROUNDING)
        near(efficiency, SLOPE / math.tan(math.atan(SLOPE) + rho), 1.0, ROUNDING)


def test_left_to_itself_it_runs_down_or_creeps() -> None:
    """J phi'' = -p N - s mu r |N|, m z'' = N - m g - s mu (p / r) |N|, z' = p phi', s = tanh(phi' / 0.01)."""
    p, J = LEAD / math.tau, 0.05
    for start, mu in ((-3.0, 0.05), (-3.0, 0.2), (3.0, 0.2)):
        scene = jack(mu)
        scene["joints"]["spin"]["initial"] = {"rate": start}
        found, s = solved(scene), math.copysign(1.0, start)
        up = W / (100 * p * (p + s * mu * R) / J + 1 - s * mu * p / R)
        near(found.coordinates["spin"]["acceleration"], -(p + s * mu * R) * up / J, 100.0, ROUNDING)
        near(found.couplings["thread"]["force"], (1 - s * mu * p / R) * up, W, ROUNDING)
    scene = jack(0.2) | {"analysis": {"duration": 5, "samples": 6, "tolerance": 1e-9}}
    found = solved(scene)
    near(found.coordinates["spin"]["rate"][-1], -0.01 * math.atanh(SLOPE / 0.2), 0.01, 1e-9)
    total = found.energy["kinetic"] + found.energy["potential"] - found.energy["work"]
    near(total, total[0], 0.1, 1e-8)


def test_where_it_jams_and_where_two_answers_meet_its_law() -> None:
    """Painleve's, of a light spindle: m p (mu r - p) > J (1 + mu p / r); told at the start, on both sides of that."""
    mu, p = 0.2, LEAD / math.tau
    limit = 100 * p * (mu * R - p) / (1 + mu * p / R)
    for start, code in ((-3.0, "friction-jams"), (3.0, "friction-not-unique")):
        for inertia in (1.001 * limit, 0.999 * limit):
            scene = jack(mu, inertia=inertia)
            scene["joints"]["spin"]["initial"] = {"rate": start}
            if inertia > limit:
                assert np.isfinite(solved(scene).couplings["thread"]["force"]).all()
                continue
            with pytest.raises(SolveError) as error:
                solved(scene)
            (problem,) = error.value.problems
            assert problem.code == code
            assert "couplings.thread" in problem.message
            assert "spindle" in problem.hint


def test_what_is_held_twice_cannot_press() -> None:
    scene = jack(0.1, rate=5.0)
    scene["couplings"]["again"] = {"type": "ratio", "of": ["spin", "guide"], "factors": [LEAD / math.tau, -1.0]}
    with pytest.raises(SolveError) as error:
        solved(scene)
    assert [(p.code, "couplings.thread" in p.message) for p in error.value.problems] == [("friction-open", True)]


def test_a_blow_goes_through_it_as_if_nothing_rubbed() -> None:
    scene = jack(0.3) | {"analysis": {"type": "impulse"}}
    scene["impulses"] = {"blow": {"on": "nut.o", "vector": [0, 0, 2]}}
    with pytest.warns(heuncli.HeunWarning, match="passes the thread thread without friction"):
        blow = heuncli.solve(text=to_yaml(scene))
    p = LEAD / math.tau
    near(float(blow["impulses.0.couplings.thread.force"]), -2 * 0.05 / (0.05 + 100 * p * p), 2.0, ROUNDING)


def test_what_heun_model_says_of_it() -> None:
    for mu, words in ((0.3, "thread: self-locking (slope 6.486 deg"), (0.05, "thread: not self-locking (slope 6.486")):
        reasons = solved(jack(mu, rate=5.0)).model["reasons"]
        assert any(sentence.startswith(words) for sentence in reasons)


@pytest.mark.parametrize(
    "wrong", [{"coefficient": -0.1}, {"radius": 0}, {"speed": 0}, {"efficiency": 0.4}, {"flank_angle": 1.2}]
)
def test_refused(wrong: dict[str, Any]) -> None:
    scene = jack(0.1, rate=5.0, **wrong)
    (key,) = wrong
    if key == "efficiency":
        both, scene["couplings"]["thread"]["friction"]["flank_angle"] = to_yaml(scene), 0.2
        del scene["couplings"]["thread"]["friction"]["coefficient"]
        key = "flank_angle"
        with pytest.raises(SpecError, match="coefficient and efficiency"):
            load("scene.yaml", both)
    with pytest.raises(SpecError) as error:
        load("scene.yaml", to_yaml(scene))
    assert [(p.code, p.location.path.rpartition(".")[2]) for p in error.value.problems if p.location] == [
        ("thread-friction", key)
    ]
