"""Balance a scene over a cycle: orders of the mass effects, counterweights that reduce them, and a flywheel."""

from __future__ import annotations

import numpy as np

from heuncli.analyses.balancing.cycle import find_cycle_axis, make_followed_scene
from heuncli.analyses.balancing.cycle_plan import CyclePlan, describe_cam_assumptions, plan_cycle
from heuncli.analyses.balancing.effects import compute_mass_effects
from heuncli.analyses.balancing.options import DEFAULT_OPTIONS, BalanceOptions
from heuncli.analyses.balancing.order_rows import CycleRotation
from heuncli.analyses.balancing.results import BalanceResults
from heuncli.analyses.balancing.sampling import sample_cycle
from heuncli.analyses.balancing.summary import is_requested, to_results
from heuncli.base.records import replace
from heuncli.multibody.coupled_start.prepare_coupled import prepare_coupled
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.setup import attach_locations, build_with_cuts


def balance(spec: Spec, options: BalanceOptions = DEFAULT_OPTIONS) -> BalanceResults:
    """Return the balance of a spec. Raises SpecError; SolveError [no-cycle] if it has no cycle."""
    with attach_locations(spec):
        return compute_balance(spec, options)


def compute_balance(spec: Spec, options: BalanceOptions) -> BalanceResults:
    """Return the balance of a spec. Errors name bodies, joints and sections, but not their location in the file."""
    reference_point = options.about if options.about is not None else np.array(spec.foundation.about or (0.0, 0.0, 0.0))
    if options.period is not None:
        from heuncli.analyses.balancing.period import balance_over_period  # with all that solves motions

        return balance_over_period(spec, options.period, options, reference_point)
    scene = assemble_scene(spec)
    plan = plan_cycle(scene, options.cycle, options.turns, options.rate)
    followed_scene = make_followed_scene(scene, plan)
    cycle, is_resolved = sample_cycle(followed_scene, reference_point)
    effects = compute_mass_effects(cycle, reference_point)
    rotation = CycleRotation(plan.turns, find_cycle_axis(cycle, plan.joint), plan.rate)
    results = replace(
        to_results(spec, plan.coordinate, rotation, effects, reference_point, options), is_resolved=is_resolved
    )
    results = replace(results, notes=(*results.notes, *describe_cam_assumptions(scene.mechanism)))
    results = add_load_torque(results, spec, scene, plan, options)
    if options.weights:
        from heuncli.analyses.balancing.counterweight_study import find_counterbalance  # where they are asked for

        counterbalance = find_counterbalance(spec, scene, plan, cycle, reference_point, options)
        results = replace(
            results, counterbalance=counterbalance, notes=tuple(dict.fromkeys((*results.notes, *counterbalance.notes)))
        )
    if options.flywheel is not None:
        from heuncli.analyses.balancing.flywheel_study import add_flywheel  # where one is asked for

        results = add_flywheel(results, spec, scene, plan, options.flywheel)
    return results


def add_load_torque(
    results: BalanceResults, spec: Spec, scene: PreparedScene, plan: CyclePlan, options: BalanceOptions
) -> BalanceResults:
    """Return the results with the orders of the torque of the loads on the shaft, if there are any."""
    if not scene.mechanism.loads and not scene.mechanism.gravity.any():
        return results
    from heuncli.analyses.balancing.load_torque import compute_load_torque  # with all that solves loads

    torque = compute_load_torque(spec, scene, plan, options.orders)
    results = replace(results, notes=(*results.notes, *torque.notes))
    if not torque.rows:
        return results
    rows = tuple(row for row in torque.rows if options.orders is None or is_requested(row.order, options.orders))
    means, errors = {**results.mean, "load": torque.mean}, {**results.mean_error, "load": torque.error}
    return replace(results, orders={**results.orders, "load": rows}, mean=means, mean_error=errors)


def assemble_scene(spec: Spec) -> PreparedScene:
    """Return the assembled scene."""
    mechanism, _ = build_with_cuts(spec._replace(sections={}))
    t = spec.analysis.times[0] if spec.analysis.type == "state" and spec.analysis.times else 0.0
    return prepare_coupled(mechanism, t)
