"""How disturbances of a motion grow, in what is integrated and out of the plane that it is integrated in."""

from __future__ import annotations

import math

import numpy as np

from heuncli.analyses.probing.instants import SearchedMotion
from heuncli.analyses.probing.numerics.shadows import Growth, Shadows
from heuncli.analyses.probing.numerics.twists import twists
from heuncli.analyses.probing.results import GrowthResults
from heuncli.base import tolerances
from heuncli.motion.integration.methods.dop853 import DOP853
from heuncli.motion.integration.methods.method import QUATERNION, Method
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.run.stiffness import implicit_for
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array

EVENLY = 200  # instants at which its slope is taken
CONTACTS = "stops or ropes open and close, and each run meets them at instants of its own: the run's own horizon counts"
TRIGGERS = "blows strike at a condition, and each run meets it at instants of its own: the run's own horizon counts"
ONE_INSTANT = "one instant: nothing goes on; heun modes tells what grows about a pose that rests"
FOLLOWED = "nothing is integrated: drives and joints leave no freedom"


def growing(along: SearchedMotion) -> tuple[GrowthResults | None, str]:
    """The growth of disturbances of what is integrated; or why it is not told."""
    checked, runner = along.checked, along.study.setup.runner
    if checked is None:
        return None, ONE_INSTANT
    if checked.run.method.determined:
        return None, FOLLOWED
    if runner.moving.layout.contacts:
        return None, CONTACTS
    if any(blow.when is not None for blow in runner.moving.layout.mechanism.blows):
        return None, TRIGGERS
    shadows = Shadows(runner, checked.run, method_beside(checked.run))
    Q = shadows.directions()
    if not Q.shape[1]:
        return None, "nothing is free to move"
    return told(shadows.growth(Q), Q.shape[1])


def method_beside(run: Trajectory) -> Method:
    """The method of runs beside a run: its own where that judges its steps and keeps quaternions.

    SciPy's own is asked for where a motion may be stiff, and is none of the kernel's: its stiff one stands for it.
    """
    own = run.method
    if own.foreign:
        return implicit_for(tolerances.LEAST_TOLERANCE)
    return own if not own.fixed and own.attitude == QUATERNION else DOP853


def across_plane(along: SearchedMotion) -> tuple[GrowthResults | None, str]:
    """The growth out of the plane that the scene was found to stay in; or why there is none."""
    study = along.study
    checked, layout = along.checked, along.layout
    if checked is None or study.setup.model.get("plane") is None:
        return None, ""
    if study.setup.model["plane"] == "declared":
        return None, "the scene is declared planar: nothing leaves the plane"
    if checked.run.method.determined:
        return None, FOLLOWED
    if layout.contacts:
        return None, CONTACTS
    if any(blow.when is not None for blow in layout.mechanism.blows):
        return None, TRIGGERS
    shadows = Shadows(study.setup.runner, checked.run, method_beside(checked.run), whole=True)
    Q = across(shadows)
    if Q is None or not Q.shape[1]:
        return None, "no joint lets a body leave the plane"
    return told(shadows.growth(Q), Q.shape[1])


def across(shadows: Shadows) -> Array | None:
    """The disturbances (2 n, N) of the start that lead out of the plane of a flat motion; None where nothing turns.

    They turn bodies about axes within it and shift them along its normal n, which is the axis of all spins.
    """
    runner, run = shadows.runner, shadows.run
    omega = runner.recovered(run.times, run.states, holding=run.holding_at(run.times)).bodies["omega"].reshape(-1, 3)
    fastest = omega[np.argmax(np.sum(omega**2, axis=1))] if len(omega) else np.zeros(3)
    size = float(np.sqrt(fastest @ fastest))
    if size == 0.0:
        return None
    n = fastest / size
    layout, own = shadows.layout, shadows.scale.coordinates
    at = Runner(layout).recovered(np.zeros(1), run.states[:1])
    found = twists(layout, at)
    turn, shift = found.turn[0][:, own.answers], found.shift[0][:, own.answers]
    within = np.concatenate([(turn @ n)[..., None], shift - (shift @ n)[..., None] * n], axis=2)
    weights = shadows.scale.by[: shadows.scale.n]
    T = shadows.directions()[: shadows.scale.n]
    T = T[:, : T.shape[1] // 2]
    along_plane = within.swapaxes(1, 2).reshape(-1, shadows.scale.n) / weights
    _, s, V = np.linalg.svd(along_plane @ T, full_matrices=True)
    T = T @ V[int(np.sum(s > tolerances.FLAT * max(float(s.max(initial=0.0)), 1.0))) :].T
    return np.block([[T, np.zeros_like(T)], [np.zeros_like(T), T]])


def told(growth: Growth, directions: int) -> tuple[GrowthResults | None, str]:
    """A growth with its rate and the instant from which on no digit is certain; or None, and why it is not told."""
    times, log = growth.times, growth.logarithm
    last = float(times[-1])
    if len(times) < 2:
        return None, growth.stopped or "the run is too short"
    rate = mean_rate(times, log)
    exponential = 0.5 * rate * last > math.log(tolerances.FASTER_THAN_TIME)
    horizon = first_beyond(growth)
    expected = None
    if horizon is None and exponential and rate > 0.0:
        left = math.log(tolerances.CLAIMED / (tolerances.EPS * math.sqrt(growth.steps[-1]))) - float(log[-1])
        expected = last + left / rate
    found = GrowthResults(rate, float(log[-1]), exponential, directions, horizon, expected, last, growth.stopped)
    return found, growth.stopped or ""


def mean_rate(times: Array, log: Array) -> float:
    """The slope of ln G over the second half of the run [1/s], by least squares; what a start does is over then."""
    at = np.linspace(0.5 * float(times[-1]), float(times[-1]), EVENLY)
    return float(np.polyfit(at - at.mean(), np.interp(at, times, log), 1)[0])


def first_beyond(growth: Growth) -> float | None:
    """The first instant at which EPS sqrt(steps) G passes CLAIMED, between the ends of pieces in its logarithm."""
    with np.errstate(divide="ignore"):
        error = math.log(tolerances.EPS) + 0.5 * np.log(growth.steps) + growth.logarithm
    limit = math.log(tolerances.CLAIMED)
    beyond = np.flatnonzero(error > limit)
    if not len(beyond):
        return None
    k = int(beyond[0])
    if k == 0 or not np.isfinite(error[k - 1]):
        return float(growth.times[k])
    share = (limit - error[k - 1]) / (error[k] - error[k - 1])
    return float(growth.times[k - 1] + share * (growth.times[k] - growth.times[k - 1]))
