"""Scenes that rest, for the tests of rest poses and of motions that start there."""

from __future__ import annotations

import numpy as np

from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import rotation_from_vector

G = 9.81
HEAD = f"heun: 1\ngravity: [0, 0, -{G}]\nanalysis: {{type: rest}}\n"
POINTS = "ground: {points: {O: [0, 0, 0], A: [1, 0, 0]}}\n"
BAR = "mass: 1, center: [0, 0, -0.5], inertia: [0.08, 0.08, 0.001], points: {top: [0, 0, 0], end: [0, 0, -1]}"
BALL = "mass: 2, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {c: [0, 0, 0]}"
PIN = "type: pin, axis: [0, 1, 0]"


def triangle(rng: np.random.Generator) -> tuple[str, Array, float, float]:
    """Two bars from A and B of the ground to a common point, which swings about AB, and a spring from S to it."""
    S, k, free = np.array([0.4, *rng.uniform(-1.0, 1.0, 2)]), float(rng.uniform(20.0, 60.0)), 0.3
    elbow = [0.5, 0.6, -0.5]
    shapes = [f"[{{type: rod, from: {end}, to: {elbow}, mass: 1}}]" for end in ([0, 0, 0], [1, 0, 0])]
    bodies = (
        f"bodies: {{a: {{shapes: {shapes[0]}, points: {{o: [0, 0, 0], e: {elbow}}}}}, "
        f"b: {{shapes: {shapes[1]}, points: {{o: [1, 0, 0], e: {elbow}}}}}}}\n"
    )
    joints = "joints: {o: {type: ball, from: ground.O, to: a.o}, "
    joints += "A: {type: ball, from: ground.A, to: b.o}, e: {type: ball, from: a.e, to: b.e}}\n"
    spring = f"forces: {{s: {{type: spring, from: ground.S, to: a.e, stiffness: {k!r}, length: {free}}}}}"
    ground = POINTS.replace("A:", f"S: {S.tolist()}, A:")
    return HEAD + ground + bodies + joints + spring, S, k, free


def tree(rng: np.random.Generator) -> str:
    """Bars on balls, pins, universals, each with a spring to the ground."""
    n = 4
    bodies, joints, springs, grounds = [], [], [], ["O: [0, 0, 0]"]
    for i in range(n):
        axis = rotation_from_vector(rng.uniform(-1.0, 1.0, 3))[0].tolist()
        bodies.append(f"b{i}: {{{BAR}, near: {{orientation: {{axis: {axis}, angle: {rng.uniform(0.2, 1.0)!r}}}}}}}")
        on = "ground.O" if i == 0 else f"b{rng.integers(i)}.end"
        kind = rng.choice(["ball", "pin, axis: [0.6, 0.8, 0]", "universal, axis: [1, 0, 0], to_axis: [0, 1, 0]"])
        joints.append(f"j{i}: {{type: {kind}, from: {on}, to: b{i}.top}}")
        grounds.append(f"G{i}: {rng.uniform(-2.0, 2.0, 3).tolist()}")
        springs.append(f"s{i}: {{type: spring, from: ground.G{i}, to: b{i}.end, stiffness: 40, length: 0.5}}")
    blocks = {"bodies": bodies, "joints": joints, "forces": springs}
    ground = f"ground: {{points: {{{', '.join(grounds)}}}}}\n"
    return HEAD + ground + "\n".join(f"{name}: {{{', '.join(rows)}}}" for name, rows in blocks.items())
