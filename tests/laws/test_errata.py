"""The errata of manual/theory.md, row by row: the right form holds to rounding, the printed one is off."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from heuncli.results.results import Array
from tests.shared.clouds import (
    Cloud,
    body_of,
    cloud,
    derivative,
    dot,
    gradient,
    links_of,
    rotation,
    spin_at,
    spins,
    variation_of,
)

Both = tuple[Array, Array]  # of a row: what is left by the right form, and by the printed one
ERRATA: dict[str, Callable[[Cloud], Both]] = {}
NEXT = ((0, 1, 2), (1, 2, 0), (2, 0, 1))


def erratum(where: str) -> Callable[[Callable[[Cloud], Both]], Callable[[Cloud], Both]]:
    """Enter a row by its place in the paper, as the table of the manual has it."""

    def entered(both: Callable[[Cloud], Both]) -> Callable[[Cloud], Both]:
        ERRATA[where] = both
        return both

    return entered


# Nos. 16 and 17


@erratum("M_v,2, M_v,3 before (18)")
def bracket(c: Cloud) -> Both:
    b = body_of(c)
    M, s, J = b.body(b.M), b.body(b.sigma), b.R.T @ b.J @ b.R
    printed = J.copy()
    np.fill_diagonal(printed, J[0, 0])
    return M - J @ s, M - printed @ s


@erratum("dM_v/dt before (19)")
def rate_of_momentum(c: Cloud) -> Both:
    b = body_of(c)
    square, along = (b.m * dot(b.x, b.x)).sum() * b.sigmadot, (b.m * (b.x @ b.sigmadot)) @ b.x
    gyro = np.cross(b.sigma, b.M)
    return b.Mk - (square - along + gyro), b.Mk - (2.0 * square + along + gyro)


@erratum("(24) in space components")
def commutator(c: Cloud) -> Both:
    b, v = body_of(c), variation_of(c)
    left = v.change - v.rate
    return left - np.cross(v.other, b.sigma), left - np.cross(b.sigma, v.other)


@erratum("(25) row 1")
def first_row(c: Cloud) -> Both:
    b, v = body_of(c), variation_of(c)
    d, e = b.body(b.sigma), b.body(v.other)
    left = (v.body_change - v.body_rate)[0]
    return left - (d[1] * e[2] - d[2] * e[1]), left - (d[1] * e[2] - d[2] * e[0])


@erratum("(27) in space components")
def change_of_spin(c: Cloud) -> Both:
    b, v = body_of(c), variation_of(c)
    cross = np.cross(b.sigma, v.other)
    return v.change - (v.rate - cross), v.change - (v.rate + cross)


@erratum("δE = M_v·δσ in space components")
def change_of_energy(c: Cloud) -> Both:
    b, v = body_of(c), variation_of(c)
    return v.energy - b.M @ v.rate, v.energy - b.M @ v.change


@erratum("(28) in space components")
def law_of_moments(c: Cloud) -> Both:
    b = body_of(c)
    rate = derivative(lambda t: np.einsum("n,ni->i", b.m, np.cross(c.places(c.coordinates(t))[0], c.velocities(t)[0])))
    return rate - b.Mk, rate + np.cross(b.sigma, b.M) - b.Mk


# Nos. 18 and 19


def reciprocal(c: Cloud, q: Array, p: Array) -> Array:
    """F = sum eta p p / 2."""
    return np.asarray(0.5 * (p @ np.linalg.inv(c.mass_matrix(q)) @ p))


@erratum("no. 19, ṗ_i")
def rates_of_momenta(c: Cloud) -> Both:
    p, k = c.mass_matrix(c.q) @ c.u, c.along(c.accelerations)
    rate = derivative(lambda t: c.mass_matrix(c.coordinates(t)) @ c.rates(t))
    slope = gradient(lambda q: reciprocal(c, q, p), c.q)
    return rate - (k - slope), k - slope


@erratum("no. 19, q̈_i")
def rates_of_rates(c: Cloud) -> Both:
    eps = c.mass_matrix(c.q)
    eta, p = np.linalg.inv(eps), eps @ c.u
    rate = derivative(lambda t: c.mass_matrix(c.coordinates(t)) @ c.rates(t))
    mixed = gradient(lambda q: np.linalg.inv(c.mass_matrix(q)) @ p, c.q)
    return c.w - (eta @ rate + mixed @ c.u), c.w - (eta @ rate + eta @ c.u)


@erratum("(38), (39)")
def explicit_form(c: Cloud) -> Both:
    eta, k = np.linalg.inv(c.mass_matrix(c.q)), c.along(c.accelerations)
    alpha = eta @ np.einsum("ilk,l,k->i", c.christoffel(), c.u, c.u)
    return c.w - (eta @ k - alpha), c.w - (eta @ k + alpha)


# No. 20


def parameters(c: Cloud, t: complex) -> tuple[Array, Array]:
    """Euler's D and lambda of the first link."""
    kappa = c.coordinates(t)[:3]
    D = 1.0 / np.sqrt(1.0 + kappa @ kappa)
    return np.asarray(D), np.asarray(D * kappa)


