"""Closed chains by hand: manual/theory.md, "Closed cases" 12 (slider-crank, driven and free) and 13 (ladder)."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from heuncli.results.results import Results
from tests.shared.scenes import near, solved
from tests.shared.slider_crank import JOINTS, slider_crank

DIGITS = 1e-12  # relative; the printed values have 15 to 16 digits


@cache
def driven(told: str) -> Results:
    return solved(slider_crank(told, "", "drives: {motor: {joint: shaft, angle: 60*deg + 100*t}}\n"))


@pytest.mark.parametrize("told", JOINTS)
def test_driven_motion(told: str) -> None:
    found = driven(told)
    rod, slider = found.bodies["rod"], found.bodies["slider"]
    psi = np.arctan2(rod["rotation"][0, 1, 0], rod["rotation"][0, 0, 0])
    near(psi, -0.2928427717285755, 1.0, DIGITS)
    near(rod["angular_velocity"][0], (0, 0, -17.40776559556978), 17.4, DIGITS)
    near(rod["angular_acceleration"][0], (0, 0, 2923.746371663162), 2924.0, DIGITS)
    near(slider["position"][0], (0.3372281323269014, 0, 0), 1.0, DIGITS)
    near(slider["velocity"][0], (-10.1678107607332, 0, 0), 10.0, DIGITS)
    near(slider["center_acceleration"][0], (-333.8349647695612, 0, 0), 334.0, DIGITS)
    guide = found.coordinates["guide"]
    near([guide["travel"][0], guide["speed"][0], guide["acceleration"][0]],
         [0.3372281323269014, -10.1678107607332, -333.8349647695612], 334.0, DIGITS)  # fmt: skip


@pytest.mark.parametrize("told", JOINTS)
def test_driven_loads(told: str) -> None:
    found, size = driven(told), 1084.0
    force = {name: block["force"][0] for name, block in found.joints.items()}
    near(force["shaft"][:2], (-1084.286433062166, -466.0281685288434), size, DIGITS)
    near(force["big_end"][:2], (-834.2864330621662, -33.0154666366241), size, DIGITS)
    near(force["wrist"][0], -500.7524471543417, size, DIGITS)
    near(force["guide"][:2], (0, -313.3946948771514), size, DIGITS)
    near(found.joints["shaft"]["drive"][0], 70.60055117462299, 70.6, DIGITS * 10)
    total = (-1084.286433062166, -779.4228634059948, 0)
    near(found.foundation["mass_effect"]["force"][0], total, size, DIGITS)
    near(-found.foundation["force"][0], total, size, DIGITS)
    motor = found.foundation["elements"]["motor"]
    near(motor["moment"][0], (0, 0, -70.60055117462299), 70.6, DIGITS * 10)
    near(motor["force"][0], 0.0, size, DIGITS)


def test_what_is_open() -> None:
    """Four parallel axes hold the plane of motion three times over; a ball and a universal leave nothing open."""
    across = {"force.z", "moment.x", "moment.y"}
    for name in ("shaft", "big_end", "wrist", "guide"):
        assert {n for n in driven("four pins").joints[name]["open"] if "." in n} == across
        assert driven("determinate").joints[name]["open"] == []
    assert driven("four pins").model["redundant"] == 3
    assert driven("determinate").model["redundant"] == 0


@pytest.mark.parametrize("told", JOINTS)
def test_free_with_a_push_on_the_slider(told: str) -> None:
    push = "forces: {push: {type: force, on: slider.B, vector: [1000, 0, 0]}}\n"
    found = solved(slider_crank(told, ", initial: {angle: 1, rate: 10}", push))
    near(found.bodies["crank"]["angular_acceleration"][0], (0, 0, -3892.65856532819), 3893.0, DIGITS)
    near(found.joints["shaft"]["force"][0, :2], (21.38399818, -86.77295698), 1000.0, 1e-11)  # 8 decimals


# ---- 13, the ladder
def ladder(tilt: float, rate: float, analysis: str) -> str:
    """A thin rod, its foot on a line along x and its head on one along y; tilt from the vertical."""
    sin, cos = np.sin(tilt), np.cos(tilt)
    return f"""
heun: 1
gravity: [0, -9.81, 0]
ground: {{points: {{corner: [0, 0, 0]}}}}
bodies:
  ladder:
    shapes: [{{type: rod, from: [0, 0, 0], to: [0, 1, 0], mass: 1}}]
    points: {{foot: [0, 0, 0], head: [0, 1, 0]}}
    position: [{float(sin)!r}, 0, 0]
    orientation: {{axis: [0, 0, 1], angle: {tilt!r}}}
    velocity: [{float(rate * cos)!r}, 0, 0]
    angular_velocity: [0, 0, {rate!r}]
joints:
  floor: {{type: line, from: ground.corner, to: ladder.foot, axis: [1, 0, 0]}}
  wall: {{type: line, from: ground.corner, to: ladder.head, axis: [0, 1, 0]}}
{analysis}"""


def of_ladder(found: Results, k: int) -> dict[str, Any]:
    rod = found.bodies["ladder"]
    turn = rod["rotation"][k]
    return {"tilt": float(np.arctan2(-turn[0, 1], turn[1, 1])), "spin": rod["angular_acceleration"][k, 2],
            "floor": found.joints["floor"]["force"][k], "wall": found.joints["wall"]["force"][k]}  # fmt: skip


def test_ladder_at_an_instant() -> None:
    rate = float(np.sqrt(3 * 9.81 * (np.cos(0.3) - np.cos(0.9))))
    found = of_ladder(solved(ladder(0.9, rate, "")), 0)
    near(found["spin"], 11.526655475168418, 11.5, 1e-14)
    near(found["floor"], (0, 2.242836917183334, 0), 9.81, 1e-14)
    near(found["wall"], (-0.2642086567283595, 0, 0), 9.81, 1e-14)


def test_ladder_sliding_down() -> None:
    """From rest at 0.3: the guides hold it also where a wall would have let it go, beyond cos = 2/3 cos 0.3."""
    found = solved(ladder(0.3, 0.0, "analysis: {duration: 0.6, samples: 31, tolerance: 1e-11}\n"))
    tilts = []
    for k in range(31):
        now = of_ladder(found, k)
        c, s, c0 = np.cos(now["tilt"]), np.sin(now["tilt"]), np.cos(0.3)
        tilts.append(now["tilt"])
        near(now["spin"], 1.5 * 9.81 * s, 14.7, 1e-10)
        near(now["floor"], (0, 9.81 / 4 * (1 - 6 * c * c0 + 9 * c * c), 0), 9.81, 1e-10)
        near(now["wall"], (0.75 * 9.81 * s * (3 * c - 2 * c0), 0, 0), 9.81, 1e-10)
    assert tilts[0] == pytest.approx(0.3, abs=1e-15) and tilts[-1] > 0.9
