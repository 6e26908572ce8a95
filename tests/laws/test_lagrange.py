"""Laws of Lagrange's equations on random trees and closed chains, driven and free."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.analyses.lagrange.coordinates import choose_coordinates, make_candidate_rows, select_independent
from heuncli.analyses.lagrange.equations import VelocityTerms, make_partials
from heuncli.analyses.lagrange.freed_scene import Instant, make_instant
from heuncli.analyses.lagrange.results import LagrangeResults
from heuncli.analyses.lagrange.study import LagrangeOptions
from heuncli.analyses.lagrange.study import compute_results as told_at
from heuncli.motion.integration.evaluator import CAUSES
from heuncli.motion.linearisation.displacements import displace
from heuncli.motion.linearisation.linearise import linearise
from heuncli.scene.file_format.load import load
from tests.oracle.values import to_yaml
from tests.shared.loops import loop_scene
from tests.shared.scenes import solved
from tests.shared.trees import tree_scene

SCENES = [("tree", seed) for seed in range(24)] + [("loop", seed) for seed in [*range(12), *range(1000, 1016)]]
DIGITS = 1e-11  # of what terms are summed from; closed chains of random joints lose three digits
QUICK = 1e-4  # [rad] or [m]: of central differences, whose error is its square and rounding over it


PROPER = [("tree of pins", seed) for seed in range(10)] + [
    ("loop of pins", seed) for seed in [*range(8), *range(1000, 1006)]
]
PINS: dict[str, Any] = {"kinds": ("pin", "slide"), "free": 0.0}  # whose rates are those of coordinates


def scene_of(kind: str, seed: int) -> dict[str, Any]:
    more = PINS if kind.endswith("of pins") else {}
    scene, _ = tree_scene(seed, **more) if kind.startswith("tree") else loop_scene(seed, **more)
    return {**scene, "analysis": {"type": "state"}}


def looked_at(kind: str, seed: int, **asked: Any) -> tuple[Instant, LagrangeResults]:
    spec = load("scene.yaml", to_yaml(scene_of(kind, seed)))
    at = make_instant(spec, None, None)
    return at, told_at(spec, at, LagrangeOptions(**asked))


@pytest.mark.parametrize(("kind", "seed"), SCENES)
@pytest.mark.third
def test_the_equations_are_those_of_the_run(kind: str, seed: int) -> None:
    """e is symmetric and positive, E that of the energy, q'' and the drives those of the run, F = E."""
    _, found = looked_at(kind, seed)
    results = solved(scene_of(kind, seed))
    assert np.linalg.eigvalsh(found.epsilon).min() > 0.0
    assert found.residual <= DIGITS
    assert found.energy == pytest.approx(float(results.energy["kinetic"][0]), rel=DIGITS, abs=1e-12)
    assert found.reciprocal_energy == pytest.approx(found.energy, rel=1e-9, abs=1e-12)
    for name, rate, acceleration in zip(found.names, found.rates, found.accelerations, strict=True):
        joint, _, quantity = name.rpartition(".")
        block = results.coordinates.get(joint, {})
        if quantity in block:
            turns = quantity == "angle" and "angular_acceleration" in block
            assert block["rate" if quantity == "angle" else "speed"][0] == pytest.approx(rate, rel=1e-9, abs=1e-9)
            second = block["angular_acceleration" if turns else "acceleration"][0]
            assert second == pytest.approx(acceleration, rel=1e-8, abs=1e-8)


def matrices(at: Instant, names: tuple[str, ...], moved: float, rates: np.ndarray[Any, Any]) -> tuple[Any, Any, Any]:
    """e at the place to which so long a motion at these rates leads, and what makes C there."""
    layout = at.freed_scene.layout
    by = choose_coordinates(at.freed_scene.scene, at.linear_equations, at.freed_scene.driven_coordinates, names)
    state = displace(layout, at.state, moved * (by.S @ rates))
    here = at.freed_scene.runner.evaluate(np.array([at.t]), state[None, :], holding=at.holding)
    found = linearise(layout, at.t, here.states[0], at.holding)
    by = choose_coordinates(at.freed_scene.scene, found, at.freed_scene.driven_coordinates, names)
    epsilon = by.S.T @ found.mass @ by.S
    terms = VelocityTerms(
        at.freed_scene, by, make_partials(layout, found, by.S), epsilon, at.t, here.states[0], at.holding
    )
    return epsilon, terms, by


@pytest.mark.parametrize(("kind", "seed"), PROPER)
@pytest.mark.third
def test_the_rate_of_the_inertia_is_what_the_coriolis_matrix_says(kind: str, seed: int) -> None:
    """e' = G + G' along any motion: e' - 2 G is antisymmetric. e' by differences, of coordinates proper alone."""
    at, found = looked_at(kind, seed)
    rates = np.random.default_rng(seed).normal(size=len(found.names))
    ahead, behind = (matrices(at, found.names, sign * QUICK, rates)[0] for sign in (1.0, -1.0))
    slope = (ahead - behind) / (2.0 * QUICK)
    _, terms, _ = matrices(at, found.names, 0.0, rates)
    G = terms.coriolis_matrix(rates)
    size = np.abs(found.epsilon).max() * max(1.0, np.abs(rates).max()) * 100.0
    assert np.abs(slope - G - G.T).max() <= 1e-6 * size
    assert np.abs(G @ rates - terms.compute_terms(rates[None, :])[0]).max() <= 1e-10 * size


@pytest.mark.parametrize(("kind", "seed"), PROPER)
@pytest.mark.third
def test_the_symbols_make_the_matrix(kind: str, seed: int) -> None:
    """gamma by unit rates and G by the rates of the scene are two routes to one matrix."""
    _, found = looked_at(kind, seed, christoffel=True)
    assert found.gamma is not None
    by_symbols = np.einsum("ilk,l->ik", found.gamma, found.rates)
    size = max(np.abs(found.gamma).max(), np.abs(found.epsilon).max()) * max(np.abs(found.rates).max(), 1.0)
    assert np.abs(by_symbols - found.coriolis_matrix).max() <= 1e-9 * size
    assert np.abs(found.gamma - found.gamma.transpose(0, 2, 1)).max() == 0.0
    assert found.alpha is not None
    free = np.einsum("ilk,l,k->i", found.alpha, found.rates, found.rates) + found.eta @ (
        found.total_force + found.drives
    )
    assert np.abs(free - found.accelerations).max() <= 1e-9 * max(np.abs(found.accelerations).max(), 1.0)


@pytest.mark.parametrize("seed", [1, 25, 30, 32, 33, 1001, 1010])
@pytest.mark.third
def test_other_coordinates(seed: int) -> None:
    """With other coordinates, q' = R r', e becomes R' e R, k and C by parts R' k; the energy stays."""
    at, found = looked_at("loop of pins", seed)
    spec = load("scene.yaml", to_yaml(scene_of("loop of pins", seed)))
    by = choose_coordinates(at.freed_scene.scene, at.linear_equations, at.freed_scene.driven_coordinates, found.names)
    rows = make_candidate_rows(at.freed_scene.layout, at.linear_equations)
    scaled = {name: row @ by.S for name, row in rows.items()}
    others = select_independent(
        scaled, [[name for name in scaled if name not in found.names], list(scaled)], len(found.names)
    )
    R = np.linalg.inv(np.array([scaled[name] for name in others]))
    second = told_at(spec, at, LagrangeOptions(coordinates=tuple(others)))
    size = np.abs(R).max() ** 2 * np.abs(found.epsilon).max()
    assert np.abs(second.epsilon - R.T @ found.epsilon @ R).max() <= 1e-9 * size
    assert np.abs(second.total_force - R.T @ found.total_force).max() <= 1e-9 * np.abs(R).max() * max(
        np.abs(found.total_force).max(), 1.0
    )
    assert second.energy == pytest.approx(found.energy, rel=1e-9)


WITH_BALLS = {1, 5, 1004}  # among the loops: turns about the world's axes have no column of their own


@pytest.mark.parametrize(("kind", "seed"), [case for case in PROPER if case[1] not in WITH_BALLS])
@pytest.mark.third
def test_forces_are_what_their_causes_accelerate(kind: str, seed: int) -> None:
    """k by virtual work is e times the accelerations that each cause alone makes of the scene without drives."""
    at, found = looked_at(kind, seed)
    layout, mechanism = at.freed_scene.layout, at.freed_scene.layout.mechanism
    by = choose_coordinates(at.freed_scene.scene, at.linear_equations, at.freed_scene.driven_coordinates, found.names)
    causes = at.freed_scene.runner.evaluate(np.array([at.t]), at.state[None, :], causes=True, holding=at.holding).causes
    assert causes is not None
    made = found.epsilon @ by.rows @ causes.freedoms["udot"][0].T  # (f, causes)
    alone: dict[str, Any] = {}
    for applied, own in mechanism.iter_load_rows():
        alone[applied.name] = alone.get(applied.name, 0.0) + made[:, own].sum(axis=1)
    alone["gravity"] = made[:, len(layout.tables["loads"]) + CAUSES.index("gravity")]
    size = max(float(np.abs(k).max()) for k in alone.values()) + 1e-12
    for name, k in found.forces.items():
        assert np.abs(alone[name] - k).max() <= 1e-9 * size
