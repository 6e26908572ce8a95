"""The motion that a chart compares: what `heun run` would integrate, over the same instants.

Impure: reads the clock.
"""

from __future__ import annotations

import time
from functools import cached_property

import numpy as np

from heuncli.base.errors import LimitError, Problem, SolveError, SpecError
from heuncli.base.method_rows import AUTO, DEFAULT
from heuncli.base.records import record
from heuncli.motion.integration.check.runs import Runs
from heuncli.motion.integration.integrated_scene import BY_JOINTS
from heuncli.motion.integration.methods.method import Method, load_method_by_name
from heuncli.motion.integration.run.request import StiffRun
from heuncli.results.results import Array
from heuncli.scene.file_format.models import ResultCondition, Spec
from heuncli.study.model.setup import Setup, set_up
from heuncli.study.solve.history import check_start

# local tolerance, and time limit, of the run that detects stiffness
STIFFNESS_TEST_TOLERANCE, STIFFNESS_TEST_SECONDS = (1e-8, 10.0)
TIME_LIMIT_TEXT = "the time limit was reached before a reference was found"
NO_MOTION_HINT = "a chart compares how a motion is integrated; request one: analysis: {duration: 2, samples: 201}"


@record
class MotionProblem:
    """A scene that is set up to move.

    times: requested instants [s], up to the one at which a condition on results ends the motion
    jumps: times of its discontinuities
    deadline: in terms of time.monotonic()
    end_note: sentence about what ends the motion, if anything does
    """

    setup: Setup
    times: Array
    jumps: tuple[float, ...]
    deadline: float | None
    end_note: str = ""

    @property
    def is_determined(self) -> bool:
        """Whether no freedom is left, so that the drives determine every instant."""
        return self.setup.method is not None and self.setup.method.is_determined

    def make_runs(self, method: Method, seconds: float | None = None, times: Array | None = None) -> Runs:
        """Return runs by a method, each within `seconds`, and all within the time limit.

        times: instants other than the requested ones
        """
        limits = [] if self.deadline is None else [self.deadline]
        if seconds is not None:
            limits.append(time.monotonic() + seconds)
        instants = self.times if times is None else times
        return Runs(self.setup.runner, instants, self.jumps, min(limits, default=None), method)

    @cached_property
    def stiffness(self) -> StiffRun | None:
        """The Stiff exception of a motion too stiff for an explicit method; None if it is not stiff."""
        if self.is_determined:
            return None
        runs = self.make_runs(load_method_by_name(DEFAULT), STIFFNESS_TEST_SECONDS)
        runs.watch_stiffness = True
        try:
            runs.run(STIFFNESS_TEST_TOLERANCE)
        except StiffRun as stiff:
            return stiff
        except (SolveError, LimitError):
            return None  # the reference run shows the reason
        return None

    @property
    def late(self) -> bool:
        """Whether the time limit is exceeded."""
        return self.deadline is not None and time.monotonic() > self.deadline


def make_motion(spec: Spec, deadline: float | None) -> MotionProblem:
    """Return the motion of a spec. Raises SpecError [nothing-to-chart] if it asks for none, SolveError if nothing can
    move.
    """
    if spec.analysis.type != "motion":
        reasons = {"rest": "a rest position has no motion", "impulse": "an impulse is one instant"}
        message = f"{reasons.get(spec.analysis.type, 'a state is one instant')}: there is nothing to integrate"
        raise SpecError(Problem("nothing-to-chart", message, hint=NO_MOTION_HINT))
    spec, ends = resolve_end(spec, deadline)
    setup = set_up(spec, AUTO)
    if BY_JOINTS in setup.model.get("reduced", ()):
        raise SolveError(Problem("nothing-to-chart", BY_JOINTS, hint="free a joint, or drive one"))
    jumps = check_start(setup)
    return MotionProblem(setup, np.array(spec.analysis.times, dtype=float), jumps, deadline, ends)


def resolve_end(spec: Spec, deadline: float | None) -> tuple[Spec, str]:
    """Replace a condition on results that ends the motion by the end time that `heun run` finds."""
    ending = next((c for c in spec.analysis.conditions if c.ends and isinstance(c, ResultCondition)), None)
    if ending is None:
        return spec, ""
    from heuncli.study.model.options import Options  # few scenes end so
    from heuncli.study.workflow import solve  # few scenes end so

    seconds_left = None if deadline is None else deadline - time.monotonic()
    if seconds_left is not None and seconds_left <= 0.0:
        raise LimitError(Problem("time-limit", TIME_LIMIT_TEXT, hint="a longer --time-limit"))
    study = solve(spec, Options(requested_reports=frozenset(), time_limit=seconds_left))
    times = tuple(study.results.time.tolist())
    is_shortened = times[-1] < spec.analysis.times[-1]
    sentence = f"the motion ends at t = {times[-1]:.6g} s: {ending.text}" if is_shortened else ""
    return spec._replace(analysis=spec.analysis._replace(times=times, conditions=())), sentence