def euler(c: Cloud) -> tuple[Array, Array, Array, Array]:
    """D, lambda and their rates."""
    D, lam = parameters(c, 0.0)
    return D, lam, derivative(lambda t: parameters(c, t)[0]), derivative(lambda t: parameters(c, t)[1])


@erratum("(40), (43) in space components")
def euler_parameters(c: Cloud) -> Both:
    D, lam, Ddot, lamdot = euler(c)
    half, plain, cross = 0.5 * spin_at(c, 0.0), D * lamdot - lam * Ddot, np.cross(lam, lamdot)
    return half - (plain + cross), half - (plain - cross)


@erratum("(41)")
def ratio_form(c: Cloud) -> Both:
    D, lam, _, lamdot = euler(c)
    half, rate = 0.5 * spin_at(c, 0.0), D**2 * derivative(lambda t: parameters(c, t)[1] / parameters(c, t)[0])
    return half - (rate + np.cross(lam, lamdot)), half - rate


@erratum("(42)")
def rodrigues(c: Cloud) -> Both:
    kappa, rate = c.q[:3], c.u[:3]
    whole = (rate + np.cross(kappa, rate)) / (1.0 + kappa @ kappa)
    return spin_at(c, 0.0) - 2.0 * whole, spin_at(c, 0.0) - whole


# No. 21


def spherical(q: Array) -> Array:
    """A point in coordinates that are neither square nor of one length."""
    return np.array([q[0] * np.cos(q[1]) * np.cos(q[2]), q[0] * np.sin(q[1]), q[0] * np.cos(q[1]) * np.sin(q[2])])


def frame(q: Array) -> Array:
    """eps_i of the point, rows."""
    r, (c1, s1), (c2, s2) = q[0], (np.cos(q[1]), np.sin(q[1])), (np.cos(q[2]), np.sin(q[2]))
    return np.array([[c1 * c2, s1, c1 * s2], [-r * s1 * c2, r * c1, -r * s1 * s2], [-r * c1 * s2, 0 * r, r * c1 * c2]])


@erratum("no. 21, free point")
def free_point(c: Cloud) -> Both:
    q, u, w = c.q[:3] + 1.0, c.u[:3], c.w[:3]

    def at(t: complex) -> Array:
        return np.asarray(q + u * t + 0.5 * w * t * t)

    e, rate = frame(q), derivative(lambda t: frame(at(t)))
    B = np.cross(u @ e, derivative(lambda t: (u + w * t) @ frame(at(t))))
    pairs = ((0, 1), (0, 2), (1, 2))
    own = sum(np.cross(e[i], e[k]) * (u[i] * w[k] - u[k] * w[i]) for i, k in pairs)
    own = own + sum(np.cross(e[i], rate[i]) * u[i] ** 2 for i in range(3))
    mixed = [np.cross(e[i], rate[k]) + np.cross(e[k], rate[i]) for i, k in pairs]
    right, printed = (sum(x * u[i] * y[k] for x, (i, k) in zip(mixed, pairs, strict=True)) for y in (u, w))
    return B - (own + right), B - (own + printed)


