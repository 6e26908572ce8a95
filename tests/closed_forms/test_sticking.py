"""Friction that sticks, where formulas know it: wedges, belts, brakes, clutches, shaken blocks, ladders, pendulums."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError, SpecError
from heuncli.results.results import Results
from tests.shared.scenes import solved

G = 9.81
DIGITS = 1e-12  # some roundings
NEAR = 1e-8  # tenfold the tolerance of a run

SLOPE = """
heun: 1
gravity: [0, 0, -9.81]
parameters: {{th: {angle}}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{block: {{mass: 3, center: [0, 0, 0], inertia: [1, 1, 1], points: {{c: [0, 0, 0]}}}}}}
joints:
  guide: {{type: slide, from: ground.O, to: block.c, axis: [cos(th), 0, -sin(th)], initial: {{travel: 0, speed: {v}}}}}
forces:
  gib: {{type: friction, joint: guide, {law}}}
analysis: {{duration: 1, samples: 11}}
"""


def slope(angle: float, law: str, v: float = 0.0) -> Results:
    return solved(SLOPE.format(angle=angle, law=law, v=v))


@pytest.mark.parametrize(("mu", "static"), [(0.3, 0.5), (0.3, 0.3), (0.0, 0.4)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("excess", [-1e-6, 1e-6])
def test_a_block_sticks_on_a_slope_up_to_the_angle_of_friction(
    mu: float, static: float, sign: float, excess: float
) -> None:
    """It sticks if tan th <= mu_s, else it slides with g (sin th - mu cos th)."""
    th = sign * (np.arctan(static) + excess)
    r = slope(th, f"coefficient: {mu}, static: {static}")
    sticks = excess < 0.0
    wanted = 0.0 if sticks else G * (np.sin(th) - sign * mu * np.cos(th))
    assert r.coordinates["guide"]["acceleration"] == pytest.approx(np.full(11, wanted), abs=1e-10)
    assert r.coordinates["guide"]["travel"] == pytest.approx(0.5 * wanted * r.time**2, abs=1e-9)
    value = -3 * G * np.sin(th) if sticks else -sign * mu * 3 * G * np.cos(th)
    assert r.forces["gib"]["value"] == pytest.approx(np.full(11, value), rel=1e-10, abs=1e-12)
    reserve = static * 3 * G * np.cos(th) - abs(value) if sticks else 0.0
    assert r.forces["gib"]["reserve"] == pytest.approx(np.full(11, reserve), abs=1e-10)


def test_a_block_thrown_up_a_slope_stops_and_stays_or_comes_back() -> None:
    """It stops after v / g (sin th + mu cos th); it comes back only on a slope steeper than the static angle."""
    th, mu, v = 0.6, 0.4, 2.0
    up = G * (np.sin(th) + mu * np.cos(th))
    down = G * (np.sin(th) - mu * np.cos(th))
    stays = slope(th, f"coefficient: {mu}, static: 0.7", -v)
    comes = slope(th, f"coefficient: {mu}", -v)
    t = np.minimum(stays.time, v / up)
    travel = -v * t + 0.5 * up * t**2
    assert stays.coordinates["guide"]["travel"] == pytest.approx(travel, abs=NEAR)
    back = travel + 0.5 * down * np.maximum(comes.time - v / up, 0.0) ** 2
    assert comes.coordinates["guide"]["travel"] == pytest.approx(back, abs=NEAR)


BELT = """
heun: 1
space: planar
gravity: [0, -9.81, 0]
ground: {{points: {{O: [0, 0, 0], wall: [-1, 0, 0]}}}}
bodies:
  belt: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{c: [0, 0, 0]}}}}
  block: {{mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {{c: [0, 0, 0]}}}}
joints:
  drive: {{type: slide, from: ground.O, to: belt.c, axis: [1, 0, 0]}}
  on: {{type: slide, from: belt.c, to: block.c, axis: [1, 0, 0], initial: {{travel: 0, speed: {speed}}}}}
drives: {{motor: {{joint: drive, travel: {law}}}}}
forces:
  rub: {{type: friction, joint: on, {friction}}}
  {more}
