"""Places that `heun find` tells of integrated scenes: those of a coarse run lie within their errors of a fine one's."""

from __future__ import annotations

import json
from typing import Any

import pytest

from tests.shared.command import Heun
from tests.shared.folders import SPECS

CASES = (
    ("four_bar", "w=42:84rpm", "max joints.rocker.force"),
    ("v_twin", "r=40:70mm", "max joints.bore_left.force"),
    ("trolley", "M=1.4:2.8", "max joints.rail.force"),
    ("top", "g=7:13", "max joints.tip.force"),
    ("charpy", "m=14:28kg", "max joints.pivot.force"),
)


def found(heun: Heun, name: str, unknown: str, value: str, tolerance: str) -> Any:
    words = ("find", str(SPECS / f"{name}.yaml"), unknown, value, "--tolerance", tolerance, "--format", "json", "-q")
    done = heun(*words)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize(("name", "unknown", "measure"), CASES, ids=[case[0] for case in CASES])
@pytest.mark.third
def test_a_coarse_run_tells_the_place_within_its_error(heun: Heun, name: str, unknown: str, measure: str) -> None:
    ends = found(heun, name, unknown, f"{measure} = 0", "1e-7")["course"]
    low, high = (sorted(each["measure"] for each in ends)[k] for k in (0, -1))
    value = f"{measure} = {0.37 * low + 0.63 * high!r}"
    fine = found(heun, name, unknown, value, "1e-12")["crossings"]
    for tolerance in ("1e-7", "1e-9"):
        coarse = found(heun, name, unknown, value, tolerance)["crossings"]
        assert len(coarse) == len(fine) >= 1
        for one, other in zip(coarse, fine, strict=True):
            assert abs(one["x"] - other["x"]) <= one["error"] + other["error"]
            assert one["error"] <= 1e-3 * abs(one["x"])
