"""What a run will take, as far as its beginning shows: what is integrated, by which method, in how many steps.

Impure: looks at the clock.
"""

from __future__ import annotations

import time
from contextlib import suppress

import numpy as np

from heuncli.base.errors import LimitError, SolveError
from heuncli.base.method_rows import row_of
from heuncli.motion.integration.check.fewer_stages import try_fewer_stages
from heuncli.motion.integration.check.runs import Runs
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.run.errors import Eventful, Stiff
from heuncli.motion.integration.run.kernel_loop import depends
from heuncli.motion.integration.run.request import MotionTask, StoppingRules
from heuncli.motion.integration.segments import discontinuities_of
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.study.model.counts_and_lists import count
from heuncli.study.model.method_choice import is_smooth
from heuncli.study.model.setup import Setup

PART = 0.1  # of the run, which is tried
PATIENCE = 0.5  # seconds that the trial may take
MOST_STEPS = 2_000


def outlook(setup: Setup) -> list[str]:
    """What is integrated, and what the first part of the run takes, in sentences."""
    if setup.spec.analysis.type == "rest":
        return ["nothing: what is looked for is the pose at rest that a heavily damped motion from the start comes to"]
    if setup.method is None:
        return ["nothing: one instant is solved"]
    if setup.method.determined:
        return ["nothing: every instant is solved by itself, along its branch"]
    layout, tolerance = setup.runner.moving.layout, setup.spec.analysis.tolerance
    how = f"to {tolerance:.3g} of the scene's size; then once more at a thirtieth of that, to check"
    if setup.step is not None:
        how = f"in steps of {setup.step:.4g} s; then once more in quarters of them, to check"
    row = row_of(setup.method.name)
    kind = f"{row.kind} " if row is not None and row.kind != "SciPy" else ""
    sentence = (
        f"{count(layout.n_state, 'number')} of state, by {setup.method.name}, an {kind}method of order "
        f"{setup.method.order}, {how}"
    )
    return [sentence, *pace(setup, tolerance if setup.step is None else setup.step)]


def noticed(setup: Setup) -> tuple[Method, str] | None:
    """By which method the run would be begun anew, and why: where its beginning is stiff, or events end its steps."""
    if not setup.auto or setup.method is None or setup.method.determined:
        return None
    mechanism, last = setup.scene.mechanism, float(setup.spec.analysis.times[-1])
    if not (any(depends(load) for load in mechanism.loads) or not is_smooth(setup.runner.moving.layout)):
        return None
    with suppress(SolveError, LimitError):
        try:
            begun(setup, setup.spec.analysis.tolerance, last, watched=True)
        except Stiff as stiff:
            return stiff.method, stiff.told
        except Eventful as left:
            jumps = discontinuities_of(mechanism, left.reached)
            runs = Runs(setup.runner, np.array([left.reached]), jumps, None, setup.method)
            return (runs.method, left.told) if try_fewer_stages(runs, left) else None
    return None


def pace(setup: Setup, local: float) -> list[str]:
    """What the first part of the run takes; nothing is told where that cannot be solved: the run will say why."""
    last = PART * float(setup.spec.analysis.times[-1])
    whole = round(1.0 / PART)
    with suppress(SolveError):
        try:
            run = min((begun(setup, local, last) for _ in range(2)), key=lambda run: run.seconds)
        except LimitError:
            return [f"the first {last:.4g} s take more than {MOST_STEPS:,} steps or {PATIENCE} s: a long run"]
        steps, evaluations = count(run.steps, "step"), count(run.evaluations, "evaluation")
        check = "1.3 to 1.5" if setup.step is None else "5"
        took = f"the first {last:.4g} s take {steps}, {evaluations}, {1e3 * run.seconds:.2g} ms"
        return [f"{took}: {whole} times that if it goes on so, and {check} times as much for the check"]
    return []


def begun(setup: Setup, local: float, last: float, *, watched: bool = False) -> Trajectory:
    """The first part of the run."""
    jumps = tuple(discontinuities_of(setup.scene.mechanism, last))
    assert setup.method is not None
    deadline = time.monotonic() + PATIENCE
    request = MotionTask([0.0, last], local, setup.method, jumps, deadline=deadline, most_steps=MOST_STEPS)
    return setup.runner.trajectory(request, StoppingRules(stiffness=watched, events=watched))
