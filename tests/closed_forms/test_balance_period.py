"""Orders of time: shafts at rates 1 : 2 and an oscillator in its steady state, by hand; the cycle of an angle again."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from heuncli.analyses.balancing.results import BalanceOptions, BalanceResults
from heuncli.analyses.balancing.study import balance
from heuncli.base.errors import SolveError
from heuncli.scene.file_format.load import load
from tests.shared.command import Heun
from tests.shared.folders import ROOT

SHAFTS = """
heun: 1
ground: {{points: {{A: [0, 0, 0], B: [1, 0, 0], C: [0, 2, 0], far: [-5, 2, 0]}}}}
bodies:
  a: {{mass: 2, center: [0.1, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{c: [0, 0, 0]}}}}
  b: {{mass: 3, center: [1.05, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{c: [1, 0, 0]}}}}
  m: {{mass: 1, center: [0, 2, 0], inertia: [0.1, 0.1, 0.1], points: {{c: [0, 2, 0]}}}}
joints:
  A: {{type: pin, from: ground.A, to: a.c, axis: [0, 0, 1]}}
  B: {{type: pin, from: ground.B, to: b.c, axis: [0, 0, 1]}}
  S: {{type: slide, from: ground.C, to: m.c, axis: [1, 0, 0]}}
drives: {{one: {{joint: A, angle: 20*t}}, two: {{joint: B, angle: 40*t + 0.3}}}}
forces:
  k: {{type: spring, from: ground.far, to: m.c, stiffness: 500, length: 5}}
  d: {{type: damper, joint: S, coefficient: 15}}
  f: {{type: force, on: m.c, vector: [30*cos(20*t), 0, 0]}}
analysis: {{duration: {duration}, samples: 3}}
"""
T = 2.0 * math.pi / 20.0


def orders(found: BalanceResults, quantity: str) -> list[complex]:
    """Of the first component that moves, complex: amplitude at its phase."""
    k = 2 if quantity == "moment" else 0
    return [float(row.amplitude[k]) * np.exp(-1j * float(row.phase[k])) for row in found.orders[quantity]]


def of(text: str, period: float) -> BalanceResults:
    return balance(load("scene.yaml", text), BalanceOptions(period=period))


def test_two_shafts_and_an_oscillator() -> None:
    """m e w^2 of the shafts; the oscillator's w^2 X, X = F/(k - m w^2 + i c w), stands beside the first."""
    found = of(SHAFTS.format(duration=8), T)
    shaken = 400.0 * 30.0 / (500.0 - 400.0 + 300.0j)
    first, second = orders(found, "force")
    assert first == pytest.approx(80.0 + shaken, rel=1e-7)
    assert second == pytest.approx(240.0 * np.exp(0.3j), rel=1e-7)
    # moments about O: the second shaft's force across 1 m, the oscillator's across 2 m
    once, twice = orders(found, "moment")
    assert once == pytest.approx(-2.0 * shaken, rel=1e-7)
    assert twice == pytest.approx(240.0 * np.exp(0.3j) / 1j, rel=1e-7)
    assert found.period is not None and found.period.relative_difference < 1e-8 and "torque" not in found.orders
    rms = math.sqrt((abs(first) ** 2 + 80.0**2) / 2 + 240.0**2)
    assert found.residual["force"].rms == pytest.approx(rms, rel=1e-7)


def test_it_has_to_have_come_back() -> None:
    """The free oscillation dies as exp(-7.5 t): by 0.095 in a period; what is left differs by that much."""
    with pytest.raises(SolveError, match="differ by"):
        of(SHAFTS.format(duration=2.5 * T), T)
    with pytest.raises(SolveError, match="differ by"):
        of(SHAFTS.format(duration=8), 0.9 * T)
    with pytest.raises(SolveError, match="less than two"):
        of(SHAFTS.format(duration=1.9 * T), T)
    assert of(SHAFTS.format(duration=8), 2.0 * T).orders["force"][1].order == 2.0


