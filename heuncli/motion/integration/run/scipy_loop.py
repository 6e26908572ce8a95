"""SciPy's integrators as independent checks: the kernel's derivative, their steps and their dense output.

The derivative is taken at the state brought onto the closed chains: so the exact motion solves this equation, too, and
what a step leaves beside them does not grow. They begin anew at every discontinuity in time. Events hang on dense
output and on what holds over a step, which are the kernel's: scenes with contacts, blows, branches in coordinates or
conditions are refused by name. SciPy is imported where such a method is asked for, and nowhere else.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import LimitError, Problem, SolveError, SpecError
from heuncli.base.method_rows import SMOOTH_ONLY
from heuncli.base.records import record
from heuncli.motion.integration.contacts.blows import rate_jumps
from heuncli.motion.integration.integrated_scene import IntegratedScene
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.run.limits import check_deadline
from heuncli.motion.integration.run.request import MotionTask
from heuncli.motion.integration.segments import Segment, Segments, smooth_segments
from heuncli.motion.integration.trajectory import Kept, Trajectory
from heuncli.multibody.response import settled, slope
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

LEAST_RELATIVE = 100.0 * tolerances.EPS  # what SciPy takes for its relative tolerance at least


@record
class ScipySteps:
    """Steps that were done: their ends, the states there, and what interpolates within each."""

    ends: list[float]
    states: list[Array]
    within: list[Callable[[float], Array]]
    pieces: list[Segment]

    def at(self, moving: IntegratedScene, times: Array) -> Array:
        """The scene's states (n_t, n) at instants within the run."""
        steps = np.minimum(np.searchsorted(self.ends, times), len(self.ends) - 1)
        own = [self.states[0] if t <= 0.0 else self.within[k](float(t)) for k, t in zip(steps, times, strict=True)]
        return moving.embed(times, np.array(own).reshape(len(times), moving.layout.n_state))


class Derivative:
    """dy/dt of what is integrated, on the closures; counts how often it is asked for. Impure: keeps the largest gap."""

    def __init__(self, moving: IntegratedScene) -> None:
        self.moving, self.count, self.gap = moving, 0, 0.0
        self.begin = self.end = 0.0

    def __call__(self, t: float, y: Array) -> Array:
        """The derivative at an instant of the segment; beyond its ends other branches in time hold."""
        self.count += 1
        rate, gap = slope(self.moving.workspace, min(max(t, self.begin), self.end), y)
        self.gap = max(self.gap, gap)
        return rate


def trajectory(layout: Layout, moving: IntegratedScene, request: MotionTask) -> Trajectory:
    """A run of a scene by one of SciPy's methods, as `Runner.trajectory` gives it.

    Raises SpecError for what they do not run, SolveError where they give up, LimitError past the deadline.
    """
    begun = time.perf_counter()
    times, method, last = request.instants, request.method, request.last
    require_smooth(layout, method, last)
    state = moving.restrict(0.0, layout.y0 if request.start is None else request.start)
    derivative = Derivative(moving)
    done = ScipySteps([], [state], [], [])
    solving = ScipyIntegration(derivative, request, min(request.most_steps, tolerances.MOST_FOREIGN))
    for segment in smooth_segments(last, request.discontinuities):
        done.pieces.append(segment)
        solving.run(segment, settled(moving.workspace, moving.layout, segment.begin, done.states[-1])[0], done)
    own = done.at(moving, times)
    steps = len(done.ends)
    kept = Kept(np.arange(len(done.states)), np.array(done.states))
    return Trajectory(
        times=times, states=own, ends=np.array(done.ends), steps=steps, evaluations=derivative.count,
        gap=derivative.gap, local=request.local, method=method, seconds=time.perf_counter() - begun,
        segments=Segments(np.array(done.pieces)), kept=kept, pivots=np.ones(steps), settled=np.ones(steps),
        branches=np.zeros((steps, 0)), turned=np.zeros(steps), holding=np.zeros((steps + 1, 0)),
        within=lambda at: done.at(moving, at),
    )  # fmt: skip


