"""`heun find` against closed forms: a tension, a bearing's load, a moment, a triangle of forces; its runs counted."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest

from tests.shared.command import Heun
from tests.shared.folders import SPECS
from tests.shared.variant_scenes import (
    CANTILEVER,
    IN_BAR,
    PENDULUM,
    ROOT,
    TENSION,
    TWO_BARS,
    angle_for,
    in_bar,
)

MOST_RUNS = 12  # of one crossing
DEG = math.pi / 180.0


def found(heun: Heun, text: str, unknown: str, condition: str, *more: str) -> Any:
    """What is found, of JSON."""
    done = heun("find", "-", unknown, condition, "--format", "json", *more, text=text)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def covers(crossing: Any, truth: float) -> bool:
    """Whether a crossing is within its stated error of a place, and the error is of use."""
    rounding = 4.0 * np.finfo(float).eps * abs(truth)
    return abs(crossing["x"] - truth) <= crossing["error"] + rounding and crossing["error"] <= 1e-6 * abs(truth)


@pytest.mark.parametrize("force", [20.0, 30.0, 41.5, 55.0])
def test_the_angle_from_which_a_pendulum_pulls_so_hard(heun: Heun, force: float) -> None:
    told = found(heun, PENDULUM, "a=5:95deg", f"{TENSION} = {force} N")
    (crossing,) = told["crossings"]
    assert covers(crossing, angle_for(force) / DEG) and crossing["way"] == "rises"
    assert crossing["si"] == pytest.approx(angle_for(force), rel=1e-8)
    assert told["runs"] == len(told["course"]) <= MOST_RUNS


def test_the_value_that_is_told_is_set_and_gives_that_measure(heun: Heun) -> None:
    (crossing,) = found(heun, PENDULUM, "a=5:95deg", f"{TENSION} = 30 N")["crossings"]
    done = heun("run", "-", "--set", crossing["set"], "--measure", TENSION, text=PENDULUM)
    assert float(done.stdout) == crossing["measure"]
    assert abs(crossing["measure"] - 30.0) <= crossing["measure_error"]


@pytest.mark.parametrize("force", [80.0, 100.0, 200.0, 280.0])
def test_the_speed_at_which_a_bearing_carries_so_much(heun: Heun, force: float) -> None:
    """The right one carries (shaft + M) g/2 + 2/3 m (g + e n^2) below: specs/rotor.yaml."""
    text = (SPECS / "rotor.yaml").read_text()
    told = found(heun, text, "n=500:6000rpm", f"max joints.right.radial = {force / 1e3} kN")
    (crossing,) = told["crossings"]
    shaft = 7850.0 * math.pi * 0.015**2 * 0.6
    speed = math.sqrt(((force - (shaft + 12.0) * 9.81 / 2.0) / (2.0 / 3.0 * 0.02) - 9.81) / 0.04)
    assert covers(crossing, speed * 30.0 / math.pi) and told["runs"] <= MOST_RUNS


def test_two_crossings(heun: Heun) -> None:
    """F L sin a = 60 N m on both sides of the largest; below it between them and the ends."""
    told = found(heun, CANTILEVER, "a=5:170deg", f"{ROOT} < -60 Nm")
    left, right = told["crossings"]
    angle = math.asin(60.0 / 100.0) / DEG
    assert covers(left, angle) and covers(right, 180.0 - angle)
    assert (left["way"], right["way"]) == ("falls", "rises")
    (met,) = told["met"]
    assert met["from"] == {"x": left["x"], "error": left["error"], "kind": "crossing"}
    assert met["to"] == {"x": right["x"], "error": right["error"], "kind": "crossing"}
    outside = found(heun, CANTILEVER, "a=5:170deg", f"{ROOT} >= -60 Nm")["met"]
    assert [(one["from"]["kind"], one["to"]["kind"]) for one in outside] == [("end", "crossing"), ("crossing", "end")]
    assert (outside[0]["from"]["x"], outside[1]["to"]["x"]) == (5.0, 170.0)


@pytest.mark.parametrize("gap", [0.3, 0.03, 0.003])
def test_two_crossings_between_places_of_the_scan(heun: Heun, gap: float) -> None:
    """Nearer together than the scan's spacing: the bend beside them tells of them."""
    value = 100.0 * math.cos(gap)
    told = found(heun, CANTILEVER, "a=5:170deg", f"{ROOT} = {-value!r} Nm")
    left, right = told["crossings"]
    assert told["spacing"] > 2.0 * gap / DEG
    assert covers(left, 90.0 - gap / DEG) and covers(right, 90.0 + gap / DEG)


