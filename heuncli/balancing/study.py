"""The balance of a scene over a cycle: mass effects by orders, the weights that lower them, a flywheel."""

from __future__ import annotations

import numpy as np

from heuncli.balancing.asked import NOTHING_ASKED, BalanceOptions
from heuncli.balancing.choice import CyclePlan, planned, pressed_alone
from heuncli.balancing.cycle import axis_of, turning
from heuncli.balancing.effects import mass_effects
from heuncli.balancing.results import BalanceResults
from heuncli.balancing.rows import CycleTurning
from heuncli.balancing.sampled import sampled
from heuncli.balancing.told import is_asked, told
from heuncli.coupled_start.prepared import prepare_coupled
from heuncli.records import replace
from heuncli.spec.models import Spec
from heuncli.study.model.error_places import placed
from heuncli.study.model.setup import draw
from heuncli.tree.prepare import PreparedScene


def balance(spec: Spec, asked: BalanceOptions = NOTHING_ASKED) -> BalanceResults:
    """The balance of a spec. Raises SpecError, SolveError where it has no cycle."""
    with placed(spec):
        return balanced(spec, asked)


def balanced(spec: Spec, asked: BalanceOptions) -> BalanceResults:
    """The balance of a spec. Errors name bodies, joints and sections, but not where these stand in the file."""
    about = asked.about if asked.about is not None else np.array(spec.foundation.about or (0.0, 0.0, 0.0))
    if asked.period is not None:
        from heuncli.balancing.period import over_period  # with all that solves motions

        return over_period(spec, asked.period, asked, about)
    scene = drawn(spec)
    plan = planned(scene, asked.cycle, asked.turns, asked.rate)
    followed = turning(scene, plan)
    cycle, settled = sampled(followed, about)
    effects = mass_effects(cycle, about)
    turns = CycleTurning(plan.turns, axis_of(cycle, plan.joint), plan.rate)
    found = replace(told(spec, plan.coordinate, turns, effects, about, asked), settled=settled)
    found = replace(found, notes=(*found.notes, *pressed_alone(scene.mechanism)))
    found = with_loads(found, spec, scene, plan, asked)
    if asked.weights:
        from heuncli.balancing.weights import counterbalanced  # where they are asked for

        own = counterbalanced(spec, scene, plan, cycle, about, asked)
        found = replace(found, counterbalance=own, notes=tuple(dict.fromkeys((*found.notes, *own.notes))))
    if asked.flywheel is not None:
        from heuncli.balancing.wheel import with_wheel  # where one is asked for

        found = with_wheel(found, spec, scene, plan, asked.flywheel)
    return found


def with_loads(
    found: BalanceResults, spec: Spec, scene: PreparedScene, plan: CyclePlan, asked: BalanceOptions
) -> BalanceResults:
    """The results with the orders of what loads put on the shaft, where there are any."""
    if not scene.mechanism.loads and not scene.mechanism.gravity.any():
        return found
    from heuncli.balancing.load_torque import load_torque  # with all that solves loads

    own = load_torque(spec, scene, plan, asked.orders)
    found = replace(found, notes=(*found.notes, *own.notes))
    if not own.rows:
        return found
    rows = tuple(row for row in own.rows if asked.orders is None or is_asked(row.order, asked.orders))
    means, errors = {**found.mean, "load": own.mean}, {**found.mean_error, "load": own.error}
    return replace(found, orders={**found.orders, "load": rows}, mean=means, mean_error=errors)


def drawn(spec: Spec) -> PreparedScene:
    """The scene, assembled."""
    mechanism, _ = draw(spec._replace(sections={}))
    t = spec.analysis.times[0] if spec.analysis.type == "state" and spec.analysis.times else 0.0
    return prepare_coupled(mechanism, t)
