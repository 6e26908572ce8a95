"""manual/theory.md, "Chaos": uniform double pendulum released at (2.5, 2.5) rad: 40-digit reference, then chaos."""

from __future__ import annotations

import numpy as np
import pytest

from tests.shared.bars import rods
from tests.shared.double_pendulum import REFERENCE
from tests.shared.scenes import near, solved

# The digits printed, and what an error of 1e-16 at the start has become ("Chaos": 8.6e-14, 4.6e-10 at 5, 10 s),
# thirty times each: an integrator makes one such error a step
ALLOWED = {1: 1e-13, 2: 2e-12, 5: 1e-10, 10: 1e-6}


@pytest.mark.heavy
def test_reference() -> None:
    found = solved(rods([2.5, 2.5], [0.0, 0.0], "{times: [1, 2, 5, 10], tolerance: 1e-13}"))
    upper = found.coordinates["pin0"]["angle"]
    angles = np.stack([upper, upper + found.coordinates["pin1"]["angle"]], axis=1)
    for k, (t, wanted) in enumerate(REFERENCE.items()):
        near(angles[k], wanted, 1.0, ALLOWED[t])


@pytest.mark.heavy
def test_nothing_is_claimed_beyond_the_horizon() -> None:
    """No value beyond about 15 s means anything in double precision; the energy holds all the same."""
    found = solved(rods([2.5, 2.5], [0.0, 0.0], "{duration: 25, samples: 251, tolerance: 1e-13}"))
    assert found.accuracy["horizon"] == pytest.approx(14.5, abs=1.5)
    assert found.accuracy["energy_drift"] < 5e-11
