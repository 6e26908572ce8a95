"""The two bodies on balls of manual/theory.md, "Closed cases" 15, golden case A, as text."""

from __future__ import annotations

from tests.shared.bars import HEAD

GOLDEN_A = (
    HEAD
    + """
bodies:
  one: {mass: 2, center: [0.5, 0.1, -0.05], inertia: [0.2, 0.5, 0.6], points: {base: [0, 0, 0], joint: [1, 0.2, 0.1]},
        orientation: {rodrigues: [0.1, 0.2, 0.3]}, angular_velocity: [1, -2, 0.5]}
  two: {mass: 1.5, center: [0.4, -0.1, 0.2], inertia: [0.1, 0.3, 0.35], points: {base: [0, 0, 0]},
        orientation: {rodrigues: [-0.2, 0.4, 0.1]}, angular_velocity: [-0.5, 1.5, 2]}
joints:
  fixed: {type: ball, from: ground.O, to: one.base}
  link: {type: ball, from: one.joint, to: two.base}
"""
)
