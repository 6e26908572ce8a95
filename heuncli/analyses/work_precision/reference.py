"""Compute the reference of a chart: a run of high order at the smallest tolerance, checked by a run of another method.

Both start from the same scene, the second from a start perturbed by rounding, so that the growth of rounding shows.
Twice their difference bounds the reference's error. Where they diverge, in a chaotic motion, the chart compares runs up
to where they still agree to half the digits: later differences show the growth, not the methods.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.analyses.work_precision.plan import TIME_LIMIT_TEXT, MotionProblem
from heuncli.analyses.work_precision.reference_comparison import ReferenceComparison, make_comparison
from heuncli.analyses.work_precision.results import KINDS, Errors, Reference
from heuncli.base import tolerances
from heuncli.base.errors import HeunError, LimitError, Problem, SolveError
from heuncli.base.method_rows import DEFAULT, find_method
from heuncli.base.records import record
from heuncli.motion.integration.check.estimate import estimate_errors
from heuncli.motion.integration.check.runs import Runs
from heuncli.motion.integration.methods.method import DRIVE_DETERMINED, load_method_by_name
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array
from heuncli.study.solve.error_estimates import ESTIMATED
from heuncli.study.solve.history import require_followed

# Pairs of methods, the first the reference; the second pair where the first does not agree, as in stiff scenes
PAIRS = (("Verner98", "DOP853"), ("Radau9", "Radau5"))
# local tolerances, the first by which the motion can be run
FINEST_TOLERANCES = (tolerances.LEAST_TOLERANCE, 1e-12, 1e-10)
MAX_SECONDS = 20.0  # time limit of one of these runs
SAME_METHOD_RATIO = 30.0  # of the tolerances of a run and of its check by the same method
AGREEMENT = 1e-9  # relative: if two runs agree so well, no other pair is tried
TOO_SHORT_TEXT = "the references agree only up to t = {:.6g} s, before the first output time: no errors can be found"
TOO_SHORT_HINT = "more samples, or a shorter duration"
SOLVED_TEXT = "each instant solved separately"  # text for a motion that is solved instant by instant
AGREEMENT_TEXTS = {
    "motion": "motion to {} of the model size",
    "reactions": "reactions to {}",
    "sections": "sections to {}",
}


@record
class VerifiedReference:
    """A reference solution, and the comparison of runs with it.

    seconds: processor time of its run
    """

    reference: Reference
    comparison: ReferenceComparison
    seconds: float


@record
class ReferencePair:
    """Two runs of a motion.

    error (n,): estimated error of the first run's motion at its instants
    """

    runs: Runs
    first: Trajectory
    second: Trajectory
    error: Array

    @property
    def largest_error(self) -> float:
        """The largest error over time."""
        return float(self.error.max(initial=0.0))


def find_reference(motion: MotionProblem) -> VerifiedReference:
    """Find the reference of a motion. Raises the error of the first pair if all pairs fail."""
    best: ReferencePair | None = None
    first_failure: HeunError | None = None
    stiff = motion.stiffness
    for first, second in iter_method_pairs(motion, stiff is not None):
        try:
            candidate = run_pair(motion, first, second)
        except (SolveError, LimitError) as error:
            if motion.late:
                raise LimitError(Problem("time-limit", TIME_LIMIT_TEXT, hint="a longer --time-limit")) from None
            first_failure = first_failure or error
            continue
        best = candidate if best is None or candidate.largest_error < best.largest_error else best
        if best.largest_error <= AGREEMENT:
            break
    if best is None:
        assert first_failure is not None
        raise make_failure(first_failure)
    require_followed(motion.setup.runner, best.first)
    return make_reference(motion, best, (f"heun run would take {stiff.method.name}: {stiff.reason}",) if stiff else ())


def make_failure(failure: HeunError) -> HeunError:
    """Return the error to raise without a reference: that of the motion, or that it takes too long."""
    if not isinstance(failure, LimitError):
        return failure
    message = f"no reference: {failure.problems[0].message}"
    return LimitError(Problem("no-reference", message, hint="a shorter duration; heun run shows how long a run takes"))


def iter_method_pairs(motion: MotionProblem, stiff: bool) -> Iterator[tuple[str, str]]:
    """Yield the pairs of available methods by name, those that suit the motion first."""
    if motion.is_determined:
        yield DRIVE_DETERMINED.name, DEFAULT
    available = [names for names in PAIRS if all(find_method(name) for name in names)]
    yield from (available[::-1] if stiff else available) or [(DEFAULT, DEFAULT)]


def run_pair(motion: MotionProblem, first_name: str, second_name: str) -> ReferencePair:
    """Run the motion by two methods. Raises SolveError, LimitError."""
    runs, first = run_finest(motion, first_name)
    second = run_check(motion, second_name, first)
    n = count_common_instants(first, second)
    with np.errstate(all="ignore"):
        error, _ = estimate_errors(runs, first, first.times[:n], (first.states[:n], second.states[:n]))
    return ReferencePair(runs, first, second, error)


def run_finest(motion: MotionProblem, name: str) -> tuple[Runs, Trajectory]:
    """Run the motion by a method at the smallest tolerance at which it completes."""
    method = DRIVE_DETERMINED if name == DRIVE_DETERMINED.name else load_method_by_name(name)
    first_failure: HeunError | None = None
    for local in FINEST_TOLERANCES:
        runs = motion.make_runs(method, MAX_SECONDS)
        try:
            return runs, runs.run(local)
        except SolveError as error:
            first_failure = first_failure or error
        except LimitError as error:  # a coarser one would take about as long
            raise first_failure or error from None
    assert first_failure is not None
    raise first_failure


def run_check(motion: MotionProblem, name: str, a: Trajectory) -> Trajectory:
    """Run the check of the reference: by another method, from a perturbed start if that can be run.

    A motion that is solved instant by instant, and cannot be integrated, is solved once more.
    """
    names = (name, a.method.name) if motion.is_determined else (name,)
    first_failure: HeunError | None = None
    for other in names:
        method = a.method if other == a.method.name else load_method_by_name(other)
        runs = motion.make_runs(method, MAX_SECONDS, a.times)
        # the same method once more has to differ in its steps
        tolerance_ratio = SAME_METHOD_RATIO if method is a.method else 1.0
        for start in (runs.perturbed_start, None):
            for local in FINEST_TOLERANCES:
                try:
                    return runs.run(max(local, a.local) * tolerance_ratio, a.times, start)
                except SolveError as error:
                    first_failure = first_failure or error
                except LimitError as error:
                    raise first_failure or error from None
    assert first_failure is not None
    raise first_failure


def count_common_instants(a: Trajectory, b: Trajectory) -> int:
    """Return how many instants two runs share: if ropes end them, each ends at a time of its own."""
    n = min(len(a.times), len(b.times))
    return int(np.sum(a.times[:n] == b.times[:n]))


def make_reference(motion: MotionProblem, best: ReferencePair, extra_notes: tuple[str, ...]) -> VerifiedReference:
    """Make the reference of a pair of runs, with its description and the comparison of runs with it."""
    count, horizon = count_valid_instants(best)
    setup = motion.setup
    comparison = make_comparison(best.runs, setup, best.first, count)
    known = comparison.compute_differences(best.second, ESTIMATED)
    # None for a kind that does not occur: no joints, or none that carries a load
    errors_by_kind = {kind: known[kind] or None for kind in KINDS} | {"motion": float(best.error[:count].max())}
    last_time = float(comparison.times[-1])
    notes = (
        *extra_notes,
        *([motion.end_note] if motion.end_note else []),
        *describe_early_end(best.first),
        *describe_indeterminate(comparison),
    )
    if horizon is not None:
        notes = (describe_divergence(horizon, last_time, errors_by_kind["motion"]), *notes)
    reference = Reference(describe_agreement(best, errors_by_kind), errors_by_kind, last_time, count, horizon, notes)
    return VerifiedReference(reference, comparison, best.first.seconds)


def count_valid_instants(best: ReferencePair) -> tuple[int, float | None]:
    """Return how many instants are compared, and the horizon. Raises SolveError [no-reference] if there are too few."""
    diverged = np.flatnonzero(best.error > tolerances.CLAIMED)
    if not len(diverged):
        return len(best.error), None
    horizon = float(best.first.times[diverged[0]])
    for limit in (tolerances.JUDGED, tolerances.CLAIMED):
        count = int(np.flatnonzero(best.error > limit)[0])
        if count >= 2:
            return count, horizon
    last = float(best.first.times[max(diverged[0] - 1, 0)])
    raise SolveError(Problem("no-reference", TOO_SHORT_TEXT.format(last), hint=TOO_SHORT_HINT))


def describe_agreement(best: ReferencePair, errors_by_kind: Errors) -> str:
    """Describe which runs agree, and how well."""
    a, b = best.first, best.second
    names = [SOLVED_TEXT if run.method.is_determined else f"{run.method.name} at {run.local:.0e}" for run in (a, b)]
    texts = [
        AGREEMENT_TEXTS[kind].format(f"{error:.1e}") for kind, error in errors_by_kind.items() if error is not None
    ]
    return f"{names[0]} and {names[1]} agree: {', '.join(texts)}"


def describe_divergence(horizon: float, last_time: float, error: float | None) -> str:
    """Describe the divergence of the two reference runs."""
    return (
        f"the references differ by more than {tolerances.CLAIMED:.0e} at t = {horizon:.6g} s, from where on "
        f"double precision allows no comparison; compared up to t = {last_time:.6g} s, where "
        f"they agree to {error:.0e}"
    )


def describe_early_end(a: Trajectory) -> list[str]:
    """Return a note on what ends the motion early, if anything does."""
    if a.pushing_rope:
        return [f"the motion ends at t = {a.times[-1]:.6g} s: the rope {a.pushing_rope} would have to push"]
    return [f"the motion ends at t = {a.times[-1]:.6g} s, by its end condition"] if a.ended_by_condition else []


def describe_indeterminate(comparison: ReferenceComparison) -> Sequence[str]:
    """Return notes on what is left out because it is indeterminate."""
    determinate = comparison.determinate
    partly = [name for name, (f, m) in determinate.items() if not (f.all() and m.all()) and (f.any() or m.any())]
    wholly = [name for name, (f, m) in determinate.items() if not (f.any() or m.any())]
    notes = []
    if wholly or partly:
        names = ", ".join([*wholly, *(f"{name} (partly)" for name in partly)])
        notes.append(f"open, so not compared: reactions of {names}")
    if comparison.setup.cuts and not comparison.has_sections:
        notes.append("open, so not compared: sections")
    return notes
