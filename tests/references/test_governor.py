"""A05, the stiff flyball governor: what stays in it, and its printed travel by every way of stiff motion."""

from __future__ import annotations

import pytest

from tests.shared.published import course, spec_at
from tests.shared.scenes import near, solved

pytestmark = pytest.mark.heavy
DIGITS = 2e-8  # half of the last digit printed, and the error of the reference (1e-11 local, fast transient)


def test_what_stays() -> None:
    """The spin is free: no moment about its axis. Energy less the dampers' work, within the tolerance. Arms agree."""
    found = solved(spec_at("governor", [0, 0.1, 0.2, 0.5, 1], 1e-9))
    near(found.foundation["moment"][:, 2], 0.0, 100.0, 1e-12)
    near(found.coordinates["left"]["angle"], found.coordinates["right"]["angle"], 1.0, 1e-10)
    assert found.accuracy["energy_drift"] <= 1e-8
    assert found.accuracy["estimate"]["motion"] <= 1e-8


@pytest.mark.parametrize("method", ["Radau5", "Radau9"])
def test_ten_seconds(method: str) -> None:
    """All that was printed of the slider, by each stiff method; test_published.py takes what heun chooses."""
    travel = course("governor", "coordinates.sleeve.travel")
    results = solved(spec_at("governor", [0, *travel], 1e-8), method=method)
    near(results.coordinates["sleeve"]["travel"][1:], [*travel.values()], 1.0, DIGITS)
    assert results.accuracy["estimate"]["motion"] <= 1e-8
