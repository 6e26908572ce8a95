"""The motion that a chart is made of: what `heun run` would integrate, over the instants it would tell.

Impure: looks at the clock.
"""

from __future__ import annotations

import time
from functools import cached_property

import numpy as np

from heuncli.base.errors import LimitError, Problem, SolveError, SpecError
from heuncli.base.method_rows import AUTO, DEFAULT
from heuncli.base.records import record
from heuncli.motion.integration.check.runs import Runs
from heuncli.motion.integration.determined_motion import BY_JOINTS
from heuncli.motion.integration.methods.method import Method
from heuncli.motion.integration.methods.registry import method_of
from heuncli.motion.integration.run.errors import Stiff
from heuncli.results.results import Array
from heuncli.scene.file_format.models import ResultCondition, Spec
from heuncli.study.model.setup import Setup, set_up
from heuncli.study.solve.history import begin

NOTICED, PATIENCE = 1e-8, 10.0  # local tolerance of the run by which stiffness is noticed; seconds it may take
NO_TIME = "the time limit was reached before a reference was found"
NEEDS_MOTION = "a chart compares how a motion is integrated; ask for one: analysis: {duration: 2, samples: 201}"


@record
class ChartedMotion:
    """A scene set up to move.

    times: asked ones [s], up to where a condition on results ends it; jumps: its discontinuities in time; deadline:
    time.monotonic(); ends: the sentence on what ends it, if anything does.
    """

    setup: Setup
    times: Array
    jumps: tuple[float, ...]
    deadline: float | None
    ends: str = ""

    @property
    def determined(self) -> bool:
        """Whether nothing is free, and every instant follows from the drives."""
        return self.setup.method is not None and self.setup.method.determined

    def runs(self, method: Method, seconds: float | None = None, times: Array | None = None) -> Runs:
        """Runs by a method, each within so many seconds, and all within the time limit; times: other instants."""
        limits = [] if self.deadline is None else [self.deadline]
        if seconds is not None:
            limits.append(time.monotonic() + seconds)
        at = self.times if times is None else times
        return Runs(self.setup.runner, at, self.jumps, min(limits, default=None), method)

    @cached_property
    def stiff(self) -> Stiff | None:
        """What tells that the motion is stiff, so that an explicit method would only crawl; None where it is not."""
        if self.determined:
            return None
        runs = self.runs(method_of(DEFAULT), PATIENCE)
        runs.watched = True
        try:
            runs.run(NOTICED)
        except Stiff as stiff:
            return stiff
        except (SolveError, LimitError):
            return None  # the reference tells
        return None

    @property
    def late(self) -> bool:
        """Whether the time limit is past."""
        return self.deadline is not None and time.monotonic() > self.deadline


def motion_of(spec: Spec, deadline: float | None) -> ChartedMotion:
    """The motion of a spec. Raises SpecError where it asks for none, SolveError where nothing can move."""
    if spec.analysis.type != "motion":
        what = {"rest": "a rest pose is looked for, not integrated", "impulse": "an impulse is one instant"}
        message = f"{what.get(spec.analysis.type, 'a state is one instant')}: no method has anything to integrate"
        raise SpecError(Problem("nothing-to-chart", message, hint=NEEDS_MOTION))
    spec, ends = up_to_its_end(spec, deadline)
    setup = set_up(spec, AUTO)
    if BY_JOINTS in setup.model.get("reduced", ()):
        raise SolveError(Problem("nothing-to-chart", BY_JOINTS, hint="free a joint, or drive one"))
    jumps = begin(setup)
    return ChartedMotion(setup, np.array(spec.analysis.times, dtype=float), jumps, deadline, ends)


def up_to_its_end(spec: Spec, deadline: float | None) -> tuple[Spec, str]:
    """A motion that ends on a number of its results, without the condition: up to the instant that `heun run` finds."""
    ending = next((c for c in spec.analysis.conditions if c.ends and isinstance(c, ResultCondition)), None)
    if ending is None:
        return spec, ""
    from heuncli.study.model.options import Options  # few scenes end so
    from heuncli.study.workflow import solve  # few scenes end so

    left = None if deadline is None else deadline - time.monotonic()
    if left is not None and left <= 0.0:
        raise LimitError(Problem("time-limit", NO_TIME, hint="a longer --time-limit"))
    found = solve(spec, Options(wanted=frozenset(), time_limit=left))
    times = tuple(found.results.time.tolist())
    ended = times[-1] < spec.analysis.times[-1]
    sentence = f"the motion ends at t = {times[-1]:.6g} s: {ending.text}" if ended else ""
    return spec._replace(analysis=spec.analysis._replace(times=times, conditions=())), sentence
