"""Try a method of fewer stages for a run that events interrupt at nearly every step."""

from __future__ import annotations

from contextlib import suppress

from heuncli.base.errors import LimitError, SolveError
from heuncli.motion.integration.check.runs import Runs
from heuncli.motion.integration.methods.registry import load_method_by_name
from heuncli.motion.integration.run.errors import EventfulRun
from heuncli.motion.integration.run.event_frequency import FEW_STAGES
from heuncli.motion.integration.run.request import MotionTask, StoppingRules

MESSAGE = (
    "events (contact, condition, jump, table point) end {cut} of the first {steps} steps; up to t = {t:.3g} s "
    "{name} takes {few} evaluations, {method} {many}"
)


def try_fewer_stages(runs: Runs, eventful: EventfulRun) -> bool:
    """Switch the runs to a method of few stages if it takes fewer evaluations, and record why; return whether it
    did.
    """
    method, jumps = load_method_by_name(FEW_STAGES), [t for t in runs.jumps if t < eventful.end_time]
    with suppress(SolveError, LimitError):
        most = eventful.evaluations // (len(method.nodes) - 1)
        request = MotionTask(
            [eventful.end_time], eventful.local, method, jumps, deadline=runs.deadline, most_steps=most
        )
        trial = runs.runner.run(request, StoppingRules())
        if trial.evaluations < eventful.evaluations:
            eventful.reason = MESSAGE.format(
                cut=eventful.cut, steps=eventful.steps, t=eventful.end_time, name=method.name, few=trial.evaluations,
                method=runs.method.name, many=eventful.evaluations,
            )  # fmt: skip
            runs.method = method
            return True
    return False
