"""A block on a slide under any push along it, as text."""

from __future__ import annotations

from typing import Any


def pushed_block(value: str, **analysis: Any) -> str:
    """A kilogram at rest on a slide, pushed along it."""
    asked = ", ".join(f"{k}: {v}" for k, v in {"duration": 10, "samples": 3, **analysis}.items())
    return f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  block: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{o: [0, 0, 0]}}}}
joints:
  guide: {{type: slide, from: ground.O, to: block.o, axis: [1, 0, 0]}}
forces:
  push: {{type: torque, joint: guide, value: "{value}"}}
analysis: {{{asked}}}
"""
