"""Neighbouring poses: moved a little along admissible rates, so that no accident of one pose is taken for a law."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.motion.integration.evaluator import Evaluator, Recovered
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import quaternion_product

DIRECTIONS = 3
SEED = 1901  # fixed: the same scene gives the same verdicts


def neighbours(
    runner: Evaluator, t: float, state: Array, by: Sequence[float], holding: Array | None = None
) -> Recovered | None:
    """Poses displaced by each of `by` (rad, or of the size) along fixed pseudo-random admissible rates, both ways.

    None if nothing moves. holding: the contacts that are closed, by default as at the start.
    """
    layout = runner.layout
    rng = np.random.default_rng(SEED)
    start = np.repeat(state[None, :], DIRECTIONS, axis=0)
    slots = rate_slots(layout)
    start[:, slots] = rng.uniform(-1.0, 1.0, (DIRECTIONS, len(slots))) / layout.weights[slots]
    admissible = runner.recovered(np.full(DIRECTIONS, t), start, holding=holding).states
    largest = np.abs(admissible[:, slots] * layout.weights[slots]).max(axis=1, initial=0.0)
    moving = largest > tolerances.MOVES
    if not moving.any():
        return None
    steps = [(k, sign * step / largest[k]) for k in np.flatnonzero(moving) for step in by for sign in (1.0, -1.0)]
    moved = [displaced(layout, admissible[k], step) for k, step in steps]
    found = runner.recovered(np.full(len(steps), t), np.array(moved), holding=holding)
    closed = found.gap <= tolerances.OPEN_GAP * layout.size
    if not closed.any():
        return None
    return found.at(closed)


def rate_slots(layout: Layout) -> Array:
    """Places of the controlled rates in the state."""
    groups = layout.tables["groups"]
    found: Array = np.concatenate([np.arange(g["rates"], g["end"]) for g in groups]).astype(int)
    return found


def displaced(layout: Layout, state: Array, by: float) -> Array:
    """The state with its coordinates moved by rates * by."""
    moved = state.copy()
    for body in layout.bodies[layout.bodies["ball"] == 1]:
        attitude, rate = body["attitude_at"], body["rate_at"]
        q, w = state[attitude : attitude + 4], 0.5 * by * state[rate : rate + 3]
        turn = quaternion_product(np.array([0.0, *w]), q)
        moved[attitude : attitude + 4] = (q + turn) / np.sqrt(np.sum((q + turn) ** 2))
    for freedom in layout.freedoms:
        if freedom.q >= 0:
            moved[freedom.q] += by * state[freedom.u]
    return moved
