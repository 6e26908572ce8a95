"""Drives that no motion can follow: refused with their names, when the spec is read or when the loops are closed."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import HeunError, SolveError, SpecError
from tests.shared.drive_sources import driven
from tests.shared.mechanisms import BASE, ROCKER, crank_rocker
from tests.shared.scenes import moving, solved

BARS = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  a: {mass: 1, center: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1], points: {O: [0, 0, 0], E: [1, 0, 0]}HELD}
  b: {mass: 1, center: [1.5, 0, 0], inertia: [0.1, 0.1, 0.1], points: {O: [1, 0, 0]}}
joints:
  j: {type: TYPE, from: ground.O, to: a.OINITIAL}
  k: {type: pin, from: a.E, to: b.O, axis: [0, 0, 1]}
tables: {kinked: {x: [0, 0.4, 1], y: [0, 1, 1.5]}}
drives: {motor: {joint: j, DRIVE}MORE}
analysis: {duration: 1, samples: 3}
"""
PIN = "pin, axis: [0, 0, 1]"


def bars(drive: str, kind: str = PIN, initial: str = "", held: str = "", more: str = "") -> str:
    text = BARS.replace("TYPE", kind).replace("INITIAL", initial and f", initial: {{{initial}}}")
    return text.replace("HELD", held and f", {held}").replace("DRIVE", drive).replace("MORE", more)


READING = {  # what is driven and held, the code, words of the refusal
    "jumps": (bars("angle: 0.3*step(t - 0.5)"), "drive-jumps",
              "drives.motor.angle: the drive jumps from 0 to 0.3 at t = 0.5"),
    "held angle": (bars("angle: 0.3 + t", initial="angle: 0.4"), "drive-contradicts",
                   "angle starts at 0.4, but drive motor prescribes 0.3 at t = 0"),
    "held rate": (bars("angle: 0.3 + t", initial="rate: 0.4"), "drive-contradicts", "prescribes 1 at t = 0"),
    "held travel": (bars("travel: 0.3 + t", "slide, axis: [1, 0, 0]", "travel: 0.4"), "drive-contradicts",
                    "travel starts at 0.4"),
    "two on one joint": (bars("angle: t", more=", other: {joint: j, angle: 2*t}"), "drive-form",
                         "the joint j is already driven by motor"),
    "on a ball": (bars("angle: t", "ball"), "drive-form", "a ball has no angle"),
    "travel of a pin": (bars("travel: t"), "drive-form", "a pin has no travel"),
    "not of time": (bars("angle: k.angle"), "drive-form", "depend on time alone"),
}  # fmt: skip


@pytest.mark.parametrize("case", READING)
def test_refused_when_read(case: str) -> None:
    text, code, words = READING[case]
    with pytest.raises(SpecError) as raised:
        solved(text)
    problem = raised.value.problems[0]
    assert problem.code == code
    assert words in str(raised.value)
    assert problem.location is not None and (problem.location.line or 0) > 0


@pytest.mark.parametrize("drive", ["abs(t - 1.5)", "max(0, t - 0.5)**2", "step(t - 2)", "0.1*abs(t)"])
def test_not_refused(drive: str) -> None:
    """Kinks outside the run or at its ends, and those of the second derivative alone, are no blows."""
    assert solved(bars(f"angle: '{drive}'")).status["code"] == "completed"


def test_held_pose_and_held_rates() -> None:
    pose = "position: [0, 0, 0], orientation: {axis: [0, 0, 1], angle: 0}"
    for held, code in ((pose, "held-conflict"), ("angular_velocity: [0, 0, 0.5]", "rates-do-not-fit")):
        with pytest.raises(SolveError) as raised:
            solved(bars("angle: 0.3 + t", held=held))
        assert raised.value.problems[0].code == code
        assert "motor" in str(raised.value)


