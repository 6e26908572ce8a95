"""Two bars in line between two fixed points, with any sag: the nearer to straight, the nearer to singular."""

from __future__ import annotations

KINDS = {
    "pins and a line": ("pin, axis: [0, 1, 0]", "line, axis: [0, 1, 0]", "pin, axis: [0, 1, 0]"),
    "pins": ("pin, axis: [0, 1, 0]",) * 3,
    "balls": ("ball",) * 3,
    "a universal": ("ball", "ball", "universal, axis: [0, 1, 0], to_axis: [0, 0, 1]"),
}


def stretched_chain(h: float, load: str, kinds: str = "pins and a line", more: str = "") -> str:
    """Two bars of mass 1 kg; h: the sag of their joint."""
    left, middle, right = KINDS[kinds]
    return f"""
heun: 1
ground: {{points: {{A: [0, 0, 0], B: [2, 0, 0]}}}}
bodies:
  l: {{mass: 1, center: [0.5, 0, {-h / 2!r}], inertia: [0.01, 0.08, 0.08], points: {{a: [0, 0, 0], c: [1, 0, {-h!r}]}}}}
  r: {{mass: 1, center: [1.5, 0, {-h / 2!r}], inertia: [0.01, 0.08, 0.08], points: {{c: [1, 0, {-h!r}], b: [2, 0, 0]}}}}
joints:
  A: {{type: {left}, from: ground.A, to: l.a}}
  C: {{type: {middle}, from: l.c, to: r.c}}
  B: {{type: {right}, from: r.b, to: ground.B}}
forces: {{push: {{type: force, on: l.c, vector: {load}}}}}
{more}
"""
