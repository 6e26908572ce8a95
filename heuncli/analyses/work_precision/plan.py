"""Choose the methods that a chart runs, with their tolerances and steps.

Default steps decrease by half decades, from the mean step that the default method takes at a coarse tolerance; in a
stiff motion, from that of the stiff method: there methods of low order are inaccurate, and explicit ones unstable.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Sequence

from heuncli.analyses.work_precision.motion import MotionProblem
from heuncli.analyses.work_precision.results import ChartRow
from heuncli.base.errors import LimitError, Problem, SolveError, SpecError
from heuncli.base.method_rows import DEFAULT, METHODS, MethodRow, find_method
from heuncli.base.records import record
from heuncli.motion.integration.methods.method import load_method_by_name
from heuncli.motion.integration.trajectory import Trajectory

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
