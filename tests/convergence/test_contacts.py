"""The estimate and the horizon of runs that strike: bounces against closed forms, chaos against finer runs."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.base import tolerances
from heuncli.results.results import Array
from heuncli.study.queries.study import Study
from tests.shared.bars import rods
from tests.shared.scenes import near, solved, study
from tests.shared.truth import KNOWN, SECOND, TRUTH, off

pytestmark = pytest.mark.heavy  # families: the plain kernel has the same bits

G = 9.81


def bouncing(e: float, tolerance: float, duration: float = 3.0) -> Study:
    """From a height of 1 m."""
    return study(f"""
heun: 1
gravity: [0, 0, {-G}]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{b: {{mass: 2, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{c: [0, 0, 0]}}}}}}
joints: {{guide: {{type: slide, from: ground.O, to: b.c, axis: [0, 0, 1], initial: {{travel: 1}}}}}}
stops: {{floor: {{joint: guide, travel: [0, null], restitution: {e!r}}}}}
analysis: {{duration: {duration!r}, samples: 2, tolerance: {tolerance!r}}}
""")


def height(t: Array, e: float) -> Array:
    """Of a ball that falls from 1 m, bounce after bounce."""
    fall, v = math.sqrt(2 / G), math.sqrt(2 * G)
    z = np.where(t < fall, 1 - G / 2 * t * t, 0.0)
    start = fall
    for _ in range(400):
        v *= e
        flight = 2 * v / G
        inside = (t >= start) & (t < start + flight)
        z = np.where(inside, v * (t - start) - G / 2 * (t - start) ** 2, z)
        start += flight
        if flight < 1e-13 or start > t[-1]:
            break
    return z


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize("e", [0.0, 0.5, 0.9, 1.0])
@pytest.mark.third
def test_bounces_are_as_exact_as_is_said(e: float, tolerance: float) -> None:
    """Also those at the end of infinitely many, and at rest behind them."""
    run = bouncing(e, tolerance)
    t = np.linspace(0, 3.0, 997)
    found = run.resample(t).coordinates["guide"]["travel"]
    worst = float(np.abs(found - height(t, e)).max())
    stated = run.results.accuracy["estimate"]["motion"] * run.setup.scene.layout.size
    assert worst <= stated + 1e-12, f"{worst:.3g} where {stated:.3g} is stated"
    assert stated <= max(tolerance, 1e-12) * run.setup.scene.layout.size


def struck_pendulum(tolerance: float, duration: float, e: float) -> Study:
    """Two rods thrown from above, the elbow between stops."""
    text = rods([2.5, 2.0], [0.0, 0.0], f"{{duration: {duration}, samples: 3, tolerance: {tolerance!r}}}")
    return study(text + f"stops: {{elbow: {{joint: pin1, angle: [-0.55, 0.45], restitution: {e}}}}}\n")


@pytest.mark.parametrize("e", [0.4, 1.0])
@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-11])
def test_a_struck_pendulum_against_a_finer_run(e: float, tolerance: float) -> None:
    run, fine = struck_pendulum(tolerance, 1.5, e), struck_pendulum(1e-13, 1.5, e)
    assert len(run.results.impulses) >= 2
    t = np.linspace(0, 1.5, 301)
    coarse, exact = run.resample(t), fine.resample(t)
    worst = max(float(np.linalg.norm(b["center"] - exact.bodies[n]["center"], axis=1).max())
                for n, b in coarse.bodies.items())  # fmt: skip
    stated = run.results.accuracy["estimate"]["motion"] * run.setup.scene.layout.size
    sure = fine.results.accuracy["estimate"]["motion"] * run.setup.scene.layout.size
    assert worst <= stated + sure, f"{worst:.3g} where {stated:.3g} is stated"


def test_chaos_between_stops_keeps_an_honest_horizon() -> None:
    run = struck_pendulum(1e-12, 30.0, 1.0)
    horizon = run.results.accuracy["horizon"]
    assert horizon is not None and horizon > 2.0
    times = np.linspace(0, horizon, 301)[:-1]
    shown = run.resample(times)
    worst, other = (float(off(run, shown, times, t)[-1]) for t in (TRUTH, SECOND))
    assert abs(worst - other) <= KNOWN * tolerances.CLAIMED
    assert worst <= tolerances.CLAIMED
    e = shown.energy
    total = e["kinetic"] + e["potential"] - e["work"]
    near(total, total[0], float(e["kinetic"].max()), 1e-8)


GRAZED = """
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{b: {{mass: 2, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{c: [0, 0, 0]}}}}}}
joints: {{g: {{type: slide, from: ground.O, to: b.c, axis: [0, 0, 1], initial: {{travel: 0, speed: 3}}}}}}
stops: {{top: {{joint: g, travel: [null, {limit!r}], restitution: {e}}}}}
analysis: {{duration: {duration!r}, samples: 2}}
"""


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("depth", [-1e-12, 0.0, 1e-15, 1e-14, 1e-12, 1e-10, 1e-8, 1e-6])
@pytest.mark.third
def test_a_limit_that_is_grazed(depth: float, e: float) -> None:
    """Thrown up at 3 m/s against a stop just below the apex: struck at sqrt(2 g depth), or by rounding missed.

    Whether it is struck at all the rounding of the gap decides: the estimate knows either.
    """
    v, g = 3.0, 9.81
    limit, duration = v * v / 2.0 / g - depth, 2.0 * v / g
    found = solved(GRAZED.format(limit=limit, e=e, duration=duration))
    u = math.sqrt(2.0 * g * max(depth, 0.0))
    left = duration - (v - u) / g
    wanted = limit - e * u * left - g / 2.0 * left * left if depth > 0.0 else v * duration - g / 2.0 * duration**2
    missed = abs(float(found.coordinates["g"]["travel"][-1]) - wanted)
    assert missed <= found.accuracy["estimate"]["motion"] * 0.45 + 1e-14  # the size is the apex, 0.459 m
