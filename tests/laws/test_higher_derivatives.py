"""A law whose first derivative is finite can be linearised, whatever its second one is and those of its factors are."""

from __future__ import annotations

import math

import pytest

from heuncli.analyses.lagrange.study import LagrangeOptions, solve_lagrange
from heuncli.analyses.modes.study import compute_spec_modes
from heuncli.base.errors import SolveError
from heuncli.scene.file_format.load import load
from tests.oracle.values import to_yaml

# X is 0 in the pose; each has the derivative 0 there, by X -> 0 of the difference quotient
FLAT = (
    "X*sqrt(abs(X))", "sqrt(abs(X))*X", "-X*abs(X)", "X*sqrt(X**2)", "X*abs(X)**0.5", "abs(X)**1.5*sign(X)",
    "X*sqrt(abs(X))/(2 + X)", "X*(1 - sqrt(abs(X)))- X", "X*hypot(X, X)", "sin(X)*sqrt(abs(sin(X)))",
)  # fmt: skip
STEEP = (
    "sqrt(abs(X))*sign(X)",
    "sqrt(abs(X))",
    "X/sqrt(abs(X) + 1e-300)",
    "asin(1 - abs(X))",
    "X*0 + sqrt(X**2)",
    "atan2(X, X)*X",
)
PLACES = (0.0, 0.25)


def scene(law: str, place: float) -> str:
    """A cart of 2 kg on a spring of 18 N/m, with a law of X, the distance from the pose it starts in."""
    start = {"travel": place, "speed": 0}
    joint = {"type": "slide", "from": "ground.O", "to": "cart.o", "axis": [1, 0, 0], "initial": start}
    value = f"-18*(g.travel - {place!r}) + 3*({law.replace('X', f'(g.travel - {place!r})')})"
    return to_yaml({
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {"cart": {"mass": 2, "center": [0, 0, 0], "inertia": [1, 1, 1], "points": {"o": [0, 0, 0]}}},
        "joints": {"g": joint},
        "forces": {"pull": {"type": "torque", "joint": "g", "value": value}},
    })  # fmt: skip


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("law", FLAT)
def test_a_law_with_a_slope_has_modes_and_a_state_space(law: str, place: float) -> None:
    spec = load("scene.yaml", scene(law, place))
    (mode,) = compute_spec_modes(spec).modes
    assert mode.frequency == pytest.approx(3.0 / (2.0 * math.pi), rel=1e-12)
    space = solve_lagrange(spec, LagrangeOptions(state_space=True)).state_space
    assert space is not None
    assert space.A[1] == pytest.approx([-9.0, 0.0], abs=1e-12)


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("law", STEEP)
def test_a_law_without_a_slope_has_none(law: str, place: float) -> None:
    with pytest.raises(SolveError, match=r"has no derivative there|has a jump or kink there|no derivative"):
        solve_lagrange(load("scene.yaml", scene(law, place)), LagrangeOptions(state_space=True))
