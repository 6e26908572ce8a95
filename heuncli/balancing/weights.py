"""The counterweights of a scene as asked for, with what is left and what they cost."""

from __future__ import annotations

import math

import numpy as np

from heuncli.balancing.asked import AskedWeight, BalanceOptions
from heuncli.balancing.candidates import WeightPlace
from heuncli.balancing.choice import CyclePlan
from heuncli.balancing.cost import cost
from heuncli.balancing.counterweights import Weight, applied, least
from heuncli.balancing.cycle import Cycle, axis_of, turning
from heuncli.balancing.effects import mass_effects
from heuncli.balancing.results import Counterbalance, PlacedWeight
from heuncli.balancing.rows import CycleTurning, all_rows, rounding_of
from heuncli.balancing.sampled import sampled
from heuncli.balancing.verdicts import in_words
from heuncli.errors import Problem, SolveError
from heuncli.mechanism.model import Mechanism
from heuncli.nearest import did_you_mean
from heuncli.records import replace
from heuncli.results import Array
from heuncli.spec.models import Spec
from heuncli.tree.prepare import PreparedScene


def counterbalanced(
    spec: Spec, scene: PreparedScene, plan: CyclePlan, cycle: Cycle, about: Array, asked: BalanceOptions
) -> Counterbalance:
    """The weights that are asked for. Raises SolveError where a place is none, or the weights are not told."""
    places = [place_of(scene.mechanism, weight) for weight in asked.weights]
    what = asked.minimise or ("mix" if len({place.body for place in places}) < len(places) else "force")
    lever = asked.lever if asked.lever is not None else scene.layout.size
    parts = {"force": (1.0, 0.0), "moment": (0.0, 1.0), "mix": (1.0, 1.0 / lever)}[what]
    found = least(cycle, places, about, *parts)
    heavier = applied(scene.mechanism, found.weights)
    there = sampled(turning(replace(scene, mechanism=heavier), plan), about)[0]
    effects, turns = mass_effects(there, about), CycleTurning(plan.turns, axis_of(cycle, plan.joint), plan.rate)
    rows = all_rows(effects, turns, rounding_of(effects, turns.scale))
    before, after, notes = cost(spec, scene, heavier, plan, about)
    return Counterbalance(
        weights=tuple(told(weight) for weight in found.weights),
        minimised=what, lever=lever if what == "mix" else None, several=found.several,
        orders=rows, words={name: in_words(own) for name, own in rows.items()}, before=before, after=after, notes=notes,
    )  # fmt: skip


def place_of(mechanism: Mechanism, weight: AskedWeight) -> WeightPlace:
    """A place by its names."""
    names = [body.name for body in mechanism.bodies]
    option = f"--counterweight {weight.body}.{weight.point}"
    if weight.body not in names:
        hint = did_you_mean(weight.body, names, "bodies")
        raise SolveError(Problem("no-counterweight", f"{option}: no body has this name", hint=hint))
    k = names.index(weight.body)
    points = mechanism.bodies[k].points
    if weight.point not in points:
        hint = did_you_mean(weight.point, [*points], f"points of {weight.body}")
        raise SolveError(Problem("no-counterweight", f"{option}: the body has no such point", hint=hint))
    return WeightPlace(k, f"{weight.body}.{weight.point}", np.array(points[weight.point]), weight.radius)


def told(weight: Weight) -> PlacedWeight:
    """A weight by its names."""
    body, _, place = weight.at.name.partition(".")
    product = math.sqrt(float(weight.product @ weight.product))
    return PlacedWeight(
        body=body, place=place, product=product, angle=weight.angle, mass=weight.mass, radius=weight.radius,
        vector=weight.product, first=weight.first, at=weight.position,
    )  # fmt: skip
