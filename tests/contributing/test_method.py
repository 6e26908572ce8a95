"""A method of integration is its coefficients and a row."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from tests.contributing.addition import Addition, Edit, after, answers, heun

RALSTON2 = Addition(
    "A method",
    {
        "heuncli/motion/integration/methods/explicit.py": (
            after("from heuncli.motion.integration.methods.method import GLOBAL, RECENTRED, Method\n", """
RALSTON2 = Method(
    name="Ralston2", order=2, has_fixed_step=True, nodes=(0.0, 2 / 3), stages=(((0, 2 / 3),),),
    solution=((0, 1 / 4), (1, 3 / 4)),
)
"""),
        ),
        "heuncli/base/method_rows.py": (
            Edit("METHODS = (\n", """METHODS = (
    MethodRow("Ralston2", 2, "explicit", "fixed", "quaternion", "of second order the least error", "explicit.RALSTON2"),
"""),
        ),
    },
)  # fmt: skip
SWINGS = """\
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies: {a: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}}
joints: {u: {type: slide, from: ground.O, to: a.c, axis: [1, 0, 0], initial: {travel: 1, speed: 0}}}
forces: {k: {type: torque, joint: u, value: -u.travel}}
analysis: {times: [0, 2]}
"""


def test_a_method(tmp_path: Path) -> None:
    """It is listed, taken in any case, and of half the step errs by a quarter: cos(2) of a mass on a spring."""
    folder = RALSTON2.made_in(tmp_path)
    assert "Ralston2" in heun(folder, "methods").stdout
    coarse, fine = (
        answers(folder, SWINGS, ["final coordinates.u.travel"], "--method", "ralston2", "--step", step)[0]
        - math.cos(2.0)
        for step in ("0.02", "0.01")
    )
    assert coarse / fine == pytest.approx(4.0, rel=0.05)


def test_its_list() -> None:
    assert RALSTON2.is_as_listed()