analysis: {{duration: {duration}, samples: {samples}}}
"""


def belt(law: str, friction: str, duration: float, samples: int, speed: float = 0.0, more: str = "") -> Results:
    return solved(BELT.format(law=law, friction=friction, duration=duration, samples=samples, speed=speed, more=more))


def test_a_block_on_a_belt_sticks_and_slips() -> None:
    """Carried until k x = F_s, then it swings about F_k / k until it has the belt's speed: A = (F_s - F_k) / k."""
    k, static, kinetic, m, v = 50.0, 6.0, 4.0, 2.0, 0.1
    spring = "spring: {type: spring, from: ground.wall, to: block.c, stiffness: 50, length: 1}"
    r = belt("0.1*t", f"force: {kinetic}, static: {static}", 8.0, 401, more=spring)
    w, A = np.sqrt(k / m), (static - kinetic) / k
    slipping = 2.0 / w * (np.pi - np.arctan(A * w / v))
    first, period = static / k / v, slipping + 2.0 * A / v

    def place(t: float) -> float:
        if t < first:
            return v * t
        t = (t - first) % period
        if t < slipping:
            return kinetic / k + A * np.cos(w * t) + v / w * np.sin(w * t)
        return kinetic / k - A + v * (t - slipping)

    wanted = np.array([place(t) for t in r.time.tolist()])
    travel = r.coordinates["drive"]["travel"] + r.coordinates["on"]["travel"]
    assert travel == pytest.approx(wanted, abs=NEAR)
    value, rate = r.forces["rub"]["value"], r.coordinates["on"]["speed"]
    sticks = r.forces["rub"]["reserve"] > 1e-9  # at the first event it still holds all it can
    slips = np.abs(rate) > 1e-9
    assert 0.3 < sticks.mean() < 0.7
    assert not rate[sticks].any()
    assert value[sticks] == pytest.approx(k * wanted[sticks], abs=1e-6)
    assert value[slips] == pytest.approx(np.full(slips.sum(), kinetic), rel=DIGITS)


def test_a_part_on_a_conveyor_takes_off_with_mu_g_and_is_carried_from_v_over_mu_g_on() -> None:
    """Its first instant has the full friction: mu g; it has the belt's speed after v / mu g."""
    r = belt("0.8*t", "coefficient: 0.2", 0.8, 81, speed=-0.8)
    slips = r.time < 0.8 / (0.2 * G)
    acceleration = r.coordinates["on"]["acceleration"]
    assert acceleration[slips] == pytest.approx(np.full(slips.sum(), 0.2 * G), rel=1e-10)
    assert r.coordinates["on"]["speed"] == pytest.approx(np.minimum(-0.8 + 0.2 * G * r.time, 0.0), abs=NEAR)
    assert r.forces["rub"]["value"][~slips] == pytest.approx(np.zeros((~slips).sum()), abs=1e-10)


def test_a_block_on_a_shaken_table_slips_where_that_accelerates_too_much() -> None:
    """It slips from m A w^2 sin w t = F on; it is then slowed by F / m alone."""
    A, w, F, m = 0.1, 5.0, 4.0, 2.0
    start = np.arcsin(F / (m * A * w**2)) / w
    r = belt("0.5*t - 0.1*sin(5*t)", f"force: {F}", 0.5, 51)
    slips = r.time > start
    # relative to the table: -(table's acceleration) + F/m
    s = np.maximum(r.time - start, 0.0)
    table = 0.5 * r.time - A * np.sin(w * r.time)
    place = 0.5 * start - A * np.sin(w * start) + (0.5 - A * w * np.cos(w * start)) * s + 0.5 * F / m * s**2
    wanted = np.where(slips, place - table, 0.0)
    assert (wanted <= 0.0).all()
    assert r.coordinates["on"]["travel"] == pytest.approx(wanted, abs=NEAR)


PULLED = """
heun: 1
space: planar
gravity: [0, -9.81, 0]
ground: {points: {O: [0, 0, 0]}}
bodies: {block: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}}
joints: {guide: {type: slide, from: ground.O, to: block.c, axis: [1, 0, 0]}}
forces:
  pull: {type: force, on: block.c, vector: [3*t, 0, 0]}
  rub: {type: friction, joint: guide, coefficient: 0.2, static: 0.3}
analysis: {duration: 3, samples: 31}
"""


