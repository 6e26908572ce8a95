"""Starts beside a ridge: between two that come to rest in different poses, halved until they are near."""

from __future__ import annotations

import copy
from collections.abc import Callable

import numpy as np

from tests.shared.damped_flow import NoRest, Rest
from tests.shared.rest_scenes import Scene, drawn
from tests.shared.rest_trees import Equations, Vector

APART = 1e-3  # m: two poses
TRIES = 6  # of starts that come to rest elsewhere
WIDEST, NEAREST = 0.1, 1e-9  # rad or m: how far beside the ridge
Flown = Callable[[Equations, Vector], Rest]


def beside_a_ridge(seed: int, rest_of: Flown) -> tuple[Scene, float]:
    """A scene in the plane or in space whose start is so far beside a ridge: drawn again until one has a ridge."""
    rng = np.random.default_rng([seed, 77])
    while True:
        scene = drawn("plane" if rng.random() < 0.7 else "space", int(rng.integers(1_000_000)))
        if scene.tree.rods or scene.tree.lines:
            continue
        try:
            found = halved(scene, rng, rest_of)
        except NoRest:
            continue
        if found is not None:
            return found


def halved(scene: Scene, rng: np.random.Generator, rest_of: Flown) -> tuple[Scene, float] | None:
    """The scene started beside a ridge; None where all starts tried come to rest in one pose."""
    eq = Equations(scene.tree)
    a, one = eq.y0, rest_of(eq, eq.y0)
    for _ in range(TRIES):
        b = elsewhere(eq, rng)
        other = rest_of(eq, b)
        if np.abs(one.points - other.points).max() > APART:
            break
    else:
        return None
    if one.indifferent or other.indifferent:
        return None
    low, high, far = 0.0, 1.0, float(np.linalg.norm(b - a))
    beside = float(10 ** rng.uniform(np.log10(NEAREST), np.log10(WIDEST)))
    while (high - low) * far > beside:
        middle = 0.5 * (low + high)
        there = rest_of(eq, (1 - middle) * a + middle * b)
        low, high = (middle, high) if np.abs(there.points - one.points).max() < APART else (low, middle)
    return started(scene, (1 - high) * a + high * b), beside


def elsewhere(eq: Equations, rng: np.random.Generator) -> Vector:
    """Another start, of balls on the same side."""
    b = eq.y0.copy()
    for k, body in enumerate(eq.tree.bodies):
        own = slice(eq.y_at[k], eq.y_at[k + 1])
        if body.joint == "ball":
            q = rng.normal(size=4)
            b[own] = q / np.linalg.norm(q) * np.sign(q @ b[own])
        else:
            b[own] = rng.uniform(-1.0, 1.0, len(b[own])) * (0.4 if body.joint == "slide" else 3.0)
    return b


def started(scene: Scene, y: Vector) -> Scene:
    """The scene from another start."""
    new, eq = copy.deepcopy(scene), Equations(scene.tree)
    for k, body in enumerate(new.tree.bodies):
        body.start = [float(x) for x in y[eq.y_at[k] : eq.y_at[k + 1]]]
    again = Equations(new.tree)
    R = again.placed(again.y0)[0]
    for k, body in enumerate(new.tree.bodies):
        if body.joint in ("pin", "slide"):
            new.spec["joints"][f"j{k}"]["initial"] = {"angle" if body.joint == "pin" else "travel": body.start[0]}
        else:
            new.spec["bodies"][body.name]["orientation"] = {"matrix": R[k].tolist()}
    return new
