"""Clouds of mass points on one or two links, in free coordinates: what equations of rigid bodies are tried on.

All functions are analytic, also of complex numbers, so that derivatives are taken by complex steps and keep all digits.
Coordinates are Rodrigues' numbers, three a link; places are from the fixed point, world axes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from heuncli.results.results import Array

STEP = 1e-30
Function = Callable[[complex], Array]


def derivative(f: Function) -> Array:
    """df/dt at t = 0."""
    return np.asarray(f(1j * STEP)).imag / STEP


def gradient(f: Callable[[Array], Array], x: Array) -> Array:
    """df/dx_i, i on the last axis."""
    return np.stack([derivative(lambda t, e=e: f(x + t * e)) for e in np.eye(len(x))], axis=-1)  # type: ignore[misc]


def hat(a: Array) -> Array:
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def rotation(kappa: Array) -> Array:
    """R = 1 + 2 (hat + hat^2)/(1 + kappa^2)."""
    return np.eye(3) + 2.0 / (1.0 + kappa @ kappa) * (hat(kappa) + hat(kappa) @ hat(kappa))


def spins(kappa: Array) -> Array:
    """W: the angular velocity, world axes, for the rate of each Rodrigues number, in columns."""
    return 2.0 / (1.0 + kappa @ kappa) * (np.eye(3) + hat(kappa))


def dot(a: Array, b: Array) -> Array:
    """Of vectors on the last axis, of complex numbers as of real ones."""
    return np.asarray(np.sum(a * b, axis=-1))


@dataclass(frozen=True)
class Cloud:
    """Two links: masses and places of their points in body axes; joint: of the second link, on the first.

    q (6,), u, w: coordinates, rates and second derivatives at t = 0; q(t) = q + u t + w t^2 / 2.
    """

    m: tuple[Array, Array]
    a: tuple[Array, Array]
    joint: Array
    q: Array
    u: Array
    w: Array

    def coordinates(self, t: complex) -> Array:
        return np.asarray(self.q + self.u * t + 0.5 * self.w * t * t)

    def rates(self, t: complex) -> Array:
        return np.asarray(self.u + self.w * t)

    def places(self, q: Array) -> tuple[Array, Array]:
        """x of all points, (n, 3) of each link."""
        R, S = rotation(q[:3]), rotation(q[3:])
        return self.a[0] @ R.T, R @ self.joint + self.a[1] @ S.T

    def partials(self, q: Array) -> tuple[Array, Array]:
        """eps_i = dx/dq_i of all points, (6, n, 3) of each link."""
        R, S, W, V = rotation(q[:3]), rotation(q[3:]), spins(q[:3]), spins(q[3:])
        own, far, hung = self.a[0] @ R.T, R @ self.joint, self.a[1] @ S.T
        first = [np.cross(W[:, i], own) for i in range(3)] + [0.0 * own] * 3
        second = [np.cross(W[:, i], far) + 0.0 * hung for i in range(3)] + [np.cross(V[:, i], hung) for i in range(3)]
        return np.array(first), np.array(second)

    def velocities(self, t: complex) -> tuple[Array, Array]:
        """Of all points, along the motion."""
        first, second = (np.einsum("inj,i->nj", e, self.rates(t)) for e in self.partials(self.coordinates(t)))
        return first, second

    @property
    def accelerations(self) -> tuple[Array, Array]:
        """Of all points at t = 0."""
        first, second = (derivative(lambda t, k=k: self.velocities(t)[k]) for k in (0, 1))  # type: ignore[misc]
        return first, second

    def mass_matrix(self, q: Array, link: int | None = None) -> Array:
        """eps_ik, (6, 6), of one link or of both: 2E = sum eps_ik u_i u_k."""
        parts = [np.einsum("n,inj,knj->ik", m, e, e) for m, e in zip(self.m, self.partials(q), strict=True)]
        return parts[0] + parts[1] if link is None else parts[link]

    def along(self, vectors: tuple[Array, Array], link: int | None = None) -> Array:
        """Sum of eps_i . m v over the points of one link or of both, (6,)."""
        parts = [
            np.einsum("n,inj,nj->i", m, e, v)
            for m, e, v in zip(self.m, self.partials(self.q), vectors, strict=True)
        ]  # fmt: skip
        return parts[0] + parts[1] if link is None else parts[link]

    def christoffel(self, link: int | None = None) -> Array:
        """gamma^(i)_lk = (d eps_il/dq_k + d eps_ik/dq_l - d eps_lk/dq_i)/2, (6, 6, 6)."""
        D = gradient(lambda q: self.mass_matrix(q, link), self.q)
        return np.asarray(0.5 * (D + D.transpose(0, 2, 1) - D.transpose(2, 0, 1)))


def cloud(seed: int, count: int = 7) -> Cloud:
    """A cloud at random, all of the order of 1."""
    rng = np.random.default_rng(seed)
    m = (rng.uniform(0.5, 1.5, count), rng.uniform(0.5, 1.5, count))
    a = (rng.uniform(-1.0, 1.0, (count, 3)), rng.uniform(-1.0, 1.0, (count, 3)))
    q, u, w = rng.uniform(-0.8, 0.8, (3, 6))
    return Cloud(m, a, rng.uniform(-1.0, 1.0, 3), q, u, w)


# One body, and a family of its motions


@dataclass(frozen=True)
class Body:
    """The first link alone, about its fixed point, world axes: x, v, a (n, 3) of its points; T = sum m x x^T.

    M: of momentum; Mk: the moment that its motion takes; E: kinetic energy.
    """

    m: Array
    x: Array
    v: Array
    a: Array
    R: Array
    sigma: Array
    sigmadot: Array
    J: Array
    T: Array
    M: Array
    Mk: Array
    E: float

    def body(self, v: Array) -> Array:
        """Body components."""
        return self.R.T @ v


def body_of(c: Cloud) -> Body:
    """The first link of a cloud."""
    m, x, R = c.m[0], c.places(c.q)[0], rotation(c.q[:3])
    sigma, sigmadot = spin_at(c, 0.0), derivative(lambda t: spin_at(c, t))
    v, a = c.velocities(0.0)[0], c.accelerations[0]
    T = np.einsum("n,ni,nj->ij", m, x, x)
    M, Mk = (np.einsum("n,ni->i", m, np.cross(x, y)) for y in (v, a))
    return Body(m, x, v, a, R, sigma, sigmadot, np.trace(T) * np.eye(3) - T, T, M, Mk, 0.5 * float(m @ dot(v, v)))


def spin_at(c: Cloud, t: complex) -> Array:
    """The first link's angular velocity along the motion."""
    return np.asarray(spins(c.coordinates(t)[:3]) @ c.rates(t)[:3])


