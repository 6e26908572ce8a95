"""Growth of disturbances of a motion: within the integrated freedoms, and out of the plane of a planar motion."""

from __future__ import annotations

import math

import numpy as np

from heuncli.analyses.motion_diagnostics.lyapunov import DisturbanceGrowth, DisturbedRuns
from heuncli.analyses.motion_diagnostics.motion_events import MotionSearch
from heuncli.analyses.motion_diagnostics.results import GrowthResults
from heuncli.analyses.motion_diagnostics.twists import compute_twists
from heuncli.base import tolerances
from heuncli.base.linear_algebra import compute_null_space
from heuncli.motion.integration.methods.explicit import DOP853
from heuncli.motion.integration.methods.method import QUATERNION, Method
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.run.supervision import choose_implicit_method
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array

SLOPE_SAMPLES = 200  # instants for the fit of the slope
CONTACTS_REASON = "contacts open, ropes slacken at different times in each run; heun run shows the horizon, if any"
TRIGGERS_REASON = "conditional impulses act at different times in each run; heun run shows the horizon, if any"
ONE_INSTANT_REASON = "one instant, no motion; for the stability of a rest position see heun modes"
FOLLOWED_REASON = "motion fully prescribed, nothing integrated"


def find_integrated_growth(motion: MotionSearch) -> tuple[GrowthResults | None, str]:
    """Return the growth of disturbances of the integrated motion, or the reason why it is missing."""
    checked_run, runner = motion.checked, motion.study.setup.runner
    if checked_run is None:
        return None, ONE_INSTANT_REASON
    if checked_run.run.method.is_determined:
        return None, FOLLOWED_REASON
    if runner.integrated_scene.layout.contacts:
        return None, CONTACTS_REASON
    if any(impulse.when is not None for impulse in runner.integrated_scene.layout.mechanism.impulses):
        return None, TRIGGERS_REASON
    disturbed_runs = DisturbedRuns(runner, checked_run.run, choose_method(checked_run.run))
    Q = disturbed_runs.find_directions()
    if not Q.shape[1]:
        return None, "0 degrees of freedom"
    return make_results(disturbed_runs.compute_growth(Q), Q.shape[1])


def choose_method(run: Trajectory) -> Method:
    """Choose the method of the disturbed runs: the run's own if it is adaptive and keeps quaternions.

    SciPy's methods are used where a motion may be stiff, but are not in the kernel: an implicit method of the kernel
    replaces them.
    """
    run_method = run.method
    if run_method.scipy_name:
        return choose_implicit_method(tolerances.LEAST_TOLERANCE)
    return run_method if not run_method.has_fixed_step and run_method.attitude == QUATERNION else DOP853


def find_out_of_plane_growth(motion: MotionSearch) -> tuple[GrowthResults | None, str]:
    """Return the growth out of the plane that the scene was found to stay in, or the reason why it is missing."""
    study = motion.study
    checked_run, layout = motion.checked, motion.layout
    if checked_run is None or study.setup.model.get("plane") is None:
        return None, ""
    if study.setup.model["plane"] == "declared":
        return None, "the model is declared planar, without out-of-plane motion"
    if checked_run.run.method.is_determined:
        return None, FOLLOWED_REASON
    if layout.contacts:
        return None, CONTACTS_REASON
    if any(impulse.when is not None for impulse in layout.mechanism.impulses):
        return None, TRIGGERS_REASON
    disturbed_runs = DisturbedRuns(study.setup.runner, checked_run.run, choose_method(checked_run.run), whole=True)
    Q = find_out_of_plane_directions(disturbed_runs)
    if Q is None or not Q.shape[1]:
        return None, "the joints permit no out-of-plane motion"
    return make_results(disturbed_runs.compute_growth(Q), Q.shape[1])


def find_out_of_plane_directions(disturbed_runs: DisturbedRuns) -> Array | None:
    """Return the disturbances (2 n, N) of the start that lead out of the plane of a planar motion; None if nothing
    rotates.

    They rotate bodies about axes within the plane and shift them along its normal, which is the axis of all spins.
    """
    runner, run = disturbed_runs.runner, disturbed_runs.run
    omega = runner.evaluate(run.times, run.states, holding=run.find_holding(run.times)).bodies["omega"].reshape(-1, 3)
    fastest = omega[np.argmax(np.sum(omega**2, axis=1))] if len(omega) else np.zeros(3)
    size = float(np.sqrt(fastest @ fastest))
    if size == 0.0:
        return None
    normal = fastest / size
    layout, coordinates = disturbed_runs.layout, disturbed_runs.scale.coordinates
    recovered = Runner(layout).evaluate(np.zeros(1), run.states[:1])
    start_twists = compute_twists(layout, recovered)
    turn, shift = (
        start_twists.turn[0][:, coordinates.result_indices],
        start_twists.shift[0][:, coordinates.result_indices],
    )
    in_plane_motion = np.concatenate([(turn @ normal)[..., None], shift - (shift @ normal)[..., None] * normal], axis=2)
    weights = disturbed_runs.scale.weights[: disturbed_runs.scale.n]
    T = disturbed_runs.find_directions()[: disturbed_runs.scale.n]
    T = T[:, : T.shape[1] // 2]
    in_plane_rows = in_plane_motion.swapaxes(1, 2).reshape(-1, disturbed_runs.scale.n) / weights
    T = T @ compute_null_space(in_plane_rows @ T, tolerances.FLAT)
    return np.block([[T, np.zeros_like(T)], [np.zeros_like(T), T]])


def make_results(growth: DisturbanceGrowth, directions: int) -> tuple[GrowthResults | None, str]:
    """Return a growth with its rate and the horizon of double precision, or the reason why it is missing."""
    times, log = growth.times, growth.logarithm
    last = float(times[-1])
    if len(times) < 2:
        return None, growth.stop_reason or "the run is too short"
    rate = fit_mean_rate(times, log)
    exponential = 0.5 * rate * last > math.log(tolerances.FASTER_THAN_TIME)
    horizon = find_horizon(growth)
    expected = None
    if horizon is None and exponential and rate > 0.0:
        remaining_log = math.log(tolerances.CLAIMED / (tolerances.EPS * math.sqrt(growth.steps[-1]))) - float(log[-1])
        expected = last + remaining_log / rate
    results = GrowthResults(rate, float(log[-1]), exponential, directions, horizon, expected, last, growth.stop_reason)
    return results, growth.stop_reason or ""


def fit_mean_rate(times: Array, log: Array) -> float:
    """Return the slope of ln G over the second half of the run [1/s], by least squares; transients of the start are
    over by then.
    """
    instants = np.linspace(0.5 * float(times[-1]), float(times[-1]), SLOPE_SAMPLES)
    return float(np.polyfit(instants - instants.mean(), np.interp(instants, times, log), 1)[0])


def find_horizon(growth: DisturbanceGrowth) -> float | None:
    """Return the first instant at which EPS sqrt(steps) G exceeds CLAIMED, interpolated between pieces in its
    logarithm.
    """
    with np.errstate(divide="ignore"):
        error = math.log(tolerances.EPS) + 0.5 * np.log(growth.steps) + growth.logarithm
    limit = math.log(tolerances.CLAIMED)
    exceeding = np.flatnonzero(error > limit)
    if not len(exceeding):
        return None
    k = int(exceeding[0])
    if k == 0 or not np.isfinite(error[k - 1]):
        return float(growth.times[k])
    fraction = (limit - error[k - 1]) / (error[k] - error[k - 1])
    return float(growth.times[k - 1] + fraction * (growth.times[k] - growth.times[k - 1]))
