"""Which methods a chart runs, at which tolerances and with which steps.

Steps that nobody names go down by thirds from the mean step that the default takes at a coarse tolerance, in a stiff
motion from that of the stiff method: there those of low order are far off, and explicit ones beyond their bound.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Sequence

from heuncli.analyses.charting.motion import ChartedMotion
from heuncli.analyses.charting.results import ChartRow
from heuncli.base.errors import LimitError, Problem, SolveError, SpecError
from heuncli.base.method_rows import DEFAULT, METHODS, MethodRow, row_of
from heuncli.base.records import record
from heuncli.motion.integration.methods.registry import method_of
from heuncli.motion.integration.trajectory import Trajectory

TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
STEPS = 7  # of a method with fixed ones
COARSE = 1e-4  # local tolerance of the run whose mean step is the first
SECONDS = 2.0  # it may take
FOLLOWED = "followed"  # as a row: nothing is integrated
QUATERNION = "quaternion"


@record
class ChartOptions:
    """What a chart is asked for; None: as the scene suggests."""

    methods: tuple[str, ...] | None = None
    tolerances: tuple[float, ...] | None = None
    steps: tuple[float, ...] | None = None
    time_limit: float | None = None


@record
class ChartPlan:
    """The rows to run, in their order, and what is left out, in sentences."""

    rows: tuple[ChartRow, ...]
    notes: tuple[str, ...] = ()


def plan(motion: ChartedMotion, wanted: ChartOptions) -> ChartPlan:
    """What is run. Raises SpecError for tolerances that no method takes, or steps."""
    methods = [row for row in METHODS if wanted.methods is None or row.name in wanted.methods]
    notes: list[str] = []
    if wanted.methods is None and not has_attitudes(motion):
        others = [row.name for row in methods if row.attitude != QUATERNION]
        methods = [row for row in methods if row.attitude == QUATERNION]
        if others:
            notes.append(f"{' and '.join(others)} left out: nothing here turns freely in space, they are {DEFAULT}")
    require_use(methods, wanted)
    steps = wanted.steps
    if steps is None and any(row.steps == "fixed" for row in methods):
        steps = own_steps(motion)
    rows = [ChartRow(FOLLOWED, QUATERNION, False, 0.0)] if motion.determined and wanted.methods is None else []
    for row in methods:
        fixed = row.steps == "fixed"
        values = (steps or ()) if fixed else wanted.tolerances or TOLERANCES
        rows += [ChartRow(row.name, row.attitude, fixed, value) for value in sorted(set(values), reverse=True)]
    return ChartPlan(tuple(rows), tuple(notes))


def require_use(methods: Sequence[MethodRow], wanted: ChartOptions) -> None:
    """Raise SpecError where what is given would do nothing."""
    kinds = {row.steps for row in methods}
    for given, of, option, what in (
        (wanted.tolerances, "adaptive", "--tolerances", "choose their steps by a tolerance"),
        (wanted.steps, "fixed", "--steps", "take fixed steps"),
    ):
        if given is not None and of not in kinds:
            message = f"{option}: none of the methods would {what}"
            known = ", ".join(row.name for row in METHODS if row.steps == of)
            raise SpecError(Problem("bad-option", message, hint=f"those that do: {known or 'none'}"))


def has_attitudes(motion: ChartedMotion) -> bool:
    """Whether the attitude of some body is integrated: of one on a ball joint, or on nothing."""
    return bool(motion.setup.runner.moving.layout.bodies["ball"].any())


def own_steps(motion: ChartedMotion) -> tuple[float, ...]:
    """Steps for the methods that take given ones, descending by thirds [s]: 0.03, 0.01, 0.003, ..."""
    last = float(motion.times[-1])
    mean = last / 100.0
    with contextlib.suppress(SolveError, LimitError):  # the rows of the default tell why
        method = motion.stiff.method if motion.stiff is not None else method_of(DEFAULT)
        mean = mean_step(motion.runs(method, SECONDS).run(COARSE, motion.times), last)
    k = math.floor(2.0 * math.log10(mean))  # halves of decades
    return tuple(half_decade(k - i) for i in range(STEPS))


def mean_step(run: Trajectory, last: float) -> float:
    """The mean step of a run to an instant [s]."""
    return last / max(run.steps, 1)


def half_decade(k: int) -> float:
    """10 to the power of k/2, with one digit: 1 or 3."""
    return float(f"{'3' if k % 2 else '1'}e{k // 2}")


def order_of(name: str) -> int:
    """The order of a method."""
    row = row_of(name)
    return row.order if row is not None else 1
