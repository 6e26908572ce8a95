"""A crank of 1 m and a rod of 2 m in front of a slider, as text with {DRIVES} to fill in: drives may lock it."""

from __future__ import annotations

LOCKING_CRANK = """\
heun: 1
space: planar
gravity: [0, -9.81, 0]
ground: {points: {O: [0, 0, 0]}}
bodies:
  crank:
    {mass: 1, center: [0.5, 0, 0], inertia: 0.1, points: {a: [0, 0, 0], b: [1, 0, 0]},
     near: {orientation: {axis: [0, 0, 1], angle: 0.5}}}
  rod: {mass: 1, center: [2, 0, 0], inertia: 0.1, points: {a: [1, 0, 0], b: [3, 0, 0]}}
  slider: {mass: 1, center: [3, 0, 0], inertia: 0.1, points: {a: [3, 0, 0]}}
joints:
  A: {type: pin, from: ground.O, to: crank.a}
  B: {type: pin, from: crank.b, to: rod.a}
  C: {type: pin, from: rod.b, to: slider.a}
  G: {type: slide, from: ground.O, to: slider.a, axis: [1, 0, 0]}
drives: {DRIVES}
analysis: {duration: 3, samples: 5}
"""