@erratum("no. 21, v = Σ ε'_i p_i")
def reciprocal_frame(c: Cloud) -> Both:
    e = frame(c.q[:3] + 1.0)
    v = c.u[:3] @ e
    found = sum((e[i] @ v) * np.cross(e[j], e[k]) for i, j, k in NEXT)
    return v - found / np.linalg.det(e), v - found


@erratum("no. 21, components of G")
def system_vector(c: Cloud) -> Both:
    b = body_of(c)
    B, G = np.einsum("n,ni->i", b.m, np.cross(b.v, b.a)), b.T @ np.cross(b.sigma, b.sigmadot)
    return B - (2.0 * b.E * b.sigma + G), B - (2.0 * b.E * b.sigma - G)


# Nos. 22 and 23


@erratum("(47), (48)")
def momenta_of_links(c: Cloud) -> Both:
    b, p = links_of(c), c.along(c.velocities(0.0))
    W, V = spins(c.q[:3]), spins(c.q[3:])
    right = np.concatenate([W.T @ (b.first + b.from_second), V.T @ (b.second + b.from_first)])
    printed = np.concatenate([W.T @ (b.first + b.second), V.T @ (b.own_first + b.from_first)])
    return p - right, p - printed


def moments_asked(c: Cloud) -> Both:
    """M'_k + c' x k'' and M''_k that the motion takes: of the first link about the fixed point, about the joint."""
    joint, (x1, x2), (a1, a2) = rotation(c.q[:3]) @ c.joint, c.places(c.q), c.accelerations
    whole = np.cross(joint, c.m[1] @ a2)
    return c.m[0] @ np.cross(x1, a1) + whole, c.m[1] @ np.cross(x2 - joint, a2)


@erratum("**(49)**")
def equations_of_links(c: Cloud) -> Both:
    k1, k2 = moments_asked(c)
    rate = [derivative(lambda t: momenta(c, t)[0]), derivative(lambda t: momenta(c, t)[1])]
    N = links_of(c).N
    return np.array([rate[0] - N - k1, rate[1] + N - k2]), np.array([rate[0] - k1, rate[1] - k2])


def momenta(c: Cloud, t: complex) -> Both:
    """R' and R''."""
    b = links_of(c, t)
    return b.first + b.from_second, b.second + b.from_first


@erratum("(49) with the bracket read as in (28)")
def bracket_of_spins(c: Cloud) -> Both:
    k1, _ = moments_asked(c)
    R, S, m = rotation(c.q[:3]), rotation(c.q[3:]), c.m[1].sum()
    joint, x1 = R @ c.joint, c.a[0] @ R.T
    centre = c.m[1] @ (c.a[1] @ S.T) / m
    s1, s2 = links_of(c).spins
    d1 = derivative(lambda t: links_of(c, t).spins[0])
    d2 = derivative(lambda t: links_of(c, t).spins[1])
    blocks = c.m[0] @ np.cross(x1, np.cross(d1, x1)) + m * np.cross(joint, np.cross(d1, joint) + np.cross(d2, centre))
    bias = c.m[0] @ np.cross(x1, np.cross(s1, np.cross(s1, x1)))
    bias = bias + m * np.cross(joint, np.cross(s1, np.cross(s1, joint)) + np.cross(s2, np.cross(s2, centre)))
    return k1 - (blocks + bias), k1 - (blocks + np.cross(s1, momenta(c, 0.0)[0]))


