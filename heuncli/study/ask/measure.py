"""One number of a run, such as the largest of sections.middle.M1 or energy.kinetic at 0.5 s."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import HeunError, Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.results import results_schema
from heuncli.results.results import Array, Place, Results
from heuncli.results.results_paths import Numbers, find
from heuncli.results.results_schema import (
    BLOWS,
    CUT,
    EVENTS,
    MAGNITUDES,
    SHARES,
    SPACE,
    beside_magnitudes,
    kind_of_error,
    quantity,
    spelled_first,
)  # fmt: skip
from heuncli.study.ask.study import Study
from heuncli.study.search.extremes import BOTH, ColumnSearch, no_columns

NOT_CLAIMED = "from t = {:.4g} s on nothing is claimed"


class NotOneNumber(HeunError):
    """What is to be measured is no single number of this run."""

    exit_code = 2

    def __init__(self, message: str, hint: str) -> None:
        super().__init__(Problem("bad-option", message, hint=hint))


class NotInThisRun(NotOneNumber):
    """What is to be measured does not happen in this run; in another one of the scene it may."""


class MeasureRequest(NamedTuple):
    """What is measured; how is empty for a number that has no instants, abs for the largest magnitude."""

    how: Literal["", "max", "min", "abs", "first", "final", "at"]
    path: str
    at: float | None = None


def report_of(path: str) -> frozenset[str] | None:
    """Which report a path needs; None where its first word does not say."""
    words = path.split(".")
    report = results_schema.report_of(words[0])
    return frozenset({report, SHARES} if results_schema.names_shares(words) else {report}) if report else None


def value(asked: MeasureRequest, study: Study) -> Peak:
    """The number, its instant and place if it has them; nan is open. Raises NotOneNumber."""
    results, path = study.results, asked.path
    there = study.numbers(path)
    if there.keys[0] == BLOWS:
        return struck(asked, there, study)
    if there.keys[0] == EVENTS and asked.how:
        return of_event(asked, there)
    if not there.timed:
        if asked.how:
            raise NotOneNumber(f"{path} has no instants", f"give the path alone: {path}")
        if there.values.size != 1:
            raise several(path, there)
        return Peak(float(there.values.reshape(())), None)
    if asked.how in ("max", "min", "abs"):
        return of_all(peak(study, path, asked.how))
    if asked.how == "at":
        at = instant_of(asked, results.time)
        there = find(study.resample(np.array([at])), path)
        return Peak(one_number(path, there, 0), at)
    if asked.how or len(results.time) == 1:
        k = -1 if asked.how == "final" else 0
        return Peak(one_number(path, there, k), float(results.time[k]))
    message = f"{path} runs over {len(results.time)} instants: say max, min, max abs, first, final or at T"
    raise NotOneNumber(message, f"such as 'max abs {path}', or 'at {results.time[-1]:.6g} {path}'")


def lost_from(asked: MeasureRequest, study: Study) -> float | None:
    """The horizon, where the number that is asked for lies beyond it, or may: that of a run that goes on beyond it."""
    results = study.results
    horizon, there = results.horizon, study.numbers(asked.path)
    if horizon is not None and there.keys[0] == BLOWS:
        return float(horizon) if time_of_blow(results, there) >= horizon else None
    if there.keys[0] == EVENTS:  # of a run that goes on beyond its horizon more may follow
        certain = horizon is None or not there.axes or (asked.how == "first" and there.values.size)
        return None if certain else horizon
    if horizon is None or asked.path.split(".")[0] == "time" or not (there.timed or there.instant is not None):
        return None
    last = results.time[0 if asked.how == "first" else -1]
    if there.instant is not None:
        last = results.time[there.instant]
    elif asked.how == "at":
        last = instant_of(asked, results.time)
    return float(horizon) if last >= horizon else None


def of_event(asked: MeasureRequest, there: Numbers) -> Peak:
    """The first or last of what is told of an event."""
    if not there.axes:
        raise NotOneNumber(f"{asked.path} has no instants", f"give the path alone: {asked.path}")
    if asked.how not in ("first", "final"):
        hint = f"'first {asked.path}', 'final {asked.path}', or its place: {asked.path}.0"
        raise NotOneNumber(f"{asked.path} is told of an event, once for each change", hint)
    if not there.values.size:
        raise NotInThisRun(f"{asked.path}: the event does not happen in this run", "run longer, or set another limit")
    return Peak(float(there.values[0 if asked.how == "first" else -1]), None)


def struck(asked: MeasureRequest, there: Numbers, study: Study) -> Peak:
    """A number of one blow, with its instant; of a run of cuts the largest. A vector counts by its magnitude."""
    path, at = asked.path, time_of_blow(study.results, there)
    if asked.how in ("first", "final", "at"):
        raise NotOneNumber(f"{path} has one instant, that of the blow", f"give the path alone, or 'max abs {path}'")
    require_extreme(path, there)
    if CUT in there.axes and asked.how:
        return struck_along(asked, there, study)
    values = np.sqrt(np.sum(np.square(there.values), axis=-1)) if there.of_vectors else there.values
    if values.size > 1 and not asked.how:
        raise several(path, there)
    result = float(np.abs(values).max() if asked.how == "abs" else values.min() if asked.how == "min" else values.max())
    return Peak(result + 0.0, at)


def struck_along(asked: MeasureRequest, there: Numbers, study: Study) -> Peak:
    """The extreme of one blow along a run of cuts, over its whole stretch."""
    from heuncli.study.search.stretches import at_one_instant, stretch_named  # where there are runs of cuts

    setup = study.stretched(False)
    whole = replace(study.results, impulses=study.impulses(setup))
    name = there.keys[3]
    values = find(whole, asked.path).values
    if there.of_vectors:
        values = np.sum(np.square(values), axis=-1)
    nodes = find(whole, f"{BLOWS}.{there.keys[1]}.sections.{name}.s").values
    low, high = at_one_instant(stretch_named(setup, name), nodes, values)
    lower = asked.how == "min" or (asked.how == "abs" and abs(low.value) > abs(high.value))
    value, place = low if lower else high
    value = float(np.sqrt(np.abs(value))) if there.of_vectors else abs(value) if asked.how == "abs" else value
    return Peak(value, time_of_blow(study.results, there), place)


def time_of_blow(results: Results, there: Numbers) -> float:
    """When the blow was whose number it is [s]."""
    return float(results.impulses[int(there.keys[1])]["time"])


class Peak(NamedTuple):
    """An extreme with its instant, and in a run of cuts its place; open_at: an instant at which it is open, if any."""

    value: float
    at: float | None
    place: Place | None = None
    open_at: float | None = None


SIDES = {"min": (-1.0,), "max": (1.0,), "abs": BOTH}


def peak(study: Study, path: str, how: str, times: Array | None = None) -> Peak:
    """Highest (`max`), lowest (`min`) or largest (`abs`) value up to the horizon, between the samples too; where, when.

    A vector counts by its magnitude, a run of cuts over its whole stretch. times: of these instants alone.
    """
    asked = study.numbers(path)
    if not asked.timed:
        raise NotOneNumber(f"{path} has no instants, of which one could be the largest", f"give the path alone: {path}")
    require_extreme(path, asked)
    even = is_even(asked)
    open_at: list[float] = []

    def columns(results: Results) -> Array:
        values = (asked if results is study.results else find(results, path)).values
        is_open = np.isnan(values)
        if is_open.any():
            left = is_open.reshape(len(values), -1).any(axis=1)
            open_at.extend(results.time[left & ~np.isin(results.time, results.accuracy.get("unknown", []))][:1])
        # the square of a magnitude is smooth where the magnitude is zero
        if asked.of_vectors:
            values = np.einsum("...k,...k->...", values, values)
        elif even:
            values = values * values
        return values.reshape(len(values), -1)

    if study.of_one_instant and CUT not in asked.axes:
        at = float((study.results.time if times is None else times)[0])
        low, high = lowest_and_highest(columns(study.results)[0], at)
    else:
        low, high = searched(study, path, columns, SIDES["max" if even and how == "abs" else how], times)
    lower = how == "min" or (how == "abs" and abs(low.value) > abs(high.value))
    found = low if lower else high
    result = (abs(found.value) if how == "abs" else found.value) + 0.0
    value = float(np.sqrt(np.abs(result))) if even else result
    return found._replace(value=value, open_at=float(min(open_at)) if open_at else None)


def is_even(asked: Numbers) -> bool:
    """Whether the squares of its numbers are searched: those of magnitudes, which are smooth where these are zero."""
    return asked.of_vectors or asked.keys[-1] in MAGNITUDES


def lowest_and_highest(values: Array, at: float) -> tuple[Peak, Peak]:
    """The lowest and the highest of some values (n,) at an instant; nan where all are open."""
    known = values[~np.isnan(values)]
    low, high = (float(known.min()), float(known.max())) if known.size else (np.nan, np.nan)
    return Peak(low, at), Peak(high, at)


def searched(
    study: Study, path: str, columns: Callable[[Results], Array], sides: tuple[float, ...], times: Array | None
) -> tuple[Peak, Peak]:
    """The lowest and the highest of a motion, between the samples too; along a run of cuts with its place."""
    asked = study.numbers(path)
    even = is_even(asked)
    error = np.nan_to_num(np.array([stated_error(study, asked.keys)]), nan=np.nan, posinf=np.nan)
    n = columns(study.results).shape[1]
    search = ColumnSearch(columns, [list(range(n))], error, np.array([even]), sides=sides)
    if CUT in asked.axes:
        name = asked.keys[1]
        search = search._replace(
            columns=no_columns, groups=[], along=lambda results: [(name, columns(results))], bent=asked.bent,
            sides=BOTH,
        )  # fmt: skip
    bounds = study.extremes(search, report_of(path), times=times)
    lowest, highest = bounds.places[0] if bounds.places else (None, None)
    return (
        Peak(float(bounds.low[0]), float(bounds.low_at[0]), lowest),
        Peak(float(bounds.high[0]), float(bounds.high_at[0]), highest),
    )


def of_all(found: Peak) -> Peak:
    """The extreme of a whole run: open where the quantity is open at some instant, for there it may be any number."""
    return found if found.open_at is None else found._replace(value=math.nan, at=found.open_at, place=None)


def stated_error(study: Study, keys: Sequence[str]) -> float:
    """The error of the quantity under some keys, as the tables state it; nan where they state none.

    Where what turns has another unit than what slides, the less of the two.
    """
    row, of = quantity(keys), study.magnitudes
    if row is None:
        return np.nan
    kind, lost = kind_of_error(keys[0], ".".join(keys[1:-1]), keys[-1]), of.lost()
    own = {"travels": "motion"}.get(kind, kind) if (kind, row.units[0]) not in of.errors else kind
    known = [(of.errors.get((own, unit), 0.0), lost.get(unit, 0.0)) for unit in row.units]
    return min(map(max, known)) or np.nan


def one_number(path: str, there: Numbers, k: int) -> float:
    """The number at an instant, or the magnitude of the vector. Raises NotOneNumber."""
    values = there.values[k]
    if values.size == 1:
        return float(values.reshape(()))
    if there.axes == (SPACE,):
        return float(np.linalg.norm(values))
    raise several(path, there)


def require_extreme(path: str, there: Numbers) -> None:
    """Raise NotOneNumber for lists of which no one number counts, as of a vector its magnitude does."""
    if beside_magnitudes(there.axes):
        raise several(path, there)


def several(path: str, there: Numbers) -> NotOneNumber:
    """The error of a path that leads to several numbers."""
    count = int(np.prod(there.values.shape[1 if there.timed else 0 :]))
    hint = f"name one of them: {path}{spelled_first(there.axes)}" if count else "there is none in this run"
    return NotOneNumber(f"{path} is {count} numbers: say which", hint)


def instant_of(asked: MeasureRequest, times: Array) -> float:
    """The instant asked for, if the run has it. Raises NotOneNumber."""
    at = float(asked.at or 0.0)
    slack = tolerances.SAME_INSTANT * float(np.ptp(times))
    if not times[0] - slack <= at <= times[-1] + slack:
        hint = f"such as 'at {times[-1]:.6g} {asked.path}'"
        raise NotInThisRun(f"{asked.path} at {at:.6g}: the run goes from {times[0]:.6g} to {times[-1]:.6g} s", hint)
    return float(np.clip(at, times[0], times[-1]))
