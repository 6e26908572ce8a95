"""Bushings."""

from __future__ import annotations

import math

from heuncli.base.errors import HeunError
from tests.honesty.boundaries.part import Part, Row
from tests.shared.scenes import near, solved


def short_of_half_a_turn(x: float) -> str:
    """A wheel so far short of half a turn in its bushing: what that exerts."""
    scene = f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  wheel: {{mass: 1, center: [0, 0, 0], inertia: [1, 2, 3], points: {{c: [0, 0, 0]}},
           orientation: {{axis: [0, 0, 1], angle: {math.pi - x!r}}}}}
forces: {{mount: {{type: bushing, from: ground.O, to: wheel.c, turning: [1, 2, 5]}}}}
analysis: {{type: state}}
"""
    try:
        moment = solved(scene).forces["mount"]["moment"][0]
    except HeunError as error:
        return f"refused: {error.problems[0].code}"
    near(moment, [0.0, 0.0, -5.0 * (math.pi - x)], 15.0)
    return "fine"


PART = Part(
    ("bushings",),
    rows=(Row("TURNED_OVER", short_of_half_a_turn, "refused: bushing-turned", "fine"),),
    exempt={
        "NEARLY_TURNED_OVER": "why a run ended, told; tests/closed_forms/test_bushings.py: one that would turn over",
    },
)
