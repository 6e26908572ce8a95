"""Measure one number of a run, such as the largest of sections.middle.M1 or energy.kinetic at 0.5 s."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import HeunError, Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.results import path_words, results_schema
from heuncli.results.results import Array, CutPosition, Results
from heuncli.results.results_paths import PathValues, find_values
from heuncli.results.results_schema import (
    CUT,
    EVENTS,
    IMPULSES,
    SHARES,
    SPACE,
    first_element_suffix,
    independent_axes,
)  # fmt: skip
from heuncli.study.compose.recovery import Recovery
from heuncli.study.model.selection import EVERYTHING
from heuncli.study.quantities.channels import Channel, make_path_channel
from heuncli.study.queries.measure_uncertainty import find_search_error
from heuncli.study.queries.study import Study
from heuncli.study.search.columns import ChannelSearch
from heuncli.study.search.grid import BOTH_SIDES

NOT_CLAIMED = "not reliable from t = {:.4g} s on"


class NotOneNumber(HeunError):
    """The path to be measured is no single number of this run."""

    exit_code = 2

    def __init__(self, message: str, hint: str) -> None:
        super().__init__(Problem("bad-option", message, hint=hint))


class NotInThisRun(NotOneNumber):
    """The event or instant to be measured does not occur in this run; in another run of the scene it may."""


class MeasureRequest(NamedTuple):
    """A number to measure.

    how: how a history becomes one number; empty for a number that has no instants, abs for the largest magnitude
    time [s]: of the reducer `at`
    """

    how: Literal["", "max", "min", "abs", "first", "final", "at"]
    path: str
    time: float | None = None


def find_reports(path: str) -> frozenset[str] | None:
    """Return the reports that a path needs; None if its first word does not say."""
    words = path.split(".")
    report = results_schema.find_report(words[0])
    return frozenset({report, SHARES} if path_words.names_shares(words) else {report}) if report else None


def measure_value(request: MeasureRequest, study: Study) -> Peak:
    """Measure a number: its value, its instant and place if it has them; nan is indeterminate. Raises NotOneNumber."""
    results, path = study.results, request.path
    numbers = study.find_numbers(path)
    if numbers.keys[0] == IMPULSES:
        return measure_impulse(request, numbers, study)
    if numbers.keys[0] == EVENTS and request.how:
        return measure_event(request, numbers)
    if not numbers.is_timed:
        if request.how:
            raise NotOneNumber(f"{path} has no time history", f"give the path alone: {path}")
        if numbers.values.size != 1:
            raise make_several_error(path, numbers)
        return Peak(float(numbers.values.reshape(())), None)
    if request.how in ("max", "min", "abs"):
        return mark_indeterminate(find_peak(study, path, request.how))
    if request.how == "at":
        time = require_instant(request, results.time)
        numbers = find_values(study.resample(np.array([time])), path)
        return Peak(read_one_number(path, numbers, 0), time)
    if request.how or len(results.time) == 1:
        k = -1 if request.how == "final" else 0
        return Peak(read_one_number(path, numbers, k), float(results.time[k]))
    message = f"{path} has values at {len(results.time)} instants: use max, min, max abs, first, final or at T"
    raise NotOneNumber(message, f"for example 'max abs {path}', or 'at {results.time[-1]:.6g} {path}'")


def find_exceeded_horizon(request: MeasureRequest, study: Study) -> float | None:
    """Return the horizon if the requested number lies, or may lie, beyond it; otherwise None."""
    results = study.results
    horizon, numbers = results.horizon, study.find_numbers(request.path)
    if horizon is not None and numbers.keys[0] == IMPULSES:
        return float(horizon) if find_impulse_time(results, numbers) >= horizon else None
    if numbers.keys[0] == EVENTS:  # if the run continues beyond its horizon, more events may follow
        is_certain = horizon is None or not numbers.axes or (request.how == "first" and numbers.values.size)
        return None if is_certain else horizon
    if horizon is None or request.path.split(".")[0] == "time" or not (numbers.is_timed or numbers.instant is not None):
        return None
    last = results.time[0 if request.how == "first" else -1]
    if numbers.instant is not None:
        last = results.time[numbers.instant]
    elif request.how == "at":
        last = require_instant(request, results.time)
    return float(horizon) if last >= horizon else None


def measure_event(request: MeasureRequest, numbers: PathValues) -> Peak:
    """Return the first or last value of an event."""
    if not numbers.axes:
        raise NotOneNumber(f"{request.path} has no time history", f"give the path alone: {request.path}")
    if request.how not in ("first", "final"):
        hint = f"'first {request.path}', 'final {request.path}', or its index: {request.path}.0"
        raise NotOneNumber(f"{request.path} has one value for each change of the event", hint)
    if not numbers.values.size:
        raise NotInThisRun(f"{request.path}: the event does not happen in this run", "run longer, or set another limit")
    return Peak(float(numbers.values[0 if request.how == "first" else -1]), None)


def measure_impulse(request: MeasureRequest, numbers: PathValues, study: Study) -> Peak:
    """Measure a number of one impulse, with its instant; along a series of cuts it is the extreme.

    A vector counts by its magnitude.
    """
    path, time = request.path, find_impulse_time(study.results, numbers)
    if request.how in ("first", "final", "at"):
        raise NotOneNumber(f"{path} has one instant, that of the impulse", f"give the path alone, or 'max abs {path}'")
    require_extreme(path, numbers)
    if CUT in numbers.axes and request.how:
        return measure_impulse_along_cuts(request, numbers, study)
    values = np.sqrt(np.sum(np.square(numbers.values), axis=-1)) if numbers.is_vector else numbers.values
    if values.size > 1 and not request.how:
        raise make_several_error(path, numbers)
    result = float(
        np.abs(values).max() if request.how == "abs" else values.min() if request.how == "min" else values.max()
    )
    return Peak(result + 0.0, time)


def measure_impulse_along_cuts(request: MeasureRequest, numbers: PathValues, study: Study) -> Peak:
    """Return the extreme of one impulse along a series of cuts, over its whole length."""
    from heuncli.study.search.cuts import find_cut_extremes, find_stretch  # where there are series of cuts

    setup = study.with_whole_cuts(False)
    whole = replace(study.results, impulses=study.make_impulse_blocks(setup))
    name = numbers.keys[3]
    values = find_values(whole, request.path).values
    if numbers.is_vector:
        values = np.sum(np.square(values), axis=-1)
    nodes = find_values(whole, f"{IMPULSES}.{numbers.keys[1]}.sections.{name}.s").values
    low, high = find_cut_extremes(find_stretch(setup, name), nodes, values)
    lower = request.how == "min" or (request.how == "abs" and abs(low.value) > abs(high.value))
    value, place = low if lower else high
    value = float(np.sqrt(np.abs(value))) if numbers.is_vector else abs(value) if request.how == "abs" else value
    return Peak(value, find_impulse_time(study.results, numbers), place)


def find_impulse_time(results: Results, numbers: PathValues) -> float:
    """Return the time of the impulse whose number it is [s]."""
    return float(results.impulses[int(numbers.keys[1])]["time"])


class Peak(NamedTuple):
    """An extreme with its time, and along a series of cuts its place; open_at: an instant at which the number is
    indeterminate, if any.
    """

    value: float
    time: float | None
    place: CutPosition | None = None
    open_at: float | None = None


SIDES = {"min": (-1.0,), "max": (1.0,), "abs": BOTH_SIDES}


def find_peak(study: Study, path: str, how: str, times: Array | None = None) -> Peak:
    """Find the highest (`max`), lowest (`min`) or largest (`abs`) value up to the horizon, also between the samples.

    A vector counts by its magnitude, a series of cuts over its whole length. times: restricts the search to these
    instants.
    """
    numbers = study.find_numbers(path)
    if not numbers.is_timed:
        raise NotOneNumber(f"{path} has no time history, so no largest value", f"give the path alone: {path}")
    require_extreme(path, numbers)
    open_at: list[float] = []

    def collect(results: Results) -> list[Channel]:
        """Return the channel at the path, and note the first instant at which it is indeterminate."""
        channel = make_path_channel(numbers if results is study.results else find_values(results, path))
        is_open = np.isnan(channel.values)
        if is_open.any():
            left = is_open.any(axis=1)
            open_at.extend(results.time[left & ~np.isin(results.time, results.accuracy.get("unknown", []))][:1])
        return [channel]

    if study.has_one_instant and CUT not in numbers.axes:
        instant = float((study.results.time if times is None else times)[0])
        low, high = find_lowest_and_highest(collect(study.results)[0], instant)
    else:
        is_one_sided = how == "abs" and make_path_channel(numbers).is_magnitude
        sides = BOTH_SIDES if CUT in numbers.axes else SIDES["max" if is_one_sided else how]
        error = find_search_error(study, numbers.keys)
        read = make_joint_reader(study, numbers, path)
        search = ChannelSearch(collect, lambda channel: error if math.isfinite(error) else math.nan, sides, read)
        bounds = study.search_extremes(search, find_reports(path), times=times)
        lowest, highest = bounds.places[0] if bounds.places else (None, None)
        low = Peak(float(bounds.low[0]), float(bounds.low_at[0]), lowest)
        high = Peak(float(bounds.high[0]), float(bounds.high_at[0]), highest)
    is_low = how == "min" or (how == "abs" and abs(low.value) > abs(high.value))
    found = low if is_low else high
    value = (abs(found.value) if how == "abs" else found.value) + 0.0
    return found._replace(value=value, open_at=float(min(open_at)) if open_at else None)


def make_joint_reader(study: Study, numbers: PathValues, path: str) -> Callable[[Recovery], Array | None]:
    """Return a function that reads the force or moment of a joint, or a component, from a recovery for a search.

    It reads nothing in closed chains, where loads may be indeterminate, and no number that is not finite: composed
    results say which.
    """
    quantity, component = numbers.keys[-1], None if numbers.axes else SPACE.find_index(path.rpartition(".")[2])
    is_load = numbers.keys[0] == "joints" and len(numbers.keys) == 3 and quantity in ("force", "moment")
    is_known = is_load and bool(numbers.axes or component is not None) and study.setup.selection.axes == EVERYTHING.axes

    def read(recovery: Recovery) -> Array | None:
        """Return the searched values of a joint's load without composing results; None where that is not possible."""
        if not is_known or recovery.resolution is not None:
            return None
        load = next(load for load in recovery.requested_joints if load.joint.name == numbers.keys[1])
        values: Array = getattr(load, quantity)
        if not np.isfinite(values).all():
            return None
        values = values if component is None else values[:, component]
        return make_path_channel(numbers._replace(values=values)).searched_values

    return read


