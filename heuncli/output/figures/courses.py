"""One number over the instants of a run, as a curve: close enough that no bend is lost, broken where it is not known.

Between two asked instants a motion may turn many times. A course has the asked instants, those at which the search for
extremes looks, both sides of every jump, and where these are few more between them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.output.figures.refusals import NotDrawable
from heuncli.results.results import Array
from heuncli.study.ask import curves
from heuncli.study.ask.measure import MeasureRequest, NotOneNumber, Peak, peak, several
from heuncli.study.ask.study import Study
from heuncli.study.quantities.stated import error_of, unit_of
from heuncli.study.search.extremes import distinct, sides_of_jumps

CASE = " (case "  # behind a title
ENOUGH = 400  # instants of a curve: two a pixel of a panel, nearly
JUMP = 0.01  # of the span of a course: a jump that is drawn as one
MOST = 4000  # of the instants at which extremes are looked for, as many as a picture can show


@record
class Pictured:
    """A solved scene in a picture, and how it is called there: its file and case; nothing where it is the only one."""

    name: str
    study: Study


def title_of(sources: Sequence[Pictured]) -> str:
    """What one or several runs are of; their cases stand in the legend."""
    titles = [source.study.results.title for source in sources]
    if len(titles) == 1:
        return titles[0]
    return " · ".join(dict.fromkeys(title.rpartition(CASE)[0] or title for title in titles))


class NumberCourse(NamedTuple):
    """A number over some instants (n,): its path, its SI unit, its stated error, its lowest and highest."""

    path: str
    unit: str
    times: Array
    values: Array
    error: float | None
    low: Peak
    high: Peak


def is_claimed(study: Study) -> bool:
    """Whether anything is claimed of a run at any of its instants: whether its horizon is behind the first."""
    horizon = study.results.horizon
    return study.of_one_instant or horizon is None or bool(study.results.time[0] < horizon)


def require_claimed(study: Study) -> None:
    """Raise NotDrawable for a run whose instants are all beyond its horizon."""
    if not is_claimed(study):
        horizon, first = study.results.horizon, study.results.time[0]
        message = f"from t = {horizon:.6g} s on nothing is claimed, and the first instant is t = {first:.6g} s"
        raise NotDrawable(message, "earlier instants, or a smaller --tolerance")


def instants(study: Study, most: int = MOST) -> Array:
    """The instants of curves, (n,) ascending, up to the horizon; most: of those at which extremes are looked for.

    Raises NotDrawable where the horizon is before all of them.
    """
    require_claimed(study)
    results = study.results
    times = results.time
    if study.of_one_instant:
        return times
    looked_at = study.search_times
    if len(looked_at) > most:
        jumps = np.flatnonzero(sides_of_jumps(looked_at))
        some = np.linspace(0, len(looked_at) - 1, most).round().astype(np.intp)
        looked_at = looked_at[distinct(np.concatenate([some, jumps, jumps + 1]))]
    even = np.linspace(times[0], times[-1], ENOUGH)
    found = distinct(np.concatenate([times, looked_at, even]))
    horizon = results.horizon
    return np.asarray(found if horizon is None else found[found < horizon])


def varies(low: float, high: float, error: float) -> bool:
    """Whether a number that is known to an error varies between a lowest and a highest value, both of it."""
    return high - low > max(tolerances.THROUGHOUT * max(abs(low), abs(high)), 2.0 * error)


def jumps_of(course: NumberCourse) -> Array:
    """The instants at which a course jumps by what is seen: its values on the two sides of one differ."""
    step = np.abs(np.diff(course.values))
    seen = step > JUMP * (course.high.value - course.low.value)
    return np.asarray(course.times[:-1][sides_of_jumps(course.times) & seen])


def course_of(study: Study, path: str, times: Array) -> NumberCourse:
    """The course of a number, of a vector its magnitude. Raises NotOneNumber, SpecError [unknown-path]."""
    require_one_number(study, path)
    low, high = (peak(study, path, how) for how in ("min", "max"))
    values = values_at(study, path, times)
    error = error_of(MeasureRequest("abs", path), high, study)
    return NumberCourse(path, unit_of(path, study.spec), times, values, error, low, high)


def require_one_number(study: Study, path: str) -> None:
    """Raise NotOneNumber for what has no instants, and for what is no one number or vector at each of them."""
    numbers = study.numbers(path)
    if not numbers.timed:
        raise NotOneNumber(f"{path} has no instants to be drawn over", f"such as heun run SPEC --measure {path}")
    if numbers.axes and not (numbers.of_vectors and len(numbers.axes) == 1):
        raise several(path, numbers)


def values_at(study: Study, path: str, times: Array) -> Array:
    """The number at a path at some instants, (n,); of a vector its magnitude."""
    values = curves.values_at(study, path, times)
    if study.numbers(path).of_vectors:
        return np.asarray(np.sqrt(np.einsum("nk,nk->n", values, values)))
    return values.reshape(len(times))


def vectors_at(study: Study, path: str, times: Array) -> Array:
    """The vectors at a path at some instants of the run, (n, 3)."""
    return curves.values_at(study, path, times)
