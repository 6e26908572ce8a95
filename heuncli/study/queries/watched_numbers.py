"""Find when conditions on numbers of the results change, searched for after the run.

A number of the results is compared with its limit, a vector by its magnitude, a series of cuts over its whole length.
Its changes are found between the samples, too (study/search/crossings.py).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.motion.integration.check.changes import ConditionChanges, find_impulse_time_differences
from heuncli.results.path_words import error_kind_of_path, find_quantity
from heuncli.results.results import Array
from heuncli.results.results_paths import find_values
from heuncli.results.results_schema import ESTIMATE_OF_ERROR_KIND
from heuncli.scene.file_format.models import ResultCondition
from heuncli.scene.file_format.resolve_couplings import format_rounded_up
from heuncli.study.model.setup import Setup
from heuncli.study.quantities.channels import make_path_channel
from heuncli.study.queries.measure import find_reports
from heuncli.study.queries.measure_uncertainty import find_search_error
from heuncli.study.queries.study import Study
from heuncli.study.search.crossings import Crossings, find_crossings
from heuncli.study.search.extremes import search_extremes

MAY_BE_MISSING = "event {}: times may be missing, because {} is open or not known at some of the samples"
SEARCH_CUT_SHORT = "event {}: times may be missing, because the search was stopped early"


class WatchedNumber(NamedTuple):
    """A number of the results minus its limit: positive where the condition is true.

    is_magnitude: whether squares are compared, which are smooth where a magnitude is zero
    is_along_cuts: whether it is a number along a series of cuts
    """

    study: Study
    setup: Setup
    condition: ResultCondition
    is_magnitude: bool
    is_along_cuts: bool

    def sample(self, times: Array) -> Array:
        """Return the number minus its limit at instants (n,), ascending; nan where it is indeterminate."""
        most = self.study.chunk_size
        return np.concatenate([self._sample_chunk(times[i : i + most]) for i in range(0, len(times), most)])

    def sample_column(self, times: Array) -> Array:
        """Return the values as a search's single column, (n, 1)."""
        return self.sample(times)[:, None]

    def _sample_chunk(self, times: Array) -> Array:
        """Return by how much the condition is met, at some instants."""
        values, condition = self.read_values(times), self.condition
        limit = condition.limit * abs(condition.limit) if self.is_magnitude else condition.limit
        return np.asarray(values - limit if condition.is_above else limit - values)

    def read_values(self, times: Array) -> Array:
        """Return the number itself, or its square; along a series of cuts the extreme that reaches the limit first."""
        reports = find_reports(self.condition.of)
        results = self.study.compute_reports(times, reports if reports is not None else frozenset(), self.setup)
        numbers = find_values(results, self.condition.of)
        values = numbers.values
        if numbers.is_vector:
            values = np.einsum("...k,...k->...", values, values)
        elif self.is_magnitude:
            values = values * values
        if not self.is_along_cuts:
            return values.reshape(len(times))
        from heuncli.study.search.cuts import compute_envelope

        return np.asarray(compute_envelope(values)[:, int(self.condition.is_above)])

    def estimate_error(self, keys: Sequence[str], h: Array) -> float:
        """Estimate the error of the number; h: as sampled. A number without a stated error has the relative error of
        its kind.
        """
        row, estimate, limit = find_quantity(keys), self.study.history.estimate, abs(self.condition.limit)
        largest = float(np.max(np.abs(h), initial=0.0, where=np.isfinite(h)))
        largest = limit + (math.sqrt(largest) if self.is_magnitude else largest)
        kind = error_kind_of_path(keys[0], ".".join(keys[1:-1]), keys[-1])
        relative = float(estimate.get(ESTIMATE_OF_ERROR_KIND.get(kind, kind), 0.0))  # type: ignore[arg-type]
        known = (*(self.study.magnitudes.errors.get((kind, unit), 0.0) for unit in row.units),) if row else ()
        error = find_search_error(self.study, keys) if any(known) else relative * largest
        return max(float(np.nan_to_num(error)), tolerances.WRITTEN * largest)


def find_result_changes(study: Study, setup: Setup, condition: ResultCondition) -> ConditionChanges:
    """Find when a number of the results passes its limit, in either direction, up to the horizon."""
    times = find_search_times(study)
    number, keys = watch_number(study, setup, condition, times)
    h = number.sample(times)
    error = number.estimate_error(keys, h)
    result = find_crossings(
        number.sample, times, h, error * (2.0 * abs(condition.limit) + error) if number.is_magnitude else error
    )
    if result.gaps:
        study.later_warnings[MAY_BE_MISSING.format(condition.name, condition.of)] = None
    if not result.complete:
        study.later_warnings[SEARCH_CUT_SHORT.format(condition.name)] = None
    return ConditionChanges(
        condition.name, result.begins, result.times, result.is_rise, estimate_instant_errors(study, result)
    )


def find_search_times(study: Study) -> Array:
    """Return the instants between which conditions are searched for, up to the horizon."""
    times, horizon = study.search_times, study.results.horizon
    return times if horizon is None else times[times < horizon]


def watch_number(
    study: Study, setup: Setup, condition: ResultCondition, times: Array
) -> tuple[WatchedNumber, tuple[str, ...]]:
    """Return the number of a condition, and its keys in the results."""
    reports = find_reports(condition.of)
    numbers = find_values(
        study.compute_reports(times[:1], reports if reports is not None else frozenset(), setup), condition.of
    )
    channel = make_path_channel(numbers)
    if channel.has_cuts:
        from heuncli.study.search.cuts import replace_series_by_stretches

        setup = replace_series_by_stretches(setup, channel.is_nonlinear)
    return WatchedNumber(study, setup, condition, channel.is_magnitude, channel.has_cuts), numbers.keys


def describe_reasons(
    study: Study, setup: Setup, changes_by_name: Mapping[str, ConditionChanges], last: float
) -> dict[str, str]:
    """Describe the conditions that entries bring with them, in words, for a motion up to the instant `last`.

    setup: with all results that they need

    For a given value that is too small, the text states the value that would be enough.
    """
    words = {}
    for condition in study.spec.analysis.conditions:
        if not (isinstance(condition, ResultCondition) and condition.why):
            continue
        changes, words[condition.name] = changes_by_name[condition.name], condition.why
        if condition.entry_value is not None and (changes.begins or (changes.times[changes.values] <= last).any()):
            times = find_search_times(study)
            times = np.append(times[times < last], last) if last < times[-1] else times
            number, keys = watch_number(study, setup, condition, times)
            error = np.array([number.estimate_error(keys, number.sample(times))])
            lacking = search_extremes(number.sample_column, times, errors=error, sides=(1.0,)).high[0]
            words[condition.name] = condition.why.format(format_rounded_up(condition.entry_value + float(lacking)))
    return words


def estimate_instant_errors(study: Study, result: Crossings) -> Array:
    """Estimate the errors of the instants.

    At an impulse it is the difference between the runs; at other jumps it follows from the motion's error.
    """
    history, errors = study.history, result.error.copy()
    impulse_distances = [find_impulse_time_differences(history.impulses, other) for other in history.check_impulses]
    motion_error = history.estimate["motion"] * float(history.times[-1])
    for i in np.flatnonzero(result.jumps):
        distances = [each.get(float(result.times[i]), 0.5 * motion_error) for each in impulse_distances] or [
            0.5 * motion_error
        ]
        errors[i] = max(errors[i], 2.0 * max(distances))
    return errors
