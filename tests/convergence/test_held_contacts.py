"""Contacts that rest under a driven acceleration take the steps of what is free, and let go where the formula says."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

from heuncli.base import tolerances
from heuncli.study.queries.study import Study
from tests.shared.scenes import near, study

pytestmark = pytest.mark.heavy  # families: the plain kernel has the same bits


def hub(joint: str, rest: str, angle: str, m: float, r: float, duration: float, tolerance: float) -> Study:
    """A mass at radius r on a driven hub, by the joint `guide`."""
    return study(f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  hub: {{mass: 2, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1],
         points: {{c: [0, 0, 0], p: [{r!r}, 0, 0], o: [{r + 0.3!r}, 0, 0]}}}}
  mass: {{mass: {m!r}, center: [0, 0, 0], inertia: [0.01, 0.01, 0.01], points: {{c: [0, 0, 0]}},
          position: [{r!r}, 0, 0]}}
joints:
  pin: {{type: pin, from: ground.O, to: hub.c, axis: [0, 0, 1]}}
  guide: {{type: {joint}, from: hub.p, to: mass.c}}
drives: {{motor: {{joint: pin, angle: "{angle}"}}}}
{rest}
analysis: {{duration: {duration!r}, samples: 21, tolerance: {tolerance!r}}}
""")


def pressed(force: float, spring: float) -> str:
    """A stop that the mass is pressed on, by a thrust or by a spring."""
    load = f"{{type: torque, joint: guide, value: {-force!r}}}"
    if spring:
        load = f"{{type: spring, from: mass.c, to: hub.o, stiffness: {spring!r}, length: {0.3 + force / spring!r}}}"
    return f"forces: {{press: {load}}}\nstops: {{stop: {{joint: guide, travel: [0, 50]}}}}"


@pytest.mark.parametrize("seed", range(24))
def test_what_a_stop_holds_takes_no_steps_of_its_own(seed: int) -> None:
    """Hub at al t²/2: as many steps as at a constant rate, loads as welded, the stop's by the formula."""
    draw = random.Random(seed)
    m, r, force = draw.uniform(0.3, 3), draw.uniform(0.1, 1), 10 ** draw.uniform(2.5, 4.5)
    tolerance, spring = 10 ** -draw.uniform(6, 13), draw.choice([0.0, 10 ** draw.uniform(4, 7)])
    leaving = draw.uniform(0.5, 2)  # [s]: m r (al t)² = F
    al = math.sqrt(force / (m * r)) / leaving
    angle = f"{al!r}*t**2/2"
    run = hub("slide, axis: [1, 0, 0]", pressed(force, spring), angle, m, r, 0.9 * leaving, tolerance)
    even = hub("slide, axis: [1, 0, 0]", pressed(force, spring), f"{0.5 * al!r}*t", m, r, 0.9 * leaving, tolerance)
    welded = hub("weld", "", angle, m, r, 0.9 * leaving, tolerance)
    found, same = run.results, welded.results
    assert found.work["steps"] <= 10 * even.results.work["steps"] + 10
    near(found.joints["pin"]["force"], same.joints["pin"]["force"], force, 1e-13)
    near(found.joints["pin"]["drive"], same.joints["pin"]["drive"], force * r, 1e-13)
    near(found.bodies["mass"]["center"], same.bodies["mass"]["center"], r, 1e-13)
    exact = force - m * r * (al * found.time) ** 2
    # a spring answers to the gap that a closed pose may leave, and to the rounding of its ends and length
    places = tolerances.CLOSED * run.setup.scene.layout.size + 4 * tolerances.EPS * (r + 0.3)
    rounding = 1e-13 * force + spring * places
    near(np.ravel(found.stops["stop"]["force"]), exact, 1.0, rounding)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-13])
@pytest.mark.parametrize("force", [300.0, 30_000.0])
def test_a_pressed_mass_leaves_where_the_rate_is_large_enough(force: float, tolerance: float) -> None:
    al, m, r = 50.0, 0.7, 0.4
    leaving = math.sqrt(force / (m * r)) / al
    angle = f"{al!r}*t**2/2"
    run = hub("slide, axis: [1, 0, 0]", pressed(force, 0.0), angle, m, r, 1.05 * leaving, tolerance)
    assert run.history.checked_run is not None
    steps = run.history.checked_run.run
    first_open = int(np.argmax(~steps.holding.astype(bool).any(axis=1)))
    near(steps.ends[first_open - 1], leaving, leaving, 1e-13)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-13])
def test_along_a_line_too(tolerance: float) -> None:
    """A cart at 0.1 t³, a mass pressed on its stop: F + m x.."""
    run = study(f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  cart: {{mass: 2, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{c: [0, 0, 0]}}}}
  mass: {{mass: 1, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{c: [0, 0, 0]}}}}
joints:
  rail: {{type: slide, from: ground.O, to: cart.c, axis: [1, 0, 0]}}
  guide: {{type: slide, from: cart.c, to: mass.c, axis: [1, 0, 0]}}
drives: {{motor: {{joint: rail, travel: "0.1*t**3"}}}}
forces: {{press: {{type: torque, joint: guide, value: -300}}}}
stops: {{stop: {{joint: guide, travel: [0, 1]}}}}
analysis: {{duration: 0.9, samples: 10, tolerance: {tolerance!r}}}
""")
    assert run.results.work["steps"] <= 10
    near(np.ravel(run.results.stops["stop"]["force"]), 300 + 0.6 * run.results.time, 300, 1e-14)
