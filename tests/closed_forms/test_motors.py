"""Motors with rotors: inertia seen through the gear, what the housing takes, spin that makes gyroscopic moments."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.shared.scenes import solved

I, J = 0.03, 1e-4  # of what is driven, and of the rotor
MOTOR = f"{{type: motor, joint: shaft, stall: 2, idle: 300, ratio: RATIO, rotor: {{mass: 0.2, inertia: {J}}}}}"
FIXED = f"""
heun: 1
SPACE
ground: {{points: {{O: ORIGIN}}}}
bodies:
  disc: {{mass: 1, center: ORIGIN, inertia: INERTIA, points: {{o: ORIGIN}}}}
joints: {{shaft: {{type: pin, from: ground.O, to: disc.o}}}}
forces: {{motor: {MOTOR}}}
impulses: {{blow: {{body: disc, couple: [0, 0, 0.5], time: 0.2}}}}
analysis: {{duration: 0.5, samples: 11}}
"""


@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize("ratio", [20.0, -7.0])
def test_run_up_through_a_gear(ratio: float, planar: bool) -> None:
    """(I + i^2 J) w' = i stall (1 - i w/idle); a blow sees that inertia, too; the bed bears what all gains."""
    forms = {"SPACE": "space: planar", "ORIGIN": "[0, 0]", "INERTIA": str(I)}
    if not planar:
        forms = {"SPACE": "", "ORIGIN": "[0, 0, 0]", "INERTIA": f"[0.02, 0.02, {I}]"}
    text = FIXED.replace("RATIO", repr(ratio))
    for word, becomes in forms.items():
        text = text.replace(word, becomes)
    found = solved(text if planar else text.replace("to: disc.o", "to: disc.o, axis: [0, 0, 1]"))
    seen, t = I + ratio**2 * J, found.time
    slowing, idle = ratio**2 * 2 / 300 / seen, 300 / ratio
    struck = np.where(t >= 0.2, 0.5 / seen * np.exp(-slowing * (t - 0.2)), 0.0)
    rate = idle * (1.0 - np.exp(-slowing * t)) + struck
    assert found.coordinates["shaft"]["rate"] == pytest.approx(rate, rel=1e-7, abs=1e-7)
    assert found.coordinates["motor_rotor"]["rate"] == pytest.approx(ratio * rate, rel=1e-7, abs=1e-6)
    sped: Any = (idle - rate) * slowing
    assert found.foundation["moment"][:, 2] == pytest.approx(-(I + ratio * J) * sped, rel=1e-6, abs=1e-7)
    assert found.couplings["motor_rotor"]["moment"] == pytest.approx(J * ratio * sped, rel=1e-6, abs=1e-8)
    assert found.accuracy["energy_drift"] < 1e-8


def test_a_free_housing_turns_back() -> None:
    """Nothing holds it: A w + I (w + q') + J (w + i q') stays zero about the axis."""
    found = solved(f"""
heun: 1
bodies:
  box: {{mass: 2, center: [0, 0, 0], inertia: [0.1, 0.1, 0.05], points: {{o: [0, 0, 0]}},
        position: [0, 0, 0], orientation: {{axis: [1, 2, 3], angle: 1}}}}
  disc: {{mass: 1, center: [0, 0, 0], inertia: [0.02, 0.02, {I}], points: {{o: [0, 0, 0]}}}}
joints: {{shaft: {{type: pin, from: box.o, to: disc.o, axis: [0, 0, 1]}}}}
forces: {{motor: {MOTOR.replace("RATIO", "20")}}}
analysis: {{duration: 0.5, samples: 6}}
""")
    axis: Any = np.array(found.bodies["box"]["rotation"])[:, :, 2]
    turning = np.einsum("ti,ti->t", axis, found.bodies["box"]["angular_velocity"])
    rate = np.array(found.coordinates["shaft"]["rate"])
    assert rate[-1] > 10.0
    assert (0.05 + I + J) * turning + (I + 20.0 * J) * rate == pytest.approx(np.zeros(6), abs=1e-9)


def test_spin_in_a_housing_that_turns() -> None:
    """The housing turns at W about x, the rotor at i w about its own z: its pin turns it by J i w W across both."""
    found = solved(f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  box: {{mass: 2, center: [0, 0, 0], inertia: [0.1, 0.1, 0.05], points: {{o: [0, 0, 0]}}}}
  disc: {{mass: 1, center: [0, 0, 0], inertia: [0.02, 0.02, {I}], points: {{o: [0, 0, 0]}}}}
joints:
  yaw: {{type: pin, from: ground.O, to: box.o, axis: [1, 0, 0]}}
  shaft: {{type: pin, from: box.o, to: disc.o, axis: [0, 0, 1]}}
drives: {{turn: {{joint: yaw, angle: 3*t}}, spin: {{joint: shaft, angle: 5*t}}}}
forces: {{motor: {MOTOR.replace("RATIO", "20")}}}
analysis: {{times: [0, 1]}}
""")
    across = np.array(found.bodies["box"]["rotation"])[:, :, 1]
    wanted = -(J * 100.0 * 3.0) * across
    assert found.joints["motor_rotor"]["moment"] == pytest.approx(wanted, abs=1e-12)