@dataclass(frozen=True)
class Variation:
    """Of a family of motions kappa(t, s): other, its turn along s; change, d sigma/ds; rate, d other/dt."""

    other: Array
    change: Array
    rate: Array
    body_change: Array
    body_rate: Array
    energy: Array  # dE/ds


def variation_of(c: Cloud) -> Variation:
    """kappa(t, s) = kappa(t) + s (b + d t)."""
    b, d = c.q[3:], c.w[3:]

    def kappa(t: complex, s: complex) -> Array:
        return np.asarray(c.coordinates(t)[:3] + s * (b + d * t))

    def sigma(t: complex, s: complex) -> Array:
        return np.asarray(spins(kappa(t, s)) @ (c.rates(t)[:3] + s * d))

    def other(t: complex, s: complex) -> Array:
        return np.asarray(spins(kappa(t, s)) @ (b + d * t))

    def in_body(f: Callable[[complex, complex], Array], t: complex, s: complex) -> Array:
        return np.asarray(rotation(kappa(t, s)).T @ f(t, s))

    def energy(s: complex) -> Array:
        x = c.a[0] @ rotation(kappa(0.0, s)).T
        v = np.cross(sigma(0.0, s), x)
        return np.asarray(0.5 * np.sum(c.m[0] * dot(v, v)))

    return Variation(
        other=other(0.0, 0.0),
        change=derivative(lambda s: sigma(0.0, s)),
        rate=derivative(lambda t: other(t, 0.0)),
        body_change=derivative(lambda s: in_body(sigma, 0.0, s)),
        body_rate=derivative(lambda t: in_body(other, t, 0.0)),
        energy=derivative(energy),
    )


# Two links


@dataclass(frozen=True)
class Links:
    """The blocks of two links: momenta of moment by link and by whose spin, arms, spins; loads as the motion asks."""

    first: Array  # M'_a + M'_c
    from_second: Array  # C''
    second: Array  # M''_a
    from_first: Array  # A''
    own_first: Array  # M'_a
    N: Array
    spins: tuple[Array, Array]


def links_of(c: Cloud, t: complex = 0.0) -> Links:
    """At an instant of the motion."""
    q, u = c.coordinates(t), c.rates(t)
    s1, s2 = spins(q[:3]) @ u[:3], spins(q[3:]) @ u[3:]
    R, S, m = rotation(q[:3]), rotation(q[3:]), c.m[1].sum()
    x1, joint, x2 = c.a[0] @ R.T, R @ c.joint, c.a[1] @ S.T
    centre = c.m[1] @ x2 / m
    own = c.m[0] @ np.cross(x1, np.cross(s1, x1))
    return Links(
        first=own + m * np.cross(joint, np.cross(s1, joint)),
        from_second=m * np.cross(joint, np.cross(s2, centre)),
        second=c.m[1] @ np.cross(x2, np.cross(s2, x2)),
        from_first=m * np.cross(centre, np.cross(s1, joint)),
        own_first=own,
        N=m * np.cross(np.cross(s1, joint), np.cross(s2, centre)),
        spins=(s1, s2),
    )
