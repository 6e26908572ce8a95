"""Friction by what a joint carries, where it is known by a formula: bearings, guides, wedges, Painlevé's rod."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.results.results import Results
from tests.shared.scenes import solved

G = 9.81
DIGITS = 1e-12  # some roundings

WHEEL = """
heun: 1
gravity: [0, -9.81, 0]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{wheel: {{mass: 10, center: [0, 0, 0], inertia: [0.2, 0.2, 0.2], points: {{c: [0, 0, 0]}}}}}}
joints: {{main: {{type: pin, from: ground.O, to: wheel.c, axis: [0, 0, 1]{start}}}}}
forces:
  bearing: {{type: friction, joint: main, coefficient: 0.1, radius: 20 mm, speed: {speed}}}
{more}
"""


def test_a_wheel_runs_down_and_comes_to_rest() -> None:
    """J w' = -mu r m g tanh(w/v): sinh(w/v) falls as exp(-a t/v)."""
    a, v, w0 = 0.1 * 0.02 * 10 * G / 0.2, 0.5, 2.0
    text = WHEEL.format(start=", initial: {angle: 0, rate: 2}", speed=v, more="analysis: {duration: 4, samples: 41}")
    r = solved(text)
    wanted = v * np.arcsinh(np.sinh(w0 / v) * np.exp(-a * r.time / v))
    assert r.coordinates["main"]["rate"] == pytest.approx(wanted, abs=1e-8)
    assert r.energy["work"] == pytest.approx(0.1 * (wanted**2 - w0**2), abs=1e-8)


def test_a_driven_bearing_takes_a_torque() -> None:
    """Its drive is not part of what presses: the drive's torque is mu r |F|, and what the wheel takes."""
    drives = "drives: {motor: {joint: main, angle: 3*t + t**2}}\nanalysis: {duration: 1, samples: 5}"
    r = solved(WHEEL.format(start="", speed="1e-3", more=drives))
    assert r.joints["main"]["drive"] == pytest.approx(0.2 * 2 + 0.1 * 0.02 * 10 * G, rel=DIGITS)


def test_an_eccentric_driven_wheel_presses_as_it_turns() -> None:
    """|F| of weight and of what its centre, at e, is swung by: m |e w^2 inward - g|."""
    drives = "drives: {motor: {joint: main, angle: 7*t}}\nanalysis: {duration: 1, samples: 21}"
    text = WHEEL.format(start="", speed="1e-3", more=drives).replace("center: [0, 0, 0]", "center: [0.3, 0, 0]")
    r = solved(text)
    e = 0.3 * np.array([np.cos(7 * r.time), np.sin(7 * r.time)])
    pressed = 10 * np.hypot(*(-49.0 * e + np.array([[0.0], [G]])))
    assert -r.forces["bearing"]["value"] == pytest.approx(0.1 * 0.02 * pressed, rel=DIGITS)
    assert r.joints["main"]["drive"] == pytest.approx(10 * G * e[0] + 0.1 * 0.02 * pressed, rel=1e-11)


SLOPE = """
heun: 1
gravity: [0, 0, -9.81]
parameters: {{th: {angle}, mu: {mu}}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{block: {{mass: 3, center: [0, 0, 0], inertia: [1, 1, 1], points: {{c: [0, 0, 0]}}}}}}
joints:
  guide: {{type: slide, from: ground.O, to: block.c, axis: [cos(th), 0, -sin(th)], initial: {{travel: 0, speed: 1}}}}
forces:
  gib: {{type: friction, joint: guide, coefficient: mu, speed: 1e-4}}
analysis: {{duration: 0.5, samples: 6}}
"""


@pytest.mark.parametrize(("angle", "mu"), [(0.6, 0.2), (0.6, 0.9), (-0.3, 0.4)])
def test_a_block_on_a_slope(angle: float, mu: float) -> None:
    """g (sin th - mu cos th) down it; with mu above tan th it comes to rest."""
    r = solved(SLOPE.format(angle=angle, mu=mu))
    a = G * (np.sin(angle) - mu * np.cos(angle))
    speed = 1 + a * r.time
    moving = speed > 0.01
    assert r.coordinates["guide"]["speed"][moving] == pytest.approx(speed[moving], rel=1e-9)
    assert moving.sum() > 1


DRAWER = """
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  drawer: {{mass: 4, center: [0, 0, 0], inertia: [1, 1, 1], points: {{middle: [0, 0, 0], handle: [0.1, {lever}, 0]}}}}
joints: {{guide: {{type: slide, from: {ends}, axis: [1, 0, 0], initial: {{travel: 0, speed: {speed}}}}}}}
forces:
  pull: {{type: force, on: drawer.handle, vector: [10, {side}, 0]}}
  gib: {{type: friction, joint: guide, coefficient: 0.4, length: 0.3, speed: 1e-4}}
"""


