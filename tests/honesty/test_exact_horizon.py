"""The double pendulum of manual/theory.md, "Chaos", against eleven more bits: before the horizon errors are as told.

The reference shares nothing with heun: Lagrange's equations of two uniform rods in absolute angles, extrapolated from
the modified midpoint rule (Gragg, Bulirsch, Stoer) in long double. It is checked against the 40-digit table first.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from heuncli.base import tolerances
from heuncli.results.results import Array
from tests.shared.bars import rods
from tests.shared.double_pendulum import REFERENCE
from tests.shared.scenes import study

pytestmark = [
    pytest.mark.heavy,
    pytest.mark.skipif(np.finfo(np.longdouble).nmant < 63, reason="long double is no longer than double here"),
]

Long = Any
LAST, EVERY, H = 18, 8, "0.0078125"  # [s], instants a second, a step of the reference
SEQUENCE = tuple(range(2, 20, 2))  # midpoint steps: order 18
# manual/theory.md, "Chaos": its digits, and what an error of 1e-16 at the start has become by then (8.6e-14, 4.6e-10,
# 9.9e-6 at 5, 10, 15 s), a thirtieth of it: that is fifty roundings of long double
KNOWN = REFERENCE | {15: (13.361953383, 60.114859849)}
OFF = {1: 1e-14, 2: 1e-14, 5: 6e-14, 10: 2e-11, 15: 3.3e-7}


def rate(y: Long, g: Long) -> Long:
    """(4/3) a + (c/2) b = -(s/2) w2^2 - (3/2) g sin p,  (c/2) a + (1/3) b = (s/2) w1^2 - (1/2) g sin q."""
    p, q, u, v = y
    s, c = np.sin(p - q), np.cos(p - q)
    one = np.longdouble(1)
    left, right = -(s * v * v + 3 * g * np.sin(p)) / 2, (s * u * u - g * np.sin(q)) / 2
    d = one * 4 / 9 - c * c / 4
    return np.array([u, v, (left / 3 - c * right / 2) / d, (one * 4 / 3 * right - c * left / 2) / d])


def increment(y: Long, h: Long, g: Long) -> Long:
    """What a step adds, by extrapolation of the modified midpoint rule in the square of its length."""
    rows: list[Long] = []
    first = rate(y, g)
    for j, n in enumerate(SEQUENCE):
        k = h / n
        before, now = 0 * y, k * first
        for _ in range(n - 1):
            before, now = now, before + 2 * k * rate(y + now, g)
        own = [(before + now + k * rate(y + now, g)) / 2]
        for m in range(1, j + 1):
            ratio = (np.longdouble(n) / SEQUENCE[j - m]) ** 2 - 1
            own.append(own[-1] + (own[-1] - rows[j - 1][m - 1]) / ratio)
        rows.append(own)
    return rows[-1][-1]


@cache
def reference() -> Array:
    """Angles (n, 2) every 1 / EVERY seconds, from rest at (2.5, 2.5)."""
    g, h = np.longdouble("9.81"), np.longdouble(H)
    y = np.array([np.longdouble("2.5")] * 2 + [np.longdouble(0)] * 2)
    carry = 0 * y  # what the sum's own rounding has left out
    steps = round(1.0 / (EVERY * float(H)))
    found = [y[:2].astype(float)]
    for _ in range(LAST * EVERY):
        for _ in range(steps):
            d = increment(y, h, g) + carry
            y, before = y + d, y
            carry = d - (y - before)
        found.append(y[:2].astype(float))
    return np.array(found)


@pytest.mark.parametrize("t", sorted(KNOWN))
@pytest.mark.third
def test_the_reference(t: int) -> None:
    assert np.abs(reference()[t * EVERY] - KNOWN[t]).max() <= OFF[t]


@pytest.mark.parametrize("joint", ["pin", "ball"])
@pytest.mark.parametrize("reduce", [True, False])
@pytest.mark.parametrize("tolerance", [1e-5, 1e-9])
@pytest.mark.third
def test_nothing_before_the_horizon_is_off_by_more_than_is_said(joint: str, reduce: bool, tolerance: float) -> None:
    text = rods([2.5, 2.5], [0.0, 0.0], f"{{duration: {LAST}, samples: {LAST * EVERY + 1}, tolerance: {tolerance}}}")
    if joint == "ball":
        text = text.replace("type: pin", "type: ball").replace(", axis: [0, 0, 1]}", "}")
    run = study(text, reduce=reduce)
    horizon, angles = run.results.accuracy["horizon"], reference()
    assert horizon is not None and 13.0 < horizon < 18.0
    first = np.stack([np.sin(angles[:, 0]), -np.cos(angles[:, 0])], axis=1)
    tips = {"rod0.b": first, "rod1.b": first + np.stack([np.sin(angles[:, 1]), -np.cos(angles[:, 1])], axis=1)}
    before = run.results.time < horizon
    for name, wanted in tips.items():
        off = run.results.points[name]["position"][:, :2] - wanted
        size = run.setup.scene.layout.size
        assert np.sqrt(np.sum(off**2, axis=1))[before].max() <= tolerances.CLAIMED * size
