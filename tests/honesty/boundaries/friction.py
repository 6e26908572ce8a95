"""Friction that presses the joint that it rubs in."""

from __future__ import annotations

from heuncli.results.results import Results
from tests.honesty.boundaries.part import Part, Row
from tests.honesty.boundaries.scenes import verdict
from tests.shared.scenes import near


def adds_to_what_presses(x: float) -> str:
    """A sledge, its centre 1 m above its guide of 1 m, pulled at the guide: M = (P - f) h, and N = 2 |P - mu N|.

    So friction adds 2 mu = 1 - x to what presses, by 1 N that does.
    """
    mu = 0.5 * (1.0 - x)

    def right(found: Results) -> None:
        near(-found.forces["rub"]["value"][0], mu * 2.0 * 10.0 / (2.0 - x), 10.0)

    return verdict(f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  sledge: {{mass: 2, center: [0, 0, 1], inertia: [1, 1, 1], points: {{middle: [0, 0, 0]}}}}
joints: {{guide: {{type: slide, axis: [1, 0, 0], from: ground.O, to: sledge.middle, initial: {{travel: 0, speed: 1}}}}}}
forces:
  pull: {{type: force, on: sledge.middle, vector: [10, 0, 0]}}
  rub: {{type: friction, joint: guide, coefficient: {mu!r}, length: 1, speed: 1e-3}}
""", right)  # fmt: skip


PART = Part(
    ("kernel: friction",),
    rows=(Row("KERNEL.friction_left", adds_to_what_presses, "refused: friction-not-unique", "fine"),),
)