@record
class ScipyIntegration:
    """How SciPy integrates a run, a segment after the other."""

    derivative: Derivative
    request: MotionTask
    most_steps: int

    def run(self, segment: Segment, state: Array, done: ScipySteps) -> None:
        """The steps of a segment from a state, added to those done."""
        self.derivative.begin, self.derivative.end = segment.begin, segment.before_end
        if segment.end <= segment.begin:
            return
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of SciPy: what it would say of the tolerance, the estimate tells
            solver = self.solver(segment, state)
            while solver.status == "running":
                self.step(solver)
                done.ends.append(float(solver.t))
                done.states.append(np.array(solver.y))
                done.within.append(solver.dense_output())
                check_deadline(self.request.deadline, f"at t = {solver.t:.6g} s of {self.request.last:.6g} s")
                if len(done.ends) > self.most_steps:
                    raise too_many(self.request.method, self.most_steps, solver.t, self.request.last)

    def solver(self, segment: Segment, state: Array) -> Any:
        """SciPy's solver at the start of a segment."""
        from scipy import integrate  # not before it is needed: a third of a second

        kind = getattr(integrate, self.request.method.foreign)
        scale = scales(self.derivative, segment.begin, state, self.request.last)
        relative = max(self.request.local, LEAST_RELATIVE)
        try:
            return kind(
                self.derivative, segment.begin, state, segment.end, rtol=relative, atol=self.request.local * scale
            )
        except (ValueError, ArithmeticError) as error:
            raise gave_up(self.request.method, segment.begin, str(error)) from None

    def step(self, solver: Any) -> None:
        """One step. Raises SolveError where there is none."""
        try:
            message = solver.step()
        except (ValueError, ArithmeticError, np.linalg.LinAlgError) as error:  # it factored what is no number
            raise gave_up(self.request.method, float(solver.t), str(error)) from None
        if solver.status == "failed" or not np.isfinite(solver.y).all():
            raise gave_up(self.request.method, float(solver.t), str(message or "a value is no number any more"))


def scales(derivative: Derivative, t: float, state: Array, last: float) -> Array:
    """What errors of the components are measured by: 1 rad, the scene's size, and these times the scene's rate."""
    moving = derivative.moving
    weights = np.asarray(moving.layout.weights)
    groups = moving.layout.tables["groups"]
    slopes = derivative(t, state)
    rates = np.zeros(len(state), dtype=bool)
    for group in groups:
        rates[group["rates"] : group["end"]] = True
    largest = [tolerances.LEAST_RATE / last]
    if rates.any():
        largest += [float(np.abs(weights * state)[rates].max()), float(np.sqrt(np.abs(weights * slopes)[rates].max()))]
    unit = 1.0 / weights
    return np.where(rates, unit * np.nan_to_num(max(largest), nan=1.0), unit)


def require_smooth(layout: Layout, method: Method, last: float) -> None:
    """Raise SpecError for what of a run up to `last` only the kernel's own methods do, each by name."""
    mechanism = layout.mechanism
    named = [f"the stop {stop.name}" for stop in mechanism.stops]
    named += [f"the rope {joint.name}, which may go slack" for joint in mechanism.joints if joint.tension_only]
    named += [f"the curve {joint.name}, which may lift off" for joint in mechanism.joints if joint.one_sided]
    named += [f"the impulse {blow.name}" for blow in mechanism.blows]
    whens = [blow.when for blow in mechanism.blows]
    named += [f"the condition {condition.name}" for condition in mechanism.conditions if condition not in whens]
    named += [f"the drive {law.name}, whose rate jumps" for law in mechanism.laws if rate_jumps(law.value, last)]
    problems = [Problem("method-scene", f"{method.name} does not run {name}", hint=SMOOTH_ONLY) for name in named]
    for expression in mechanism.expressions():
        if expression.uses and expression.held:
            source = expression.source.strip()
            message = f"{method.name} does not run '{source}', which jumps or bends with a coordinate"
            problems.append(Problem("method-scene", message, expression.location, SMOOTH_ONLY))
    if problems:
        raise SpecError(*problems)


def gave_up(method: Method, t: float, why: str) -> SolveError:
    """The error of a run that SciPy does not continue."""
    hint = "method: auto tells more of what happens there"
    message = f"at t = {t:.9g} s: {method.name} gave up: {why.strip()}"
    error = SolveError(Problem("step-collapsed", message, hint=hint, about="analysis.method"))
    error.reached = t
    return error


def too_many(method: Method, most: int, t: float, last: float) -> LimitError:
    """The error of a run of more steps than are worth it."""
    message = f"{most} steps of {method.name} were done at t = {t:.6g} s of {last:.6g} s"
    return LimitError(Problem("step-limit", message, hint="a coarser tolerance, or method: auto"))
