"""Stiffness: how fast disturbances of a motion decay and oscillate, and the steps that this permits explicit methods.
    x' = A x,   A = L (d ydot / d y) B      disturbances x of a state that the closed chains admit
B converts small rotations, displacements and rates to numbers of the state, L converts them back. In a step an explicit
method multiplies the component of eigenvalue l by R(h l),
    R(z) = 1 + z b' (1 - z A)^-1 1 = 1 + z b'1 + z^2 b'A 1 + ...,
and is stable while |R| exceeds neither 1 nor |exp z|. Hairer and Wanner, Solving ODEs II (1996), IV.2.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.analyses.motion_diagnostics.numerics.lyapunov import DisturbanceScale
from heuncli.base import tolerances
from heuncli.base.linear_algebra import null_space
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.motion.integration.methods.method import Method
from heuncli.multibody.response import jacobian, tangent
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import quaternion_product

RAY = np.arange(0.005, 40.0, 0.005)  # |z| along a ray, beyond the stability boundary of any method with few stages
MAX_AMPLIFICATION = (
    1.01  # of |R| per step: more than rounding of R, and enough for the error estimate to notice after some steps
)


def compute_eigenvalues(evaluator: Evaluator, t: float, state: Array, holding: Array) -> Array | None:
    """Return the eigenvalues [1/s] of the tangent at a state, on the motions that closed chains admit; None if a law
    has no slope.

    holding: the closed contacts
    """
    layout, workspace = evaluator.layout, evaluator.workspace
    scale = DisturbanceScale(layout, 1.0)
    n = scale.n
    if not n:
        return np.zeros(0, dtype=complex)
    workspace.hold(layout.closed_contacts(holding).tolist())
    recovered = evaluator.evaluate(np.array([t]), state[None], holding=holding)
    projected_state = recovered.states[0]
    A = np.asarray(
        convert_to_disturbances(
            scale, projected_state, tangent(workspace, t, projected_state) @ make_state_matrix(scale, projected_state)
        )
    )
    if layout.rows:
        T, S = find_admitted_motions(evaluator, scale, recovered)
        f = T.shape[1]
        P = np.block([[T, np.zeros((n, f))], [S, T]])
        back = np.block([[T.T, np.zeros((f, n))], [-T.T @ S @ T.T, T.T]])
        A = back @ A @ P
    if not np.isfinite(A).all():
        return None
    values: Array = np.asarray(np.linalg.eigvals(A) if A.size else np.zeros(0))
    return drop_rounding(values, float(np.abs(A).max(initial=0.0)))


def drop_rounding(values: Array, largest: float) -> Array:
    """Set eigenvalues to 0 that rounding of the matrix's entries can make of a double 0; likewise real parts."""
    size = np.abs(values)
    real = np.where(np.abs(values.real) > tolerances.INDIFFERENT * size, values.real, 0.0)
    return np.where(size > math.sqrt(tolerances.INDIFFERENT * largest), real + 1j * values.imag, 0.0)


def make_state_matrix(scale: DisturbanceScale, state: Array) -> Array:
    """Return B (n_state, 2 n): the numbers of a state per scaled disturbance."""
    n, coordinates = scale.n, scale.coordinates
    B = np.zeros((len(state), 2 * n))
    B[scale.q_at, coordinates.numbers] = 1.0
    for attitude_index, first in zip(scale.attitudes.tolist(), coordinates.turns.tolist(), strict=True):
        for i in range(3):
            turn = np.zeros(4)
            turn[1 + i] = 0.5
            B[attitude_index : attitude_index + 4, first + i] = quaternion_product(
                turn[None], state[None, attitude_index : attitude_index + 4]
            )[0]
    B[coordinates.rates, n + np.arange(n)] = 1.0
    return np.asarray(B / scale.weights)


