"""Why a run in given steps ended before its time: a step too long, or what no method can pass. Only for an error.

A method that finds its own steps is asked: where it passes the instant, the step was too long. What the step would have
to be, the fastest rate of the linearised motion at the start tells where that is too fast for it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from heuncli.base.errors import HeunError, Problem, SolveError
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.run.runner import Runner
from heuncli.multibody.response import tangent

BORNE = 2.0  # h |lambda| that explicit methods of given step bear: 2 of Euler's and Heun's, 2.5 of Heun3, 2.8 of RK4
BLAMED = {
    "not-a-number": "a motion in steps of {step:g} s has no finite acceleration beyond this instant",
    "closure-lost": "steps of {step:g} s cannot hold the closed chains together beyond this instant",
    "stages-unsolved": "the equations of a step of {step:g} s are not solved: Newton's iteration does not contract",
}


def of_given_steps(
    error: SolveError, runner: Runner, method: Method, step: float, in_own_steps: Callable[[], HeunError | None]
) -> SolveError:
    """The error to be told in place of that of a run in given steps [s], which ended at `error.reached`.

    in_own_steps: how the motion fails in steps that a method finds, None where it comes to its end; asked at need.
    """
    problem, t = error.problems[0], error.reached
    if problem.code not in BLAMED or t is None:
        return error
    other = in_own_steps()
    end = other.reached if isinstance(other, SolveError) and other.reached is not None else None
    if isinstance(other, SolveError) and (end is None or end <= t + step):
        return other  # what no step would pass, and it tells where and why
    message = f"at t = {t:.9g} s: {BLAMED[problem.code].format(step=step)}"
    hint = f"{shorter(runner, method, step)}, or --method auto, which finds its own"
    if other is None:
        hint += " and comes to the end"
    elif end is not None:
        hint += f"; but that ends {other.problems[0].message}"
        hint += f": {other.problems[0].hint}" if other.problems[0].hint else ""
    found = SolveError(Problem(problem.code, message, hint=hint, about="analysis.step"))
    found.reached = t
    return found


def shorter(runner: Runner, method: Method, step: float) -> str:
    """What steps to try in place of a step [s], in words."""
    rate = 0.0 if method.implicit else fastest_rate(runner)
    if rate * step > BORNE:
        return f"the fastest rate at the start is {rate:.2g} 1/s: steps of {BORNE / rate:.1g} s and less"
    return f"a shorter step than {step:g} s"


def fastest_rate(runner: Runner) -> float:
    """The largest magnitude among the eigenvalues of the linearised motion at the start [1/s]; 0 where it has none."""
    moving = runner.moving
    start = moving.restrict(0.0, runner.layout.y0)
    linearised = tangent(moving.workspace, 0.0, start)
    if not np.isfinite(linearised).all():
        return 0.0
    return float(np.abs(np.linalg.eigvals(linearised)).max(initial=0.0))
