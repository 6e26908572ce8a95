"""Small scenes with an event of every kind, as text: branches, pulses, stops that are struck, ropes that catch."""

from __future__ import annotations

SLIDER = """
heun: 1
gravity: [0, 0, 0]
ground: {points: {O: [0, 0, 0]}}
bodies: {block: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {p: [0, 0, 0]}}}
joints: {guide: {type: slide, from: ground.O, to: block.p, axis: [1, 0, 0], initial: {travel: 0.2, speed: 1}}}
forces: {push: {type: torque, joint: guide, value: "%s"}}
analysis: {duration: 4, samples: 5}
"""
STOPS = "stops: {ends: {joint: guide, travel: [0, 1], restitution: 0.5}}"
EVENTS = {
    "branches": SLIDER
    % "-3*abs(guide.speed) if guide.travel > 1 and guide.speed > 0 else (4 if guide.travel < -1 else -1)",
    "pulses": SLIDER % "100*exp(-((guide.travel - 0.5)/0.0005)**2) + 50*exp(-((t - 2)/0.002)**2)",
    "angles": SLIDER % "0.3*atan2(sin(9*guide.travel), cos(9*guide.travel)) - max(guide.travel, 2*guide.speed)",
    "strikes": STOPS + SLIDER % "-2",
    "catches": """
heun: 1
gravity: [0, 0, -10]
ground: {points: {O: [0, 0, 0]}}
bodies: {ball: {mass: 2, center: [0, 0, -1], inertia: [1, 1, 1], velocity: [6, 0, 0]}}
joints:
  rope:
    {type: rod, from: ground.O, to: {body: ball, at: [0, 0, -1]}, tension_only: true, restitution: 0}
analysis: {duration: 2, samples: 7}
""",
    "rope": """
heun: 1
gravity: [0, 0, -10]
ground: {points: {O: [0, 0, 0]}}
bodies: {ball: {mass: 2, center: [0, 0, -1], inertia: [1, 1, 1], velocity: [6, 0, 0]}}
joints: {rope: {type: rod, from: ground.O, to: {body: ball, at: [0, 0, -1]}, tension_only: true}}
analysis: {duration: 3, samples: 7}
""",
}
