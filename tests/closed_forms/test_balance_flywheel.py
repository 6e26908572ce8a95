"""The flywheel of `heun balance` against closed forms, and against a run with that wheel."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from heuncli.analyses.balancing.results import BalanceOptions, Flywheel, FlywheelRequest, WeightRequest
from heuncli.analyses.balancing.study import balance
from heuncli.base.errors import SolveError
from heuncli.scene.file_format.load import load
from heuncli.study.workflow import solve
from tests.shared.cycling import RPM, balance_of

SPECS = Path(__file__).parents[2] / "specs"
SHAFT = """\
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  shaft: {mass: 100, center: [0, 0, 0], inertia: [50, 50, 50], points: {main: [0, 0, 0]}}
joints:
  shaft: {type: pin, from: ground.O, to: shaft.main, axis: [0, 0, 1]}
forces:
  tool: {type: torque, joint: shaft, value: "LAW"}
"""
TORQUE = "2200*sin(2*shaft.angle) - 1800*cos(2*shaft.angle)"
SWING = math.hypot(2200.0, 1800.0)  # J: of a wave of that amplitude, twice a turn


def wheel(scene: str, **asked: Any) -> Flywheel:
    found = balance_of(scene, **asked).flywheel
    assert found is not None
    return found


def test_a_shaft_of_constant_inertia() -> None:
    """J (ω_max² - ω_min²)/2 is the work of a half wave; at 1 % the mean in time is that of both extremes to 5e-5/8."""
    found = wheel(SHAFT.replace("LAW", TORQUE), rate=200.0 * RPM, flywheel=FlywheelRequest("shaft", 0.01))
    assert found.energy == pytest.approx(SWING, rel=1e-9)
    assert found.textbook + 50.0 == pytest.approx(648.0200646028352, rel=1e-9)
    assert found.fastest - found.slowest == pytest.approx(0.01 * 200.0 * RPM, rel=1e-9)
    both = 0.5 * (found.fastest + found.slowest)
    assert found.added + 50.0 == pytest.approx(SWING / (0.01 * 200.0 * RPM * both), rel=1e-9)  # exact for constant J
    assert found.own == pytest.approx(50.0, rel=1e-12) and found.even == 0.0


def test_work_that_does_not_come_back_is_evened_out_and_told() -> None:
    told = balance_of(SHAFT.replace("LAW", f"300 + {TORQUE}"), rate=20.0, flywheel=FlywheelRequest("", 0.01))
    plain = wheel(SHAFT.replace("LAW", TORQUE), rate=20.0, flywheel=FlywheelRequest("", 0.01))
    assert told.flywheel is not None and told.flywheel.even == pytest.approx(-300.0, rel=1e-9)
    assert told.flywheel.added == pytest.approx(plain.added, rel=1e-9)
    assert "a constant torque of -300 N·m on shaft" in " ".join(told.notes)


def test_orders_of_the_loads() -> None:
    """The law's own waves, of one turn; half orders where it takes two; friction of a rate at the cycle's."""
    law = f"300 + {TORQUE} + 70*sin(shaft.angle/2) - 2*shaft.rate"
    told = balance_of(SHAFT.replace("LAW", law), rate=20.0)
    assert told.turns == 2 and told.mean["load"] == pytest.approx(300.0 - 2.0 * 20.0, rel=1e-12)
    found = {row.order: row for row in told.orders["load"] if row.verdict == "remains"}
    assert found.keys() == {0.5, 2.0}
    assert found[0.5].amplitude == pytest.approx([70.0]) and found[0.5].phase == pytest.approx([math.pi / 2.0])
    assert found[2.0].amplitude == pytest.approx([SWING], rel=1e-12)
    assert found[2.0].phase == pytest.approx([math.atan2(2200.0, -1800.0)], rel=1e-12)


def test_what_runs_evenly_needs_no_wheel() -> None:
    told = balance_of(SHAFT.replace("LAW", TORQUE), rate=2000.0, flywheel=FlywheelRequest("", 0.01))
    assert told.flywheel is not None and told.flywheel.added == 0.0 and told.flywheel.present < 0.01
    assert "no flywheel needed" in " ".join(told.notes)


@pytest.mark.parametrize("delta", [1e-14, 1e-307])
def test_an_unevenness_within_rounding_is_refused(delta: float) -> None:
    """At 1e-14 the inertia was off by 0.2 %, at 1e-307 it was no number."""
    with pytest.raises(SolveError, match=r"rounding of the speeds.*no-flywheel"):
        wheel(SHAFT.replace("LAW", TORQUE), rate=200.0 * RPM, flywheel=FlywheelRequest("shaft", delta))


def test_an_inertia_beyond_all_numbers_is_refused() -> None:
    with pytest.raises(SolveError, match=r"no flywheel has a speed fluctuation of 0.01 .*no-flywheel"):
        wheel(SHAFT.replace("LAW", TORQUE), rate=1e-153, flywheel=FlywheelRequest("shaft", 0.01))


def test_the_engine_runs_as_a_run_has_it() -> None:
    """Two turns of a free run with the wheel, from the start told, between the extremes told."""
    text = (SPECS / "engine.yaml").read_text()
    engine = load(str(SPECS / "engine.yaml"), checking=False)
    asked = BalanceOptions(rate=1500.0 * RPM, flywheel=FlywheelRequest("main", 0.01))
    found = balance(engine, asked).flywheel
    assert found is not None
    assert found.present == pytest.approx(0.0332636676, rel=1e-6)
    assert found.added == pytest.approx(1.20397003, rel=1e-6)
    assert found.textbook == pytest.approx(1.2023025, rel=1e-5)
    assert found.start / RPM == pytest.approx(1501.817352, rel=1e-8)
    m = found.added / 0.09
    points = "    points: {main: [0, 0, 0], pin: [0, 0, r]}\n"
    shape = f"{{type: cylinder, from: [-0.001, 0, 0], to: [0, 0, 0], radius: {math.sqrt(0.18)!r}, mass: {m!r}}}"
    text = text.replace(points, f"      - {shape}\n{points}", 1)
    text = text.replace("rate: n}", f"rate: {found.start!r}}}").partition("expect:")[0]
    rates = solve(load(str(SPECS / "engine.yaml"), text)).results.coordinates["main"]["rate"]
    assert rates.max() == pytest.approx(found.fastest, rel=1e-5)  # between the samples it is a little more
    assert rates.max() <= found.fastest * (1.0 + 1e-7) and rates.min() >= found.slowest * (1.0 - 1e-7)
    assert rates.min() == pytest.approx(found.slowest, rel=1e-5)


@pytest.mark.parametrize(
    ("law", "why"), [(f"{TORQUE} - 2*shaft.rate", "depends on a rate"), (f"{TORQUE} + sin(t)", "depends on t")]
)
def test_loads_that_the_angle_does_not_tell_are_refused(law: str, why: str) -> None:
    with pytest.raises(SolveError, match=why):
        balance_of(SHAFT.replace("LAW", law), rate=20.0, flywheel=FlywheelRequest("shaft", 0.01))


@pytest.mark.parametrize("width", [0.3, 0.003, 1e-4, 1e-8])
def test_a_punch_counts_in_full_however_short(width: float) -> None:
    """300 J a turn from 1 rad on: ΔE = 300 (1 - b/2π), the mean -300/2π; order k is 300/π sin(kb/2)/(kb/2)."""
    law = f"-{300.0 / width!r} if shaft.angle > 1 and shaft.angle < {1.0 + width!r} else 0"
    told = balance_of(
        SHAFT.replace("LAW", law), rate=200.0 * RPM, flywheel=FlywheelRequest("", 0.01), orders=(1.0, 30.0, 5000.0)
    )
    own = told.flywheel
    assert own is not None
    b = (1.0 + width) - 1.0
    work = 300.0 / width * b
    assert told.mean["load"] == pytest.approx(-work / (2.0 * math.pi), abs=told.mean_error["load"])
    assert own.energy == pytest.approx(work * (1.0 - b / (2.0 * math.pi)), abs=own.error["energy"])
    assert own.textbook == pytest.approx(own.energy / (0.01 * (200.0 * RPM) ** 2) - 50.0, rel=1e-12)
    for row in told.orders["load"]:
        half = 0.5 * row.order * b
        assert row.amplitude[0] == pytest.approx(work / math.pi * abs(math.sin(half)) / half, abs=row.error)
        assert row.error <= 1e-2 * work * max(1.0, 1e-8 / width)


def test_loads_have_orders_as_high_as_they_go() -> None:
    """5 cos 30φ + 10 abs(sin φ): order k of the latter is 40/π/(k² - 1), from 160 on less than 4.99e-4."""
    told = balance_of(SHAFT.replace("LAW", "5*cos(30*shaft.angle) + 10*abs(sin(shaft.angle))"), rate=20.0)
    rows = {row.order: row for row in told.orders["load"]}
    for k in range(2, 160, 2):
        wanted = 40.0 / math.pi / (k * k - 1.0)
        assert rows[float(k)].amplitude[0] == pytest.approx(abs(5.0 * (k == 30) - wanted), abs=rows[float(k)].error)
        assert rows[float(k)].error < 1e-9
    assert max(rows) == 158.0


GEARED = """\
heun: 1
ground: {points: {A: [0, 0, 0], B: [0.3, 0, 0]}}
bodies:
  a: {mass: 2, center: [0.05, 0, 0], inertia: [0.01, 0.01, 0.02], points: {o: [0, 0, 0]}}
  b: {mass: 0.3, center: [0.02, 0, 0], inertia: [0.02, 0.02, 0.03], position: [0.3, 0, 0], points: {o: [0, 0, 0]}}