def find_lowest_and_highest(channel: Channel, time: float) -> tuple[Peak, Peak]:
    """Return the lowest and the highest number of a channel at its only instant; nan if all are indeterminate."""
    values = channel.searched_values[0]
    known = values[~np.isnan(values)]
    known = np.sqrt(known) if channel.is_magnitude else known
    low, high = (float(known.min()), float(known.max())) if known.size else (np.nan, np.nan)
    return Peak(low, time), Peak(high, time)


def mark_indeterminate(extreme: Peak) -> Peak:
    """Return the extreme of a whole run: nan if the quantity is indeterminate at some instant, where it may have any
    value.
    """
    return extreme if extreme.open_at is None else extreme._replace(value=math.nan, time=extreme.open_at, place=None)


def read_one_number(path: str, numbers: PathValues, k: int) -> float:
    """Return the number at instant k, or the magnitude of the vector. Raises NotOneNumber."""
    values = numbers.values[k]
    if values.size == 1:
        return float(values.reshape(()))
    if numbers.axes == (SPACE,):
        return float(np.linalg.norm(values))
    raise make_several_error(path, numbers)


def require_extreme(path: str, numbers: PathValues) -> None:
    """Raise NotOneNumber for lists that no single number represents, as the magnitude represents a vector."""
    if independent_axes(numbers.axes):
        raise make_several_error(path, numbers)


def make_several_error(path: str, numbers: PathValues) -> NotOneNumber:
    """Return the error of a path that leads to several numbers."""
    count = int(np.prod(numbers.values.shape[1 if numbers.is_timed else 0 :]))
    hint = f"name one of them: {path}{first_element_suffix(numbers.axes)}" if count else "there is none in this run"
    return NotOneNumber(f"{path} is {count} numbers: choose one", hint)


def require_instant(request: MeasureRequest, times: Array) -> float:
    """Return the requested instant if it lies within the run. Raises NotInThisRun."""
    time = float(request.time or 0.0)
    slack = tolerances.SAME_INSTANT * float(np.ptp(times))
    if not times[0] - slack <= time <= times[-1] + slack:
        hint = f"for example 'at {times[-1]:.6g} {request.path}'"
        raise NotInThisRun(f"{request.path} at {time:.6g}: the run goes from {times[0]:.6g} to {times[-1]:.6g} s", hint)
    return float(np.clip(time, times[0], times[-1]))