@erratum("no. 23, second equation")
def part_in_coordinates(c: Cloud) -> Both:
    """k'' at random, s'' = k'' - sum'' m eps . a; E'' of the second link alone."""
    k = c.q[::-1] + 2.0
    s = k - c.along(c.accelerations, 1)
    rate = derivative(lambda t: c.mass_matrix(c.coordinates(t), 1) @ c.rates(t))
    left = rate - gradient(lambda q: 0.5 * (c.u @ c.mass_matrix(q, 1) @ c.u), c.q)
    return left - (k - s), left - (k + s)


@erratum("(51)")
def impulses_apart(c: Cloud) -> Both:
    """h' on the first link, h'' on the second; r' = h' - p' behind the blow, from rest."""
    first, second = c.u + 1.0, c.w - 1.0
    own, eta, h = c.mass_matrix(c.q, 0), np.linalg.inv(c.mass_matrix(c.q)), first + second
    lost = first - c.along(np_pair(c, eta @ h), 0)
    return lost - (first - own @ eta @ h), lost - (first - own.sum(axis=1) * (eta @ h))


def np_pair(c: Cloud, u: Array) -> Both:
    """Velocities of all points for rates u."""
    first, second = (np.einsum("inj,i->nj", e, u) for e in c.partials(c.q))
    return first, second


@erratum("(53)")
def forces_apart(c: Cloud) -> Both:
    """k as the motion takes, k' a part of it at random."""
    k, part = c.along(c.accelerations), c.q[::-1] + 2.0
    lost = part - c.along(c.accelerations, 0)
    mixed = c.mass_matrix(c.q, 0) @ np.linalg.inv(c.mass_matrix(c.q))
    symbols = np.einsum("ij,jkl->ikl", mixed, c.christoffel()) - c.christoffel(0)
    right = np.einsum("ikl,k,l->i", symbols, c.u, c.u)
    printed = np.einsum("ikl,k,k->i", symbols, c.u, c.u)
    return lost - (part - mixed @ k + right), lost - (part - mixed @ k + printed)


# No. 28


@dataclass(frozen=True)
class Principal:
    """The first link in principal axes: places x, spin s, its rate d, accelerations a, moment M; piece: x1 > 0."""

    m: Array
    x: Array
    s: Array
    d: Array
    a: Array
    A: Array
    B: Array
    M: Array
    piece: Array

    @property
    def J(self) -> Array:
        """Of the piece."""
        T = np.einsum("n,ni,nj->ij", self.m[self.piece], self.x[self.piece], self.x[self.piece])
        return np.trace(T) * np.eye(3) - T

    @property
    def moment(self) -> Array:
        """Of the piece's inertia, M'_k - M'_s."""
        return np.asarray(self.m[self.piece] @ np.cross(self.x[self.piece], self.a[self.piece]))


def principal(c: Cloud) -> Principal:
    """In axes in which J is diagonal."""
    b = body_of(c)
    A, P = np.linalg.eigh(b.J)
    P = P * np.linalg.det(P)
    x = b.x @ P
    T = (b.m[:, None] * x * x).sum(axis=0)
    return Principal(b.m, x, P.T @ b.sigma, P.T @ b.sigmadot, b.a @ P, A, 2.0 * T, P.T @ b.Mk, x[:, 0] > 0.0)


@erratum("ẍ in no. 28")
def acceleration(c: Cloud) -> Both:
    b = principal(c)
    right, printed = np.zeros_like(b.x), np.zeros_like(b.x)
    for i, j, k in NEXT:
        turn = b.d[j] * b.x[:, k] - b.d[k] * b.x[:, j]
        square, last = (b.s[j] ** 2 + b.s[k] ** 2) * b.x[:, i], b.s[i] * b.s[k] * b.x[:, k]
        right[:, i] = turn - square + b.s[i] * b.s[j] * b.x[:, j] + last
        printed[:, i] = turn + square + b.s[i] * b.s[j] * b.s[j] + last
    return b.a - right, b.a - printed