def drawer(lever: float, side: float = 0.0, speed: float = 1.0, turned: bool = False) -> Results:
    ends = "drawer.middle, to: ground.O" if turned else "ground.O, to: drawer.middle"
    return solved(DRAWER.format(lever=lever, side=side, speed=speed, ends=ends))


@pytest.mark.parametrize("lever", [0.0, 0.2, 0.37, 0.38, 1.0])
def test_a_guide_that_tilts_holds_beyond_its_length_by_two_mu(lever: float) -> None:
    """m a = P (1 - 2 mu e/L): pushed beyond e = L/(2 mu) = 0.375 it is slowed, however hard it is pushed."""
    r = drawer(lever)
    assert r.coordinates["guide"]["acceleration"][0] == pytest.approx(2.5 * (1 - 2 * 0.4 * lever / 0.3), rel=DIGITS)


@pytest.mark.parametrize("turned", [False, True])
def test_a_side_load_presses_the_two_ends_apart(turned: bool) -> None:
    """F/2 -+ M/L of a side load at 0.1 beside the middle, which is less than half the length: both on one side."""
    r = drawer(0.0, side=6.0, speed=-1.0 if turned else 1.0, turned=turned)
    assert abs(r.forces["gib"]["value"][0]) == pytest.approx(0.4 * 6.0, rel=DIGITS)
    r = drawer(0.5, side=6.0)  # M = 6 * 0.1 - 10 * 0.5
    assert -r.forces["gib"]["value"][0] == pytest.approx(0.4 * 2 * abs(0.6 - 5.0) / 0.3, rel=DIGITS)


PAINLEVE = """
heun: 1
space: planar
gravity: [0, -9.81, 0]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  foot: {{mass: 1e-9, center: [0, 0, 0], inertia: [1e-9, 1e-9, 1e-9], points: {{c: [0, 0, 0]}}}}
  rod: {{shapes: [{{type: rod, from: [0, 0, 0], to: [2, 0, 0], mass: 1}}], points: {{end: [0, 0, 0]}}}}
joints:
  guide: {{type: slide, from: ground.O, to: foot.c, axis: [1, 0, 0], initial: {{travel: 0, speed: {speed}}}}}
  hinge: {{type: pin, from: foot.c, to: rod.end, axis: [0, 0, 1], initial: {{angle: {angle}, rate: {rate}}}}}
forces:
  rub: {{type: friction, joint: guide, coefficient: {mu}, speed: 1e-6}}
analysis: {{duration: {duration}, samples: 2}}
"""


def painleve(
    mu: float, speed: float, angle: float = np.arctan(2.0), rate: float = 0.0, duration: float = 1e-3
) -> Results:
    return solved(PAINLEVE.format(mu=mu, speed=speed, angle=angle, rate=rate, duration=duration))


@pytest.mark.parametrize("angle", [0.4, 0.9, np.arctan(2.0), 1.3])
@pytest.mark.parametrize("speed", [-3.0, 3.0])
def test_painleves_rod_up_to_its_threshold(angle: float, speed: float) -> None:
    """N (1 + 3 cos^2 + 3 mu sin cos sign v) = m g of the rod at rest about its end, while mu is below the threshold."""
    c, s = np.cos(angle), np.sin(angle)
    threshold = (1 + 3 * c * c) / (3 * s * c)
    mu = 0.999 * threshold
    N = painleve(mu, speed, angle).joints["guide"]["force"][0][1]
    assert N == pytest.approx(G / (1 + 3 * c * c + np.sign(speed) * 3 * mu * s * c), rel=1e-5)  # the foot's mass
    beyond = "friction-not-unique" if speed > 0 else "friction-jams"
    with pytest.raises(SolveError) as error:
        painleve(1.001 * threshold, speed, angle)
    assert error.value.problems[0].code == beyond


def test_the_threshold_is_four_thirds() -> None:
    """At tan th = 2 it is least; on either side of the motion one of the two paradoxes."""
    assert painleve(1.3333, -3.0).joints["guide"]["radial"][0] > 1.0
    codes = []
    for speed in (-3.0, 3.0):
        with pytest.raises(SolveError) as error:
            painleve(1.3334, speed)
        codes.append(error.value.problems[0].code)
        assert "joints.guide" in error.value.problems[0].message
    assert sorted(codes) == ["friction-jams", "friction-not-unique"]