# ---- in a loop of one freedom
def rocker(*drives: tuple[str, str], phi: float = 0.5) -> dict[str, Any]:
    """The crank-rocker assembled near a pose, with these (joint, expression in t) as drives d0, d1, ..."""
    scene = crank_rocker(phi, 0.0)
    for body in scene["bodies"].values():
        body["near"] = {"position": body.pop("position"), "orientation": body.pop("orientation")}
        del body["velocity"], body["angular_velocity"]
    return {**scene, "drives": {f"d{k}": driven(joint, "angle", source) for k, (joint, source) in enumerate(drives)}}


def angles(phi: float = 0.5) -> dict[str, float]:
    """The joints' angles in a pose."""
    found = solved(crank_rocker(phi, 0.0)).coordinates
    return {name: float(block["angle"][0]) for name, block in found.items()}


def refusal(scene: dict[str, Any], times: tuple[float, ...] = (0.0, 0.5, 1.0)) -> HeunError:
    with pytest.raises(SolveError) as raised:
        solved(moving(scene, times, 1e-9), time_limit=20)
    return raised.value


@pytest.mark.heavy
def test_two_drives_of_one_freedom() -> None:
    """In the pose, in the rate, in the acceleration, and later on: each refused; the first three name both drives."""
    A, D = angles()["A"], angles()["D"]
    rate, acceleration = rocker_slopes()
    follows = f"{D!r} + ({rate!r})*t + ({acceleration / 2!r})*t**2"
    cases = {"does-not-fit": f"{D + 0.3!r}", "rates-do-not-fit": f"{D!r} + 2*t"}
    cases["singular-pose"] = f"{D!r} + ({rate!r})*t"
    for code, source in cases.items():
        error = refusal(rocker(("A", f"{A!r} + t"), ("D", source)))
        assert error.problems[0].code == code
        assert "d0, d1" in str(error)
    error = refusal(rocker(("A", f"{A!r} + t"), ("D", follows)))
    assert error.problems[0].code in ("closure-lost", "step-collapsed")
    assert float(re.search(r"t = (\S+) s", str(error))[1]) < 0.5  # type: ignore[index]


def rocker_slopes() -> tuple[float, float]:
    """Rate and acceleration of the rocker when the crank turns at 1 rad/s."""
    one = solved(moving(rocker(("A", f"{angles()['A']!r} + t")), (0.0, 0.1), 1e-9)).coordinates["D"]
    return float(one["rate"][0]), float(one["acceleration"][0])


def test_every_joint_of_a_loop_driven() -> None:
    error = refusal(rocker(*((name, f"{angle!r}") for name, angle in angles().items())))
    assert error.problems[0].code == "over-driven"
    assert "joints." in str(error)


def test_two_drives_that_hold_still_together() -> None:
    """A brake on both shafts is no contradiction: the motion is certain, the torques are not, nor their pins' loads."""
    A, D = angles()["A"], angles()["D"]
    found = solved(moving(rocker(("A", f"{A!r}"), ("D", f"{D!r}")), (0.0, 1.0)))
    for name in ("A", "D"):
        assert np.isnan(found.joints[name]["drive"]).all()
        assert "drive" in found.joints[name]["open"]
        assert np.abs(found.coordinates[name]["rate"]).max() <= 1e-12
    assert not np.isnan(found.foundation["force"]).any()


@pytest.mark.heavy
def test_a_drive_beyond_what_the_loop_can_do() -> None:
    """The rocker cannot swing past where coupler and crank lie over each other, C 0.6 m from A: there the run ends."""
    D = angles()["D"]
    error = refusal(rocker(("D", f"{D!r} + t")), (0.0, 0.5, 3.0))
    limit = np.arccos((0.6**2 - BASE**2 - ROCKER**2) / (2 * BASE * ROCKER)) - D
    assert float(re.search(r"t = (\S+) s", str(error))[1]) == pytest.approx(limit, abs=1e-6)  # type: ignore[index]