def explicit(b: Principal, x: Array, sign: float = -1.0) -> Array:
    """The acceleration of a point without sigma's rate, by the moment and the spin."""
    out = np.zeros_like(x)
    for i, j, k in NEXT:
        out[..., i] = (
            sign * (b.s[j] ** 2 + b.s[k] ** 2) * x[..., i]
            + b.B[i] / b.A[k] * b.s[i] * b.s[j] * x[..., j] + b.B[i] / b.A[j] * b.s[i] * b.s[k] * x[..., k]
            + b.M[j] * x[..., k] / b.A[j] - b.M[k] * x[..., j] / b.A[k]
        )  # fmt: skip
    return out


@erratum("explicit ẍ_i in no. 28")
def explicit_acceleration(c: Cloud) -> Both:
    b = principal(c)
    return b.a - explicit(b, b.x), b.a - explicit(b, b.x, sign=1.0)


@erratum("explicit s'_1 in no. 28")
def explicit_force(c: Cloud) -> Both:
    """Without a load on the piece; printed with A1 - A2 + A3 in B1's place, and the brace reversed."""
    b = principal(c)
    m, first = b.m[b.piece], b.m[b.piece] @ b.x[b.piece]
    lost = -(m @ b.a[b.piece])
    spin = -explicit(b, first) + np.array(
        [b.M[j] * first[k] / b.A[j] - b.M[k] * first[j] / b.A[k] for _, j, k in NEXT]
    )  # fmt: skip
    moment = -explicit(b, first) - spin
    wrong = b.A[0] - b.A[1] + b.A[2]
    brace = (b.s[1] ** 2 + b.s[2] ** 2) * first[0] - wrong * b.s[0] * (
        b.s[1] * first[1] / b.A[2] + b.s[2] * first[2] / b.A[1]
    )
    return lost - (moment + spin), (lost - moment)[0] + brace


@erratum("(60) in components")
def moment_in_rows(c: Cloud) -> Both:
    b = principal(c)
    J = b.J
    D = (-J[1, 2], -J[2, 0], -J[0, 1])
    plain = np.array([-J[i, i] * b.d[i] - (J[k, k] - J[j, j]) * b.s[j] * b.s[k] for i, j, k in NEXT])
    rows = np.array([
        D[k] * (b.d[j] - b.s[k] * b.s[i]) + D[j] * (b.d[k] + b.s[i] * b.s[j]) + D[i] * (b.s[j] ** 2 - b.s[k] ** 2)
        for i, j, k in NEXT
    ])  # fmt: skip
    return -b.moment - (plain + rows), -b.moment - plain


@erratum("(61) row 2")
def moment_without_rates(c: Cloud) -> Both:
    """Of a piece without deviation moments in the body's principal axes: M'_s,2 by M'_k,2, at random, and M_k,2."""
    b = principal(c)
    J, Mk = np.diag(b.J), np.array([0.7, -1.3, 0.4])
    lost = Mk - J * b.d - np.cross(b.s, J * b.s)
    coefficient = J[1] * (b.A[0] - b.A[2]) - b.A[1] * (J[0] - J[2])  # D'_2 of the paper, no deviation moment
    right = b.A[1] * Mk[1] - J[1] * b.M[1] + coefficient * b.s[2] * b.s[0]
    printed = b.A[1] * Mk[0] - J[1] * b.M[0] + coefficient * b.s[2] * b.s[0]
    return b.A[1] * lost[1] - right, b.A[1] * lost[1] - printed


@pytest.mark.parametrize("where", ERRATA)
def test_right_and_as_printed(where: str) -> None:
    """On clouds of points, of the order of 1; of the printed forms the worst of some clouds."""
    found = [ERRATA[where](cloud(seed)) for seed in range(4)]
    assert max(float(np.abs(right).max()) for right, _ in found) < 1e-11
    assert max(float(np.abs(printed).max()) for _, printed in found) > 0.05
