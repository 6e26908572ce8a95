"""Run a scene with SciPy's integrators as independent checks: the kernel's derivative, their steps and dense output.

The derivative is taken at the state projected onto the closures: so the exact motion solves this equation, too, and the
closure error of a step does not grow. The integrators restart at every discontinuity in time. Events need the kernel's
dense output and the branches held over a step: so scenes with contacts, impulses, branches in coordinates or conditions
are refused by name. SciPy is imported only where such a method is requested.
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
from heuncli.motion.integration.contacts.impulses import find_rate_jumps
from heuncli.motion.integration.integrated_scene import IntegratedScene, Segment, Segments, make_segments
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.run.request import MotionTask
from heuncli.motion.integration.run.supervision import check_deadline
from heuncli.motion.integration.trajectory import StepRecords, Trajectory
from heuncli.multibody.response import settle_state, slope
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

MIN_RELATIVE_TOLERANCE = 100.0 * tolerances.EPS  # SciPy's smallest relative tolerance


@record
class ScipySteps:
    """The steps done: their ends, the states there, and the interpolant within each."""

    ends: list[float]
    states: list[Array]
    interpolants: list[Callable[[float], Array]]
    pieces: list[Segment]

    def interpolate(self, integrated_scene: IntegratedScene, times: Array) -> Array:
        """Return the scene's states (n_t, n) at instants within the run."""
        steps = np.minimum(np.searchsorted(self.ends, times), len(self.ends) - 1)
        integrated_states = [
            self.states[0] if t <= 0.0 else self.interpolants[k](float(t)) for k, t in zip(steps, times, strict=True)
        ]
        return integrated_scene.embed(
            times, np.array(integrated_states).reshape(len(times), integrated_scene.layout.n_state)
        )


class Derivative:
    """dy/dt of the integrated scene, on the closures; counts its calls. Impure: records the largest gap."""

    def __init__(self, integrated_scene: IntegratedScene) -> None:
        self.integrated_scene, self.count, self.gap = integrated_scene, 0, 0.0
        self.begin = self.end = 0.0

    def __call__(self, t: float, y: Array) -> Array:
        """Return the derivative at an instant of the segment; outside of it other branches in time would hold."""
        self.count += 1
        rate, gap = slope(self.integrated_scene.workspace, min(max(t, self.begin), self.end), y)
        self.gap = max(self.gap, gap)
        return rate


def run_scipy(layout: Layout, integrated_scene: IntegratedScene, request: MotionTask) -> Trajectory:
    """Run a scene with one of SciPy's methods and return the same as `Runner.run`.

    Raises SpecError for scenes that they do not run, SolveError where they fail, LimitError past the deadline.
    """
    clock_start = time.perf_counter()
    times, method, last = request.instants, request.method, request.last
    require_smooth(layout, method, last)
    state = integrated_scene.restrict(0.0, layout.y0 if request.start is None else request.start)
    derivative = Derivative(integrated_scene)
    scipy_steps = ScipySteps([], [state], [], [])
    scipy_integration = ScipyIntegration(derivative, request, min(request.most_steps, tolerances.MOST_FOREIGN))
    for segment in make_segments(last, request.discontinuities):
        scipy_steps.pieces.append(segment)
        scipy_integration.run_segment(
            segment,
            settle_state(integrated_scene.workspace, integrated_scene.layout, segment.begin, scipy_steps.states[-1])[0],
            scipy_steps,
        )
    scene_states = scipy_steps.interpolate(integrated_scene, times)
    steps = len(scipy_steps.ends)
    records = StepRecords(np.arange(len(scipy_steps.states)), np.array(scipy_steps.states))
    return Trajectory(
        times=times,
        states=scene_states,
        ends=np.array(scipy_steps.ends),
        steps=steps,
        evaluations=derivative.count,
        gap=derivative.gap,
        local=request.local,
        method=method,
        seconds=time.perf_counter() - clock_start,
        segments=Segments(np.array(scipy_steps.pieces)),
        records=records,
        pivots=np.ones(steps),
        is_projected=np.ones(steps),
        branches=np.zeros((steps, 0)),
        branch_changed=np.zeros(steps),
        holding=np.zeros((steps + 1, 0)),
        interpolate=lambda at: scipy_steps.interpolate(integrated_scene, at),
    )


