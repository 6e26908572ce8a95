"""The torque that drives a slider-crank, put into the free machine as a table of t, gives back the driven motion."""

from __future__ import annotations

import numpy as np
import pytest

from tests.shared.scenes import near, solved
from tests.shared.slider_crank import slider_crank

TURN = 2 * np.pi / 100.0  # [s] one turn at 100 rad/s
GRAVITY = "gravity: [0, -9.81, 0]\n"
FRICTION = "  rub: {type: friction, joint: guide, force: 50, speed: 0.5}\n"


@pytest.mark.heavy
@pytest.mark.parametrize("told", ["four pins", "determinate"])
@pytest.mark.parametrize("interpolation", ["cubic", "pchip"])
def test_one_turn(told: str, interpolation: str) -> None:
    """Within 1e-6 of the motion; 720 knots a turn leave 1e-8 (cubic) and 1e-7 (pchip) of the torque."""
    samples = np.linspace(0.0, TURN, 721)
    rub = f"forces:\n{FRICTION}"
    drive = "drives: {motor: {joint: shaft, angle: 60*deg + 100*t}}\n"
    analysis = f"analysis: {{duration: {TURN!r}, samples: 721, tolerance: 1e-11}}\n"
    driven = solved(slider_crank(told, "", drive + GRAVITY + rub + analysis))
    torque = driven.joints["shaft"]["drive"]
    assert np.ptp(torque) > 100.0
    table = f"tables: {{torque: {{x: {samples.tolist()}, y: {torque.tolist()}, interpolation: {interpolation}}}}}\n"
    motor = f"{rub}  motor: {{type: torque, joint: shaft, value: 'table(torque, t)'}}\n"
    analysis = f"analysis: {{duration: {TURN!r}, samples: 13, tolerance: 1e-9}}\n"
    free = solved(slider_crank(told, ", initial: {angle: 60 deg, rate: 100}", GRAVITY + table + motor + analysis))
    near(free.coordinates["shaft"]["angle"], driven.coordinates["shaft"]["angle"][::60], 1.0, 1e-6)
    near(free.coordinates["shaft"]["rate"], 100.0, 100.0, 1e-6)
    near(free.coordinates["guide"]["travel"], driven.coordinates["guide"]["travel"][::60], 0.1, 1e-6)
    for name in ("shaft", "big_end", "wrist", "guide"):
        whole = driven.joints[name]["force"][::60, :2]
        near(free.joints[name]["force"][:, :2], whole, float(np.abs(whole).max()), 1e-5)
