"""A flat scene moves as the scene in its plane does: the same accelerations wherever it may be, in any orientation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.integration.run.runner import make_runner
from heuncli.multibody.reduction.compose import Reduction
from heuncli.multibody.reduction.plane import step as plane
from heuncli.multibody.tree.prepare import PreparedScene, prepare
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import build_with_cuts
from tests.oracle.values import to_yaml
from tests.shared.flat_in_any_plane import PLANES, flat

ROUNDING = 1e-9  # of the largest acceleration: poses of random loops are well conditioned to three digits or so
INSTANTS = np.array([0.0, 0.4, 1.3])


def prepared(scene: dict[str, Any]) -> PreparedScene:
    mechanism, _ = build_with_cuts(load("scene.yaml", to_yaml(scene)))
    return make_runner(prepare(mechanism))[0]


def reduction(scene: PreparedScene) -> Reduction:
    found = plane.step(scene)
    assert isinstance(found, Reduction), found
    return found


def elsewhere(small: PreparedScene, rng: np.random.Generator) -> Array:
    """States beside the start, closed."""
    layout = small.layout
    states = layout.y0 + 0.05 * rng.normal(size=(len(INSTANTS), layout.n_state))
    evaluator = Evaluator(make_runner(small)[0].layout)
    for _ in range(2):  # what is far from closed is closed to rounding by the second
        states = evaluator.evaluate(INSTANTS, states).states
    return states


def compare(scene: PreparedScene, found: Reduction, seed: int) -> None:
    E = plane.make_view(
        scene, next(n for n in plane.iter_normals(scene) if not any(plane.iter_departures(plane.make_view(scene, n))))
    ).E
    small, own = (Evaluator(make_runner(s)[0].layout) for s in (found.scene, scene))
    states = elsewhere(found.scene, np.random.default_rng(seed))
    embedded = found.embed(INSTANTS, states)
    flat, full = small.evaluate(INSTANTS, states), own.evaluate(INSTANTS, embedded)
    assert np.abs(full.gap).max() <= 1e-12 * scene.layout.size
    assert np.abs(full.states - embedded).max() <= 1e-12 * max(1.0, np.abs(embedded).max())
    scale = max(1.0, *(float(np.abs(full.bodies[name]).max()) for name in ("a", "alpha", "omega", "v")))
    for name, parts in {"r": (0, 1), "v": (0, 1), "a": (0, 1), "omega": (0, 1, 2), "alpha": (0, 1, 2)}.items():
        here, there = flat.bodies[name][..., parts], (full.bodies[name] @ E.T)[..., parts]
        assert np.abs(here - there).max() <= ROUNDING * scale, name
    for k, y in enumerate(states):
        back = found.restrict(float(INSTANTS[k]), embedded[k])
        again = found.embed(INSTANTS[k : k + 1], back[None])[0]
        assert np.abs(again - embedded[k]).max() <= 1e-12 * max(1.0, np.abs(embedded[k]).max())
        assert np.abs(back - y).max() <= 1e-12 * max(1.0, np.abs(y).max())


@pytest.mark.parametrize("own_axes", [False, True])
@pytest.mark.parametrize("upright", [False, True])
@pytest.mark.parametrize("name", PLANES)
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.third
def test_accelerations(name: str, upright: bool, own_axes: bool, seed: int) -> None:
    """Upright ones whatever acts on them, and those that are their own mirror image; states there and back."""
    scene = prepared(flat(seed, name, upright, own_axes))
    compare(scene, reduction(scene), seed)
