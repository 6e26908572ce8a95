"""Scenes of the reference tests that recur: the benchmarks, rods and pendulums, as text."""

from __future__ import annotations

UPPER = (
    "mass: 1.0, center: [0, 0, -0.5], inertia: [0.0842, 0.0850, 0.0017], points: {top: [0, 0, 0], end: [0, 0, -1.0]}"
)
HEAD = "heun: 1\ngravity: [0, 0, -9.81]\nground: {points: {O: [0, 0, 0]}}\n"


def double(analysis: str) -> str:
    """Two bars on ball joints, in space."""
    return (
        HEAD
        + f"""
bodies:
  upper:
    mass: 1.0
    center: [0, 0, -0.5]
    inertia: [0.0842, 0.0850, 0.0017]
    points: {{top: [0, 0, 0], end: [0, 0, -1.0]}}
    orientation: {{axis: [1, 0, 0], angle: 60 deg}}
    angular_velocity: {{vector: [0.3, -0.2, 1.0], frame: body}}
  lower:
    mass: 0.8
    center: [0, 0, -0.4]
    inertia: [0.0437, 0.0440, 0.0013]
    points: {{top: [0, 0, 0], end: [0, 0, -0.8]}}
    orientation: {{axis: [0, 1, 0], angle: 45 deg}}
    angular_velocity: {{vector: [-0.5, 0.4, 0.7], frame: body}}
joints:
  pivot: {{type: ball, from: ground.O, to: upper.top}}
  elbow: {{type: ball, from: upper.end, to: lower.top}}
analysis: {analysis}
"""
    )


def top(analysis: str) -> str:
    """A heavy symmetric top."""
    return (
        HEAD
        + f"""
bodies:
  top:
    mass: 1.0
    center: [0, 0, 0.3]
    inertia: [0.02, 0.02, 0.01]
    points: {{tip: [0, 0, 0]}}
    orientation: {{axis: [1, 0, 0], angle: 30 deg}}
    angular_velocity: {{vector: [0, 0, 60], frame: body}}
joints:
  tip: {{type: ball, from: ground.O, to: top.tip}}
analysis: {analysis}
"""
    )


def chain(count: int, analysis: str) -> str:
    """Bars on ball joints, released level, each turning a little about its axis."""
    start = "orientation: {axis: [0, 1, 0], angle: -90 deg}, angular_velocity: {vector: [0, 0, 0.1], frame: body}"
    bodies = "".join(f"  bar{k}: {{{UPPER}, {start}}}\n" for k in range(1, count + 1))
    joints = "  j1: {type: ball, from: ground.O, to: bar1.top}\n"
    joints += "".join(f"  j{k}: {{type: ball, from: bar{k - 1}.end, to: bar{k}.top}}\n" for k in range(2, count + 1))
    return f"{HEAD}bodies:\n{bodies}joints:\n{joints}analysis: {analysis}\n"


BENCHMARKS = {
    "double": lambda analysis: double(analysis), "top": lambda analysis: top(analysis),
    "chain10": lambda analysis: chain(10, analysis),
}  # fmt: skip


def rods(angles: list[float], rates: list[float], analysis: str = "{type: state}", point_masses: bool = False) -> str:
    """Rods of mass and length 1 hanging in the xy plane on pins, y up; angles of each from downward vertical [rad].

    point_masses: the mass at the rod's end instead.
    """
    mass = "shapes: [{type: rod, from: [0, 0, 0], to: [0, -1, 0], mass: 1}]"
    if point_masses:
        mass = "mass: 1, center: [0, -1, 0], inertia: [0, 0, 0]"
    bodies, joints = "", ""
    for k, (angle, rate) in enumerate(zip(angles, rates, strict=True)):
        pose = f"orientation: {{axis: [0, 0, 1], angle: {angle!r}}}, angular_velocity: [0, 0, {rate!r}]"
        bodies += f"  rod{k}: {{{mass}, points: {{a: [0, 0, 0], b: [0, -1, 0]}}, {pose}}}\n"
        owner = f"rod{k - 1}.b" if k else "ground.O"
        joints += f"  pin{k}: {{type: pin, from: {owner}, to: rod{k}.a, axis: [0, 0, 1]}}\n"
    head = HEAD.replace("[0, 0, -9.81]", "[0, -9.81, 0]")
    return f"{head}bodies:\n{bodies}joints:\n{joints}analysis: {analysis}\n"
