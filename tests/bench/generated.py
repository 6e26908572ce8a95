"""Scenes of any size, as specs."""

from __future__ import annotations


def chain(n: int, duration: float) -> str:
    """A chain of n bars on ball joints, released level."""
    head = "heun: 1\ntitle: chain\ngravity: [0, 0, -9.81]\nground: {points: {O: [0, 0, 0]}}\nbodies:\n"
    bar = (
        "  b{}: {{mass: 1.0, center: [0, 0, -0.5], inertia: [0.0842, 0.0850, 0.0017], "
        "points: {{top: [0, 0, 0], end: [0, 0, -1]}}, orientation: {{axis: [0, 1, 0], angle: -90 deg}}}}\n"
    )
    joint = "  j{}: {{type: ball, from: {}, to: b{}.top}}\n"
    bodies = "".join(bar.format(i) for i in range(n))
    joints = "".join(joint.format(i, f"b{i - 1}.end" if i else "ground.O", i) for i in range(n))
    return f"{head}{bodies}joints:\n{joints}analysis: {{duration: {duration}, samples: 3, tolerance: 1e-6}}\n"
