"""Pseudo-inertias: to and from mass, centre and inertia; moved; what a body can have."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.rotations import symmetric_eigenvalues
from heuncli.scene.shapes.inertia import pseudo_inertia, split_pseudo_inertia
from tests.shared.solids import carried, rotation


def points(rng: np.random.Generator) -> tuple[Array, Array]:
    return rng.uniform(0.1, 1.0, 12), rng.normal(size=(12, 3))


def summed(m: Array, x: Array) -> tuple[float, Array, Array]:
    """Mass, centre and inertia about it of mass points, from their definitions."""
    center = m @ x / m.sum()
    a = x - center
    inertia = sum(mi * (ai @ ai * np.eye(3) - np.outer(ai, ai)) for mi, ai in zip(m, a, strict=True))
    return float(m.sum()), center, np.asarray(inertia)


@pytest.mark.parametrize("seed", range(5))
def test_a_cloud_of_points(seed: int) -> None:
    m, x = points(np.random.default_rng(seed))
    y = np.append(x, np.ones((12, 1)), axis=1)
    P = (y * m[:, None]).T @ y
    mass, center, inertia = summed(m, x)
    assert np.allclose(pseudo_inertia(mass, center, inertia), P, rtol=0, atol=1e-14)
    for found, expected in zip(split_pseudo_inertia(P), (mass, center, inertia), strict=True):
        assert np.allclose(found, expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize("seed", range(5))
def test_moving_the_points_moves_the_sum(seed: int) -> None:
    rng = np.random.default_rng(seed)
    (m, x), R, p = points(rng), rotation(rng), rng.normal(size=3)
    P = pseudo_inertia(*summed(m, x))
    assert np.allclose(carried(P, R, p), pseudo_inertia(*summed(m, x @ R.T + p)), rtol=0, atol=1e-13)


def test_two_bodies_add() -> None:
    m, x = points(np.random.default_rng(8))
    both = pseudo_inertia(*summed(m[:5], x[:5])) + pseudo_inertia(*summed(m[5:], x[5:]))
    assert np.allclose(both, pseudo_inertia(*summed(m, x)), rtol=0, atol=1e-14)


def test_deviation_moments_are_off_the_diagonal() -> None:
    """Heun no. 16: D1 = sum m a2 a3 is T23, and minus the tensor's element."""
    m, x = points(np.random.default_rng(9))
    _, center, inertia = summed(m, x)
    P = pseudo_inertia(m.sum(), np.zeros(3), inertia)
    D1 = m @ ((x - center)[:, 1] * (x - center)[:, 2])
    assert np.allclose([P[1, 2], -inertia[1, 2]], D1, rtol=1e-13)


def test_principal_moments() -> None:
    R = rotation(np.random.default_rng(10))
    assert np.allclose(
        symmetric_eigenvalues((R @ np.diag([0.3, 0.5, 0.7]) @ R.T).tolist()), [0.3, 0.5, 0.7], rtol=1e-14
    )


REFUSED, ROUGH, POSSIBLE = {"inertia-not-physical"}, {"inertia-rounded"}, set[str]()


def judged(inertia: Array) -> set[str]:
    """What a spec is told about a body with this inertia."""
    text = f"heun: 1\nbodies: {{b: {{mass: 1, center: [0, 0, 0], inertia: {inertia.tolist()}}}}}\n"
    try:
        return {problem.code for problem in load("scene.yaml", text).warnings}
    except SpecError as error:
        return {problem.code for problem in error.problems}


@pytest.mark.parametrize(
    ("moments", "verdict"),
    [
        ((1.0, 2.0, 2.9), POSSIBLE),
        ((1.0, 1.0, 0.0), POSSIBLE),
        ((0.0, 0.0, 0.0), POSSIBLE),
        ((1.0, 2.0, 3.0), POSSIBLE),
        ((1.0, 2.0, 3.0001), ROUGH),
        ((1.0, 2.0, 3.0031), REFUSED),
        ((0.0, 0.0, 1.0), REFUSED),
        ((-0.1, 1.0, 1.0), REFUSED),
    ],
)
def test_what_a_body_can_have(moments: tuple[float, float, float], verdict: set[str]) -> None:
    """A1 + A2 >= A3 and none negative, in any axes and units."""
    R = rotation(np.random.default_rng(12))
    turned = R @ np.diag(moments) @ R.T
    assert judged((turned + turned.T) / 2) == verdict
    assert judged(1e6 * np.diag(moments)) == verdict