joints:
  sa: {type: pin, from: ground.A, to: a.o, axis: [0, 0, 1]}
  sb: {type: pin, from: ground.B, to: b.o, axis: [0, 0, 1]}
drives: {motor: {joint: sa, angle: 50*t}}
couplings: {mesh: {type: gear, of: [sa, sb], ratio: -1}}
forces: {tool: LOAD}
"""


@pytest.mark.parametrize(
    ("load", "turns", "back"),
    [
        ('{type: torque, joint: sb, value: "5*cos(sb.angle)"}', 1, True),
        ('{type: torque, joint: sb, value: "5*cos(sb.angle/2)"}', 1, False),
        ('{type: torque, joint: sb, value: "5*cos(sb.angle/2)"}', 2, True),
        ('{type: torque, joint: sa, value: "5*cos(sa.angle/2)"}', 1, False),
        ('{type: torque, joint: sa, value: "5*cos(sa.angle/3)"}', 2, False),
        ('{type: torque, joint: sb, value: "3 if sin(sb.angle) > 0 else -3"}', 1, True),
        ('{type: torque, joint: sb, value: "3 if sin(sb.angle/2) > 0 else -3"}', 1, False),
        ("{type: turn_spring, joint: sb, stiffness: 4}", 1, False),
        ("{type: damper, joint: sb, coefficient: 0.1}", 1, True),
        ("{type: spring, from: ground.B, to: a.o, stiffness: 100, length: 0.1}", 1, True),
    ],
)
@pytest.mark.third
def test_a_load_that_takes_longer_than_the_cycle_is_told(load: str, turns: int, back: bool) -> None:
    """Where it comes back its orders are its own; else they are those of a law that jumps, and a note says so."""
    told = balance_of(GEARED.replace("LOAD", load), turns=turns)
    notes = [note for note in told.notes if note.startswith("forces.tool does not repeat after ")]
    assert len(notes) == (0 if back else 1)
    assert all(("--turns 2" in note) == (turns == 1) for note in notes)
    if back and "cos" in load:
        (row,) = (row for row in told.orders["load"] if row.verdict == "remains")
        assert row.order == 1.0 / turns and row.amplitude == pytest.approx([5.0], rel=1e-12)


@pytest.mark.parametrize(("law", "back"), [("5*cos(50*t)", True), ("5*cos(30*t)", False)])
def test_what_a_counterweight_costs_under_a_load_in_time(law: str, back: bool) -> None:
    """The loads of joints are those of one cycle: of another law in time the next one has others."""
    scene = GEARED.replace("LOAD", f'{{type: torque, joint: sb, value: "{law}"}}')
    told = balance_of(scene, weights=(WeightRequest("a", "o", 0.03),))
    assert any(note.startswith("forces.tool does not repeat after one revolution") for note in told.notes) != back
