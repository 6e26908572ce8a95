"""A spring or actuator between two points of one body: it moves nothing, and the cuts between its points carry it."""

from __future__ import annotations

from math import sqrt

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from tests.shared.scenes import solved

BAR = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  bar:
    shapes: [{type: cylinder, from: [0, 0, 0], to: [1, 0, 0], radius: 20 mm, density: 7850}]
    points: {a: [0, 0, 0], b: [1, 0, 0], c: [0.3, 0, 0], d: [0.7, 0, 0.4]}
joints: {pivot: {type: pin, from: ground.O, to: bar.a, axis: [0, 1, 0]}}
FORCES
sections:
  left: {body: bar, at: [0.1, 0, 0], normal: [1, 0, 0]}
  middle: {body: bar, at: [0.5, 0, 0], normal: [1, 0, 0], first_axis: [0, 1, 0]}
analysis: {duration: 0.6, samples: 4}
"""
TIE = "forces: {tie: {type: TYPE, from: bar.c, to: bar.d, VALUE}}"
LENGTH = 0.4 * sqrt(2.0)


@pytest.mark.parametrize(("kind", "value", "force"), [
    ("actuator", "value: '1000*t'", lambda t: 1000.0 * t),
    ("actuator", "value: 1e7", lambda t: 1e7 + 0.0 * t),
    ("spring", "stiffness: 1000, length: 0.5, damping: 30", lambda t: 1000.0 * (0.5 - LENGTH) + 0.0 * t),
])  # fmt: skip
def test_it_moves_nothing_and_cuts_between_carry_it(kind, value, force) -> None:  # type: ignore[no-untyped-def]
    """The very bits of the motion without it; in between its force F (1, 0, 1)/√2, of moment (0.4 - 0.2) F/√2."""
    without = solved(BAR.replace("FORCES", ""))
    found = solved(BAR.replace("FORCES", TIE.replace("TYPE", kind).replace("VALUE", value)))
    for key in ("position", "velocity", "angular_acceleration"):
        assert np.array_equal(found.bodies["bar"][key], without.bodies["bar"][key])
    assert np.array_equal(found.joints["pivot"]["force"], without.joints["pivot"]["force"])
    assert np.array_equal(found.foundation["force"], without.foundation["force"])
    F = force(found.time)
    tie, size = found.forces["tie"], np.abs(F).max()
    assert np.abs(tie["value"] - F).max() <= 1e-13 * size
    assert not tie["rate"].any() and not tie["power"].any()
    own, other = found.sections["middle"], without.sections["middle"]
    across = F / sqrt(2.0)
    for key, wanted in (("N", across), ("Q2", across), ("M1", across * 0.2), ("Q1", 0.0), ("T", 0.0), ("M2", 0.0)):
        assert np.abs(own[key] - other[key] - wanted).max() <= 1e-12 * max(size, 100.0)
    assert np.abs(found.sections["left"]["N"] - without.sections["left"]["N"]).max() <= 1e-12 * max(size, 100.0)
    assert not without.energy["work"].any() and not found.energy["work"].any()
    assert found.accuracy["balance_residual"] < 1e-13


PAIR = "forces: {tie: {type: TYPE, from: ground.O, to: bar.a, VALUE}}"


@pytest.mark.parametrize(("kind", "value", "fine"), [
    ("actuator", "value: 3", False),
    ("actuator", "value: 3*t", False),
    ("actuator", "value: 0", True),
    ("spring", "stiffness: 100, length: 0.1", False),
    ("spring", "stiffness: 100, length: 0", True),
    ("spring", "stiffness: 0, length: 0.1, damping: 1", True),
])  # fmt: skip
@pytest.mark.parametrize("analysis", ["", "analysis: {duration: 0.6, samples: 4}"])
def test_points_that_coincide_give_no_direction(kind: str, value: str, fine: bool, analysis: str) -> None:
    """Else a value would be told that acts on nothing."""
    text = BAR[: BAR.index("analysis")] + analysis
    text = text.replace("FORCES", PAIR.replace("TYPE", kind).replace("VALUE", value))
    if fine:
        assert not solved(text).forces["tie"]["value"].any()
        return
    with pytest.raises(SolveError) as raised:
        solved(text)
    (problem,) = raised.value.problems
    assert problem.code == "no-direction"
    assert "the points of forces.tie coincide" in problem.message
