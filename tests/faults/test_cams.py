"""Cams as people mistype them: tables that fold or jump, joints that are each other's, faces that lean."""

from __future__ import annotations

import pytest

from heuncli.errors import HeunError
from tests.shared.cams import PERIOD
from tests.shared.scenes import solved

TABLE = f"{{x: [0, 90 deg, 180 deg, 270 deg, 360 deg], y: [40 mm, 45 mm, 50 mm, 45 mm, 40 mm], {PERIOD}}}"
CAM = "{type: cam, of: [shaft, guide], lift: lift, at: tappet.P, contact: flat, normal: [0, 1, 0], two_sided: true}"
SCENE = f"""
heun: 1
tables: {{lift: {TABLE}}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  disc: {{mass: 2, center: [0, 0, 0], inertia: [0.01, 0.01, 0.02], points: {{O: [0, 0, 0]}}}}
  tappet: {{mass: 0.5, center: [0, 0.1, 0], inertia: [1e-3, 1e-3, 1e-3], points: {{P: [0, 0, 0]}}}}
joints:
  shaft: {{type: pin, from: ground.O, to: disc.O, axis: [0, 0, 1]}}
  guide: {{type: slide, from: ground.O, to: tappet.P, axis: [0, 1, 0]}}
drives: {{motor: {{joint: shaft, angle: 20*t}}}}
couplings:
  cam: {CAM}
analysis: {{duration: 0.3, samples: 3}}
"""
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
