"""A02, windows of equal bars (IFToMM): through every horizontal position, where the freedoms jump from 1 to N + 1.

Exact values by the closed motion I th'' = G sin th (manual/references.md, "Windows").
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from heuncli.results.results import Results
from tests.oracle.published import windows
from tests.shared.published import printed_values
from tests.shared.scenes import moving, near, solved

TIMES = (0.0, 0.5, 1.0, 5.0, 10.0)
PRINTED = printed_values("windows", "formula")  # the other numbers of the case are held by test_published.py


def exact(t: float) -> tuple[float, ...]:
    """Place and velocity of the first bar's end."""
    paths = [f"points.bar0.end.{what}.{axis}" for what in ("position", "velocity") for axis in "xy"]
    return tuple(PRINTED[path, t] for path in paths)


FORTY = {
    0.5: (0.687925970791, 0.725780861357, 1.92916231127, -1.82854209371),
    1.0: (-0.115356880632, -0.9933241113, -6.66998752394, 0.774600098662),
}  # fmt: skip


pytestmark = pytest.mark.heavy  # one long run for all


@cache
def two() -> Results:
    return solved(moving(windows(2, 0.0, 1.0), TIMES, 1e-11))


def apart(found: Results, k: int, wanted: tuple[float, ...]) -> tuple[float, float]:
    """How far place and velocity of the first bar's end are from the exact ones."""
    end = found.points["bar0.end"]
    place = end["position"][k] - [*wanted[:2], 0.0]
    speed = end["velocity"][k] - [*wanted[2:], 0.0]
    return float(np.linalg.norm(place)), float(np.linalg.norm(speed))


@pytest.mark.parametrize("t", TIMES[1:])
def test_exact_motion(t: float) -> None:
    """In space. What ten crossings cost is no more than the growth of any error: 2e-10 reached."""
    place, speed = apart(two(), TIMES.index(t), exact(t))
    assert place <= 5e-10
    assert speed <= 7.0 * 5e-10  # the largest speed is 7 m/s


def test_the_run_says_what_it_reached() -> None:
    """The estimate covers the true error, also where the tolerance cannot be had."""
    found = two()
    size = np.sqrt(2.0**2 + 1.0)  # of the scene, at least
    worst = max(apart(found, k, exact(t))[0] for k, t in enumerate(TIMES[1:], 1))
    assert worst <= found.accuracy["estimate"]["motion"] * 1.5 * size
    assert found.accuracy["energy_drift"] <= 1e-9
    assert found.accuracy["constraint_gap"] <= 1e-13


def test_all_windows_stay_parallelograms() -> None:
    """No bar takes the other branch at any crossing."""
    found = two()
    first = found.points["bar0.end"]["position"]
    for i in (1, 2):
        near(found.points[f"bar{i}.end"]["position"] - first, np.array([i, 0, 0]) + 0 * first, 1.0, 1e-13)


def test_pin_reactions() -> None:
    """In the plane certain, across it open: three loads held twice by each window."""
    found = two()
    assert (found.model["freedoms"], found.model["redundant"], found.model["loops"]) == (1, 6, 2)
    upright = {"G0": (0, 13.715), "G1": (0, 18.12), "G2": (0, 13.715)}
    leaning = {"G0": (0.8112759, 3.8361331), "G1": (0.2942763, 3.3016997), "G2": (0.8112759, 3.8361331)}
    ends = {"left0": ((0, 4.405), (0.5374433, -0.5344334)), "right0": ((0, 4.405), (0.0102219, -0.5344334)),
            "left1": ((0, 4.405), None), "right1": ((0, 4.405), None)}  # fmt: skip
    for name in upright:  # ON the first-named body, the bar, as printed: heun's force is on the ground
        near(-found.joints[name]["force"][0, :2], upright[name], 1.0, 1e-12)
        near(-found.joints[name]["force"][1, :2], leaning[name], 1.0, 6e-8)
    for name, (start, later) in ends.items():
        near(found.joints[name]["force"][0, :2], start, 1.0, 1e-12)
        if later is not None:
            near(found.joints[name]["force"][1, :2], later, 1.0, 6e-8)
    for block in found.joints.values():
        assert np.isnan(block["force"][:, 2]).all() and not np.isnan(block["force"][:, :2]).any()
        assert np.isnan(block["moment"][:, :2]).all()
    near(found.foundation["force"][0], (0, -45.55, 0), 1.0, 1e-12)


def test_total_force_on_the_ground() -> None:
    """The weight less m times the acceleration of all bars, by the closed motion: w² = 1 + 2 G/I (1 - cos th)."""
    found = two()
    inertia, G = 2 + 3 / 3, (2 + 3 / 2) * 9.81  # the bars turn about their ends, the couplers move in circles
    for k, t in enumerate(TIMES[1:3], 1):
        sin, cos = exact(t)[:2]
        turning, w2 = G / inertia * sin, 1.0 + 2 * G / inertia * (1.0 - cos)
        lever = 3 / 2 + 2
        a = lever * np.array([turning * cos - w2 * sin, -turning * sin - w2 * cos])
        near(found.foundation["force"][k, :2], np.array([0.0, -5 * 9.81]) - a, 100.0, 1e-8)


def test_forty_windows() -> None:
    """81 bodies, 40 loops, 120 loads held twice: to a tolerance of 1e-6 of the scene's 40 m."""
    found = solved(moving(windows(40, 0.0, 1.0), (0.0, 0.5, 1.0), 1e-6))
    assert (found.model["freedoms"], found.model["redundant"], found.model["loops"]) == (1, 120, 40)
    for k, t in ((1, 0.5), (2, 1.0)):
        assert apart(found, k, FORTY[t])[0] <= 40 * 1e-6
    assert found.accuracy["constraint_gap"] <= 1e-12