def test_a_block_that_is_pulled_harder_and_harder_breaks_away_at_mu_s_m_g() -> None:
    """It slips from 3 t = mu_s m g on, with (3 t - mu m g) / m."""
    r = solved(PULLED)
    start, m = 0.3 * 2 * G / 3, 2.0
    s = np.maximum(r.time - start, 0.0)
    wanted = (3 * (start * s**2 / 2 + s**3 / 6) - 0.2 * m * G * s**2 / 2) / m
    assert r.coordinates["guide"]["travel"] == pytest.approx(wanted, abs=NEAR)
    assert r.energy["potential"] + r.energy["kinetic"] - r.energy["work"] == pytest.approx(np.zeros(31), abs=NEAR)


ROTORS = """
heun: 1
space: planar
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  one: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 0.3], points: {{c: [0, 0, 0]}}}}
  other: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 0.6], points: {{c: [0, 0, 0]}}}}
joints:
  bearing: {{type: pin, from: ground.O, to: one.c, axis: [0, 0, 1], initial: {{angle: 0, rate: {w}}}}}
  clutch: {{type: pin, from: one.c, to: other.c, axis: [0, 0, 1], initial: {{angle: 0, rate: {w2}}}}}
forces: {{{friction}}}
analysis: {{duration: 2, samples: 41}}
"""


def test_a_clutch_takes_its_rotors_to_one_speed() -> None:
    """They meet after w J1 J2 / (J1 + J2) T at J1 w / (J1 + J2), and stay together without a torque."""
    text = ROTORS.format(w=6, w2=-6, friction="plate: {type: friction, joint: clutch, torque: 1.5, static: 2}")
    r = solved(text)
    meet = 6 * 0.3 * 0.6 / (0.9 * 1.5)
    t = np.minimum(r.time, meet)
    assert r.coordinates["bearing"]["rate"] == pytest.approx(6 - 1.5 / 0.3 * t, abs=NEAR)
    assert r.coordinates["clutch"]["rate"] == pytest.approx(-6 + 1.5 * (1 / 0.3 + 1 / 0.6) * t, abs=NEAR)
    assert r.forces["plate"]["value"][r.time > meet + 1e-9] == pytest.approx(0.0, abs=1e-12)


def test_a_band_brake_stops_its_drum_and_keeps_it() -> None:
    """The drum stops after J w / T; both rotors stick together, which one coordinate each decides."""
    friction = "band: {type: friction, joint: bearing, torque: 0.9}, plate: {type: friction, joint: clutch, torque: 9}"
    r = solved(ROTORS.format(w=1, w2=0, friction=friction))
    assert r.coordinates["bearing"]["rate"] == pytest.approx(np.maximum(1 - r.time, 0.0), abs=NEAR)
    assert r.coordinates["clutch"]["rate"] == pytest.approx(np.zeros(41), abs=1e-15)
    slips = r.time < 0.999
    assert r.forces["plate"]["value"][slips] == pytest.approx(np.full(slips.sum(), -0.6), rel=1e-9)
    assert r.forces["band"]["value"][slips] == pytest.approx(np.full(slips.sum(), -0.9), rel=DIGITS)
    assert r.forces["band"]["value"][r.time > 1.001] == pytest.approx(0.0, abs=1e-9)


PENDULUM = """
heun: 1
gravity: [0, -9.81, 0]
ground: {points: {pivot: [0, 0, 0]}}
bodies: {bob: {mass: 2, center: [0, -1, 0], inertia: [0, 0, 0], points: {top: [0, 0, 0]}}}
joints: {pivot: {type: pin, from: ground.pivot, to: bob.top, axis: [0, 0, 1], initial: {angle: 1.2, rate: 0}}}
forces: {rub: {type: friction, joint: pivot, torque: 2}}
analysis: {duration: 12, samples: 601}
"""


