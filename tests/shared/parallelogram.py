"""A parallelogram of thin rods in the xy plane, upright and turning: on pins or balls, with any coupler."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from tests.oracle.published import four_bar


def parallelogram(rate: float, duration: float, samples: int, kinds: Sequence[str] = ("pin",) * 4,
                  coupler: float = 1.0) -> str:  # fmt: skip
    """Bars of 1 m and 1 kg on the joints A, B (ground) and C, D (coupler), the left one turning at -rate about z."""
    ends = {"A": ("ground.A", "left.foot"), "B": ("ground.B", "right.foot"),
            "C": ("left.top", "coupler.left"), "D": ("coupler.right", "right.top")}  # fmt: skip
    joints = [
        f"  {name}: {{type: {kind}, from: {a}, to: {b}{', axis: [0, 0, 1]' if kind == 'pin' else ''}}}"
        for (name, (a, b)), kind in zip(ends.items(), kinds, strict=True)
    ]
    return f"""
heun: 1
gravity: [0, -9.81, 0]
ground: {{points: {{A: [0, 0, 0], B: [1, 0, 0]}}}}
bodies:
  left:
    shapes: [{{type: rod, from: [0, 0, 0], to: [0, 1, 0], mass: 1}}]
    points: {{foot: [0, 0, 0], top: [0, 1, 0]}}
    angular_velocity: [0, 0, -{rate!r}]
  right:
    shapes: [{{type: rod, from: [1, 0, 0], to: [1, 1, 0], mass: 1}}]
    points: {{foot: [1, 0, 0], top: [1, 1, 0]}}
  coupler:
    shapes: [{{type: rod, from: [0, 1, 0], to: [{coupler!r}, 1, 0], mass: 1}}]
    points: {{left: [0, 1, 0], right: [{coupler!r}, 1, 0]}}
joints:
{chr(10).join(joints)}
analysis: {{duration: {duration!r}, samples: {samples}}}
"""


def parallelogram_in_line(crank: float, rocker: float) -> dict[str, Any]:
    """The four-bar of 1, 2, 1, 2 m folded on a line, a singular pose, as the oracle's dict, with two of its rates."""
    return four_bar(0.0, 0.0, 0.0, (1, 2, 1, 2), (crank, (rocker - crank) / 2, rocker))