def test_a_touch_is_one(heun: Heun) -> None:
    told = found(heun, CANTILEVER, "a=5:170deg", f"{ROOT} = -100 Nm")
    (touch,) = told["touches"]
    assert told["crossings"] == [] and touch["side"] == 1
    assert touch["x"] == pytest.approx(90.0, abs=1e-3)  # where 1 - sin a passes the rounding of 100 N m


def test_a_near_miss_is_told_with_the_extreme(heun: Heun) -> None:
    told = found(heun, CANTILEVER, "a=5:170deg", f"{ROOT} = -100.001 Nm")
    assert told["crossings"] == told["touches"] == [] and told["refined"]
    assert told["least"]["measure"] == pytest.approx(-100.0, abs=1e-4)
    assert told["least"]["x"] == pytest.approx(90.0, abs=0.1)
    assert told["greatest"]["x"] == 5.0 or told["greatest"]["x"] == 170.0


def test_a_jump_is_no_crossing(heun: Heun) -> None:
    told = found(heun, CANTILEVER, "at_once=0:3", "joints.root.force.z = -2 N")
    (jump,) = told["jumps"]
    assert told["crossings"] == []
    assert (jump["from"]["measure"], jump["to"]["measure"]) == (0.0, -5.0)
    assert jump["from"]["x"] <= 1.2 <= jump["to"]["x"] <= jump["from"]["x"] + 1e-8


@pytest.mark.long
def test_what_cannot_be_solved_holds_no_crossing(heun: Heun) -> None:
    """The bars close for b from 0.5 to 1.5 m; towards both ends their forces grow beyond all bounds."""
    told = found(heun, TWO_BARS, "b=0.2:2", f"{IN_BAR} = 40 N")
    for crossing in told["crossings"]:
        assert in_bar(crossing["x"]) == pytest.approx(40.0, rel=1e-9)
    assert [one["way"] for one in told["crossings"]] == ["falls", "rises"]
    below, above = told["unsolved"]
    assert below["code"] == above["code"] == "does-not-fit"
    assert (below["from"], above["to"]) == (0.2, 2.0)
    assert [below["to"], above["from"]] == pytest.approx([0.5, 1.5], abs=1e-9)  # what closing leaves of a length


def test_the_sides_of_an_unsolvable_stretch_are_no_crossing(heun: Heun) -> None:
    """The load turns its sign at q = 1, where the mass is none."""
    text = (
        TWO_BARS.replace("W: 30}", "W: 30, q: 2}")
        .replace("[0, -W, 0]", "[0, -W*(q - 1), 0]")
        .replace("one: {mass: 1", "one: {mass: 1 if abs(q - 1) > 0.2 else -1")
    )
    told = found(heun, text, "q=0:2", "joints.A.force.y = 0 N")
    assert told["crossings"] == told["jumps"] == [] and len(told["unsolved"]) == 1
    assert told["unsolved"][0]["code"] == "not-positive"
    assert told["unsolved"][0]["from"] < 0.8 and told["unsolved"][0]["to"] > 1.2


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.third
def test_stated_errors_cover_random_pendulums(heun: Heun, seed: int) -> None:
    rng = np.random.default_rng(seed)
    m, g, length = rng.uniform(0.2, 5.0), rng.uniform(2.0, 20.0), rng.uniform(0.2, 0.6)
    share = rng.uniform(1.05, 2.8)
    tolerance = 10.0 ** rng.uniform(-11.0, -6.0)
    told = found(
        heun, PENDULUM, "a=2:95deg", f"{TENSION} = {share * m * g!r} N",
        "--set", f"m={m!r} kg", "--set", f"g={g!r}", "--set", f"L={length!r} m", "--set", "analysis.duration=3",
        "--tolerance", repr(tolerance),
    )  # fmt: skip
    (crossing,) = told["crossings"]
    assert abs(crossing["x"] - angle_for(share * m * g, m, g) / DEG) <= crossing["error"]
    assert told["runs"] <= MOST_RUNS
