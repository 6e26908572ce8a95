"""Make neighbouring poses, displaced along admissible rates, so that a coincidence in one pose is not taken for a
rule.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import quaternion_product

DIRECTIONS = 3
SEED = 1901  # fixed: the same scene gives the same verdicts


def find_neighbour_poses(
    runner: Evaluator, t: float, state: Array, step_sizes: Sequence[float], holding: Array | None = None
) -> Evaluation | None:
    """Return poses displaced by each step size (rad, or relative to the size) along fixed pseudo-random admissible
    rates, in both directions.

    Returns None if nothing moves. holding: the closed contacts, by default as at the start.
    """
    layout = runner.layout
    rng = np.random.default_rng(SEED)
    random_states = np.repeat(state[None, :], DIRECTIONS, axis=0)
    slots = find_rate_indices(layout)
    random_states[:, slots] = rng.uniform(-1.0, 1.0, (DIRECTIONS, len(slots))) / layout.weights[slots]
    admissible = runner.evaluate(np.full(DIRECTIONS, t), random_states, holding=holding).states
    largest = np.abs(admissible[:, slots] * layout.weights[slots]).max(axis=1, initial=0.0)
    is_moving = largest > tolerances.MOVES
    if not is_moving.any():
        return None
    steps = [
        (k, sign * step / largest[k]) for k in np.flatnonzero(is_moving) for step in step_sizes for sign in (1.0, -1.0)
    ]
    displaced_states = [displace_along_rates(layout, admissible[k], step) for k, step in steps]
    evaluation = runner.evaluate(np.full(len(steps), t), np.array(displaced_states), holding=holding)
    is_closed = evaluation.gap <= tolerances.OPEN_GAP * layout.size
    if not is_closed.any():
        return None
    return evaluation.select(is_closed)


def find_rate_indices(layout: Layout) -> Array:
    """Return the indices of the controlled rates in the state."""
    groups = layout.tables["groups"]
    indices: Array = np.concatenate([np.arange(g["rates"], g["end"]) for g in groups]).astype(int)
    return indices


def displace_along_rates(layout: Layout, state: Array, factor: float) -> Array:
    """Return the state with its coordinates displaced by rates times a factor."""
    displaced_state = state.copy()
    for body in layout.bodies[layout.bodies["ball"] == 1]:
        attitude, rate = body["attitude_at"], body["rate_at"]
        q, w = state[attitude : attitude + 4], 0.5 * factor * state[rate : rate + 3]
        turn = quaternion_product(np.array([0.0, *w]), q)
        displaced_state[attitude : attitude + 4] = (q + turn) / np.sqrt(np.sum((q + turn) ** 2))
    for freedom in layout.freedoms:
        if freedom.q >= 0:
            displaced_state[freedom.q] += factor * state[freedom.u]
    return displaced_state
