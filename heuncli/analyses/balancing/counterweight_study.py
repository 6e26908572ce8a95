"""Find the requested counterweights of a scene, with the remaining orders and their effect on the loads."""

from __future__ import annotations

import math

import numpy as np

from heuncli.analyses.balancing.candidates import WeightPlace
from heuncli.analyses.balancing.counterweights import Counterweight, add_weights, find_least_weights
from heuncli.analyses.balancing.cycle import Cycle, find_cycle_axis, make_followed_scene
from heuncli.analyses.balancing.cycle_plan import CyclePlan
from heuncli.analyses.balancing.effects import compute_mass_effects
from heuncli.analyses.balancing.load_comparison import compare_loads
from heuncli.analyses.balancing.options import BalanceOptions, WeightRequest
from heuncli.analyses.balancing.order_rows import CycleRotation, compute_rounding, make_all_rows
from heuncli.analyses.balancing.results import Counterbalance, CounterweightResult
from heuncli.analyses.balancing.sampling import sample_cycle
from heuncli.analyses.balancing.verdicts import format_remaining_orders
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import replace
from heuncli.base.spelling import suggest
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec


def find_counterbalance(
    spec: Spec, scene: PreparedScene, plan: CyclePlan, cycle: Cycle, reference_point: Array, options: BalanceOptions
) -> Counterbalance:
    """Find the requested counterweights. Raises SolveError [no-counterweight, radius-needed]."""
    places = [find_place(scene.mechanism, weight) for weight in options.weights]
    objective = options.minimise or ("mix" if len({place.body for place in places}) < len(places) else "force")
    lever = options.lever if options.lever is not None else scene.layout.size
    parts = {"force": (1.0, 0.0), "moment": (0.0, 1.0), "mix": (1.0, 1.0 / lever)}[objective]
    solution = find_least_weights(cycle, places, reference_point, *parts)
    heavier = add_weights(scene.mechanism, solution.weights)
    heavier_cycle = sample_cycle(make_followed_scene(replace(scene, mechanism=heavier), plan), reference_point)[0]
    effects, rotation = (
        compute_mass_effects(heavier_cycle, reference_point),
        CycleRotation(plan.turns, find_cycle_axis(cycle, plan.joint), plan.rate),
    )
    rows = make_all_rows(effects, rotation, compute_rounding(effects, rotation.scale))
    before, after, notes = compare_loads(spec, scene, heavier, plan, reference_point)
    return Counterbalance(
        weights=tuple(to_result(weight) for weight in solution.weights),
        objective=objective,
        lever=lever if objective == "mix" else None,
        several=solution.several,
        orders=rows,
        summaries={name: format_remaining_orders(own) for name, own in rows.items()},
        loads_without=before,
        loads_with=after,
        notes=notes,
    )


def find_place(mechanism: Mechanism, weight: WeightRequest) -> WeightPlace:
    """Find a place by the names of its body and point. Raises SolveError [no-counterweight]."""
    names = [body.name for body in mechanism.bodies]
    option = f"--counterweight {weight.body}.{weight.point}"
    if weight.body not in names:
        hint = suggest(weight.body, names, "bodies")
        raise SolveError(Problem("no-counterweight", f"{option}: no body has this name", hint=hint))
    k = names.index(weight.body)
    points = mechanism.bodies[k].points
    if weight.point not in points:
        hint = suggest(weight.point, [*points], f"points of {weight.body}")
        raise SolveError(Problem("no-counterweight", f"{option}: the body has no such point", hint=hint))
    return WeightPlace(k, f"{weight.body}.{weight.point}", np.array(points[weight.point]), weight.radius)


def to_result(weight: Counterweight) -> CounterweightResult:
    """Convert a counterweight to its result, with the names of body and point."""
    body, _, place = weight.weight_place.name.partition(".")
    product = math.sqrt(float(weight.product @ weight.product))
    return CounterweightResult(
        body=body, place=place, product=product, angle=weight.angle, mass=weight.mass, radius=weight.radius,
        vector=weight.product, reference_direction=weight.reference_direction, position=weight.position,
    )  # fmt: skip
