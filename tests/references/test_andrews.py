"""A03, Andrews' squeezing mechanism (IVP Test Set), told in space: ten pins, of which nine loads a loop hold twice.

What was printed of it is compared in the plane: tests/references/test_published.py. In space it is the same motion, and
what the plane does not have is open.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from heuncli.results.results import Results
from tests.oracle.published import PINS, START, andrews
from tests.shared.published import spec_at
from tests.shared.scenes import moving, near, solved

TIMES = [0.0, 0.03, 0.05]


pytestmark = pytest.mark.heavy  # one long run for all


@cache
def squeezer() -> Results:
    return solved(moving(andrews(START, dict.fromkeys(START, 0.0)), TIMES, 1e-11))


@cache
def planar() -> Results:
    return solved(spec_at("andrews", TIMES, 1e-11))


@pytest.mark.parametrize("quantity", ["angle", "rate", "acceleration"])
def test_the_same_motion_in_space(quantity: str) -> None:
    """Turns are counted on in both; relative to the largest."""
    for pin in PINS.values():
        own, other = (found.coordinates[pin][quantity] for found in (squeezer(), planar()))
        near(own, other, float(np.abs(planar().coordinates["G"][quantity]).max() + 15.0), 1e-9)


def test_the_same_pin_forces_in_space() -> None:
    """To 1e-9 of the largest; across the plane three loads a loop are open. E4 and E6 are told from the other side."""
    for name, block in squeezer().joints.items():
        sign = -1.0 if name in ("E4", "E6") else 1.0
        near(block["force"][:, :2], sign * planar().joints[name]["force"][:, :2], 333.0, 1e-9)
        assert set(block["open"]) == {"force.z", "moment.x", "moment.y", "axial", "tilting"}
        near(block["radial"], np.hypot(*block["force"][:, :2].T), 333.0, 1e-14)


def test_beyond_the_published_end() -> None:
    """t = 0.05 by another program, to the digits it gives."""
    c = squeezer().coordinates
    for pin, angle in (("O", 33.8258678), ("F", -33.5834315), ("B", 0.11339507)):
        assert c[pin]["angle"][2] == pytest.approx(angle, abs=1e-6)


def test_model_and_accuracy() -> None:
    found = squeezer()
    assert (found.model["freedoms"], found.model["redundant"], found.model["grubler"]) == (1, 9, -8)
    assert found.accuracy["constraint_gap"] <= 1e-15  # the size of the scene is 0.1 m
    assert found.accuracy["energy_drift"] <= 1e-10
    assert found.accuracy["estimate"]["motion"] <= 1e-11