def test_a_slider_crank_by_time_and_by_angle() -> None:
    spec = load(str(ROOT / "specs" / "slider_crank.yaml"))
    turn = 2.0 * math.pi / 100.0
    spec = spec._replace(analysis=spec.analysis._replace(type="motion", duration=2.0 * turn, times=(0.0, 2.0 * turn)))
    angle, time = balance(spec), balance(spec, BalanceOptions(period=turn))
    begin = angle.effects.angles[0]
    for quantity in ("force", "moment"):
        for a, b in zip(angle.orders[quantity], time.orders[quantity], strict=False):
            assert a.amplitude == pytest.approx(b.amplitude, rel=1e-9, abs=1e-9)
            moved = np.exp(1j * (a.phase - b.phase - a.order * begin))  # the angle at t = 0 is begin
            assert np.allclose(moved[a.amplitude > 1e-6], 1.0, atol=1e-9)


def test_what_strikes_has_no_orders() -> None:
    with pytest.raises(SolveError, match=r"impulse or impact at t = 7\.9 s"):
        of(
            SHAFTS.format(duration=8).replace(
                "analysis:", "impulses: {hit: {on: m.c, vector: [1, 0, 0], time: 7.9}}\nanalysis:"
            ),
            T,
        )


def test_the_command(heun: Heun, tmp_path: Path) -> None:
    spec = tmp_path / "shafts.yaml"
    spec.write_text(SHAFTS.format(duration=8))
    words = ("balance", str(spec), "--period", "2*pi/20")
    text = heun(*words).stdout
    assert "order k is k/T" in text and "TORQUE" not in text and "t = 7." in text
    told = json.loads(heun(*words, "--format", "json").stdout)
    assert told["cycle"]["period"] == pytest.approx(T, rel=1e-15) and told["cycle"]["differs_by"] < 1e-8
    assert told["harmonics"].keys() == {"force", "moment"} and "per_rate" not in told
    both = heun(*words, "--cycle", "A", "--flywheel", "1%")
    assert both.returncode == 2 and "--period and --cycle" in both.stderr and "--period and --flywheel" in both.stderr
    assert heun("balance", str(spec), "--period", "0").returncode == 2


SQUARE = """
heun: 1
parameters: {{T: 0.2, d: {duty}, F: 100, m: 2 kg}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{a: {{mass: m, center: [0, 0, 0], inertia: [1, 1, 1], points: {{o: [0, 0, 0]}}}}}}
joints:
  s: {{type: slide, from: ground.O, to: a.o, axis: [1, 0, 0], initial: {{travel: 0, speed: "-F*(1-d)*d*T/2/m"}}}}
forces:
  f: {{type: torque, joint: s, value: "F*(1-d) if t - T*(step(t-T)+step(t-2*T)+step(t-3*T)) < d*T else -F*d"}}
analysis: {{duration: {duration}, samples: 51}}
"""


@pytest.mark.parametrize(("duty", "duration"), [(0.3, 0.4517), (0.3, 0.5), (0.3, 0.4), (1e-4, 0.45)])
def test_jumps_are_met_and_not_aliased(duty: float, duration: float) -> None:
    """A square wave has orders 2F/kπ |sin k d π|, also where a period begins or ends with a jump."""
    found = balance(
        load("scene.yaml", SQUARE.format(duty=duty, duration=duration)),
        BalanceOptions(period=0.2, orders=(1.0, 2.0, 3.0, 10.0, 100.0, 2001.0)),
    )
    assert len(found.orders["force"]) == 6
    for row in found.orders["force"]:
        wanted = 200.0 / row.order / math.pi * abs(math.sin(row.order * duty * math.pi))
        assert abs(row.amplitude[0] - wanted) <= row.error < 1e-7
        phase = row.phase[0] - 2.0 * math.pi * row.order * (duty / 2.0)  # masses push back: half a turn, or none
        if row.amplitude[0] > 1e-6:
            assert abs(math.sin(phase)) < 1e-6 / row.amplitude[0] + 1e-9
    assert abs(found.mean["force"][0]) <= found.mean_error["force"] < 1e-7
    assert found.residual["force"].peak == pytest.approx(100.0 * max(duty, 1.0 - duty), rel=1e-9)
    assert found.period is not None and found.period.relative_difference < 1e-9
