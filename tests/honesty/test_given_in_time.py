"""Extremes of what is given in time alone, against closed forms: no step of an integration tells how fast it runs.

Where drives hold or lead everything a run takes two steps, whatever its loads and laws do between them.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from heuncli.results.results import Array
from heuncli.study.queries.measure import Peak, find_peak
from heuncli.study.queries.study import TOO_FEW, Study
from tests.shared.scenes import study

TABLE = """\
heun: 1
title: A table on a guide, led along it and pushed across
parameters: {{w: 20 1/s, T: 1.5 s}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  table: {{mass: 2, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{c: [0, 0, 0]}}}}
joints:
  guide: {{type: slide, from: ground.O, to: table.c, axis: [1, 0, 0]}}
drives:
  lead: {{joint: guide, travel: "{travel}"}}
forces:
  push: {{type: force, on: table.c, vector: [0, "{push}", 0]}}
{more}analysis: {{duration: T, samples: {samples}}}
"""
KNOTS = "tables:\n  steep: {{x: {x}, y: {y}}}\n"
W, T = 20.0, 1.5
ACROSS, RATE = "joints.guide.force.y", "coordinates.guide.acceleration"


def table(push: str = "0", travel: str = "0", samples: int = 2, more: str = "") -> Study:
    """The table, led by one law in time and pushed by another."""
    return study(TABLE.format(push=push, travel=travel, samples=samples, more=more))


def both(run: Study, path: str) -> tuple[Peak, Peak]:
    """The lowest and the highest of a number of a run, of which no doubt was told."""
    found = find_peak(run, path, "min"), find_peak(run, path, "max")
    assert not run.later_warnings
    return found


def highest(f: Callable[[Array], Array]) -> float:
    """The highest value of a formula over the run: among many, and among more about the highest of these."""
    t = np.linspace(0.0, T, 100_001)
    for _ in range(3):
        k = int(np.argmax(f(t)))
        t = np.linspace(t[max(k - 1, 0)], t[min(k + 1, len(t) - 1)], 1001)
    return float(f(t).max())


@pytest.mark.parametrize("samples", [2, 400])
@pytest.mark.parametrize(
    ("law", "formula"),
    [
        ("10*sin(w*t) + 4*sin(61*w*t + 1)", lambda t: 10 * np.sin(W * t) + 4 * np.sin(61 * W * t + 1)),
        ("10*sin(311*w*t)*exp(-t)", lambda t: 10 * np.sin(311 * W * t) * np.exp(-t)),
        # a ripple that hardly shows in the slope, on which the highest value hangs
        ("1000*t*(3 - 2*t) + 0.01*sin(4000*t)", lambda t: 1000 * t * (3 - 2 * t) + 0.01 * np.sin(4000 * t)),
    ],
    ids=["orders", "damped", "ripple"],
)
def test_loads_that_no_step_feels(law: str, formula: Callable[[Array], Array], samples: int) -> None:
    low, high = both(table(law, samples=samples), ACROSS)
    assert math.isclose(high.value, highest(lambda t: -formula(t)), rel_tol=1e-10, abs_tol=1e-9)
    assert math.isclose(low.value, -highest(formula), rel_tol=1e-10, abs_tol=1e-9)


def test_pulses_shorter_than_any_distance_of_looking() -> None:
    """At instants that no grid has, a hundred-thousandth of the run wide."""
    law = "10*exp(-((t - 0.3123456)/1.5e-5)**2) - 7*exp(-((t - 1.2345678)/1.5e-5)**2)"
    low, high = both(table(law), ACROSS)
    assert math.isclose(high.value, 7.0, rel_tol=1e-9)
    assert math.isclose(low.value, -10.0, rel_tol=1e-9)
    assert low.time == pytest.approx(0.3123456, abs=1e-8)


def test_ripples_of_a_drive_are_its_acceleration() -> None:
    """A millionth of the travel, and at 3000/s it makes nine times the acceleration of all the rest."""
    low, high = both(table(travel="t**2/2 + 1e-6*sin(3000*t)"), RATE)
    assert math.isclose(high.value, 10.0, rel_tol=1e-9)
    assert math.isclose(low.value, -8.0, rel_tol=1e-9)


def test_knots_and_steps_between_the_samples() -> None:
    """The highest point of a table of straight lines, and both sides of steps a microsecond apart."""
    x = [0.0, 0.4, 0.4001, 0.4002, 1.1, 1.5]
    more = KNOTS.format(x=x, y=[0.0, 1.0, 6.0, 1.0, -2.0, 0.0])
    low, high = both(table("table(steep, t) + 3*(t > 1.2345) - 3*(t > 1.234501)", more=more), ACROSS)
    assert math.isclose(low.value, -6.0, rel_tol=1e-12)
    assert math.isclose(high.value, 2.0, rel_tol=1e-12)
    low, _ = both(table("9*(t > 1.2345)*(t < 1.234501)"), ACROSS)
    assert math.isclose(low.value, -9.0, rel_tol=1e-12)


def test_kinks_that_no_switch_tells_of() -> None:
    low, high = both(table("5 - (sin(w*t)**2)**0.5"), ACROSS)
    assert math.isclose(low.value, -5.0, abs_tol=1e-9)
    assert math.isclose(high.value, -4.0, rel_tol=1e-9)


def test_too_fast_to_be_followed_is_told() -> None:
    run = table("10*sin(2e6*t*(1 + t))")
    find_peak(run, ACROSS, "max")
    assert TOO_FEW.format(len(run.search_times)) in run.later_warnings


@pytest.mark.parametrize("led", [True, False], ids=["driven", "free"])
@pytest.mark.parametrize(
    ("law", "formula"),
    [
        ("10*sin(400*guide.travel)*exp(-guide.travel)", lambda x: 10 * np.sin(400 * x) * np.exp(-x)),
        ("10*sin(91*guide.travel + 1) + 3*sin(5*guide.travel)", lambda x: 10 * np.sin(91 * x + 1) + 3 * np.sin(5 * x)),
    ],
    ids=["damped", "orders"],
)  # fmt: skip
def test_loads_along_a_coordinate_that_push_nothing(law: str, formula: Callable[[Array], Array], led: bool) -> None:
    """Across a guide on which a table goes evenly, led or free: its motion takes no more steps for them."""
    text = TABLE.format(push=law, travel="2*t", samples=2, more="")
    if not led:
        head, rest = text.split("drives:")
        text = head.replace("[1, 0, 0]}", "[1, 0, 0], initial: {speed: 2 m/s}}") + rest[rest.index("forces:") :]
    low, high = both(study(text), ACROSS)
    assert math.isclose(high.value, highest(lambda t: -formula(2.0 * t)), rel_tol=1e-8)
    assert math.isclose(low.value, -highest(lambda t: formula(2.0 * t)), rel_tol=1e-8)
