"""Pseudo-inertias: to and from mass, centre and inertia; moved; what a body can have."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.results import Array
from heuncli.shapes.inertia import Verdict, judged, moved, principal, properties, pseudo_inertia
from tests.shared.solids import rotation


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
    for found, expected in zip(properties(P), (mass, center, inertia), strict=True):
        assert np.allclose(found, expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize("seed", range(5))
def test_moving_the_points_moves_the_sum(seed: int) -> None:
    rng = np.random.default_rng(seed)
    (m, x), R, p = points(rng), rotation(rng), rng.normal(size=3)
    P = pseudo_inertia(*summed(m, x))
    assert np.allclose(moved(P, R, p), pseudo_inertia(*summed(m, x @ R.T + p)), rtol=0, atol=1e-13)


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


def test_principal_axes() -> None:
    rng = np.random.default_rng(10)
    R = rotation(rng)
    moments, axes = principal(R @ np.diag([0.3, 0.5, 0.7]) @ R.T)
    assert np.allclose(moments, [0.3, 0.5, 0.7], rtol=1e-14)
    assert np.isclose(np.linalg.det(axes), 1.0)
    assert np.allclose(np.abs(axes.T @ R), np.eye(3), atol=1e-14)


@pytest.mark.parametrize(
    ("moments", "verdict"),
    [
        ((1.0, 2.0, 2.9), Verdict.POSSIBLE),
        ((1.0, 1.0, 0.0), Verdict.POSSIBLE),
        ((0.0, 0.0, 0.0), Verdict.POSSIBLE),
        ((1.0, 2.0, 3.0), Verdict.POSSIBLE),
        ((1.0, 2.0, 3.0001), Verdict.ROUGH),
        ((1.0, 2.0, 3.0031), Verdict.IMPOSSIBLE),
        ((0.0, 0.0, 1.0), Verdict.IMPOSSIBLE),
        ((-0.1, 1.0, 1.0), Verdict.NEGATIVE),
    ],
)
def test_what_a_body_can_have(moments: tuple[float, float, float], verdict: Verdict) -> None:
    R = rotation(np.random.default_rng(12))
    assert judged(R @ np.diag(moments) @ R.T) is verdict
    assert judged(1e6 * np.diag(moments)) is verdict
