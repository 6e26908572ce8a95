"""A run that events cut at nearly every step, tried by a method of fewer stages."""

from __future__ import annotations

from contextlib import suppress

from heuncli.base.errors import LimitError, SolveError
from heuncli.motion.integration.check.runs import Runs
from heuncli.motion.integration.methods.registry import method_of
from heuncli.motion.integration.run.errors import Eventful
from heuncli.motion.integration.run.event_frequency import FEW_STAGES
from heuncli.motion.integration.run.request import MotionTask, StoppingRules

TOLD = (
    "events: {cut} of the first {steps} steps end at one: up to t = {t:.3g} s {name} takes {few} evaluations, where "
    "{method} takes {many}"
)


def try_fewer_stages(runs: Runs, left: Eventful) -> bool:
    """Whether the runs go by a method of few stages from now on, and why; not where the one they had takes no more."""
    method, before = method_of(FEW_STAGES), [t for t in runs.jumps if t < left.reached]
    with suppress(SolveError, LimitError):
        most = left.evaluations // (len(method.nodes) - 1)
        request = MotionTask([left.reached], left.local, method, before, deadline=runs.deadline, most_steps=most)
        trial = runs.runner.trajectory(request, StoppingRules())
        if trial.evaluations < left.evaluations:
            left.told = TOLD.format(
                cut=left.cut, steps=left.steps, t=left.reached, name=method.name, few=trial.evaluations,
                method=runs.method.name, many=left.evaluations,
            )  # fmt: skip
            runs.method = method
            return True
    return False
