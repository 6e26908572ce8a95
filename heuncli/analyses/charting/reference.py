"""The reference of a chart: a run of high order at the least tolerance, checked by one of another method.

Both set out from the same scene, the second from a start moved by rounding, so that what rounding grows to is seen. By
how much they differ, twice, is what the reference may err by. Where they part, in a chaotic motion, the chart is judged
up to where they still agree to half the digits: beyond, differences tell of the growth and no more of the methods.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.analyses.charting.judge import Judge, judge_of
from heuncli.analyses.charting.motion import NO_TIME, ChartedMotion
from heuncli.analyses.charting.results import KINDS, Errors, Reference
from heuncli.base import tolerances
from heuncli.base.errors import HeunError, LimitError, Problem, SolveError
from heuncli.base.method_rows import DEFAULT, row_of
from heuncli.base.records import record
from heuncli.motion.integration.check.estimate import errors
from heuncli.motion.integration.check.runs import Runs
from heuncli.motion.integration.methods.followed import FOLLOWED
from heuncli.motion.integration.methods.registry import method_of
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array
from heuncli.study.solve.error_extents import ESTIMATED
from heuncli.study.solve.history import require_followed

# Pairs of methods, the first the reference; the second pair where the first does not agree, as in stiff scenes
PAIRS = (("Verner98", "DOP853"), ("Radau9", "Radau5"))
FINEST = (tolerances.LEAST_TOLERANCE, 1e-12, 1e-10)  # local tolerances, the first by which the motion can be run
SECONDS = 20.0  # that one of these runs may take
AGREED = 1e-9  # relative: two runs that agree so well need no other pair
FEW = "the references agree up to t = {:.6g} s only, before the first asked instant: nothing can be judged"
FEW_HINT = "more samples, or a shorter duration"
ITSELF = "every instant solved by itself"  # as a run that is followed
WORDS = {"motion": "motion to {} of the scene's size", "reactions": "reactions to {}", "sections": "sections to {}"}


@record
class JudgedReference:
    """A reference, and what holds runs against it; seconds: what its run took."""

    reference: Reference
    judge: Judge
    seconds: float


@record
class ReferencePair:
    """Two runs of a motion; error (n,): by how much the motion of the first may err at its instants."""

    runs: Runs
    first: Trajectory
    second: Trajectory
    error: Array

    @property
    def whole(self) -> float:
        """The largest error."""
        return float(self.error.max(initial=0.0))


def refer(motion: ChartedMotion) -> JudgedReference:
    """The reference of a motion. Raises what kept all pairs from it."""
    best: ReferencePair | None = None
    failed: HeunError | None = None
    stiff = motion.stiff
    for first, second in pairs(motion, stiff is not None):
        try:
            found = pair(motion, first, second)
        except (SolveError, LimitError) as error:
            if motion.late:
                raise LimitError(Problem("time-limit", NO_TIME, hint="a longer --time-limit")) from None
            failed = failed or error
            continue
        best = found if best is None or found.whole < best.whole else best
        if best.whole <= AGREED:
            break
    if best is None:
        assert failed is not None
        raise no_reference(failed)
    require_followed(motion.setup.runner, best.first)
    return referred(motion, best, (f"heun run would take {stiff.method.name}: {stiff.told}",) if stiff else ())


def no_reference(failed: HeunError) -> HeunError:
    """Why there is none: what the motion fails by, or that it takes too long."""
    if not isinstance(failed, LimitError):
        return failed
    message = f"no reference: {failed.problems[0].message}"
    return LimitError(Problem("no-reference", message, hint="a shorter duration; heun run says how long a run takes"))


def pairs(motion: ChartedMotion, stiff: bool) -> Iterator[tuple[str, str]]:
    """The pairs of methods that there are, by their names, those first that suit the motion."""
    if motion.determined:
        yield FOLLOWED.name, DEFAULT
    known = [names for names in PAIRS if all(row_of(name) for name in names)]
    yield from (known[::-1] if stiff else known) or [(DEFAULT, DEFAULT)]


def pair(motion: ChartedMotion, first: str, second: str) -> ReferencePair:
    """Two runs by two methods. Raises SolveError, LimitError."""
    runs, a = finest(motion, first)
    b = beside(motion, second, a)
    n = common(a, b)
    with np.errstate(all="ignore"):
        error, _ = errors(runs, a, a.times[:n], (a.states[:n], b.states[:n]))
    return ReferencePair(runs, a, b, error)


def finest(motion: ChartedMotion, name: str) -> tuple[Runs, Trajectory]:
    """The run by a method at the least of the tolerances at which it comes to its end."""
    method = FOLLOWED if name == FOLLOWED.name else method_of(name)
    failed: HeunError | None = None
    for local in FINEST:
        runs = motion.runs(method, SECONDS)
        try:
            return runs, runs.run(local)
        except SolveError as error:
            failed = failed or error
        except LimitError as error:  # a coarser one would take about as long
            raise failed or error from None
    assert failed is not None
    raise failed


def beside(motion: ChartedMotion, name: str, a: Trajectory) -> Trajectory:
    """The run that checks the reference: by another method, from a start moved by rounding where that can be run.

    What is followed and cannot be integrated is followed once more.
    """
    names = (name, a.method.name) if motion.determined else (name,)
    failed: HeunError | None = None
    for other in names:
        method = a.method if other == a.method.name else method_of(other)
        runs = motion.runs(method, SECONDS, a.times)
        ratio = 30.0 if method is a.method else 1.0  # the same method once more has to differ in its steps
        for start in (runs.moved, None):
            for local in FINEST:
                try:
                    return runs.run(max(local, a.local) * ratio, a.times, start)
                except SolveError as error:
                    failed = failed or error
                except LimitError as error:
                    raise failed or error from None
    assert failed is not None
    raise failed


def common(a: Trajectory, b: Trajectory) -> int:
    """How many instants two runs share: where ropes end them, each ends at an instant of its own."""
    n = min(len(a.times), len(b.times))
    return int(np.sum(a.times[:n] == b.times[:n]))


def referred(motion: ChartedMotion, best: ReferencePair, more: tuple[str, ...]) -> JudgedReference:
    """The reference of a pair of runs: what the chart tells of it, and what judges runs by it; more: further notes."""
    count, horizon = judged_instants(best)
    setup = motion.setup
    judge = judge_of(best.runs, setup, best.first, count)
    known = judge.apart(best.second, ESTIMATED)
    # nothing is told of a kind of which there is nothing: no joints, or none that carries anything
    own = {kind: known[kind] or None for kind in KINDS} | {"motion": float(best.error[:count].max())}
    until = float(judge.times[-1])
    notes = (*more, *([motion.ends] if motion.ends else []), *ended(best.first), *open_notes(judge))
    if horizon is not None:
        notes = (beyond(horizon, until, own["motion"]), *notes)
    reference = Reference(words(best, own), own, until, count, horizon, notes)
    return JudgedReference(reference, judge, best.first.seconds)


def judged_instants(best: ReferencePair) -> tuple[int, float | None]:
    """How many of the instants are judged, and the horizon. Raises SolveError where there are too few."""
    late = np.flatnonzero(best.error > tolerances.CLAIMED)
    if not len(late):
        return len(best.error), None
    horizon = float(best.first.times[late[0]])
    for limit in (tolerances.JUDGED, tolerances.CLAIMED):
        count = int(np.flatnonzero(best.error > limit)[0])
        if count >= 2:
            return count, horizon
    last = float(best.first.times[max(late[0] - 1, 0)])
    raise SolveError(Problem("no-reference", FEW.format(last), hint=FEW_HINT))


def words(best: ReferencePair, own: Errors) -> str:
    """Which runs agree how well."""
    a, b = best.first, best.second
    names = [ITSELF if run.method.determined else f"{run.method.name} at {run.local:.0e}" for run in (a, b)]
    found = [WORDS[kind].format(f"{error:.1e}") for kind, error in own.items() if error is not None]
    return f"{names[0]} and {names[1]} agree: {', '.join(found)}"


def beyond(horizon: float, until: float, own: float | None) -> str:
    """What is said of a motion whose references part."""
    return (
        f"the references differ by more than {tolerances.CLAIMED:.0e} at t = {horizon:.6g} s, from where on nobody can "
        f"compare anything in double precision; run and judged up to t = {until:.6g} s, where they agree to {own:.0e}"
    )


def ended(a: Trajectory) -> list[str]:
    """What ends the motion before its time."""
    if a.stopped:
        return [f"the motion ends at t = {a.times[-1]:.6g} s: the rope {a.stopped} would have to push"]
    return [f"the motion ends at t = {a.times[-1]:.6g} s, by its condition"] if a.ended else []


def open_notes(judge: Judge) -> Sequence[str]:
    """What is left out because it is open."""
    certain = judge.certain
    partly = [name for name, (f, m) in certain.items() if not (f.all() and m.all()) and (f.any() or m.any())]
    wholly = [name for name, (f, m) in certain.items() if not (f.any() or m.any())]
    notes = []
    if wholly or partly:
        names = ", ".join([*wholly, *(f"{name} in part" for name in partly)])
        notes.append(f"open, and so not judged: reactions of {names}")
    if judge.setup.cuts and not judge.sections:
        notes.append("open, and so not judged: sections")
    return notes