def convert_to_disturbances(scale: DisturbanceScale, state: Array, columns: Array) -> Array:
    """Apply L to columns (n_state, k): return scaled disturbances (2 n, k)."""
    n, coordinates = scale.n, scale.coordinates
    disturbances = np.zeros((2 * n, columns.shape[1]))
    disturbances[coordinates.numbers] = columns[scale.q_at]
    for attitude_index, first in zip(scale.attitudes.tolist(), coordinates.turns.tolist(), strict=True):
        inverse_attitudes = np.repeat(
            (state[attitude_index : attitude_index + 4] * np.array([1.0, -1.0, -1.0, -1.0]))[None],
            columns.shape[1],
            axis=0,
        )
        disturbances[first : first + 3] = (
            2.0 * quaternion_product(columns[attitude_index : attitude_index + 4].T, inverse_attitudes)[:, 1:].T
        )
    disturbances[n:] = columns[coordinates.rates]
    return np.asarray(disturbances * scale.weights[:, None])


def find_admitted_motions(evaluator: Evaluator, scale: DisturbanceScale, recovered: Evaluation) -> tuple[Array, Array]:
    """Return the scaled displacements T (n, f) that closed chains admit, orthonormal, and the rates S (n, f) that they
    require.
    """
    layout, n, state = evaluator.layout, scale.n, recovered.states[0]
    J = jacobian(evaluator.workspace, layout, recovered.times, recovered.states)
    rows = J.block(np.arange(len(layout.rows)), scale.coordinates.result_indices)[0] / scale.weights[:n]
    T = null_space(rows[recovered.rows["closed"][0] > 0.0], least_scale=0.0)
    step = math.sqrt(tolerances.EPS)
    displaced = scale.disturb_state(state, np.concatenate([step * T.T, np.zeros_like(T.T)], axis=1))
    times = np.full(len(displaced), float(recovered.times[0]))
    projected = (
        evaluator.evaluate(times, displaced, holding=recovered.holding[0]).states if len(displaced) else displaced
    )
    S = scale.measure_disturbances(state, projected)[:, n:].T / step
    return T, S


def stability_polynomial(method: Method) -> Array:
    """Return the coefficients of R(z), ascending."""
    s = len(method.stages) + 1
    A, b = np.zeros((s, s)), np.zeros(s)
    for i, row in enumerate(method.stages):
        for j, a in row:
            A[i + 1, j] = a
    for j, a in method.solution:
        b[j] = a
    coefficients, x = [1.0], np.ones(s)
    for _ in range(s):
        coefficients.append(float(b @ x))
        x = A @ x
    return np.array(coefficients)


def find_stable_distance(method: Method, direction: complex) -> float:
    """Return how far |z| may go along a direction of the complex plane; infinite if there is no limit."""
    z = RAY * direction
    R = np.abs(np.polynomial.polynomial.polyval(z, stability_polynomial(method)))
    is_unstable = R > MAX_AMPLIFICATION * np.maximum(1.0, np.exp(np.minimum(z.real, 700.0)))
    return float(RAY[np.argmax(is_unstable)]) if is_unstable.any() else math.inf


def find_stable_step(method: Method, values: Array) -> float:
    """Return the longest stable step [s] for eigenvalues (n,); infinite if there is no limit."""
    steps = [find_stable_distance(method, complex(x / abs(x))) / abs(x) for x in values if x != 0.0 and x.imag >= 0.0]
    return min(steps, default=math.inf)


def compute_accurate_step(order: int, local: float, rate: float) -> float:
    """Return the step [s] at which the error of a method equals a local tolerance for the motion sin(rate t)."""
    return float((math.factorial(order + 1) * local) ** (1.0 / (order + 1)) / rate) if rate != 0.0 else math.inf


def compute_equivalent_rate(order: int, local: float, step: float) -> float:
    """Return the rate of the sine for which accuracy requires this step."""
    return float((math.factorial(order + 1) * local) ** (1.0 / (order + 1)) / step)


def compute_motion_rate(scale: DisturbanceScale, times: Array, states: Array) -> Array:
    """Return how fast the rates of a motion change between instants, relative to the largest, (n_t - 1,) [1/s]."""
    rates = states[:, scale.coordinates.rates] * scale.coordinates.weights
    largest = float(np.sqrt(np.sum(rates**2, axis=1)).max(initial=0.0))
    differences = np.sqrt(np.sum(np.diff(rates, axis=0) ** 2, axis=1))
    return np.asarray(differences / np.maximum(np.diff(times), 1e-300) / max(largest, 1e-300))
