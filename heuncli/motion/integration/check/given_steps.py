"""Explain why a run in fixed steps ended early: the step is too long, or no method can pass. Imported only for an
error.

A method with automatic steps is tried: if it passes the instant, the step was too long. The fastest rate of the
linearised motion at the start tells how long the step may be, where that rate is too fast for it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from heuncli.base.errors import HeunError, Problem, SolveError
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.run.runner import Runner
from heuncli.multibody.response import tangent

STABILITY_LIMIT = (
    2.0  # stable h |lambda| of explicit fixed-step methods: 2 for Euler's and Heun's, 2.5 for Heun3, 2.8 for RK4
)
STEP_MESSAGES = {
    "not-a-number": "a motion in steps of {step:g} s has no finite acceleration after this instant",
    "closure-lost": "with steps of {step:g} s closed loops cannot be assembled after this instant",
    "stages-unsolved": "the equations of a step of {step:g} s cannot be solved: Newton's iteration does not converge",
}


def explain_fixed_step_error(
    error: SolveError,
    runner: Runner,
    method: Method,
    step: float,
    run_with_automatic_steps: Callable[[], HeunError | None],
) -> SolveError:
    """Return the error to report in place of that of a run in fixed steps [s], which ended at `error.reached`.

    run_with_automatic_steps: returns how the motion fails with automatic steps, None if it reaches its end; called only
    if needed
    """
    problem, t = error.problems[0], error.reached
    if problem.code not in STEP_MESSAGES or t is None:
        return error
    other = run_with_automatic_steps()
    end = other.reached if isinstance(other, SolveError) and other.reached is not None else None
    if isinstance(other, SolveError) and (end is None or end <= t + step):
        return other  # no step would pass, and this error says where and why
    message = f"at t = {t:.9g} s: {STEP_MESSAGES[problem.code].format(step=step)}"
    hint = f"{suggest_step(runner, method, step)}, or --method auto, which chooses its own"
    if other is None:
        hint += " and reaches the end"
    elif end is not None:
        hint += f"; but that stops {other.problems[0].message}"
        hint += f": {other.problems[0].hint}" if other.problems[0].hint else ""
    explained = SolveError(Problem(problem.code, message, hint=hint, entry_path="analysis.step"))
    explained.reached = t
    return explained


def suggest_step(runner: Runner, method: Method, step: float) -> str:
    """Say which steps to try in place of a step [s]."""
    rate = 0.0 if method.implicit else fastest_rate(runner)
    if rate * step > STABILITY_LIMIT:
        return f"the fastest rate at the start is {rate:.2g} 1/s: use steps of {STABILITY_LIMIT / rate:.1g} s or less"
    return f"use steps shorter than {step:g} s"


def fastest_rate(runner: Runner) -> float:
    """Return the largest eigenvalue magnitude of the linearised motion at the start [1/s]; 0 if it has none."""
    integrated_scene = runner.integrated_scene
    start = integrated_scene.restrict(0.0, runner.layout.y0)
    linearised = tangent(integrated_scene.workspace, 0.0, start)
    if not np.isfinite(linearised).all():
        return 0.0
    return float(np.abs(np.linalg.eigvals(linearised)).max(initial=0.0))
