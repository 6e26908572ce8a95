"""Stiffness along a motion: eigenvalues of its tangent at some instants, and the steps of explicit methods.

What accuracy asks is taken from the steps of the run itself, as the rate of a sine that would ask for the same; a run
of an explicit method that stability keeps short shows no more than that, and then the rate at which the speeds change
over a hundredth of the run stands for it.
"""

from __future__ import annotations

import math

import numpy as np

from heuncli.analyses.probing.instants import SearchedMotion
from heuncli.analyses.probing.numerics.shadows import ShadowScale
from heuncli.analyses.probing.numerics.stiffness import accurate_step, eigenvalues, motion_rate, rate_of, stable_step
from heuncli.analyses.probing.results import Step, StiffnessResults
from heuncli.base import tolerances
from heuncli.base.method_rows import row_of
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.integration.methods.dop853 import DOP853
from heuncli.motion.integration.methods.registry import method_of
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array

EXPLICIT = ("RK4", "DOPRI5", "DOP853")
LOOKS = 60  # instants at which eigenvalues are looked at
MOST_STATE = 600  # numbers of state, of a matrix that is formed
WINDOWS = 100  # of the run, over which the speeds change
NO_SLOPE = "a law has no slope, as the root of 0: the tangent does not exist there"


def stiffness_of(along: SearchedMotion) -> tuple[StiffnessResults | None, str]:
    """The stiffness of a motion or a state, or why there is none."""
    study = along.study
    runner, checked = study.setup.runner, along.checked
    n = runner.moving.layout.n_state
    if checked is not None and checked.run.method.determined:
        return None, "nothing is integrated: drives and joints leave no freedom"
    if n > MOST_STATE:
        return None, f"{n} numbers of state, more than {MOST_STATE}: the tangent is not formed as a whole"
    if not ShadowScale(runner.moving.layout, 1.0).n:
        return None, "nothing is free to move"
    if checked is None:
        at = study.history.recovered
        values = eigenvalues(Evaluator(runner.layout), float(at.times[0]), at.states[0], at.holding[0])
        if values is None:
            return None, NO_SLOPE
        return of_instants(at.times, [values], math.nan, along.study.spec.analysis.tolerance), ""
    run = checked.run
    times, values_at = spectra(along, looked_at(run))
    if not values_at:
        return None, NO_SLOPE
    stable = np.array([stable_step(DOP853, values) for values in values_at])
    grows = max(float(values.real.max(initial=0.0)) for values in values_at)  # what grows is followed, too
    own = max(own_rate(along, run, times, stable), grows)
    if own == 0.0:
        return None, "nothing moves: accuracy asks for no step"
    return of_instants(times, values_at, own, tolerance_of(along, run)), ""


def of_instants(times: Array, values: list[Array], own: float, local: float) -> StiffnessResults:
    """The stiffness by the eigenvalues at instants; own [1/s]: the motion's rate; local: tolerance of a step."""
    stable = np.array([stable_step(DOP853, x) for x in values])
    worst = int(np.argmin(stable))
    steps = [
        Step(name, method.order, stable_step(method, values[worst]), accurate_step(method.order, local, own))
        for name in EXPLICIT
        if row_of(name) is not None
        for method in [method_of(name)]
    ]
    asked = accurate_step(DOP853.order, local, own)
    ratio = 0.0 if math.isinf(stable[worst]) else asked / float(stable[worst])
    return StiffnessResults(
        decay=max((float(np.abs(np.minimum(x.real, 0.0)).max(initial=0.0)) for x in values), default=0.0),
        oscillation=max((float(np.abs(x.imag).max(initial=0.0)) for x in values), default=0.0),
        time=float(times[worst]),
        own=own,
        steps=tuple(steps),
        ratio=ratio,
        share=float(np.mean(stable < asked)),
    )


def looked_at(run: Trajectory) -> Array:
    """The ends of some steps, evenly spread over them: where steps are short, close together."""
    marks = np.concatenate([[0.0], run.ends])
    marks = marks[marks <= run.times[-1]]
    return np.unique(marks[np.linspace(0, len(marks) - 1, min(LOOKS, len(marks))).astype(int)])


def spectra(along: SearchedMotion, times: Array) -> tuple[Array, list[Array]]:
    """Eigenvalues of what is integrated, at those of the instants at which all laws have a slope."""
    runner, checked = along.study.setup.runner, along.study.history.checked
    assert checked is not None
    moving, beside = runner.moving, Evaluator(runner.moving.layout)
    states, holding = runner.resample(checked.run, times), checked.run.holding_at(times)
    found = [
        eigenvalues(beside, t, moving.restrict(t, state), closed)
        for t, state, closed in zip(times.tolist(), states, holding, strict=True)
    ]
    have = np.array([values is not None for values in found])
    return times[have], [values for values in found if values is not None]


def tolerance_of(along: SearchedMotion, run: Trajectory) -> float:
    """The local tolerance that accuracy is asked by; a run of given steps has none of its own."""
    return along.study.spec.analysis.tolerance if run.method.fixed else run.local


def own_rate(along: SearchedMotion, run: Trajectory, times: Array, stable: Array) -> float:
    """The motion's own rate [1/s]: that of a sine for which accuracy asks for the steps of the run."""
    local, mean = tolerance_of(along, run), float(run.times[-1]) / max(run.steps, 1)
    lengths = np.diff(np.concatenate([[0.0], run.ends]))
    taken = lengths[np.minimum(np.searchsorted(run.ends, times), len(lengths) - 1)]
    limited = not run.method.implicit and float(np.median(taken / stable)) > tolerances.STIFF
    if not limited and not run.method.fixed:
        return rate_of(run.method.order, local, mean)
    layout = along.layout
    windows = np.linspace(0.0, float(run.times[-1]), WINDOWS + 1)
    rates = motion_rate(ShadowScale(layout, 1.0), windows, along.study.setup.runner.resample(run, windows))
    return float(np.sqrt(np.mean(rates**2)))