def test_a_pendulum_loses_by_each_half_swing_what_friction_takes() -> None:
    """m g l (cos b - cos a) = T (a + b) for the next turning point b; it stays where |m g l sin a| < T."""
    r = solved(PENDULUM)
    angle, turned = r.coordinates["pivot"]["angle"], [1.2]
    while 2 * G * np.sin(turned[-1]) > 2:
        low, high = -turned[-1], turned[-1]  # from the other side's full height down to none
        for _ in range(200):
            b = 0.5 * (low + high)
            low, high = (b, high) if 2 * G * (np.cos(turned[-1]) - np.cos(b)) < -2 * (turned[-1] + b) else (low, b)
        turned.append(0.5 * (low + high))
    assert len(turned) > 3
    assert abs(angle[-1]) == pytest.approx(abs(turned[-1]), abs=1e-7)
    assert r.forces["rub"]["value"][-1] == pytest.approx(2 * G * np.sin(angle[-1]), rel=1e-9)


LADDER = """
heun: 1
space: planar
gravity: [0, -9.81, 0]
parameters: {{th: {angle}}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  ladder: {{mass: 12, center: [0.5*cos(th), 0.5*sin(th), 0], inertia: [1, 1, 1],
            points: {{foot: [cos(th), 0, 0], head: [0, sin(th), 0]}}}}
  shoe: {{mass: 1e-9, center: [0, 0, 0], inertia: [1e-9, 1e-9, 1e-9], points: {{c: [0, 0, 0]}}}}
  cap: {{mass: 1e-9, center: [0, 0, 0], inertia: [1e-9, 1e-9, 1e-9], points: {{c: [0, 0, 0]}}}}
joints:
  floor: {{type: slide, from: ground.O, to: shoe.c, axis: [1, 0, 0], initial: {{travel: cos(th), speed: 0}}}}
  wall: {{type: slide, from: ground.O, to: cap.c, axis: [0, 1, 0]}}
  foot: {{type: pin, from: shoe.c, to: ladder.foot, axis: [0, 0, 1]}}
  head: {{type: pin, from: cap.c, to: ladder.head, axis: [0, 0, 1]}}
forces: {{{friction}}}
"""


@pytest.mark.parametrize("excess", [-1e-4, 1e-4])
def test_a_ladder_at_a_smooth_wall_stands_down_to_tan_th_of_half_mu(excess: float) -> None:
    """mu >= 1 / 2 tan th; the friction is m g / 2 tan th."""
    th = np.arctan(1 / (2 * 0.4)) + excess
    r: Any = solved(LADDER.format(angle=th, friction="rub: {type: friction, joint: floor, coefficient: 0.4}"))
    sticks = bool(r.forces["rub"]["reserve"][0] > 0.0)
    assert sticks == (excess > 0.0)
    if sticks:
        assert r.forces["rub"]["value"][0] == pytest.approx(-12 * G / (2 * np.tan(th)), rel=1e-6)


def test_a_ladder_with_friction_at_both_ends_is_indeterminate() -> None:
    friction = "{type: friction, joint: floor, coefficient: 0.6}, b: {type: friction, joint: wall, coefficient: 0.6}"
    with pytest.raises(SolveError) as caught:
        solved(LADDER.format(angle=1.1, friction=f"a: {friction}"))
    assert caught.value.problems[0].code == "friction-indeterminate"


@pytest.mark.parametrize(("start", "holds"), [(0.4, True), (1.2, False)])
def test_a_rest_position_is_the_start_if_friction_holds_there(start: float, holds: bool) -> None:
    """|m g l sin a| <= T; it is left with what is left of T, and else there is no rest position to speak of."""
    text = PENDULUM.replace("angle: 1.2, rate: 0", f"angle: {start}").replace("torque: 2", "torque: 9")
    text = text.replace("duration: 12, samples: 601", "type: rest")
    if holds:
        reserve = solved(text).forces["rub"]["reserve"][0]
        assert reserve == pytest.approx(9 - 2 * G * np.sin(start), rel=1e-9)
        return
    with pytest.raises(SolveError, match="does not hold the start position"):
        solved(text)


