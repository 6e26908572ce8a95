"""Forecast a run from its first part: what is integrated, by which method, in how many steps.

Impure: reads the clock.
"""

from __future__ import annotations

import time
from contextlib import suppress

import numpy as np

from heuncli.base.errors import LimitError, SolveError
from heuncli.base.method_rows import find_method
from heuncli.base.spelling import format_count
from heuncli.motion.integration.check.runs import Runs, try_fewer_stages
from heuncli.motion.integration.integrated_scene import find_discontinuities
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.run.kernel_loop import depends_on_state
from heuncli.motion.integration.run.request import EventfulRun, MotionTask, StiffRun, StoppingRules
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.study.model.model_note import is_smooth
from heuncli.study.model.setup import Setup

TRIAL_SHARE = 0.1  # share of the run that the trial integrates
MAX_TRIAL_SECONDS = 0.5  # seconds for the trial
MAX_STEPS = 2_000


def describe_integration(setup: Setup) -> list[str]:
    """Describe in sentences what is integrated, and what the first part of the run costs."""
    if setup.spec.analysis.type == "rest":
        return ["none: search for the rest position that a heavily damped motion from the start would reach"]
    if setup.method is None:
        return ["none: one instant is solved"]
    if setup.method.is_determined:
        return ["none: motion fully prescribed, solved at each instant on the same assembly branch"]
    layout, tolerance = setup.runner.integrated_scene.layout, setup.spec.analysis.tolerance
    how = f"tolerance {tolerance:.3g} of the model size; repeated at 1/30 of this tolerance as a check"
    if setup.step is not None:
        how = f"in steps of {setup.step:.4g} s; repeated with steps of a quarter as a check"
    row = find_method(setup.method.name)
    kind = f"an {row.kind}" if row is not None and row.kind != "SciPy" else "a"
    sentence = (
        f"{format_count(layout.n_state, 'state variable')}, integrated by {setup.method.name}, {kind} method of order "
        f"{setup.method.order}, {how}"
    )
    return [sentence, *describe_cost(setup, tolerance if setup.step is None else setup.step)]


def find_restart_method(setup: Setup) -> tuple[Method, str] | None:
    """Find the method that the run would be restarted with, and why; None if it would not.

    A run is restarted if its beginning is stiff, or if events end most steps.
    """
    if not setup.is_auto or setup.method is None or setup.method.is_determined:
        return None
    mechanism, last = setup.scene.mechanism, float(setup.spec.analysis.times[-1])
    if not (
        any(depends_on_state(load) for load in mechanism.loads) or not is_smooth(setup.runner.integrated_scene.layout)
    ):
        return None
    with suppress(SolveError, LimitError):
        try:
            run_first_part(setup, setup.spec.analysis.tolerance, last, stops_early=True)
        except StiffRun as stiff:
            return stiff.method, stiff.reason
        except EventfulRun as eventful:
            jumps = find_discontinuities(mechanism, eventful.end_time)
            runs = Runs(setup.runner, np.array([eventful.end_time]), jumps, None, setup.method)
            return (runs.method, eventful.reason) if try_fewer_stages(runs, eventful) else None
    return None


def describe_cost(setup: Setup, tolerance_or_step: float) -> list[str]:
    """Describe what the first part of the run costs; empty if it cannot be solved, because the run itself will say
    why.
    """
    last = TRIAL_SHARE * float(setup.spec.analysis.times[-1])
    whole = round(1.0 / TRIAL_SHARE)
    with suppress(SolveError):
        try:
            run = min((run_first_part(setup, tolerance_or_step, last) for _ in range(2)), key=lambda run: run.seconds)
        except LimitError:
            return [f"the first {last:.4g} s take over {MAX_STEPS:,} steps or {MAX_TRIAL_SECONDS} s: a long run"]
        steps, evaluations = format_count(run.steps, "step"), format_count(run.evaluations, "evaluation")
        check = "1.3 to 1.5" if setup.step is None else "5"
        took = f"the first {last:.4g} s take {steps}, {evaluations}, {1e3 * run.seconds:.2g} ms"
        return [f"{took}; the whole run about {whole} times that, and the check {check} times as much again"]
    return []


def run_first_part(setup: Setup, tolerance_or_step: float, last: float, *, stops_early: bool = False) -> Trajectory:
    """Integrate the run up to `last`."""
    jumps = tuple(find_discontinuities(setup.scene.mechanism, last))
    assert setup.method is not None
    deadline = time.monotonic() + MAX_TRIAL_SECONDS
    request = MotionTask([0.0, last], tolerance_or_step, setup.method, jumps, deadline=deadline, most_steps=MAX_STEPS)
    return setup.runner.run(request, StoppingRules(stiffness=stops_early, events=stops_early))
