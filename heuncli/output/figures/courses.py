"""One number over the instants of a run as a curve: dense enough to show every bend, interrupted where it is not known.

A motion may reverse many times between two samples. A course therefore has the samples, the instants of the search for
extremes, both sides of every jump, and further instants between them if these are few.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import HeunError, Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.results.results import Array
from heuncli.study.quantities.captions import describe_path
from heuncli.study.quantities.labels import make_labels
from heuncli.study.queries import curves
from heuncli.study.queries.curves import MAX_SEARCH_INSTANTS, choose_curve_instants
from heuncli.study.queries.measure import NotOneNumber, Peak, find_peak, make_several_error
from heuncli.study.queries.measure_uncertainty import find_unit, measure_uncertainty
from heuncli.study.queries.study import Study
from heuncli.study.search.extremes import find_jump_sides

CASE_SUFFIX = " (case "  # at the end of a title
VISIBLE_JUMP = 0.01  # share of the range: larger jumps are drawn as jumps


@record
class FigureSource:
    """A solved scene in a figure, and its name there (file and case); empty if it is the only one."""

    name: str
    study: Study


def make_title(sources: Sequence[FigureSource]) -> str:
    """Return the title of one or several runs; their cases are shown in the legend."""
    titles = [source.study.results.title for source in sources]
    if len(titles) == 1:
        return titles[0]
    return " · ".join(dict.fromkeys(title.rpartition(CASE_SUFFIX)[0] or title for title in titles))


def describe_number(source: FigureSource, path: str) -> str:
    """Describe a path in words, with the first letter in capital."""
    text = describe_path(path, make_labels(source.study.spec))
    return f"{text[:1].upper()}{text[1:]}"


class NumberCourse(NamedTuple):
    """A number over some instants (n,): its path, SI unit, stated error, lowest and highest value."""

    path: str
    unit: str
    times: Array
    values: Array
    error: float | None
    low: Peak
    high: Peak


def is_claimed(study: Study) -> bool:
    """Return whether the first instant of a run is before its horizon."""
    horizon = study.results.horizon
    return study.has_one_instant or horizon is None or bool(study.results.time[0] < horizon)


def require_claimed(study: Study) -> None:
    """Raise NotDrawable if all instants of a run are beyond its horizon."""
    if not is_claimed(study):
        horizon, first = study.results.horizon, study.results.time[0]
        message = f"no results are claimed from t = {horizon:.6g} s on, and the first output time is t = {first:.6g} s"
        raise NotDrawable(message, "use earlier output times or a smaller --tolerance")


def choose_instants(study: Study, max_search_instants: int = MAX_SEARCH_INSTANTS) -> Array:
    """Choose the instants of curves, as `choose_curve_instants` does.

    Raises NotDrawable if the horizon is before all of them.
    """
    require_claimed(study)
    return choose_curve_instants(study, max_search_instants)


def is_varying(low: float, high: float, error: float) -> bool:
    """Return whether a number with an error varies, given its lowest and highest value."""
    return high - low > max(tolerances.THROUGHOUT * max(abs(low), abs(high)), 2.0 * error)


def find_jumps(course: NumberCourse) -> Array:
    """Find the instants at which a course visibly jumps."""
    step = np.abs(np.diff(course.values))
    is_visible = step > VISIBLE_JUMP * (course.high.value - course.low.value)
    return np.asarray(course.times[:-1][find_jump_sides(course.times) & is_visible])


def make_course(study: Study, path: str, times: Array) -> NumberCourse:
    """Make the course of a number; for a vector that of its magnitude. Raises NotOneNumber, SpecError
    [unknown-path].
    """
    require_one_number(study, path)
    low, high = (find_peak(study, path, how) for how in ("min", "max"))
    values = find_values(study, path, times)
    error = measure_uncertainty(study, path, "abs", high.value)
    return NumberCourse(path, find_unit(path, study.spec), times, values, error, low, high)


def require_one_number(study: Study, path: str) -> None:
    """Raise NotOneNumber for a path without instants, or with several numbers that are no vector at each instant."""
    numbers = study.find_numbers(path)
    if not numbers.is_timed:
        raise NotOneNumber(f"{path} does not vary with time", f"use heun run SPEC --measure {path}")
    if numbers.axes and not (numbers.is_vector and len(numbers.axes) == 1):
        raise make_several_error(path, numbers)


def find_values(study: Study, path: str, times: Array) -> Array:
    """Return the number at a path at some instants, (n,); for a vector its magnitude."""
    values = curves.sample_values(study, path, times)
    if study.find_numbers(path).is_vector:
        return np.asarray(np.sqrt(np.einsum("nk,nk->n", values, values)))
    return values.reshape(len(times))


def find_vectors(study: Study, path: str, times: Array) -> Array:
    """Return the vectors at a path at some instants of the run, (n, 3)."""
    return curves.sample_values(study, path, times)


class NotDrawable(HeunError):
    """The requested quantity cannot be drawn in this kind of figure."""

    exit_code = 2

    def __init__(self, message: str, hint: str) -> None:
        super().__init__(Problem("bad-option", message, hint=hint))