def two_belts(delta: float, speed: float) -> str:
    """Blocks on two belts of one speed, pushed by 20 (t - delta) N; each holds 7 N."""
    blocks = range(2)
    bodies = [
        f"  belt{k}: {{mass: 5, center: [0, 0, 0], inertia: [1, 1, 1], points: {{o: [0, 0, 0]}}}}\n"
        f"  block{k}: {{mass: {1 + 0.37 * k}, center: [0, 0, 0], inertia: [1, 1, 1], points: {{o: [0, 0, 0]}}}}"
        for k in blocks
    ]
    joints = [
        f"  run{k}: {{type: slide, from: ground.O, to: belt{k}.o, axis: [0.6, 0.8, 0]}}\n"
        f"  slip{k}: {{type: slide, from: belt{k}.o, to: block{k}.o, axis: [0.6, 0.8, 0], initial: {{speed: 0}}}}"
        for k in blocks
    ]
    forces = [
        f'  push{k}: {{type: torque, joint: slip{k}, value: "20*(t - {k}*{delta!r})"}}\n'
        f"  hold{k}: {{type: friction, joint: slip{k}, force: 7}}"
        for k in blocks
    ]
    drives = [f"  d{k}: {{joint: run{k}, speed: {speed}}}" for k in blocks]
    parts = ["heun: 1", "ground: {points: {O: [0, 0, 0]}}", "bodies:", *bodies, "joints:", *joints, "forces:", *forces]
    return "\n".join([*parts, "drives:", *drives, "analysis: {duration: 0.5, samples: 6}"])


@pytest.mark.parametrize("delta", [0.0, 1e-15, 3e-14, 1e-12, 1e-9])
@pytest.mark.parametrize("speed", [1.3, 100.3])
def test_blocks_that_break_away_together_or_nearly_so(delta: float, speed: float) -> None:
    """m v' = 20 (t - delta) - 7 from where the push is 7 N on, though the first has moved by rounding till the next."""
    r = solved(two_belts(delta, speed))
    for k in range(2):
        start, mass = 0.35 + k * delta, 1 + 0.37 * k
        wanted = np.where(r.time > start, 10 * (r.time - start) ** 2 / mass, 0.0)
        found = r.coordinates[f"slip{k}"]["speed"]
        assert found[-2:] == pytest.approx(wanted[-2:], rel=1e-8)
        assert not found[:4].any()


SPRUNG_BELT = """
heun: 1
gravity: [0, -9.81, 0]
ground: {{points: {{O: [0, 0, 0], wall: [-1, 0, 0]}}}}
bodies:
  belt: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{top: [0, 0, 0]}}}}
  block: {{mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {{base: [0, 0, 0]}}}}
joints:
  run: {{type: slide, from: ground.O, to: belt.top, axis: [1, 0, 0]}}
  contact: {{type: slide, from: belt.top, to: block.base, axis: [1, 0, 0], initial: {{speed: 0}}}}
drives: {{motor: {{joint: run, speed: 0.1}}}}
forces:
  spring: {{type: spring, from: ground.wall, to: block.base, stiffness: 50, length: 1}}
  rub: {{type: friction, joint: contact, force: 4, static: 6}}
analysis: {{duration: 3, samples: 4{events}}}
expect:
  - {{of: events.rub_sticks.time, is: [1.2, 1.2 + 2/5*(pi - atan(0.04*5/0.1)), 2 + 2/5*(pi - atan(0.04*5/0.1))]}}
"""


def test_sticking_is_an_event_with_its_instants() -> None:
    """It slips after Fs / (k v), for 2/w (pi - atan(A w / v)), and sticks for 2 A / v, with A = (Fs - Fk) / k."""
    r = solved(SPRUNG_BELT.format(events=""))
    event = r.events["rub_sticks"]
    slips = 0.4 * (math.pi - math.atan(2.0))
    assert event["condition"] == "forces.rub sticks"
    assert event["begins"] is True
    assert event["to"] == [False, True, False]
    wanted = np.array([1.2, 1.2 + slips, 2.0 + slips])
    assert (np.abs(event["time"] - wanted) <= 2.0 * event["error"] + 1e-12).all()
    assert (event["error"] < 1e-7).all()
    assert "rub_sticks" not in solved(SPRUNG_BELT.format(events="").replace("static: 6", "speed: 1e-3")
                                      .partition("expect")[0]).events  # fmt: skip


def test_the_name_of_a_sticking_event_is_reserved() -> None:
    with pytest.raises(SpecError, match="'rub_sticks' is reserved") as error:
        solved(SPRUNG_BELT.format(events=", events: {rub_sticks: t > 1}"))
    assert error.value.problems[0].code == "event-name"
