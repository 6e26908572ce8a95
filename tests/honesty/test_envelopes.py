"""Extremes between the samples against closed forms: a driven bar, a pendulum through its lowest place."""

from __future__ import annotations

import math
import random
from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.queries.measure import MeasureRequest, measure_value
from heuncli.study.workflow import solve

G = 9.81
DENSE = 4_000  # instants between which each extreme is looked for once more


class Bar(NamedTuple):
    """A uniform bar on a pin, driven by phi = rate t + swing sin(omega t), cut at s."""

    mass: float
    length: float
    s: float
    rate: float
    swing: float
    omega: float
    duration: float

    def loads(self, t: float) -> dict[str, float]:
        """N, Q2 and M1 of the piece beyond the cut on the part before it; e1 is y, across it turns from x to z.

        dF = (g - a) dm,  a = -phi'^2 r e + phi'' r n  at r along the bar
        """
        phi = self.rate * t + self.swing * math.sin(self.omega * t)
        first = self.rate + self.swing * self.omega * math.cos(self.omega * t)
        second = -self.swing * self.omega**2 * math.sin(self.omega * t)
        along, across = -G * math.sin(phi), -G * math.cos(phi)  # of g
        mu, L, s = self.mass / self.length, self.length, self.s
        m, c = mu * (L - s), 0.5 * (L + s)
        lever = (L**3 - s**3) / 3.0 - s * (L**2 - s**2) / 2.0  # of r (r - s)
        return {
            "N": m * (along + first**2 * c),
            "Q2": m * (across - second * c),
            "M1": mu * second * lever - m * across * (c - s),
        }


def drawn(seed: int) -> Bar:
    draw = random.Random(seed)
    length = draw.uniform(0.3, 3.0)
    omega = draw.uniform(1.0, 9.0)
    return Bar(
        draw.uniform(0.5, 20.0), length, draw.uniform(0.0, 0.9) * length, draw.uniform(-4.0, 4.0),
        draw.uniform(0.1, 1.5), omega, draw.uniform(1.0, 3.0),
    )  # fmt: skip


def told(bar: Bar) -> str:
    """In the xz plane, turning from x to z: e1 of the cut is the body's y, e2 = n x e1 the body's z."""
    return f"""
heun: 1
gravity: [0, 0, {-G}]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bar:
    shapes: [{{type: rod, from: [0, 0, 0], to: [{bar.length!r}, 0, 0], mass: {bar.mass!r}}}]
    points: {{O: [0, 0, 0]}}
joints: {{pin: {{type: pin, from: ground.O, to: bar.O, axis: [0, -1, 0]}}}}
drives: {{motor: {{joint: pin, angle: "{bar.rate!r}*t + {bar.swing!r}*sin({bar.omega!r}*t)"}}}}
sections: {{cut: {{body: bar, at: [{bar.s!r}, 0, 0], normal: [1, 0, 0]}}}}
analysis: {{duration: {bar.duration!r}, samples: 14}}
"""


def extreme(bar: Bar, part: str, sign: float) -> float:
    """The largest value of sign times a load over the run."""
    times = np.linspace(0.0, bar.duration, DENSE)
    values = [sign * bar.loads(t)[part] for t in times]
    k = int(np.argmax(values))
    low, high = times[max(k - 1, 0)], times[min(k + 1, DENSE - 1)]
    found = minimize_scalar(lambda t: -sign * bar.loads(t)[part], bounds=(low, high), options={"xatol": 1e-12})
    return max(values[k], -float(found.fun))


@pytest.mark.parametrize("seed", range(24))
@pytest.mark.third
def test_a_driven_bar(seed: int) -> None:
    bar = drawn(seed)
    run = solve(load("bar.yaml", told(bar)), Options(requested_reports=frozenset({"sections"})))
    size = max(abs(x) for t in np.linspace(0.0, bar.duration, 99) for x in bar.loads(t).values())
    for part in ("N", "Q2", "M1"):
        for how, sign in (("max", 1.0), ("min", -1.0)):
            found = measure_value(MeasureRequest(how, f"sections.cut.{part}"), run).value
            exact = sign * extreme(bar, part, sign)
            assert abs(found - exact) <= 1e-9 * size, (part, how, found, exact)


@pytest.mark.parametrize("seed", range(12))
def test_a_pendulum_through_its_lowest_place(seed: int) -> None:
    """A bar let go at theta from below: at the lowest place the pin carries m g (1 + 2 (1 - cos theta) m c^2 / I)."""
    draw = random.Random(seed)
    mass, length, theta = draw.uniform(0.5, 20.0), draw.uniform(0.3, 3.0), draw.uniform(0.3, 2.9)
    inertia = mass * length**2 / 12.0
    text = f"""
heun: 1
gravity: [0, 0, {-G}]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bar: {{mass: {mass!r}, center: [0, 0, {-0.5 * length!r}], inertia: [{inertia!r}, {inertia!r}, 1e-3],
        points: {{O: [0, 0, 0]}}, orientation: {{axis: [0, 1, 0], angle: {theta!r}}}}}
joints: {{pin: {{type: pin, from: ground.O, to: bar.O, axis: [0, 1, 0]}}}}
analysis: {{duration: {draw.uniform(4.0, 9.0) * math.sqrt(length)!r}, samples: 7}}
"""
    run = solve(load("bar.yaml", text), Options(requested_reports=frozenset({"joints"})))
    about = inertia + mass * (0.5 * length) ** 2
    exact = mass * G * (1.0 + 2.0 * (1.0 - math.cos(theta)) * mass * (0.5 * length) ** 2 / about)
    found = measure_value(MeasureRequest("max", "joints.pin.force.z"), run).value
    assert abs(found - exact) <= (run.results.accuracy["estimate"]["reactions"] + 1e-13) * exact
