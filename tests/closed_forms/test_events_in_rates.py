"""Loads that begin, end or bend at a rate; and those that switch to and fro at once, which are told."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from tests.shared.one_freedom import TOO_LONG, One, follows, moved
from tests.shared.scenes import study

pytestmark = pytest.mark.heavy  # families: the plain kernel has the same bits (tests/package/test_kernels_agree.py)

SPAN = "duration: 6, samples: {}"


def wheel(loads: dict[str, str], rate: float, samples: int = 2, span: str = SPAN) -> One:
    return One(2.0, loads, 0.0, rate, span.format(samples), True)


@pytest.mark.parametrize("samples", [2, 49])
@pytest.mark.parametrize("brake", [
    "-3 if shaft.rate > 5 else 0", "-3*step(shaft.rate - 5)", "-1.5*(1 + sign(shaft.rate - 5))",
    "-3 if abs(shaft.rate) >= 5 and shaft.angle < 1e6 else 0",
])  # fmt: skip
def test_a_brake_above_a_rate(brake: str, samples: int) -> None:
    """Driven by 5 N·m, of which 3 are taken from 5 rad/s on: two parabolas."""
    found = moved(wheel({"motor": "5", "brake": brake}, 1.0, samples))
    t, at = found.time, 4 / 2.5
    x = np.where(t < at, t + 1.25 * t**2, at + 1.25 * at**2 + 5 * (t - at) + 0.5 * (t - at) ** 2)
    follows(found, x, np.where(t < at, 1 + 2.5 * t, 5 + t - at))


@pytest.mark.parametrize("samples", [2, 49])
def test_a_drag_that_ends_at_its_own_edge(samples: int) -> None:
    """2 N·m s of drag above 5 rad/s alone: the rate falls to 5 and stays there, hardly below."""
    found = moved(wheel({"drag": "-2*shaft.rate if shaft.rate > 5 else 0"}, 10.0, samples))
    t, at = found.time, math.log(2.0)
    x = np.where(t < at, 10 * -np.expm1(-t), 5 + 5 * (t - at))
    follows(found, x, np.where(t < at, 10 * np.exp(-t), 5.0))


@pytest.mark.parametrize("samples", [2, 49])
def test_a_drag_that_bends(samples: int) -> None:
    """Nothing below 5 rad/s, in proportion to what is above; driven by 8 N·m."""
    found = moved(wheel({"motor": "8", "drag": "-2*max(0, shaft.rate - 5)"}, 1.0, samples))
    t, at = found.time, 1.0
    s = np.maximum(t - at, 0)
    x = np.where(t < at, t + 2 * t**2, 3 + 5 * s + 4 * (s + np.expm1(-s)))
    follows(found, x, np.where(t < at, 1 + 4 * t, 5 - 4 * np.expm1(-s)))


@pytest.mark.parametrize("width", [1.0, 1e-3, 1e-6])
@pytest.mark.parametrize("torque", [-4.5, -4.999, 40.0])
def test_a_span_of_rates(width: float, torque: float) -> None:
    """Driven by 5 N·m; from 5 rad/s to a little above another torque acts, which nearly holds the wheel there."""
    low, high = 5.0, 5.0 + width
    load = f"{torque!r} if {low!r} < shaft.rate < {high!r} else 0"
    within = (high - low) / ((5 + torque) / 2)
    last = 1.6 + within + 2.0
    found = moved(wheel({"motor": "5", "load": load}, 1.0, 9, f"duration: {last!r}, samples: {{}}"))
    t = found.time
    s, late = np.maximum(t - 1.6, 0), np.maximum(t - 1.6 - within, 0)
    a, b = 1.6 + 1.25 * 1.6**2, 0.5 * (low + high) * within
    x = np.where(late > 0, a + b + high * late + 1.25 * late**2, np.where(
        s > 0, a + low * s + 0.25 * (5 + torque) * s**2, t + 1.25 * t**2))  # fmt: skip
    u = np.where(late > 0, high + 2.5 * late, np.where(s > 0, low + 0.5 * (5 + torque) * s, 1 + 2.5 * t))
    # how long it takes has the digits of the two edges' difference
    rounding = 4e-16 * 5 / width * within * 8
    follows(found._replace(error=found.error + rounding), x, u)


@pytest.mark.parametrize("samples", [2, 49])
def test_dry_friction_is_overcome(samples: int) -> None:
    """-8 sign(rate) against a push of 10: it comes to rest and turns back."""
    found = moved(wheel({"push": "10", "friction": "-8*sign(shaft.rate)"}, -27.0, samples))
    t, at = found.time, 27 / 9  # slowed by 18 of 2 kg m²
    s = t - at
    x = -27 * t + 4.5 * t**2
    follows(found, np.where(s < 0, x, -40.5 + 0.5 * s**2), np.where(s < 0, 9 * s, s))


STUCK = [
    ("friction", {"push": "5", "friction": "-8*sign(shaft.rate)"}, 6.0, 6.0 / 1.5),
    ("from behind", {"push": "5", "friction": "-8*sign(shaft.rate)"}, -6.0, 6.0 / 6.5),
    ("hardly", {"push": "7.9999", "friction": "-8*sign(shaft.rate)"}, -6.0, 6.0 / 7.99995),
    ("at once", {"push": "5", "friction": "-8*sign(shaft.rate)"}, 0.0, 0.0),
    ("by conditions", {"push": "5", "friction": "-8 if shaft.rate > 0 else 8"}, 6.0, 4.0),
    ("two ways", {"push": "5", "friction": "8 - 16*step(shaft.rate)"}, 6.0, 4.0),
    ("a governor", {"push": "5", "brake": "-9*step(shaft.rate - 5)"}, 1.0, 1.6),
    ("in time", {"push": "5 if t < 2 else 9", "friction": "-8*sign(shaft.rate - 1)"}, 3.4, 1.6),
    # on the line rate = -angle the switch drives it back from either side: from (1, 0), down a parabola
    ("sliding", {"switch": "-8*sign(shaft.angle - 1 + shaft.rate)"}, 1.0, None),
]


@pytest.mark.parametrize("row", STUCK, ids=[row[0] for row in STUCK])
def test_what_chatters_is_told(row: tuple[str, dict[str, str], float, float | None]) -> None:
    """From the instant on at which each side drives to the other there is no motion: told with that instant."""
    _, loads, rate, at = row
    with pytest.raises(SolveError) as told:
        study(wheel(loads, rate, 13).text(), time_limit=TOO_LONG)
    problem = told.value.problems[0]
    assert "chatter" in problem.code, problem
    assert problem.hint
    if at is not None:
        named = float(problem.message.split("t = ")[1].split(" ")[0].rstrip(":"))
        assert abs(named - at) <= 1e-6 * max(at, 1.0), problem


def test_what_hardly_chatters_goes_on() -> None:
    """8 of friction, a push of 8.0001: it turns, slowly."""
    found = moved(wheel({"push": "8.0001", "friction": "-8*sign(shaft.rate)"}, -4.0, 5))
    t, at = found.time, 4 / 8.00005
    s = t - at
    x = np.where(s < 0, -4 * t + 8.00005 * t * t / 2, -4 * at / 2 + 0.00005 * s * s / 2)
    follows(found, x, np.where(s < 0, 8.00005 * s, 0.00005 * s))


@pytest.mark.parametrize("samples", [2, 33])
def test_ever_shorter_flights(samples: int) -> None:
    """-8 sign(angle) with a little drag: the parabolas shrink, the run still ends."""
    found = moved(One(2.0, {"load": "-8*sign(shaft.angle) - 0.2*shaft.rate"}, 0.0, 3.0,
                      f"duration: 20, samples: {samples}", True))  # fmt: skip
    x, u = shrinking(found.time, 3.0)
    follows(found, x, u)


def shrinking(times: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """2 φ.. = -8 side - 0.2 φ. from passage to passage: φ. = (w + 40) exp(-s/10) - 40 with the side's sign."""
    xs, us = np.empty_like(times), np.empty_like(times)
    t, side, w = 0.0, 1.0, rate
    while True:

        def flight(s: np.ndarray | float, w: float = w) -> tuple[np.ndarray, np.ndarray]:
            fall = -np.expm1(-np.asarray(s) / 10)
            return 10 * (w + 40) * fall - 40 * np.asarray(s), (w + 40) * (1 - fall) - 40

        low, high = w / 8, w
        while low < 0.5 * (low + high) < high:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if flight(middle)[0] > 0 else (low, middle)
        here = (times >= t) & (times <= t + low)
        x, u = flight(times[here] - t)
        xs[here], us[here] = side * x, side * u
        if t + low >= times[-1]:
            return xs, us
        t, side, w = t + low, -side, -float(flight(low)[1])
