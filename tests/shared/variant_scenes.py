"""Scenes with numbers to vary whose measures are known in closed form, for what looks along one number.

PENDULUM   let go at the angle a from rest: the greatest tension, at the bottom, is m g (3 - 2 cos a)
CANTILEVER a force F at the angle a to a bar of length L: its root holds F and the moment F L sin a
TWO_BARS   of lengths p and b between supports d apart, a weight W where they meet: a triangle of forces
"""

from __future__ import annotations

import math

PENDULUM = """\
heun: 1
title: A pendulum let go
parameters: {a: 40 deg, m: 2 kg, L: 500 mm, g: 9.81, idle: 3 mm}
gravity: [0, 0, -g]
ground: {points: {O: [0, 0, 0]}}
bodies:
  bob:
    shapes: [{type: point, at: [0, 0, -L], mass: m}]
    points: {top: [0, 0, 0]}
    orientation: {axis: [1, 0, 0], angle: a}
joints: {pivot: {type: pin, from: ground.O, to: bob.top, axis: [1, 0, 0]}}
analysis: {duration: 1.2, samples: 5}
"""
TENSION = "max joints.pivot.force"

CANTILEVER = """\
heun: 1
title: A force on a bar
parameters: {F: 0.2 kN, a: 40 deg, L: 500 mm, side: 0, at_once: 1.2}
ground: {points: {O: [0, 0, 0]}}
bodies:
  bar: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {root: [0, 0, 0], end: [L, 0, 0]}}
joints: {root: {type: weld, from: ground.O, to: bar.root}}
forces:
  pull: {type: force, on: bar.end, vector: [F*cos(a), F*sin(a), 0]}
  aside: {type: force, on: bar.root, vector: [0, 0, side]}
  switched: {type: force, on: bar.root, vector: [0, 0, 5 if at_once > 1.2 else 0]}
"""
ROOT = "joints.root.moment.z"  # what holds against the force's moment: -F L sin a

TWO_BARS = """\
heun: 1
title: Two bars and a weight
space: planar
parameters: {p: 0.5, b: 0.8, d: 1, W: 30}
ground: {points: {A: [0, 0, 0], B: [d, 0, 0]}}
bodies:
  one: {mass: 1, center: [0, 0, 0], inertia: 1, points: {A: [0, 0, 0], C: [p, 0, 0]}}
  two: {mass: 1, center: [0, 0, 0], inertia: 1, points: {B: [0, 0, 0], C: [b, 0, 0]}}
joints:
  A: {type: pin, from: ground.A, to: one.A}
  B: {type: pin, from: ground.B, to: two.B}
  C: {type: pin, from: one.C, to: two.C}
forces: {weight: {type: force, on: one.C, vector: [0, -W, 0]}}
"""
IN_BAR = "joints.C.force"  # the magnitude of what the bar b holds


def tension(a: float, m: float = 2.0, g: float = 9.81) -> float:
    """The greatest tension of the pendulum [N]; a [rad]."""
    return m * g * (3.0 - 2.0 * math.cos(a))


def angle_for(force: float, m: float = 2.0, g: float = 9.81) -> float:
    """The angle from which the pendulum pulls so hard [rad]."""
    return math.acos((3.0 - force / (m * g)) / 2.0)


def in_bar(b: float, p: float = 0.5, d: float = 1.0, W: float = 30.0) -> float:
    """What the bar b carries where it and p meet above or below the line of their supports [N]."""
    x = (p * p - b * b + d * d) / (2.0 * d)
    y = math.sqrt(p * p - x * x)
    # forces along the bars balance (0, -W): their components across the other bar
    return W * abs(x) * b / (d * y)
