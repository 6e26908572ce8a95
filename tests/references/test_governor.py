"""A05, the stiff flyball governor (OpenSim): springs of 8e5 N/m and 4e4 N s/m hold a slider on a turning shaft; 1 s.

The reduced motion of manual/references.md, "Governor", by Radau at 1e-11, is printed to 8 digits.
"""

from __future__ import annotations

from functools import cache

import pytest

from heuncli.results import Results
from tests.shared.governors import GOVERNOR
from tests.shared.scenes import near, solved

DIGITS = 2e-8  # half of the last digit printed, and the error of the reference (1e-11 local, fast transient)

TRAVEL = {0.1: 0.52383648, 0.2: 0.58507981, 0.5: 0.74324942, 1.0: 0.50142092}
ARM = {0.5: 0.25949138, 1.0: 0.5218333}
SPIN = {0.5: 5.10341542, 1.0: 6.27112574}
TIMES = (0.0, 0.1, 0.2, 0.5, 1.0)


@cache
def governor() -> Results:
    return solved(GOVERNOR)


@pytest.mark.heavy
def test_first_second() -> None:
    found = governor().coordinates
    for t, value in TRAVEL.items():
        assert found["sleeve"]["travel"][TIMES.index(t)] == pytest.approx(value, abs=DIGITS)
    for t, value in ARM.items():
        assert found["right"]["angle"][TIMES.index(t)] == pytest.approx(value, abs=DIGITS)
        assert found["left"]["angle"][TIMES.index(t)] == pytest.approx(value, abs=DIGITS)
    for t, value in SPIN.items():
        assert found["spin"]["rate"][TIMES.index(t)] == pytest.approx(value, abs=6 * DIGITS)


@pytest.mark.heavy
def test_what_stays() -> None:
    """The spin is free: no moment about its axis. Energy less the dampers' work, within the tolerance."""
    found = governor()
    near(found.foundation["moment"][:, 2], 0.0, 100.0, 1e-12)
    assert found.accuracy["energy_drift"] <= 1e-8
    assert found.accuracy["estimate"]["motion"] <= 1e-8


LATER = {2.0: 0.50590929, 3.0: 0.51324608, 4.0: 0.52322337, 5.0: 0.5355631, 6.0: 0.54992867, 8.0: 0.58317834,
         10.0: 0.61962292}  # fmt: skip


@pytest.mark.heavy
@pytest.mark.parametrize("method", ["auto", "Radau5", "Radau9"])
def test_ten_seconds(method: str) -> None:
    """All of the table, by what heun chooses and by its stiff methods, at the order's tolerance of 1e-6 and finer."""
    times = [0.0, *TRAVEL, *LATER]
    text = GOVERNOR.replace("times: [0, 0.1, 0.2, 0.5, 1], tolerance: 1e-9", f"times: {times}, tolerance: 1e-8")
    results = solved(text, method=method)
    assert str(results.model["method"]).startswith("Radau")
    found = results.coordinates
    for t, value in (TRAVEL | LATER).items():
        assert found["sleeve"]["travel"][times.index(t)] == pytest.approx(value, abs=DIGITS)
    assert found["right"]["angle"][-1] == pytest.approx(0.3900737, abs=10 * DIGITS)
    assert found["spin"]["rate"][-1] == pytest.approx(5.54820362, abs=10 * DIGITS)
    assert results.accuracy["estimate"]["motion"] <= 1e-8
