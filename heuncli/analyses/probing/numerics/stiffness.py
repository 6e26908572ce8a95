"""Stiffness: how fast what is near a motion decays and oscillates, and the steps that this allows explicit methods.

    x' = A x,   A = L (d ydot / d y) B      disturbances x of a state that the closed chains admit
B takes small turns, shifts and rates to the numbers of the state, L takes them back. An explicit method multiplies what
belongs to the eigenvalue l by R(h l) in a step,
    R(z) = 1 + z b' (1 - z A)^-1 1 = 1 + z b'1 + z^2 b'A 1 + ...,
and is stable while |R| is no larger than 1, and than |exp z|. Hairer and Wanner, Solving ODEs II (1996), IV.2.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.analyses.probing.numerics.shadows import ShadowScale
from heuncli.base import tolerances
from heuncli.motion.integration.evaluator import Evaluator, Recovered
from heuncli.motion.integration.methods.method import Method
from heuncli.multibody.response import jacobian, tangent
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import quaternion_product

RAY = np.arange(0.005, 40.0, 0.005)  # |z| along a ray, beyond the boundary of any method of some stages
GROWTH = 1.01  # of |R|: by a hundredth a step, which rounding of R is not, and an estimate of errors sees after some


def eigenvalues(beside: Evaluator, t: float, state: Array, holding: Array) -> Array | None:
    """Eigenvalues [1/s] of the tangent at a state, on what the closed chains admit; None where a law has no slope.

    holding: the contacts closed.
    """
    layout, workspace = beside.layout, beside.workspace
    scale = ShadowScale(layout, 1.0)
    n = scale.n
    if not n:
        return np.zeros(0, dtype=complex)
    workspace.hold(layout.closed(holding).tolist())
    at = beside.recovered(np.array([t]), state[None], holding=holding)
    settled = at.states[0]
    A = np.asarray(to_disturbances(scale, settled, tangent(workspace, t, settled) @ to_states(scale, settled)))
    if layout.rows:
        T, S = admitted(beside, scale, at)
        f = T.shape[1]
        P = np.block([[T, np.zeros((n, f))], [S, T]])
        back = np.block([[T.T, np.zeros((f, n))], [-T.T @ S @ T.T, T.T]])
        A = back @ A @ P
    if not np.isfinite(A).all():
        return None
    values: Array = np.asarray(np.linalg.eigvals(A) if A.size else np.zeros(0))
    return without_rounding(values, float(np.abs(A).max(initial=0.0)))


def without_rounding(values: Array, largest: float) -> Array:
    """Eigenvalues of a matrix of such entries: 0 where rounding makes as much of a double 0; likewise real parts."""
    size = np.abs(values)
    real = np.where(np.abs(values.real) > tolerances.INDIFFERENT * size, values.real, 0.0)
    return np.where(size > math.sqrt(tolerances.INDIFFERENT * largest), real + 1j * values.imag, 0.0)


def to_states(scale: ShadowScale, state: Array) -> Array:
    """B (n_state, 2 n): the numbers of a state by scaled disturbances."""
    n, own = scale.n, scale.coordinates
    B = np.zeros((len(state), 2 * n))
    B[scale.q_at, own.numbers] = 1.0
    for at, first in zip(scale.attitudes.tolist(), own.turns.tolist(), strict=True):
        for i in range(3):
            turn = np.zeros(4)
            turn[1 + i] = 0.5
            B[at : at + 4, first + i] = quaternion_product(turn[None], state[None, at : at + 4])[0]
    B[own.rates, n + np.arange(n)] = 1.0
    return np.asarray(B / scale.by)


def to_disturbances(scale: ShadowScale, state: Array, of: Array) -> Array:
    """L of columns (n_state, k): scaled disturbances (2 n, k)."""
    n, own = scale.n, scale.coordinates
    found = np.zeros((2 * n, of.shape[1]))
    found[own.numbers] = of[scale.q_at]
    for at, first in zip(scale.attitudes.tolist(), own.turns.tolist(), strict=True):
        back = np.repeat((state[at : at + 4] * np.array([1.0, -1.0, -1.0, -1.0]))[None], of.shape[1], axis=0)
        found[first : first + 3] = 2.0 * quaternion_product(of[at : at + 4].T, back)[:, 1:].T
    found[n:] = of[own.rates]
    return np.asarray(found * scale.by[:, None])


def admitted(beside: Evaluator, scale: ShadowScale, at: Recovered) -> tuple[Array, Array]:
    """Scaled displacements T (n, f) that closed chains admit, orthonormal, and the rates S (n, f) that these need."""
    layout, n, state = beside.layout, scale.n, at.states[0]
    J = jacobian(beside.workspace, layout, at.times, at.states)
    rows = J.block(np.arange(len(layout.rows)), scale.coordinates.answers)[0] / scale.by[:n]
    _, s, V = np.linalg.svd(rows[at.rows["closed"][0] > 0.0])
    T = V[int(np.sum(s > tolerances.RANK * s.max(initial=0.0))) :].T
    by = math.sqrt(tolerances.EPS)
    moved = scale.moved(state, np.concatenate([by * T.T, np.zeros_like(T.T)], axis=1))
    times = np.full(len(moved), float(at.times[0]))
    beside_it = beside.recovered(times, moved, holding=at.holding[0]).states if len(moved) else moved
    S = scale.apart(state, beside_it)[:, n:].T / by
    return T, S


def polynomial(method: Method) -> Array:
    """Coefficients of R(z), ascending."""
    s = len(method.stages) + 1
    A, b = np.zeros((s, s)), np.zeros(s)
    for i, row in enumerate(method.stages):
        for j, a in row:
            A[i + 1, j] = a
    for j, a in method.solution:
        b[j] = a
    found, x = [1.0], np.ones(s)
    for _ in range(s):
        found.append(float(b @ x))
        x = A @ x
    return np.array(found)


def reach(method: Method, direction: complex) -> float:
    """How far |z| a step may go along a direction of the plane; infinite where it may go as far as it likes."""
    z = RAY * direction
    R = np.abs(np.polynomial.polynomial.polyval(z, polynomial(method)))
    beyond = R > GROWTH * np.maximum(1.0, np.exp(np.minimum(z.real, 700.0)))
    return float(RAY[np.argmax(beyond)]) if beyond.any() else math.inf


def stable_step(method: Method, values: Array) -> float:
    """The longest stable step [s] beside eigenvalues (n,); infinite where any is."""
    steps = [reach(method, complex(x / abs(x))) / abs(x) for x in values if x != 0.0 and x.imag >= 0.0]
    return min(steps, default=math.inf)


def accurate_step(order: int, local: float, rate: float) -> float:
    """The step [s] at which a method of an order errs by a local tolerance where the motion goes as sin(rate t)."""
    return float((math.factorial(order + 1) * local) ** (1.0 / (order + 1)) / rate) if rate != 0.0 else math.inf


def rate_of(order: int, local: float, step: float) -> float:
    """The rate that such steps stand for."""
    return float((math.factorial(order + 1) * local) ** (1.0 / (order + 1)) / step)


def motion_rate(scale: ShadowScale, times: Array, states: Array) -> Array:
    """How fast the rates of a motion change between instants, by the largest of them, (n_t - 1,) [1/s]."""
    rates = states[:, scale.coordinates.rates] * scale.coordinates.weights
    largest = float(np.sqrt(np.sum(rates**2, axis=1)).max(initial=0.0))
    apart = np.sqrt(np.sum(np.diff(rates, axis=0) ** 2, axis=1))
    return np.asarray(apart / np.maximum(np.diff(times), 1e-300) / max(largest, 1e-300))
