"""What each cause does alone: one solution a cause on absolute coordinates, which add up to the whole.

A force acts on the scene at rest in its pose, without weight or drives; gravity likewise; the drives give their second
derivatives to the scene at rest; the motion is what the velocities ask for, with nothing else.
"""

from __future__ import annotations

import numpy as np

from tests.oracle.loads import gathered, pushes
from tests.oracle.read import Model, Placed, Scene, State, model
from tests.oracle.rows import assemble
from tests.oracle.solve import Solution, answer, inertia, moved, scene_length
from tests.oracle.turns import Array


def at_rest(state: State) -> dict[str, Placed]:
    """The same pose, nothing moving."""
    zero = np.zeros(3)
    return {name: placed._replace(velocity=zero, angular_velocity=zero) for name, placed in state.items()}


def solve_by_cause(
    scene: Model | Scene, state: State, t: float = 0.0, about: Array | None = None, length: float | None = None
) -> dict[str, Solution]:
    """A solution a cause: gravity, every load by its name, drives, motion."""
    read = scene if isinstance(scene, Model) else model(scene)
    still, size = at_rest(state), scene_length(read, state)
    M, b = inertia(read, state)
    rows, moving = assemble(read, still, t), assemble(read, state, t)
    none = np.zeros(len(M))
    assert np.allclose(rows.gamma, 0.0, atol=1e-300)
    found = {}
    for name, parts in pushes(read, state, t).items():  # loads as they are at the true speeds
        own = {name: parts}
        motion = moved(rows, 0.0 * rows.acceleration, M, gathered(read, still, own), size)
        found[name] = answer(read, still, motion, own, size, about, length=length)
    motion = moved(rows, rows.acceleration, M, none, size)
    found["drives"] = answer(read, still, motion, {}, size, about, length=length)
    motion = moved(moving, -moving.gamma, M, -b, size)
    found["motion"] = answer(read, state, motion, {}, size, about, length=length)
    return found
