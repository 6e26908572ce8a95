"""Runs in given steps that come to no end: the step is named where it was too long, the lock where there is one."""

from __future__ import annotations

import math

import pytest

from heuncli.base.errors import Problem, SolveError
from tests.bench.stiff import WIRE
from tests.shared.bars import double
from tests.shared.folders import SPECS
from tests.shared.locking_crank import LOCKING_CRANK
from tests.shared.scenes import solved
from tests.shared.seeds import spared

FOUR_BAR = (SPECS / "four_bar.yaml").read_text().partition("\nexpect:")[0]
STIFF = WIRE.replace("DAMPING", "2e4")
ITS_OWN = "or --method auto, which chooses its own and reaches the end"


def problem_of(text: str, method: str, step: float) -> Problem:
    with pytest.raises(SolveError) as caught:
        solved(text, method=method, step=step)
    assert caught.value.reached is not None
    return caught.value.problems[0]


@pytest.mark.heavy
@pytest.mark.parametrize("method", spared(["Euler", "Heun2", "Heun3", "RK4"], quick={"RK4"}))
def test_a_stiff_spring_in_long_steps(method: str) -> None:
    """k = 1e8 N/m, c = 2e4 Ns/m on 1 kg: a double root at 1e4 1/s; shorter steps than the hint's follow it."""
    found = problem_of(STIFF, method, 1e-3)
    assert found.code == "not-a-number"
    assert "a motion in steps of 0.001 s has no finite acceleration after this instant" in found.message
    assert found.hint == f"the fastest rate at the start is 1e+04 1/s: use steps of 0.0002 s or less, {ITS_OWN}"
    short = STIFF.replace("duration: 2", "duration: 0.02")
    assert math.isfinite(solved(short, method=method, step=1e-4).accuracy["estimate"]["motion"])


def test_a_loop_in_steps_too_long() -> None:
    found = problem_of(FOUR_BAR, "RK4", 0.5)
    assert found.code == "closure-lost"
    assert found.message == "at t = 0.5 s: with steps of 0.5 s closed loops cannot be assembled after this instant"
    assert found.hint is not None and found.hint.endswith(ITS_OWN)
    assert solved(FOUR_BAR, method="RK4", step=0.1).status["code"] == "completed"


def test_stages_that_are_not_solved() -> None:
    found = problem_of(double("{duration: 2, samples: 3}"), "Gauss4", 0.5)
    assert (found.code, found.message.partition(": ")[2]) == (
        "stages-unsolved", "the equations of a step of 0.5 s cannot be solved: Newton's iteration does not converge",
    )  # fmt: skip
    assert found.hint == f"use steps shorter than 0.5 s, {ITS_OWN}"


@pytest.mark.heavy
@pytest.mark.parametrize("method", ["Euler", "RK4", "Gauss4"])
def test_a_lock_is_no_fault_of_the_step(method: str) -> None:
    """The slider is drawn beyond the reach of crank and rod, 3 m, at 1 s: told as by a method that finds its steps."""
    text = LOCKING_CRANK.replace("{DRIVES}", '{push: {joint: G, travel: "2.5 + 0.5*t"}}')
    with pytest.raises(SolveError) as caught:
        solved(text)
    other = caught.value.problems[0]
    found = problem_of(text, method, 1e-3)
    assert found.code == other.code == "closure-lost"
    assert found.hint is not None and other.hint is not None
    assert found.hint.endswith(other.hint)
    assert "the drive push exceeds the range of the loop" in (found.hint or "")
