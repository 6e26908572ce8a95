"""Stiff scenes, by name: what `method: auto` is to find."""

from __future__ import annotations

from tests.shared.published import spec_at

FRICTION = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  bar:
    shapes: [{type: rod, from: [0, 0, 0], to: [0, 0, -1], mass: 2}]
    points: {top: [0, 0, 0]}
joints: {pivot: {type: pin, from: ground.O, to: bar.top, axis: [0, 1, 0], initial: {angle: 60 deg, rate: 0}}}
forces: {rub: {type: friction, joint: pivot, torque: 5, speed: 1e-6}}
analysis: {duration: 2, samples: 201}
"""
# a pendulum on a spring as stiff as a steel wire, and one with a damper
WIRE = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  bob: {mass: 1, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], position: [0.6, 0, -0.8], points: {c: [0, 0, 0]}}
forces: {wire: {type: spring, from: ground.O, to: bob.c, stiffness: 1e8, length: 1, damping: DAMPING}}
analysis: {duration: 2, samples: 21}
"""

STIFF_SCENES = {
    "governor, 1 s": spec_at("governor", [0, 0.1, 0.2, 0.5, 1], 1e-9),
    "governor, 10 s": spec_at("governor", [0, 1, 2, 5, 10], 1e-9),
    "friction of 1e-6": FRICTION,
    "wire": WIRE.replace("DAMPING", "0"),
    "wire, damped": WIRE.replace("DAMPING", "2e4"),
}
