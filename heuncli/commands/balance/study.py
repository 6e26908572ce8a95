"""The balance of a scene over a cycle: mass effects by orders, the weights that lower them, a flywheel."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli import tolerances
from heuncli.commands.balance.asked import NOTHING_ASKED, BalanceOptions
from heuncli.commands.balance.choice import CyclePlan, planned
from heuncli.commands.balance.cycle import MOST_SAMPLES, QUARTER, SAMPLES, Cycle, FollowedScene, axis_of, turning
from heuncli.commands.balance.effects import MassEffects, mass_effects
from heuncli.commands.balance.harmonics import tail
from heuncli.commands.balance.results import BalanceResults, OrderRow
from heuncli.commands.balance.rows import CycleTurning, all_rows, residual
from heuncli.commands.balance.verdicts import in_words
from heuncli.records import replace
from heuncli.results import Array
from heuncli.spec.models import Spec
from heuncli.study.model.error_places import placed
from heuncli.study.model.setup import draw
from heuncli.tree.prepare import PreparedScene, prepare

IN_TABLE = 1e-4  # of the largest order: smaller ones do not stand in a table unless they are asked for
MOST_ROWS = 12
GOING_DOWN = 2.0  # times: samples doubled must lower the highest orders by as much, else these are rounding


def balance(spec: Spec, asked: BalanceOptions = NOTHING_ASKED) -> BalanceResults:
    """The balance of a spec. Raises SpecError, SolveError where it has no cycle."""
    with placed(spec):
        return balanced(spec, asked)


def balanced(spec: Spec, asked: BalanceOptions) -> BalanceResults:
    """The balance of a spec. Errors name bodies, joints and sections, but not where these stand in the file."""
    scene = drawn(spec)
    plan = planned(scene, asked.cycle, asked.turns, asked.rate)
    about = asked.about if asked.about is not None else np.array(spec.foundation.about or (0.0, 0.0, 0.0))
    followed = turning(scene, plan)
    cycle, settled = sampled(followed, about)
    effects = mass_effects(cycle, about)
    found = with_loads(told(spec, plan, cycle, effects, about, settled, asked), spec, scene, plan, asked)
    if asked.weights:
        from heuncli.commands.balance.weights import counterbalanced  # where they are asked for

        found = replace(found, counterbalance=counterbalanced(spec, scene, plan, cycle, about, asked))
    if asked.flywheel is not None:
        from heuncli.commands.balance.wheel import with_wheel  # where one is asked for

        found = with_wheel(found, spec, scene, plan, asked.flywheel)
    return found


def with_loads(
    found: BalanceResults, spec: Spec, scene: PreparedScene, plan: CyclePlan, asked: BalanceOptions
) -> BalanceResults:
    """The results with the orders of what loads put on the shaft, where there are any."""
    if not scene.mechanism.loads and not scene.mechanism.gravity.any():
        return found
    from heuncli.commands.balance.load_torque import load_torque  # with all that solves loads

    own = load_torque(spec, scene, plan)
    if own.note or not own.rows:
        return replace(found, notes=(*found.notes, own.note) if own.note else found.notes)
    rows = tuple(row for row in own.rows if asked.orders is None or is_asked(row.order, asked.orders))
    return replace(found, orders={**found.orders, "load": rows}, mean={**found.mean, "load": own.mean})


def drawn(spec: Spec) -> PreparedScene:
    """The scene, assembled."""
    mechanism, _ = draw(spec._replace(sections={}))
    t = spec.analysis.times[0] if spec.analysis.type == "state" and spec.analysis.times else 0.0
    return prepare(mechanism, t)


def sampled(followed: FollowedScene, about: Array) -> tuple[Cycle, bool]:
    """The cycle at so many angles that the highest orders are rounding; whether they are."""
    count, before = SAMPLES * followed.turns, math.inf
    while True:
        cycle = followed.at(count)
        found = mass_effects(cycle, about)
        kinds = {"force": found.force, "moment": found.moment, "torque": found.half_slope}
        highest = max(tail(own, QUARTER, found.terms[name]) for name, own in kinds.items())
        rounding = highest < tolerances.CANCELS and highest * GOING_DOWN > before
        if highest <= tolerances.ORDERS_SETTLED or rounding or count >= MOST_SAMPLES:
            return cycle, count < MOST_SAMPLES
        count, before = 2 * count, highest


def told(
    spec: Spec, plan: CyclePlan, cycle: Cycle, effects: MassEffects, about: Array, settled: bool, asked: BalanceOptions
) -> BalanceResults:
    """What was found, by orders at the cycle's rate."""
    turning_so = CycleTurning(plan.turns, axis_of(cycle, plan.joint), plan.rate)
    scale = turning_so.scale
    found = all_rows(effects, turning_so)
    words = {name: in_words(rows) for name, rows in found.items()}
    if asked.orders is not None:
        found = {name: tuple(row for row in rows if is_asked(row.order, asked.orders)) for name, rows in found.items()}
    values = {
        "force": -scale * effects.force, "moment": -scale * effects.moment,
        "moment_orbital": -scale * effects.orbital, "moment_spin": -scale * effects.spin,
        "torque": scale * effects.half_slope[:, :, None],
    }  # fmt: skip
    least = {name: tolerances.ORDERS_SETTLED * scale * terms for name, terms in effects.terms.items()}
    return BalanceResults(
        title=spec.title, spec={"path": spec.path, "sha256": spec.sha256},
        coordinate=plan.coordinate, turns=plan.turns, rate=plan.rate, samples=len(cycle.angles), settled=settled,
        about=about, place=asked.place, axis=turning_so.axis, effects=effects, orders=found,
        words=words,
        mean={name: own.sum(axis=1).mean(axis=0) for name, own in values.items()},
        residual={name: residual(own, effects.angles, least[name.partition("_")[0]]) for name, own in values.items()},
        shown=shown(found) if asked.orders is None else asked.orders,
    )  # fmt: skip


def is_asked(order: float, orders: Sequence[float]) -> bool:
    """Whether an order is among those."""
    return any(abs(order - one) < tolerances.SAME_VALUE for one in orders)


def shown(found: dict[str, tuple[OrderRow, ...]]) -> tuple[float, ...]:
    """The orders that a table shows: up to the last that is no small part of the largest of its quantity."""
    last = 0.0
    for rows in found.values():
        largest = max((row.size for row in rows), default=0.0)
        last = max([last, *(row.order for row in rows if row.size > IN_TABLE * largest)])
    every = sorted({row.order for rows in found.values() for row in rows if row.order <= last})
    some = {row.order for rows in found.values() for row in rows if row.size > 0.0}
    return tuple(order for order in every if order == round(order) or order in some)[:MOST_ROWS]
