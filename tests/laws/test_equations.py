"""Numbered equations that no function computes alone, on clouds of mass points: manual/theory.md, by number.

Those that are wrong in print are in test_errata.py; what heun computes has tests of its own, listed in the manual's
index of equations.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from heuncli.results.results import Array
from heuncli.scene.shapes.inertia import inertia_tensor, second_moment
from tests.shared.clouds import (
    Body,
    Cloud,
    body_of,
    cloud,
    derivative,
    gradient,
    links_of,
    rotation,
    spin_at,
    spins,
    variation_of,
)
from tests.shared.scenes import near, solved

EXACT = 1e-12
CLOUDS = range(4)


def momentum(c: Cloud, t: complex) -> Array:
    """M_v of the first link along the motion."""
    return c.m[0] @ np.cross(c.places(c.coordinates(t))[0], c.velocities(t)[0])


@pytest.mark.parametrize("seed", CLOUDS)
def test_16_to_21_one_body(seed: int) -> None:
    """M_v = J σ; its rate is the moment; in the body's components (dM/dt) + σ × M; Euler's rows in principal axes."""
    c = cloud(seed)
    b: Body = body_of(c)
    near(inertia_tensor(b.T) @ b.sigma, b.M, 1.0, EXACT)  # (18), and J and T give each other
    near(second_moment(inertia_tensor(b.T)), b.T, 1.0, EXACT)
    near(derivative(lambda t: momentum(c, t)), b.Mk, 1.0, EXACT)  # (17); (16) is its integral
    inner = derivative(lambda t: rotation(c.coordinates(t)[:3]).T @ momentum(c, t))
    near(inner + np.cross(b.body(b.sigma), b.body(b.M)), b.body(b.Mk), 1.0, EXACT)  # (19), (28)
    near(b.J @ b.sigmadot + np.cross(b.sigma, b.M), b.Mk, 1.0, EXACT)  # (20)
    A, P = np.linalg.eigh(b.J)
    s, d, k = (P.T @ x for x in (b.sigma, b.sigmadot, b.Mk))
    s, d, k = (np.linalg.det(P) * x for x in (s, d, k))
    for i, j, n in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        near(A[i] * d[i] + (A[n] - A[j]) * s[j] * s[n], k[i], 1.0, EXACT)  # (21)


@pytest.mark.parametrize("seed", CLOUDS)
def test_22_to_27_variations(seed: int) -> None:
    """d/dt Σ m ẋ·δx = δE + δ'A_k; δdθ − dδθ and δσ in the body's components; δE = M_v·δσ there."""
    c = cloud(seed)
    b, v = body_of(c), variation_of(c)

    def of_momenta(t: complex) -> Array:
        kappa = c.coordinates(t)[:3]
        x = c.a[0] @ rotation(kappa).T
        shift = np.cross(spins(kappa) @ (c.q[3:] + c.w[3:] * t), x)
        return np.sum(c.m[0][:, None] * np.cross(spin_at(c, t), x) * shift)

    work = np.sum(b.m[:, None] * b.a * np.cross(v.other, b.x))
    near(derivative(of_momenta), v.energy + work, 1.0, EXACT)  # (22), (26)
    near(work, b.Mk @ v.other, 1.0, EXACT)  # δ'A_k = M_k·δθ
    sigma, other = b.body(b.sigma), b.body(v.other)
    near(v.body_change - v.body_rate, np.cross(sigma, other), 1.0, EXACT)  # (24), (25), (27) in body components
    near(v.energy, b.body(b.M) @ v.body_change, 1.0, EXACT)  # (23)


@pytest.mark.parametrize("seed", CLOUDS)
def test_29_to_37_free_coordinates(seed: int) -> None:
    """Two links in six coordinates: partial velocities, momenta, energy, forces."""
    c = cloud(seed)
    eps, p = c.mass_matrix(c.q), c.mass_matrix(c.q) @ c.u
    for link in (0, 1):
        steps = gradient(lambda q, k=link: c.places(q)[k], c.q)  # type: ignore[misc]
        near(np.moveaxis(steps, -1, 0), c.partials(c.q)[link], 1.0, EXACT)  # (29), (30)
    near(c.along(c.velocities(0.0)), p, 1.0, EXACT)  # (31); (32): it is what impulses h_i make from rest

    def energy(q: Array, u: Array) -> Array:
        return 0.5 * (u @ c.mass_matrix(q) @ u)

    near(gradient(lambda u: energy(c.q, u), c.u), p, 1.0, EXACT)  # (35), (37)
    near(p @ c.u, 2.0 * energy(c.q, c.u), 1.0, EXACT)  # (33)
    k = c.along(c.accelerations)  # (34): the virtual work of m ẍ along each coordinate
    rate = derivative(lambda t: c.mass_matrix(c.coordinates(t)) @ c.rates(t))
    near(rate - gradient(lambda q: energy(q, c.u), c.q), k, 1.0, EXACT)  # (36)
    C = np.einsum("ilk,l,k->i", c.christoffel(), c.u, c.u)
    near(eps @ c.w + C, k, 1.0, EXACT)
    still = Cloud(c.m, c.a, c.joint, c.q, c.u, np.zeros(6))
    near(C, still.along(still.accelerations), 1.0, EXACT)  # C_i = Σ m ε_i·ẍ at q̈ = 0


@pytest.mark.parametrize("seed", CLOUDS)
def test_45_to_47_two_links(seed: int) -> None:
    """Velocities of the second link by both spins; virtual work of the momenta by the blocks of moment."""
    c = cloud(seed)
    W, V, R, S = spins(c.q[:3]), spins(c.q[3:]), rotation(c.q[:3]), rotation(c.q[3:])
    s1, s2 = W @ c.u[:3], V @ c.u[3:]
    near(c.velocities(0.0)[0], np.cross(s1, c.a[0] @ R.T), 1.0, EXACT)
    near(c.velocities(0.0)[1], np.cross(s1, R @ c.joint) + np.cross(s2, c.a[1] @ S.T), 1.0, EXACT)  # (46)
    b, turn = links_of(c), c.w  # any variation of the coordinates
    shifts = [np.einsum("inj,i->nj", e, turn) for e in c.partials(c.q)]
    work = [np.sum(m[:, None] * v * x) for m, v, x in zip(c.m, c.velocities(0.0), shifts, strict=True)]
    t1, t2 = W @ turn[:3], V @ turn[3:]
    near(work[0], b.own_first @ t1, 1.0, EXACT)  # (45)
    near(sum(work), (b.first + b.from_second) @ t1 + (b.second + b.from_first) @ t2, 1.0, EXACT)  # (47)


@pytest.mark.parametrize("seed", CLOUDS)
def test_50_52_parts_of_a_chain(seed: int) -> None:
    """What the first link loses in impulses and in forces the second one gains: r'' = −r', s'' = −s'."""
    c = cloud(seed)
    h, own = c.mass_matrix(c.q) @ c.u, c.q[::-1] + 2.0  # all impulses, from rest; those on the first link
    p1, p2 = (c.along(c.velocities(0.0), link) for link in (0, 1))
    near(own - p1, -((h - own) - p2), 1.0, EXACT)  # (50)
    k = c.along(c.accelerations)
    parts = []
    for link in (0, 1):
        rate = derivative(lambda t, n=link: c.mass_matrix(c.coordinates(t), n) @ c.rates(t))  # type: ignore[misc]
        slope = gradient(lambda q, n=link: 0.5 * (c.u @ c.mass_matrix(q, n) @ c.u), c.q)  # type: ignore[misc]
        parts.append(rate - slope)
    s = own - parts[0]
    near((k - own) - parts[1], -s, 1.0, EXACT)  # (52)


def test_56_the_spin_is_not_small() -> None:
    """A uniform connecting rod, r/l = 1/3, the crank square to the bore: 63.64 of it orbital, less 21.21 of spin."""
    text = (Path(__file__).parents[2] / "specs" / "slider_crank.yaml").read_text()
    text = text[: text.index("\nexpect:")].replace("phi: 60 deg", "phi: 90 deg")
    found = solved(text).foundation["mass_effect"]
    near(found["moment_orbital"][0, 2], -45.0 * 2.0**0.5, 60.0, EXACT)
    near(found["moment_spin"][0, 2], 15.0 * 2.0**0.5, 60.0, EXACT)
    near(found["moment_orbital"][0, 2] + found["moment_spin"][0, 2], -30.0 * 2.0**0.5, 60.0, EXACT)
