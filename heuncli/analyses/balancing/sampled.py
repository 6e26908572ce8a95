"""The mass effects of a cycle at nodes that tell all of it: even ones of what is smooth, else those of pieces."""

from __future__ import annotations

import math

import numpy as np

from heuncli.analyses.balancing.cycle import MOST_SAMPLES, Cycle, FollowedScene
from heuncli.analyses.balancing.effects import MassEffects, mass_effects
from heuncli.analyses.balancing.followed import SAMPLES
from heuncli.analyses.balancing.harmonics import tail
from heuncli.analyses.balancing.nodes import QUARTER
from heuncli.analyses.balancing.resolved import CycleResolver, scales_of
from heuncli.base import tolerances
from heuncli.base.records import replace
from heuncli.results.results import Array

BETWEEN = 0.25  # of the distance of even nodes: where steps are shorter a law bends there
FEW = 8  # angles by which it is told what their terms are
GOING_DOWN = 2.0  # times: samples doubled must lower the highest orders by as much, else these are rounding


def sampled(followed: FollowedScene, about: Array) -> tuple[Cycle, bool]:
    """The cycle at nodes that tell all of it, and whether they do: even ones where it is smooth, else on pieces."""
    cycle = evenly(followed, about) if followed.followed.is_smooth() else None
    return (cycle, True) if cycle is not None else on_pieces(followed, about)


def evenly(followed: FollowedScene, about: Array) -> Cycle | None:
    """The cycle at so many angles that the highest orders are rounding; None where it is not as smooth as that."""
    count, before = SAMPLES * followed.turns, math.inf
    while True:
        cycle = followed.at(followed.even(count))
        found = mass_effects(cycle, about)
        kinds = {"force": found.force, "moment": found.moment, "torque": found.half_slope}
        highest = max(tail(own, QUARTER, found.terms[name]) for name, own in kinds.items())
        rounding = highest < tolerances.CANCELS and highest * GOING_DOWN > before
        if highest <= tolerances.ORDERS_SETTLED or rounding:
            return cycle if is_seen(followed, cycle, about) else None
        if count >= MOST_SAMPLES * followed.turns:
            return None
        count, before = 2 * count, highest


def is_seen(followed: FollowedScene, cycle: Cycle, about: Array) -> bool:
    """Whether waves through the nodes tell the cycle where its run took short steps, and as laws in time ask for."""
    run, n = followed.followed, len(cycle.angles)
    x = np.union1d(run.short_steps(BETWEEN * run.length / n), run.given_in_time())
    if not len(x):
        return True
    there = columns_of(mass_effects(replace(cycle, states=followed.states(x)), about))
    effects = mass_effects(cycle, about)
    found = columns_of(effects)
    places = x if followed.rate > 0.0 else run.length - x
    off = np.abs(cycle.nodes.course(found)(places) - there)
    return bool((off <= tolerances.CANCELS * scales_of(parts_of(found), rounding_in(effects))(found)).all())


def on_pieces(followed: FollowedScene, about: Array) -> tuple[Cycle, bool]:
    """The cycle at the nodes of pieces between its breaks, and whether they tell all of it."""
    run = followed.followed

    def sample(x: Array) -> Array:
        cycle = Cycle(followed.scene.mechanism, run.cycle, followed.states(x), followed.scene.layout.size)
        return columns_of(mass_effects(cycle, about))

    first = mass_effects(followed.at(followed.even(FEW)), about)
    resolver = CycleResolver(sample, run.cycle, scales_of(parts_of(columns_of(first)), rounding_in(first)))
    resolver.resolve(run.breaks)
    resolver.probed(np.union1d(run.short_steps(BETWEEN * run.length / SAMPLES), run.given_in_time()))
    found = resolver.found()
    return followed.at(found.nodes), found.settled


def columns_of(effects: MassEffects) -> Array:
    """Force, both moments and torque of all bodies at unit rate, (n, columns)."""
    own = (effects.force, effects.orbital, effects.spin, effects.half_slope)
    return np.concatenate([x.reshape(len(x), -1) for x in own], axis=1)


def parts_of(columns: Array) -> list[int]:
    """How many of these columns are of force, moment and torque."""
    bodies = columns.shape[1] // 10
    return [3 * bodies, 6 * bodies, bodies]


def rounding_in(effects: MassEffects) -> list[float]:
    """What of force, moment and torque at unit rate is rounding."""
    return [tolerances.SUM_ROUNDING * effects.terms[name] for name in ("force", "moment", "torque")]
