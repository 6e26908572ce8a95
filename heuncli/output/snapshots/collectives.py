"""The load collectives of a solved scene: numbers of its motion, counted.

collective(study, "joints.main.force.y", slopes=(3.0, 5.0)).equivalents[0].range
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from heuncli.base.errors import Problem, SolveError, UsageError
from heuncli.study.ask.histories import CODE, histories
from heuncli.study.ask.measure import MeasureRequest, Peak
from heuncli.study.ask.study import Study
from heuncli.study.load_cycles.counted import Collective, Counting, LoadHistory, UnfitCounting, counted
from heuncli.study.quantities.stated import error_of, unit_of

NOWHERE = Peak(math.nan, None)


def collective(
    study: Study,
    path: str,
    *,
    slopes: Sequence[float] = (),
    cycles: float | None = None,
    bins: int = Counting().bins,
    repeat: int = 1,
    closed: bool = False,
) -> Collective:
    """The load collective of the number at a path over the motion; of a vector of its magnitude.

    slopes: of Wöhler lines, a damage-equivalent range each, of so many cycles (None: of one each time the motion is run
    through); bins: classes of ranges and means; repeat: how often the motion is run through; closed: it is repeated for
    ever, and one time counted. Raises NotOneNumber, SpecError [unknown-path], SolveError [no-collective], LimitError.
    """
    return collectives(study, [path], Counting(tuple(slopes), cycles, bins, repeat, closed))[0]


def collectives(study: Study, paths: Sequence[str], asked: Counting) -> list[Collective]:
    """Those of several paths, searched together. Raises as collective() does, and UsageError for no way to count."""
    if unfit := asked.unfit():
        raise UsageError(*(said(one, one.name, getattr(asked, one.name)) for one in unfit))
    whole = MeasureRequest("abs", "")
    errors = {path: error_of(whole._replace(path=path), NOWHERE, study) or 0.0 for path in paths}
    found = histories(study, errors, {path: unit_of(path, study.spec) for path in paths})
    if asked.closed or asked.repeat > 1:
        require_closed(found)
    return [counted(history, asked) for history in found]


def said(unfit: UnfitCounting, option: str, value: object) -> Problem:
    """What is wrong with an option."""
    message = f"{option} {value}: expected {unfit.expected}"
    return Problem("bad-option", message, hint=f"such as {option} {unfit.example}")


def require_closed(several: Sequence[LoadHistory]) -> None:
    """Raise SolveError for each history that does not end where it began, within its errors: it is no cycle."""
    problems = []
    for one in several:
        off, first, last = one.values[-1] - one.values[0], one.values[0], one.values[-1]
        if abs(off) > 2.0 * one.error:
            apart = f"it begins with {first:.6g} {one.unit} and ends with {last:.6g}, off by {abs(off):.2g}"
            message = f"{one.path}: --repeat is of a motion that comes back: {apart}; the error is {one.error:.1g}"
            hint = "make the duration one period: --set analysis.duration=...; or begin where the motion has settled"
            problems.append(Problem(CODE, message, hint=hint, about="analysis"))
    if problems:
        raise SolveError(*problems)
