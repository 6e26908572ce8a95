"""The range of what is computed with."""

from __future__ import annotations

from heuncli.base.errors import HeunError
from tests.honesty.boundaries.part import Part, Row
from tests.shared.scenes import near, solved


def heavy(x: float) -> str:
    """A bar of so much mass hangs: refused when it is read, or its weight."""
    text = f"""
heun: 1
gravity: [0, 0, -0.01]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{bar: {{mass: {x!r}, center: [0, 0, 0], inertia: [0, 0, 0], points: {{a: [0, 0, 0]}}}}}}
joints: {{pivot: {{type: ball, from: ground.O, to: bar.a}}}}
"""
    try:
        found = solved(text)
    except HeunError as error:
        return f"refused: {error.problems[0].code}"
    near(found.joints["pivot"]["force"][0, 2], 0.01 * x, x, 1e-12)
    return "fine"


PART = Part(
    ("the range of what is computed with, SI",),
    rows=(
        Row("LEAST_MAGNITUDE", heavy, "refused: magnitude", "fine"),
        Row("MOST_MAGNITUDE", heavy, "fine", "refused: magnitude"),
    ),
)
