"""A disc on three rods that nearly meet in one point: how near to a singular pose it stands is one number."""

from __future__ import annotations

COUPLE = "{type: couple, on: disc, vector: [0, 0, 1]}"


def three_rods(off: float, mass: float = 1.0, analysis: str = "", load: str = COUPLE) -> str:
    """A disc on three rods, the third `off` past the point where the others meet, and a couple of 1 N m."""
    return f"""
heun: 1
space: planar
gravity: [0, 0, 0]
ground: {{points: {{A: [-2, 0, 0], B: [0, 2, 0], C: [{off!r}, -3, 0]}}}}
bodies:
  disc:
    mass: {mass!r}
    center: [0, 0, 0]
    inertia: [{mass!r}, {mass!r}, {mass!r}]
    points: {{a: [-1, 0, 0], b: [0, 1, 0], c: [{off!r}, -1, 0]}}
joints:
  r1: {{type: rod, from: ground.A, to: disc.a}}
  r2: {{type: rod, from: ground.B, to: disc.b}}
  r3: {{type: rod, from: ground.C, to: disc.c}}
forces: {{m: {load}}}
{analysis}
"""