@record
class ScipyIntegration:
    """Integrates a run with SciPy, one segment after the other."""

    derivative: Derivative
    request: MotionTask
    most_steps: int

    def run_segment(self, segment: Segment, state: Array, scipy_steps: ScipySteps) -> None:
        """Add the steps of a segment from a state to those done."""
        self.derivative.begin, self.derivative.end = segment.begin, segment.before_end
        if segment.end <= segment.begin:
            return
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # SciPy's warning on the tolerance; the error estimate covers it
            solver = self.make_solver(segment, state)
            while solver.status == "running":
                self.take_step(solver)
                scipy_steps.ends.append(float(solver.t))
                scipy_steps.states.append(np.array(solver.y))
                scipy_steps.interpolants.append(solver.dense_output())
                check_deadline(self.request.deadline, f"at t = {solver.t:.6g} s of {self.request.last:.6g} s")
                if len(scipy_steps.ends) > self.most_steps:
                    raise step_limit_error(self.request.method, self.most_steps, solver.t, self.request.last)

    def make_solver(self, segment: Segment, state: Array) -> Any:
        """Make SciPy's solver at the start of a segment."""
        from scipy import integrate  # not before it is needed: a third of a second

        solver_class = getattr(integrate, self.request.method.scipy_name)
        scale = find_error_scales(self.derivative, segment.begin, state, self.request.last)
        relative_tolerance = max(self.request.local, MIN_RELATIVE_TOLERANCE)
        try:
            return solver_class(
                self.derivative,
                segment.begin,
                state,
                segment.end,
                rtol=relative_tolerance,
                atol=self.request.local * scale,
            )
        except (ValueError, ArithmeticError) as error:
            raise give_up_error(self.request.method, segment.begin, str(error)) from None

    def take_step(self, solver: Any) -> None:
        """Take one step. Raises SolveError if it fails."""
        try:
            message = solver.step()
        except (ValueError, ArithmeticError, np.linalg.LinAlgError) as error:  # it factored nan
            raise give_up_error(self.request.method, float(solver.t), str(error)) from None
        if solver.status == "failed" or not np.isfinite(solver.y).all():
            raise give_up_error(self.request.method, float(solver.t), str(message or "a value is no longer a number"))


def find_error_scales(derivative: Derivative, t: float, state: Array, last: float) -> Array:
    """Return the error scales of the components: 1 rad, the scene's size, and these times the scene's rate."""
    integrated_scene = derivative.integrated_scene
    weights = np.asarray(integrated_scene.layout.weights)
    groups = integrated_scene.layout.tables["groups"]
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
    """Raise SpecError for each feature of a run up to `last` that only the kernel's own methods handle."""
    mechanism = layout.mechanism
    feature_names = [f"the stop {stop.name}" for stop in mechanism.stops]
    feature_names += [f"the friction {friction.load.name}, which sticks" for friction in mechanism.iter_sticking()]
    feature_names += [f"the rope {joint.name}, which may go slack" for joint in mechanism.joints if joint.tension_only]
    feature_names += [f"the curve {joint.name}, which may lift off" for joint in mechanism.joints if joint.one_sided]
    feature_names += [f"the impulse {blow.name}" for blow in mechanism.impulses]
    whens = [blow.when for blow in mechanism.impulses]
    feature_names += [f"the condition {condition.name}" for condition in mechanism.conditions if condition not in whens]
    feature_names += [
        f"the drive {law.name}, whose rate jumps" for law in mechanism.laws if find_rate_jumps(law.value, last)
    ]
    problems = [
        Problem("method-scene", f"{method.name} does not support {name}", hint=SMOOTH_ONLY) for name in feature_names
    ]
    for expression in mechanism.iter_expressions():
        if expression.uses and expression.held_branches:
            source = expression.source.strip()
            message = f"{method.name} does not support '{source}', which has a jump or kink in a coordinate"
            problems.append(Problem("method-scene", message, expression.location, SMOOTH_ONLY))
    if problems:
        raise SpecError(*problems)


def give_up_error(method: Method, t: float, why: str) -> SolveError:
    """Make the error of a run that SciPy does not continue."""
    hint = "method: auto reports more about the cause"
    message = f"at t = {t:.9g} s: {method.name} gave up: {why.strip()}"
    error = SolveError(Problem("step-collapsed", message, hint=hint, entry_path="analysis.method"))
    error.reached = t
    return error


def step_limit_error(method: Method, most: int, t: float, last: float) -> LimitError:
    """Make the error of a run with too many steps."""
    message = f"{most} steps of {method.name} were done at t = {t:.6g} s of {last:.6g} s"
    return LimitError(Problem("step-limit", message, hint="use a coarser tolerance, or method: auto"))
