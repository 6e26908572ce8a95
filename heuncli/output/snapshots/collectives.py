"""Load collectives of a solved scene: the histories of its numbers, counted by rainflow.

count_collective(study, "joints.main.force.y", slopes=(3.0, 5.0)).equivalents[0].range
"""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.base.errors import Problem, SolveError, UsageError
from heuncli.study.load_collectives import (
    CODE,
    Collective,
    Counting,
    LoadHistory,
    UnfitCounting,
    make_collective,
    make_histories,
)
from heuncli.study.queries.measure_uncertainty import find_unit, measure_uncertainty
from heuncli.study.queries.study import Study


def count_collective(
    study: Study,
    path: str,
    *,
    slopes: Sequence[float] = (),
    cycles: float | None = None,
    bins: int = Counting().bins,
    repeat: int = 1,
    is_closed: bool = False,
) -> Collective:
    """Count the load collective of the number at a path over the motion; for a vector that of its magnitude.

    slopes: of Wöhler lines; each gives a damage-equivalent range
    cycles: number of cycles of these ranges; None for one per repetition of the motion
    bins: number of classes of ranges and means
    repeat: how often the motion is repeated
    is_closed: the motion is repeated endlessly, and one repetition is counted

    Raises NotOneNumber, SpecError [unknown-path], SolveError [no-collective], LimitError.
    """
    return count_collectives(study, [path], Counting(tuple(slopes), cycles, bins, repeat, is_closed))[0]


def count_collectives(study: Study, paths: Sequence[str], options: Counting) -> list[Collective]:
    """Count the collectives of several paths in one search.

    Raises as count_collective() does, and UsageError for options that do not fit together.
    """
    if unfit := options.find_unfit():
        raise UsageError(
            *(make_option_problem(problem, problem.name, getattr(options, problem.name)) for problem in unfit)
        )
    errors = {path: measure_uncertainty(study, path, "abs") or 0.0 for path in paths}
    found = make_histories(study, errors, {path: find_unit(path, study.spec) for path in paths})
    if options.is_endless or options.repeat > 1:
        require_closed(found)
    return [make_collective(history, options) for history in found]


def make_option_problem(unfit: UnfitCounting, option: str, value: object) -> Problem:
    """Return the problem with an option."""
    message = f"{option} {value}: expected {unfit.requirement}"
    return Problem("bad-option", message, hint=f"for example {option} {unfit.example}")


def require_closed(histories: Sequence[LoadHistory]) -> None:
    """Raise SolveError if a history does not end where it began, within its errors: then it is no cycle."""
    problems = []
    for history in histories:
        gap, first, last = history.values[-1] - history.values[0], history.values[0], history.values[-1]
        if abs(gap) > 2.0 * history.error:
            ends_text = (
                f"it starts at {first:.6g} {history.unit} and ends at {last:.6g}, a difference of {abs(gap):.2g}"
            )
            message = (
                f"{history.path}: --repeat requires a periodic motion: {ends_text}; the error is {history.error:.1g}"
            )
            hint = "make the duration one period: --set analysis.duration=...; or start after the motion has settled"
            problems.append(Problem(CODE, message, hint=hint, entry_path="analysis"))
    if problems:
        raise SolveError(*problems)
