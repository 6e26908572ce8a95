"""Paths that only push: where a bead lifts off a dome, how one bounces, what is told where one would have to pull."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.base.errors import SolveError, SpecError
from tests.shared.cams import table
from tests.shared.scenes import near, solved, study

G = 9.81
DOME = [table(f, -1.6, 1.6, 160) for f in (np.sin, np.cos)]  # over the angle from its top, clockwise: left is outside
ROUNDED = 0.02**2 / 12.0  # what the curvature of a spline is off by


def bead(keys: str, x: str, y: str, times: str, place: str = "", more: str = "") -> str:
    """A bead of 2 kg on or above a path in a planar scene."""
    return f"""
heun: 1
space: planar
gravity: [0, {-G}]
tables: {{x: {x}, y: {y}}}
ground: {{points: {{O: [0, 0]}}}}
bodies:
  bead: {{mass: 2, center: [0, 0], inertia: 0.1, points: {{P: [0, 0]}}{place}}}
joints:
  wire: {{type: curve, from: ground.O, to: bead.P, x: x, y: y, {keys}}}
{more}
analysis: {{times: {times}, tolerance: 1e-11}}
"""


@pytest.mark.parametrize("radius", [0.0, 0.5])
def test_where_a_bead_lifts_off_a_dome(radius: float) -> None:
    """m g cos - m v^2 / r = 0, v^2 = v0^2 + 2 g r (1 - cos): cos = 2/3 + v0^2 / 3 g r; a roller on a larger dome."""
    r = 1.0 + radius
    roller = f"radius: {radius}, " if radius else ""
    keys = f"one_sided: true, {roller}initial: {{travel: 0.1, speed: {0.5 / r}}}"
    found = study(bead(keys, *DOME, "[0, 0.3, 3]"))
    told = found.results
    theta = told.coordinates["wire"]["travel"][-1]
    wanted = (2.0 * math.cos(0.1) + 0.25 / (G * r)) / 3.0
    near(math.cos(theta), wanted, 1.0, ROUNDED)
    near(told.joints["wire"]["force"][-1], 0.0, 20.0, 1e-6)
    s = told.coordinates["wire"]["travel"][:-1]
    square = 0.25 + 2.0 * G * r * (math.cos(0.1) - np.cos(s))
    pressed = 2.0 * (G * np.cos(s) - square / r)
    near(told.joints["wire"]["force"][:-1, 1], pressed * np.cos(s), 20.0, 1e-5)
    assert "contact lost: the point of joint wire" in "".join(told.warnings)


def test_a_bead_that_bounces() -> None:
    """On a slope of 3 : 4: n = (-.6, .8) turns back e of the speed, whatever stands along; in between it falls."""
    slope = [f"{{x: [-9, 0, 9], y: {[k * s for s in (-9.0, 0.0, 9.0)]}, interpolation: cubic}}" for k in (0.8, 0.6)]
    n, e = np.array([-0.6, 0.8]), 0.7
    keys = f"one_sided: true, restitution: {e}"
    place = f", position: {(0.5 * n).tolist()}, velocity: [0, 0]"
    found = solved(bead(keys, *slope, "[0, 0.1, 0.5, 1]", place))
    fall = math.sqrt(2.0 * 0.5 / (G * 0.8))
    blows = found.impulses
    near(blows[0]["time"], fall, 1.0, 1e-9)
    v = G * 0.8 * fall
    near(blows[0]["joints"]["wire"]["force"][:2], 2.0 * v * (1.0 + e) * n, 20.0, 1e-9)
    near(blows[1]["time"], fall * (1.0 + 2.0 * e), 1.0, 1e-9)
    near(blows[1]["joints"]["wire"]["force"][:2], 2.0 * v * e * (1.0 + e) * n, 20.0, 1e-9)
    near(found.joints["wire"]["force"], 0.0, 20.0, 1e-9)
    along = 0.5 * G * 0.6 * found.time**2
    near(found.coordinates["wire"]["travel"], -along, 1.0, 1e-9)
    near(found.coordinates["wire"]["speed"], -G * 0.6 * found.time, 1.0, 1e-9)
    near(found.coordinates["wire"]["acceleration"], -G * 0.6, 10.0, 1e-9)


def test_flight_over_a_bent_path() -> None:
    """Travel, speed and acceleration are those of the place beside the point, of a roller's centre too."""
    for roller in ("", "radius: 0.2, "):
        place = ", position: [0.3, 1.6], velocity: [1.5, 1]"
        times = np.linspace(0.0, 0.2, 5)
        keys = f"one_sided: true, restitution: 0, {roller}"
        found = solved(bead(keys.rstrip(", "), *DOME, str(times.tolist()), place))
        x, y = 0.3 + 1.5 * times, 1.6 + times - 0.5 * G * times**2
        near(found.coordinates["wire"]["travel"], np.arctan2(x, y), 1.0, 1e-6)
        square = x * x + y * y
        u = (1.5 * y - x * (1.0 - G * times)) / square
        near(found.coordinates["wire"]["speed"], u, 1.0, 1e-5)
        turned = (x * G - 2.0 * u * (x * 1.5 + y * (1.0 - G * times))) / square
        near(found.coordinates["wire"]["acceleration"], turned, 10.0, 1e-3)


def test_a_state_in_which_a_path_would_have_to_pull() -> None:
    """Of one instant a warning tells; a motion ends there at once."""
    keys = "one_sided: true, normal: [0, 0, -1], initial: {travel: 0.3}"
    text = bead(keys, *DOME, "[0, 0.1]")
    assert "contact lost" in "".join(study(text.replace("times: [0, 0.1]", "type: state")).results.warnings)
    assert len(study(text).results.time) == 1


@pytest.mark.parametrize(("keys", "more", "code"), [
    ("one_sided: true, restitution: 1.2", "", "restitution"),
    ("restitution: 0.2", "", "restitution"),
    ("one_sided: true, restitution: 0", "forces: {f: {type: damper, joint: wire, coefficient: 3}}", "restitution"),
    ("one_sided: true", "drives: {d: {joint: wire, travel: 't'}}", "over-driven"),
    ("one_sided: true", "stops: {d: {joint: wire, travel: [0, 1]}}", "over-driven"),
])  # fmt: skip
def test_what_a_one_sided_path_refuses(keys: str, more: str, code: str) -> None:
    """Told with a hint."""
    with pytest.raises((SpecError, SolveError)) as told:
        solved(bead(keys, *DOME, "[0, 0.1]", more=more))
    (problem,) = told.value.problems
    assert problem.code == code and problem.hint


def test_a_roller_that_would_meet_its_path_elsewhere() -> None:
    """A hairpin that narrows from 1 m to 0.4: within a roller of 0.19 passes, one of 0.21 meets the other leg."""
    bump = lambda s: 0.5 - 0.3 / (1.0 + 4.0 * (np.abs(s) - 4.0) ** 2)  # noqa: E731
    width = table(lambda s: np.tanh(1.5 * s) * bump(s), -7.0, 7.0, 280)
    way = table(lambda s: -np.sqrt(0.25 + s * s), -7.0, 7.0, 280)
    text = bead("radius: 0.19, normal: NORMAL, initial: {travel: 4}", way, width, "[0, 0.01]")
    outside, inside = (text.replace("NORMAL", f"[0, 0, {k}]") for k in (-1, 1))
    solved(outside.replace("0.19,", "0.3,"))
    solved(inside)
    with pytest.raises(SpecError, match="at travel -4 the roller would also touch the path at travel 4"):
        solved(inside.replace("0.19,", "0.21,"))
