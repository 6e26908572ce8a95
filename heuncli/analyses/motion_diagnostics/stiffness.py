"""Stiffness along a motion: eigenvalues of its tangent at several instants, and the steps of explicit methods.

What accuracy requires follows from the steps of the run itself, as the rate of a sine that would require the same. The
steps of an explicit run that stability keeps short do not show this; there it is the rate at which the speeds change
over a hundredth of the run.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.analyses.motion_diagnostics.motion_events import MotionSearch
from heuncli.analyses.motion_diagnostics.numerics.lyapunov import DisturbanceScale
from heuncli.analyses.motion_diagnostics.numerics.stiffness import (
    compute_accurate_step,
    compute_eigenvalues,
    compute_equivalent_rate,
    compute_motion_rate,
    find_stable_step,
)
from heuncli.analyses.motion_diagnostics.results import StepLimits, StiffnessResults
from heuncli.base import tolerances
from heuncli.base.method_rows import find_method
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.integration.methods.dop853 import DOP853
from heuncli.motion.integration.methods.method import load_method_by_name
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array

EXPLICIT = ("RK4", "DOPRI5", "DOP853")
MAX_INSTANTS = 60  # instants at which eigenvalues are computed
MAX_STATE_SIZE = 600  # largest size of the state for which the matrix is formed
WINDOW_COUNT = 100  # of the run, over which the speeds change
NO_SLOPE_REASON = "a force law has no derivative there (such as sqrt at 0): no tangent matrix exists"


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
        for name in EXPLICIT
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
