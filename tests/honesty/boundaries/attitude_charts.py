"""Charts of attitudes."""

from __future__ import annotations

import math

from heuncli.base.errors import HeunError
from tests.honesty.boundaries.part import Part, Row
from tests.shared.scenes import near, solved


def beside_a_half_turn(x: float) -> str:
    """A free body that starts 2 x before a half turn, in the global chart, and turns back: its angle after 1 s."""
    scene = f"""
heun: 1
bodies:
  wheel: {{mass: 1, center: [0, 0, 0], inertia: [1, 2, 3], angular_velocity: [0, 0, -1],
           orientation: {{axis: [0, 0, 1], angle: {math.pi - 2.0 * x!r}}}}}
analysis: {{times: [1], method: DOP853-rodrigues}}
"""
    try:
        R = solved(scene, reduce=False).bodies["wheel"]["rotation"][0]
    except HeunError as error:
        return f"refused: {error.problems[0].code}"
    near(R[:2, 0], [math.cos(math.pi - 2.0 * x - 1.0), math.sin(math.pi - 2.0 * x - 1.0)], 1.0)
    return "fine"


PART = Part(
    ("kernel: charts of attitudes",),
    rows=(Row("KERNEL.half_turn", beside_a_half_turn, "refused: half-turn", "fine"),),
    exempt={
        "KERNEL.chart_turn": "lengths of steps in a chart; tests/closed_forms/test_half_turns.py: none jumps",
    },
)
