"""What a chart compares: the motion of `heun run` over its instants, and the methods with their tolerances and steps.

Default steps decrease by half decades, from the mean step that the default method takes at a coarse tolerance; in a
stiff motion, from that of the stiff method: there methods of low order are inaccurate, and explicit ones unstable.
"""

from __future__ import annotations

import contextlib
import math
import time
from collections.abc import Sequence
from functools import cached_property

import numpy as np

from heuncli.analyses.work_precision.results import ChartRow
from heuncli.base.errors import LimitError, Problem, SolveError, SpecError
from heuncli.base.method_rows import AUTO, DEFAULT, METHODS, MethodRow, find_method
from heuncli.base.records import record
from heuncli.motion.integration.check.runs import Runs
from heuncli.motion.integration.integrated_scene import BY_JOINTS
from heuncli.motion.integration.methods.method import Method, load_method_by_name
from heuncli.motion.integration.run.request import StiffRun
from heuncli.motion.integration.trajectory import Trajectory
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


TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
STEP_COUNT = 7  # of a method with fixed ones
COARSE_TOLERANCE = 1e-4  # local tolerance of the run whose mean step is the first
MAX_COARSE_SECONDS = 2.0  # time limit of that run
FOLLOWED = "followed"  # as a row: nothing is integrated
QUATERNION = "quaternion"


@record
class ChartOptions:
    """Options of a chart; None means that the scene decides."""

    methods: tuple[str, ...] | None = None
    tolerances: tuple[float, ...] | None = None
    steps: tuple[float, ...] | None = None
    time_limit: float | None = None


@record
class ChartPlan:
    """The rows to run, in order, and notes on methods that are left out."""

    rows: tuple[ChartRow, ...]
    notes: tuple[str, ...] = ()


def plan_chart(motion: MotionProblem, options: ChartOptions) -> ChartPlan:
    """Return the rows to run. Raises SpecError [bad-option] for tolerances or steps that no method uses."""
    methods = [row for row in METHODS if options.methods is None or row.name in options.methods]
    notes: list[str] = []
    if options.methods is None and not has_attitudes(motion):
        others = [row.name for row in methods if row.attitude != QUATERNION]
        methods = [row for row in methods if row.attitude == QUATERNION]
        if others:
            notes.append(f"{' and '.join(others)} omitted: no body rotates freely in space, so they equal {DEFAULT}")
    require_usable_options(methods, options)
    steps = options.steps
    if steps is None and any(row.steps == "fixed" for row in methods):
        steps = choose_steps(motion)
    rows = [ChartRow(FOLLOWED, QUATERNION, False, 0.0)] if motion.is_determined and options.methods is None else []
    for row in methods:
        is_fixed = row.steps == "fixed"
        values = (steps or ()) if is_fixed else options.tolerances or TOLERANCES
        rows += [ChartRow(row.name, row.attitude, is_fixed, value) for value in sorted(set(values), reverse=True)]
    return ChartPlan(tuple(rows), tuple(notes))


def require_usable_options(methods: Sequence[MethodRow], options: ChartOptions) -> None:
    """Raise SpecError [bad-option] if an option has no effect on any of the methods."""
    kinds = {row.steps for row in methods}
    for values, step_kind, option, phrase in (
        (options.tolerances, "adaptive", "--tolerances", "uses a tolerance"),
        (options.steps, "fixed", "--steps", "uses fixed steps"),
    ):
        if values is not None and step_kind not in kinds:
            message = f"{option}: none of the methods {phrase}"
            known = ", ".join(row.name for row in METHODS if row.steps == step_kind)
            raise SpecError(Problem("bad-option", message, hint=f"methods that do: {known or 'none'}"))


def has_attitudes(motion: MotionProblem) -> bool:
    """Return whether the attitude of some body is integrated: of one on a ball joint, or of a free one."""
    return bool(motion.setup.runner.integrated_scene.layout.bodies["ball"].any())


def choose_steps(motion: MotionProblem) -> tuple[float, ...]:
    """Return steps for the fixed-step methods, descending by half decades [s]: 0.03, 0.01, 0.003, ..."""
    last = float(motion.times[-1])
    mean = last / 100.0
    with contextlib.suppress(SolveError, LimitError):  # the rows of the default method show the reason
        method = motion.stiffness.method if motion.stiffness is not None else load_method_by_name(DEFAULT)
        mean = mean_step(motion.make_runs(method, MAX_COARSE_SECONDS).run(COARSE_TOLERANCE, motion.times), last)
    k = math.floor(2.0 * math.log10(mean))  # half decades
    return tuple(half_decade(k - i) for i in range(STEP_COUNT))


def mean_step(run: Trajectory, last: float) -> float:
    """Return the mean step of a run up to a time [s]."""
    return last / max(run.steps, 1)


def half_decade(k: int) -> float:
    """Return 10 to the power of k/2 with one digit: 1 or 3."""
    return float(f"{'3' if k % 2 else '1'}e{k // 2}")


def get_order(name: str) -> int:
    """Return the order of a method."""
    row = find_method(name)
    return row.order if row is not None else 1
