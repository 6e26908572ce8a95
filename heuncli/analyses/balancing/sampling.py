"""Sample the mass effects of a cycle at nodes that resolve it: equally spaced ones if it is smooth, else nodes on
pieces.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.analyses.balancing.cycle import MAX_SAMPLES, Cycle, FollowedScene
from heuncli.analyses.balancing.cycle_nodes import TAIL_FRACTION
from heuncli.analyses.balancing.effects import MassEffects, compute_mass_effects
from heuncli.analyses.balancing.followed_run import SAMPLES_PER_TURN
from heuncli.analyses.balancing.harmonics import relative_tail
from heuncli.analyses.balancing.piece_resolver import CycleResolver, make_scales
from heuncli.base import tolerances
from heuncli.base.records import replace
from heuncli.results.results import Array

SHORT_STEP_FRACTION = 0.25  # of the distance of nodes: shorter steps of the run indicate a kink
FIRST_SAMPLES = 8  # angles for the size of the terms
MIN_REDUCTION = 2.0  # factor by which doubling the samples must lower the highest orders, else they are rounding


def sample_cycle(followed_scene: FollowedScene, reference_point: Array) -> tuple[Cycle, bool]:
    """Return the cycle at nodes that resolve it, and whether they do: equally spaced if it is smooth, else on
    pieces.
    """
    cycle = sample_evenly(followed_scene, reference_point) if followed_scene.followed_run.is_smooth() else None
    return (cycle, True) if cycle is not None else sample_on_pieces(followed_scene, reference_point)


def sample_evenly(followed_scene: FollowedScene, reference_point: Array) -> Cycle | None:
    """Return the cycle at enough angles that the highest orders are rounding; None if it is not smooth enough for
    that.
    """
    count, previous_tail = SAMPLES_PER_TURN * followed_scene.turns, math.inf
    while True:
        cycle = followed_scene.evaluate_cycle(followed_scene.make_even_nodes(count))
        effects = compute_mass_effects(cycle, reference_point)
        kinds = {"force": effects.force, "moment": effects.moment, "torque": effects.half_slope}
        largest_tail = max(relative_tail(own, TAIL_FRACTION, effects.terms[name]) for name, own in kinds.items())
        is_rounding = largest_tail < tolerances.CANCELS and largest_tail * MIN_REDUCTION > previous_tail
        if largest_tail <= tolerances.ORDERS_SETTLED or is_rounding:
            return cycle if is_resolved(followed_scene, cycle, reference_point) else None
        if count >= MAX_SAMPLES * followed_scene.turns:
            return None
        count, previous_tail = 2 * count, largest_tail


def is_resolved(followed_scene: FollowedScene, cycle: Cycle, reference_point: Array) -> bool:
    """Return whether the interpolant resolves the cycle where the run took short steps, and where laws in time require
    it.
    """
    run, n = followed_scene.followed_run, len(cycle.angles)
    x = np.union1d(run.find_short_steps(SHORT_STEP_FRACTION * run.length / n), run.find_time_law_places())
    if not len(x):
        return True
    exact = join_columns(compute_mass_effects(replace(cycle, states=followed_scene.compute_states(x)), reference_point))
    effects = compute_mass_effects(cycle, reference_point)
    columns = join_columns(effects)
    places = x if followed_scene.rate > 0.0 else run.length - x
    deviations = np.abs(cycle.nodes.interpolate(columns)(places) - exact)
    return bool(
        (
            deviations <= tolerances.CANCELS * make_scales(count_columns(columns), estimate_rounding(effects))(columns)
        ).all()
    )


def sample_on_pieces(followed_scene: FollowedScene, reference_point: Array) -> tuple[Cycle, bool]:
    """Return the cycle at the nodes of pieces between its breaks, and whether they resolve it."""
    run = followed_scene.followed_run

    def sample(x: Array) -> Array:
        cycle = Cycle(
            followed_scene.scene.mechanism,
            run.cycle,
            followed_scene.compute_states(x),
            followed_scene.scene.layout.size,
        )
        return join_columns(compute_mass_effects(cycle, reference_point))

    first_effects = compute_mass_effects(
        followed_scene.evaluate_cycle(followed_scene.make_even_nodes(FIRST_SAMPLES)), reference_point
    )
    resolver = CycleResolver(
        sample, run.cycle, make_scales(count_columns(join_columns(first_effects)), estimate_rounding(first_effects))
    )
    resolver.resolve(run.breaks)
    resolver.probe(
        np.union1d(
            run.find_short_steps(SHORT_STEP_FRACTION * run.length / SAMPLES_PER_TURN), run.find_time_law_places()
        )
    )
    resolved = resolver.collect_numbers()
    return followed_scene.evaluate_cycle(resolved.nodes), resolved.is_resolved


def join_columns(effects: MassEffects) -> Array:
    """Return force, both moments and torque of all bodies at unit rate, (n, columns)."""
    arrays = (effects.force, effects.orbital, effects.spin, effects.half_slope)
    return np.concatenate([x.reshape(len(x), -1) for x in arrays], axis=1)


def count_columns(columns: Array) -> list[int]:
    """Return the numbers of these columns that belong to force, moment and torque."""
    bodies = columns.shape[1] // 10
    return [3 * bodies, 6 * bodies, bodies]


def estimate_rounding(effects: MassEffects) -> list[float]:
    """Return the rounding level of force, moment and torque at unit rate."""
    return [tolerances.SUM_ROUNDING * effects.terms[name] for name in ("force", "moment", "torque")]
