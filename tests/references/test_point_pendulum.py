"""A01, a point mass on a massless bar of 1 m, released level: told as a rod, as a rod in a plane, on a pin, on a ball.

Exact by Jacobi's functions (manual/references.md, "Point pendulum"), over 845 periods; the tension is 3 m g |y|. The
body has no inertia at all. The error of the phase grows with the square of the time: in double precision the best run
of 2000 s is good to 1e-8.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

from heuncli.results.results import Results
from tests.shared.scenes import near, solved

TIMES = (0.5, 1.0, 2.0, 5.0, 10.0, 100.0, 1000.0, 2000.0)


def exact(t: float) -> tuple[float, float]:
    """The place: from the turning point the half angle's sine is k sn(K - w t), w = sqrt(g), k^2 = 1/2."""
    sn, _, dn, _ = ellipj(ellipk(0.5) - np.sqrt(9.81) * t, 0.5)
    half = np.sqrt(0.5) * sn  # sin(angle/2), the angle from hanging, positive towards -x
    return float(-2.0 * half * dn), float(2.0 * half * half - 1.0)


HEAD = """
heun: 1
gravity: [0, -9.81, 0]
ground: {points: {O: [0, 0, 0]}}
bodies:
  bob:
    shapes: [{type: point, at: [0, 0, 0], mass: 1}]
    points: {O: [1, 0, 0], mass: [0, 0, 0]}
    position: [-1, 0, 0]
joints:
"""
TOLD = {
    "rod": "  bar: {type: rod, from: ground.O, to: bob.mass, length: 1}\n",
    "rod in a plane": "  bar: {type: rod, from: ground.O, to: bob.mass}\n"
                      "  flat: {type: plane, from: ground.O, to: bob.mass, normal: [0, 0, 1]}\n",
    "pin": "  bar: {type: pin, from: ground.O, to: bob.O, axis: [0, 0, 1]}\n",
    "ball": "  bar: {type: ball, from: ground.O, to: bob.O}\n",
}  # fmt: skip
DIGITS = 1e-12  # what an argument of a hundred periods loses by rounding


@cache
def swing(told: str, last: float, tolerance: float) -> Results:
    times = [0.0, *(t for t in TIMES if t <= last)]
    return solved(f"{HEAD}{TOLD[told]}analysis: {{times: {times}, tolerance: {tolerance}}}\n")


@pytest.mark.heavy
@pytest.mark.parametrize("told", TOLD)
def test_ten_seconds(told: str) -> None:
    found = swing(told, 10.0, 1e-12)
    for k, t in enumerate(found.time.tolist()):
        if t == 0.0:
            continue
        near(found.points["bob.mass"]["position"][k, :2], exact(t), 1.0, 1e-12 + DIGITS)
        force = found.joints["bar"]["force"][k]
        pull = found.joints["bar"].get("tension", np.linalg.norm(found.joints["bar"]["force"], axis=1))[k]
        near(pull, 3 * 9.81 * -exact(t)[1], 1.0, 1e-10)
        near(-force, pull * np.array([*exact(t), 0.0]), 1.0, 1e-10)  # ON the bob, towards O
    assert all(block["open"] == [] for block in found.joints.values())


@pytest.mark.heavy
def test_845_periods() -> None:
    """The estimate covers the true error, which is at its floor: 1e-9 cannot be had after 2000 s."""
    found = swing("pin", 2000.0, 1e-9)
    apart = [np.abs(found.points["bob.mass"]["position"][k, :2] - exact(t)).max()
             for k, t in enumerate(found.time.tolist()) if t > 0.0]  # fmt: skip
    assert max(apart) <= 1e-8
    assert max(apart) <= found.accuracy["estimate"]["motion"]
    assert found.accuracy["energy_drift"] <= 1e-10


@pytest.mark.heavy
def test_a_hundred_seconds_on_a_closure() -> None:
    found = swing("rod in a plane", 100.0, 1e-11)
    near(found.points["bob.mass"]["position"][-1, :2], exact(100.0), 1.0, 1e-11 * 5 + DIGITS)
    assert found.accuracy["constraint_gap"] <= 1e-14
