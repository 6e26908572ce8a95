"""Couplings: axes of gears that are meant to be parallel, pitch points that are meant to lie on both; ropes."""

from __future__ import annotations

from heuncli.errors import HeunError
from heuncli.spec.load import load
from heuncli.study.workflow import solve
from tests.honesty.boundaries.part import Part, Row

PAIR = """
heun: 1
ground: {points: {A: [0, 0, 0], B: [0.4, 0, 0], P: [PLACE, 0, 0]}}
bodies:
  one: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}
  two: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}
joints:
  a: {type: pin, from: ground.A, to: one.o, axis: [0, 0, 1]}
  b: {type: pin, from: ground.B, to: two.o, axis: [0, TILT, 1]}
couplings: {mesh: {type: gear, of: [a, b], teeth: [20, 60], at: ground.P}}
analysis: {type: state}
"""


def meshes(tilt: float, place: float) -> str:
    """Two gears, whose axes are tilted against each other, at a pitch point."""
    try:
        solve(load("gears.yaml", text=PAIR.replace("TILT", repr(tilt)).replace("PLACE", repr(place))))
    except HeunError as error:
        return f"refused: {error.problems[0].code}"
    return "fine"


PART = Part(
    headings=("couplings",),
    rows=(
        Row("TYPED_AXES", lambda x: meshes(x, 0.1), "fine", "refused: gear-axes"),
        Row("TYPED_POINT", lambda x: meshes(0.0, 0.1 + 0.4 * x), "fine", "refused: gear-axes"),
    ),
    wanted={"STANDS_STILL": "whether a path has a direction where its slope is least"},
)
ROPES = Part(
    headings=("ropes over sheaves",),
    rows=(),
    wanted={
        "FLEET_ANGLE": "whether a rope has left the plane of its sheave: tests/laws/test_ropes.py has both sides",
        "FLEET_SEEN": "whether a slant is warned of",
        "ASKEW": "whether the axes of two sheaves are parallel",
        "OFF_SHEAVE": "whether a rope has left its sheave: tests/laws/test_ropes.py has both sides",
    },
)