@pytest.mark.parametrize("method", ["DOP853", "Radau5", "RK4"])
def test_a_rod_that_turns_into_the_paradox(method: str) -> None:
    """The run ends where the threshold is reached, and says when."""
    text = PAINLEVE.format(mu=1.6, speed=3.0, angle=0.5, rate=4.0, duration=1.0)
    step = ", method: RK4, step: 1e-3" if method == "RK4" else f", method: {method}"
    with pytest.raises(SolveError) as error:
        solved(text.replace("samples: 2", "samples: 2" + step))
    problem = error.value.problems[0]
    assert problem.code == "friction-jams"  # it turns so fast that it lifts its foot: what presses grows without bound
    t = float(problem.message.split("t = ")[1].split(" s ")[0])
    before = solved(text.replace("duration: 1.0", f"duration: {t - 2e-3}"))
    angle = float(before.coordinates["hinge"]["angle"][-1] + 2e-3 * before.coordinates["hinge"]["rate"][-1])
    c, s = np.cos(angle), np.sin(angle)
    assert 3 * 1.6 * s * c / (1 + 3 * c * c) == pytest.approx(1.0, abs=2e-2)


def test_two_pins_of_one_shaft_are_the_sum_of_both() -> None:
    """Twice the friction at half the coefficient, in two loads of one joint."""
    text = WHEEL.format(start=", initial: {angle: 0, rate: 2}", speed=0.5, more="analysis: {duration: 1, samples: 3}")
    half = text.replace("coefficient: 0.1", "coefficient: 0.05")
    line = next(line for line in half.splitlines() if "bearing" in line)
    twice = solved(half.replace(line, line + "\n" + line.replace("bearing", "second")))
    once = solved(text)
    assert twice.coordinates["main"]["rate"] == pytest.approx(once.coordinates["main"]["rate"], rel=1e-9)


def test_rest_is_no_friction() -> None:
    """tanh(0) = 0: at rest a joint rubs not at all, whatever presses; on a slope it then creeps."""
    r = solved(SLOPE.format(angle=0.1, mu=0.5).replace("speed: 1}", "speed: 0}"))
    assert r.forces["gib"]["value"][0] == 0.0
    creep = 1e-4 * np.arctanh(np.tan(0.1) / 0.5)
    assert r.coordinates["guide"]["speed"][-1] == pytest.approx(creep, rel=1e-6)


def test_work_is_what_friction_took() -> None:
    r = solved(SLOPE.format(angle=0.6, mu=0.2))
    power = r.forces["gib"]["value"] * r.forces["gib"]["rate"]
    assert r.forces["gib"]["power"] == pytest.approx(power, rel=DIGITS)
    sums = r.energy["kinetic"] + r.energy["potential"] - r.energy["work"]
    assert all(abs(b - a) < 1e-9 for a, b in pairwise(sums.tolist()))


WEDGE = """
heun: 1
space: planar
parameters: {{alpha: 0.17, mu: {mu}, F: 1000}}
ground: {{points: {{floor: [0, 0], wall: [0, 1]}}}}
bodies:
  wedge: {{mass: 1, inertia: 0.1, center: [0, 0], points: {{sole: [0, 0], face: [0, 0.2]}}}}
  ram: {{mass: 1, inertia: 0.1, center: [0, 1], points: {{foot: [0, 0.2], side: [0, 1]}}}}
joints:
  floor: {{type: slide, from: ground.floor, to: wedge.sole, axis: [1, 0]}}
  face: {{type: slide, from: wedge.face, to: ram.foot, axis: [cos(alpha), -sin(alpha)]}}
  wall: {{type: slide, from: ground.wall, to: ram.side, axis: [0, 1]}}
drives: {{push: {{joint: floor, speed: {speed}}}}}
forces:
  load: {{type: force, on: ram.side, vector: [0, -F]}}
  sole: {{type: friction, joint: floor, coefficient: mu, speed: 1e-9}}
  incline: {{type: friction, joint: face, coefficient: mu, speed: 1e-9}}
  gib: {{type: friction, joint: wall, coefficient: mu, speed: 1e-9}}
"""


@pytest.mark.parametrize("mu", [0.05, 0.1])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_wedge_lifts_and_lets_down(mu: float, sense: float) -> None:
    """R at the friction angle p beside the face's normal; below alpha = 2 p a wedge, as a screw, holds by itself.

    The moments of three slides in a loop are open, the forces that press are not.
    """
    r = solved(WEDGE.format(mu=mu, speed=0.01 * sense))
    alpha, p, m = 0.17, sense * np.arctan(mu), sense * mu
    R = 1000.0 / (np.cos(alpha + p) - m * np.sin(alpha + p))
    push = R * np.sin(alpha + p) + m * R * np.cos(alpha + p)
    assert r.joints["floor"]["drive"][0] == pytest.approx(push, rel=1e-11)
    assert (push < 0.0) == (sense < 0.0 and alpha < 2.0 * np.arctan(mu))
