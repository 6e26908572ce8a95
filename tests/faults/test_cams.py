"""Cams as people mistype them: tables that fold or jump, joints that are each other's, faces that lean."""

from __future__ import annotations

import pytest

from heuncli.base.errors import HeunError
from tests.shared.cams import PERIOD, eccentric
from tests.shared.scenes import solved

TABLE = f"{{x: [0, 90 deg, 180 deg, 270 deg, 360 deg], y: [40 mm, 45 mm, 50 mm, 45 mm, 40 mm], {PERIOD}}}"
SCENE = eccentric(TABLE, "flat, normal: [0, 1, 0]", 20)
WRONG = {
    "180 deg, 270 deg": ("270 deg, 180 deg", "table-shape"),
    "90 deg, 180 deg": ("180 deg, 180 deg", "table-shape"),
    "45 mm, 40 mm]": ("45 mm, 41 mm]", "table-period"),
    "270 deg, 360 deg": ("270 deg, 400 deg", "table-period"),
    "40 mm, 45 mm, 50": (".nan, 45 mm, 50", "not-finite"),
    "50 mm": ("500 mm", "cam-undercut"),
    "40 mm, 45 mm, 50 mm, 45 mm, 40 mm": ("0, 0, 0, 0, 0", "cam-undercut"),
    "interpolation: cubic": ("interpolation: linear", "table-curve"),
    "of: [shaft, guide]": ("of: [shaft, shaft]", "cam-joints"),
    "[shaft, guide], lift": ("[guide, shaft], lift", "cam-joints"),
    "[shaft, guide]": ("[cam, guide]", "coupled-joint"),
    "lift: lift": ("lift: cam", "table-curve"),
    "two_sided: true": ("two_sided: true, phase: 3 mm", "dimension"),
    "two_sided: ": ("two_sided: true, phase: t, restitution: ", "not-in-time"),
    "normal: [0, 1, 0]": ("normal: [0, 0, 1]", "cam-contact"),
    "0, 1, 0], two": ("0, 1, 1], two", "cam-contact"),
    "at: tappet.P": ("at: disc.O", "cam-joints"),
    ", period: 360 deg": ("", "path-ends"),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_what_is_mistyped_of_a_cam(wrong: str) -> None:
    """It is refused with its code, a place and a hint."""
    other, code = WRONG[wrong]
    assert wrong in SCENE
    with pytest.raises(HeunError) as told:
        solved(SCENE.replace(wrong, other).replace("20*t", "20*t + 3" if code == "path-ends" else "20*t"))
    assert code in {problem.code for problem in told.value.problems}
    assert all(problem.hint for problem in told.value.problems)
