"""Stiffness along a motion: how fast disturbances decay and oscillate, and the steps that this requires.

What accuracy requires follows from the steps of the run itself, as the rate of a sine that would require the same. The
steps of an explicit run that stability keeps short do not show this; there it is the rate at which the speeds change
over a hundredth of the run.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.analyses.motion_diagnostics.lyapunov import DisturbanceScale
from heuncli.analyses.motion_diagnostics.motion_events import MotionSearch
from heuncli.analyses.motion_diagnostics.results import StepLimits, StiffnessResults
from heuncli.base import tolerances
from heuncli.base.linear_algebra import compute_null_space
from heuncli.base.method_rows import find_method
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.motion.integration.methods.explicit import DOP853
from heuncli.motion.integration.methods.method import Method, load_method_by_name
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.response import jacobian, tangent
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import quaternion_product

EXPLICIT_METHODS = ("RK4", "DOPRI5", "DOP853")
MAX_INSTANTS = 60  # instants at which eigenvalues are computed
MAX_STATE_SIZE = 600  # largest size of the state for which the matrix is formed
WINDOW_COUNT = 100  # of the run, over which the speeds change
NO_SLOPE_REASON = "a force law has no derivative there (such as sqrt at 0): no tangent matrix exists"
RAY = np.arange(0.005, 40.0, 0.005)  # |z| along a ray, beyond the stability boundary of any method with few stages
# of |R| per step: more than rounding of R, and enough for the error estimate to notice after some steps
MAX_AMPLIFICATION = 1.01
MAX_EXPONENT = 700.0  # e to this power is still a number
TINY = 1e-300  # smallest divisor


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
    slopes = tangent(workspace, t, projected_state) @ make_state_matrix(scale, projected_state)
    A = np.asarray(convert_to_disturbances(scale, projected_state, slopes))
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
    """Convert small changes of a state, columns (n_state, k), to scaled disturbances (2 n, k)."""
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
    T = compute_null_space(rows[recovered.rows["closed"][0] > 0.0], min_scale=0.0)
    step = math.sqrt(tolerances.EPS)
    displaced = scale.disturb_state(state, np.concatenate([step * T.T, np.zeros_like(T.T)], axis=1))
    times = np.full(len(displaced), float(recovered.times[0]))
    projected = (
        evaluator.evaluate(times, displaced, holding=recovered.holding[0]).states if len(displaced) else displaced
    )
    S = scale.measure_disturbances(state, projected)[:, n:].T / step
    return T, S


def stability_polynomial(method: Method) -> Array:
    """Return the coefficients of R(z), ascending: 1 + z b·1 + z² b·A 1 + ... of an explicit method."""
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
    is_unstable = R > MAX_AMPLIFICATION * np.maximum(1.0, np.exp(np.minimum(z.real, MAX_EXPONENT)))
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
    return np.asarray(differences / np.maximum(np.diff(times), TINY) / max(largest, TINY))


def find_stiffness(motion: MotionSearch) -> tuple[StiffnessResults | None, str]:
    """Return the stiffness of a motion or a state, or the reason why it is missing."""
    study = motion.study
    runner, checked_run = study.setup.runner, motion.checked
    n = runner.integrated_scene.layout.n_state
    if checked_run is not None and checked_run.run.method.is_determined:
        return None, "motion fully prescribed, nothing integrated"
    if n > MAX_STATE_SIZE:
        return None, f"{n} state variables, more than {MAX_STATE_SIZE}: the full tangent matrix is not formed"
    if not DisturbanceScale(runner.integrated_scene.layout, 1.0).n:
        return None, "0 degrees of freedom"
    if checked_run is None:
        recovered = study.history.solutions
        values = compute_eigenvalues(
            Evaluator(runner.layout), float(recovered.times[0]), recovered.states[0], recovered.holding[0]
        )
        if values is None:
            return None, NO_SLOPE_REASON
        return make_results(recovered.times, [values], math.nan, motion.study.spec.analysis.tolerance), ""
    run = checked_run.run
    times, values_at = compute_spectra(motion, choose_instants(run))
    if not values_at:
        return None, NO_SLOPE_REASON
    stable = np.array([find_stable_step(DOP853, values) for values in values_at])
    growth_rate = max(float(values.real.max(initial=0.0)) for values in values_at)  # growth is part of the motion, too
    rate = max(find_motion_rate(motion, run, times, stable), growth_rate)
    if rate == 0.0:
        return None, "nothing moves: accuracy sets no step size"
    return make_results(times, values_at, rate, get_tolerance(motion, run)), ""


def make_results(times: Array, values: list[Array], rate: float, local: float) -> StiffnessResults:
    """Return the stiffness from the eigenvalues at instants.

    local: local tolerance of a step
    """
    stable = np.array([find_stable_step(DOP853, x) for x in values])
    worst = int(np.argmin(stable))
    steps = [
        StepLimits(
            name,
            method.order,
            find_stable_step(method, values[worst]),
            compute_accurate_step(method.order, local, rate),
        )
        for name in EXPLICIT_METHODS
        if find_method(name) is not None
        for method in [load_method_by_name(name)]
    ]
    accurate = compute_accurate_step(DOP853.order, local, rate)
    ratio = 0.0 if math.isinf(stable[worst]) else accurate / float(stable[worst])
    return StiffnessResults(
        decay=max((float(np.abs(np.minimum(x.real, 0.0)).max(initial=0.0)) for x in values), default=0.0),
        oscillation=max((float(np.abs(x.imag).max(initial=0.0)) for x in values), default=0.0),
        time=float(times[worst]),
        motion_rate=rate,
        steps=tuple(steps),
        ratio=ratio,
        share=float(np.mean(stable < accurate)),
    )


def choose_instants(run: Trajectory) -> Array:
    """Return the ends of some steps, evenly spread over the steps: close together where steps are short."""
    marks = np.concatenate([[0.0], run.ends])
    marks = marks[marks <= run.times[-1]]
    return np.unique(marks[np.linspace(0, len(marks) - 1, min(MAX_INSTANTS, len(marks))).astype(int)])


def compute_spectra(motion: MotionSearch, times: Array) -> tuple[Array, list[Array]]:
    """Return the eigenvalues of the integrated scene at those instants where all laws have a slope, and these
    instants.
    """
    runner, checked_run = motion.study.setup.runner, motion.study.history.checked_run
    assert checked_run is not None
    moving, evaluator = runner.integrated_scene, Evaluator(runner.integrated_scene.layout)
    states, holding = runner.resample(checked_run.run, times), checked_run.run.find_holding(times)
    all_spectra = [
        compute_eigenvalues(evaluator, t, moving.restrict(t, state), closed)
        for t, state, closed in zip(times.tolist(), states, holding, strict=True)
    ]
    is_known = np.array([values is not None for values in all_spectra])
    return times[is_known], [values for values in all_spectra if values is not None]


def get_tolerance(motion: MotionSearch, run: Trajectory) -> float:
    """Return the local tolerance for the accurate step; a fixed-step run has none of its own."""
    return motion.study.spec.analysis.tolerance if run.method.has_fixed_step else run.local


def find_motion_rate(motion: MotionSearch, run: Trajectory, times: Array, stable: Array) -> float:
    """Return the motion's own rate [1/s]: that of a sine for which accuracy requires the steps of the run."""
    local, mean_run_step = get_tolerance(motion, run), float(run.times[-1]) / max(run.steps, 1)
    lengths = np.diff(np.concatenate([[0.0], run.ends]))
    steps_taken = lengths[np.minimum(np.searchsorted(run.ends, times), len(lengths) - 1)]
    is_limited = not run.method.implicit and float(np.median(steps_taken / stable)) > tolerances.STIFF
    if not is_limited and not run.method.has_fixed_step:
        return compute_equivalent_rate(run.method.order, local, mean_run_step)
    layout = motion.layout
    windows = np.linspace(0.0, float(run.times[-1]), WINDOW_COUNT + 1)
    rates = compute_motion_rate(
        DisturbanceScale(layout, 1.0), windows, motion.study.setup.runner.resample(run, windows)
    )
    return float(np.sqrt(np.mean(rates**2)))
