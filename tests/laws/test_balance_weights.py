"""Counterweights keep what they promise: put into the scene as point masses they leave what was told, and no less."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

from heuncli.analyses.balancing.results import BalanceResults, CounterweightResult, WeightRequest
from heuncli.base.errors import SolveError
from heuncli.base.records import replace
from tests.shared.cycling import balance_of, four_bar

SEEDS = range(3)
PLACES = {
    "crank": (WeightRequest("crank", "A", 0.05),),
    "coupler": (WeightRequest("coupler", "B", 0.03),),
    "crank and coupler": (WeightRequest("crank", "A", None), WeightRequest("coupler", "C", 0.2)),
    "rocker": (WeightRequest("rocker", "D", 0.04),),
}


def linkage(seed: int) -> dict[str, Any]:
    return four_bar(np.random.default_rng(seed))


def with_points(scene: dict[str, Any], weights: tuple[CounterweightResult, ...]) -> dict[str, Any]:
    """The scene with bodies that hang on to others by a weld: a point mass each, as who builds it would draw it."""
    own = copy.deepcopy(scene)
    for k, weight in enumerate(weight for weight in weights if weight.mass > 0.0):
        place = weight.position.tolist()
        own["bodies"][f"w{k}"] = {
            "mass": weight.mass,
            "center": [0, 0, 0],
            "inertia": [0, 0, 0],
            "points": {"c": [0, 0, 0]},
        }
        own["joints"][f"w{k}"] = {"type": "weld", "from": {"body": weight.body, "at": place}, "to": f"w{k}.c"}
    return own


def sum_of(found: BalanceResults, what: str, lever: float) -> float:
    """What was minimised."""
    force, moment = found.residual["force"].rms, found.residual["moment"].rms
    return {"force": force**2, "moment": moment**2, "mix": force**2 + (moment / lever) ** 2}[what]


@pytest.mark.heavy
@pytest.mark.parametrize("what", ["force", "moment", "mix"])
@pytest.mark.parametrize("places", PLACES)
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.sixth
def test_a_weight_leaves_what_it_promised(seed: int, places: str, what: str) -> None:
    scene = linkage(seed)
    found = balance_of(scene, weights=PLACES[places], minimise=what, lever=0.1)
    own = found.counterbalance
    assert own is not None
    there = balance_of(with_points(scene, own.weights))
    for name in ("force", "moment"):
        told = own.loads_with[name].rms
        assert told == pytest.approx(there.residual[name].rms, rel=1e-9)
    assert sum_of(there, what, 0.1) <= sum_of(found, what, 0.1) * (1.0 + 1e-12)
    before = own.loads_without["drive"].rms
    assert before == pytest.approx(found.residual["torque"].rms, rel=1e-9)  # nothing else loads this linkage


@pytest.mark.heavy
@pytest.mark.parametrize("places", ["crank", "crank and coupler", "rocker"])
def test_no_weight_beside_it_leaves_less(places: str) -> None:
    """Turned or moved by a little, a weight of the same mass leaves no less of what was to be least."""
    scene = linkage(1)
    own = balance_of(scene, weights=PLACES[places], minimise="mix", lever=0.1).counterbalance
    assert own is not None and all(weight.mass > 0.0 for weight in own.weights)
    best = sum_of(balance_of(with_points(scene, own.weights)), "mix", 0.1)
    for factor in (0.999, 1.001):
        lighter = tuple(scaled(weight, factor) for weight in own.weights)
        assert sum_of(balance_of(with_points(scene, lighter)), "mix", 0.1) > best


def scaled(weight: CounterweightResult, factor: float) -> CounterweightResult:
    """The weight with another mass at its place, as another product at the same radius is."""
    return replace(weight, mass=factor * weight.mass)


def test_a_weight_that_hangs_on_its_radius_asks_for_it() -> None:
    with pytest.raises(SolveError, match="depends on its radius") as error:
        balance_of(linkage(0), weights=(WeightRequest("coupler", "B", None),))
    assert error.value.problems[0].code == "radius-needed"
