"""A solved scene that answers further queries: its results at other instants, their extremes between the samples."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base.records import record
from heuncli.results.results import Accuracy, Array, Block, CutPosition, Extremes, Magnitudes, Results
from heuncli.results.results_paths import PathValues, find_values
from heuncli.results.results_schema import REPORTS, SHARED_BLOCKS, SHARES, add_shared_reports
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.accuracy import require_finite
from heuncli.study.compose.recovery import Recovery, recover
from heuncli.study.compose.results import compose, make_known_blocks
from heuncli.study.compose.warnings import (
    PartialFriction,
    depends_on_friction,
    describe_partial,
    has_smoothed_friction,
    list_partial_friction,
    warn_left_out,
)
from heuncli.study.model.options import Options
from heuncli.study.model.setup import Setup
from heuncli.study.search import extremes
from heuncli.study.search.columns import MAX_INSTANTS as MOST_INSTANTS
from heuncli.study.search.columns import ChannelSearch, StudyColumns, choose_search_times
from heuncli.study.search.grid import BOTH_SIDES, fill_short_stretches, sort_distinct
from heuncli.study.solve.history import History, resample

if TYPE_CHECKING:
    from heuncli.motion.integration.check.changes import ConditionChanges
    from heuncli.study.compose.impulses import Impulses
    from heuncli.study.compose.unknown_numbers import OpenMarker

MOST_SEARCHED = 5_000_000  # numbers sampled for the extremes of a whole report, about 1 s; a measure has no limit
NO_REPORTS: frozenset[str] = frozenset()
CHUNK = 200_000  # body-instants whose solutions are in memory at a time
MAX_RECOVERIES = 64  # recoveries that are cached, together of no more instants than a chunk
RECENT_PARTS = 8  # so many parts make a chunk; one part stays cached for the next question
TOO_FEW = "extremes are searched from {} samples: too few to find every peak and jump of this motion"
CUT_SHORT = "the search for extremes was stopped early: higher values may exist"


@record
class Study:
    """A solved scene: `results` at the requested instants, `resample` for any other instants of the same run.

    Impure: collects the warnings of later queries.
    """

    spec: Spec
    options: Options
    setup: Setup
    history: History
    result_recovery: Recovery | None  # the results were composed of it; None if they were composed part by part
    results: Results
    impulse_results: Impulses | None = None
    changes: Mapping[str, ConditionChanges] = MappingProxyType({})

    @cached_property
    def recovery(self) -> Recovery:
        """The loads and motions recovered from the kernel's solutions at the requested instants."""
        return self.result_recovery or recover(self.setup, self.history.solutions, self.options.least_norm)

    @property
    def magnitudes(self) -> Magnitudes:
        """The sizes of the terms of which all numbers are sums, including those of impulses, and their errors."""
        magnitudes = self.recovery.magnitudes
        errors = {**self.history.errors, **self.results.position_errors(magnitudes.size)}
        if self.impulse_results is None:
            return magnitudes._replace(errors=errors)
        return magnitudes._replace(
            by_unit={**self.impulse_results.magnitudes_by_unit, **magnitudes.by_unit},
            errors=errors | self.impulse_results.errors,
        )

    @property
    def load_magnitudes(self) -> Magnitudes:
        """The part of the magnitudes that errors of loads depend on."""
        if self.impulse_results is not None:
            return self.magnitudes
        return self.recovery.load_magnitudes._replace(errors=dict(self.history.errors))

    @property
    def has_one_instant(self) -> bool:
        """Whether there is no motion: a state, or an impulse."""
        return self.history.checked_run is None

    def find_numbers(self, path: str) -> PathValues:
        """Return the numbers at a path of the results, cached. Raises SpecError [unknown-path]."""
        found = self._numbers.get(path)
        if found is None:
            found = self._numbers[path] = find_values(self.results, path)
        return found

    @cached_property
    def _numbers(self) -> dict[str, PathValues]:
        """Values at paths that were already read."""
        return {}

    @cached_property
    def search_times(self) -> Array:
        """Instants close enough to bracket every extreme, (n,) ascending."""
        times, enough = self.find_close_times()
        if not enough:
            self.later_warnings[TOO_FEW.format(len(times))] = None
        return times

    def find_close_times(self, most: int = MOST_INSTANTS) -> tuple[Array, bool]:
        """Find instants that bracket every turning point, (n,) ascending, and whether `most` of them are enough."""
        times, is_enough = choose_search_times(self.setup, self.history, most)
        if self.setup.cuts and len(times) > 1:
            from heuncli.study.search.cuts import find_passages, has_moving_joints  # where there are sections

            if has_moving_joints(self.setup):
                times = sort_distinct(
                    np.concatenate([times, find_passages(lambda instants: self._recover(instants, NO_REPORTS), times)])
                )
        return fill_short_stretches(times), is_enough

    def resample(self, times: Array) -> Results:
        """Return the results of the run at other instants within it, (n,) ascending; a state always has its one
        instant.
        """
        if self.has_one_instant:
            return self.results
        reports = self.options.reports
        results = compose(self.setup, self.history, self._recover(times, reports), reports, self.impulse_results)
        results.work["seconds"] = dict(self.results.work["seconds"])
        self.unknown.update(results.accuracy.get("unknown", ()))
        self.later_warnings.update(dict.fromkeys(w for w in results.warnings if w not in self.results.warnings))
        return results

    @cached_property
    def later_warnings(self) -> dict[str, None]:
        """Warnings since the run, from other instants and from searches, in their order; a dict used as an ordered
        set.
        """
        return {}

    @cached_property
    def unknown(self) -> set[float]:
        """The instants seen since the run that lie so close to a singular pose that rounding decides some numbers."""
        return set(self.results.accuracy.get("unknown", ()))

    @cached_property
    def left_out(self) -> set[float]:
        """The instants that searches for extremes left out, with the intervals to their neighbours."""
        return set()

    def make_impulse_blocks(self, setup: Setup | None = None) -> list[Block]:
        """Return the blocks of the impulses; setup: with other cuts."""
        if self.impulse_results is None:
            return []
        return (self.impulse_results if setup is None else self.impulse_results.with_cuts(setup)).make_blocks()

    def find_impulse_extremes(self) -> list[dict[str, Extremes]]:
        """Return the lowest and highest of the section forces along whole series of cuts: one mapping by run for each
        impulse.
        """
        if not any(cuts.s is not None for cuts in self.setup.cuts):
            return []
        from heuncli.study.search.cuts import find_impulse_extremes  # only series of cuts are worth it

        setup = self.with_whole_cuts(False)
        return [find_impulse_extremes(setup, block) for block in self.make_impulse_blocks(setup)]

    def compute_reports(self, times: Array, reports: frozenset[str], setup: Setup | None = None) -> Results:
        """Return only the blocks of some reports at other instants of the same run; setup: with other cuts.

        The last ones are cached: figures ask for several numbers at the same instants.
        """
        is_kept = len(times) <= self.chunk_size // RECENT_PARTS
        if setup is not None:
            return self.compose_reports(self.find_recovery(times, reports, setup, keep=is_kept), reports)
        key = times.tobytes(), frozenset(reports)
        found = self._recent_reports.pop(key, None)
        if found is None:
            found = self.compose_reports(self.find_recovery(times, reports, keep=is_kept), reports)
        self._recent_reports[key] = found
        counts = [len(own.time) for own in self._recent_reports.values()]
        while sum(counts) > self.chunk_size // RECENT_PARTS:
            del self._recent_reports[next(iter(self._recent_reports))], counts[0]
        return found

    @cached_property
    def _recent_reports(self) -> dict[tuple[bytes, frozenset[str]], Results]:
        """Blocks of reports by their instants, those used last at the end."""
        return {}

    def compose_reports(
        self, recovery: Recovery, reports: frozenset[str], open_marker: OpenMarker | None = None
    ) -> Results:
        """Return the blocks of some reports from a recovery.

        open_marker: marks indeterminate numbers where the recovery did not look for them
        """
        results = self.results
        blocks, unknown = make_known_blocks(self.history, recovery, reports, open_marker)
        accuracy: Accuracy = {"unknown": unknown.tolist()} if len(unknown) else {}
        times = recovery.solutions.times
        composed = Results(
            results.title,
            results.spec,
            results.version,
            results.model,
            results.status,
            times,
            accuracy=accuracy,
            **blocks,
        )
        return require_finite(composed)

    def find_recovery(
        self, times: Array, reports: frozenset[str], setup: Setup | None = None, *, keep: bool = False
    ) -> Recovery:
        """Return the recovery at some instants of the run, (n,) ascending, from the cache if possible.

        setup: with other cuts
        keep: cache it for the next search or figure, which begins at the same instants
        """
        key = times.tobytes(), SHARES in reports
        recovery = self.recovery_cache.get(key)
        if recovery is None:
            recovery = self._recover(times, reports)
            if keep:
                self.recovery_cache[key] = recovery
                counts = [len(own.solutions.times) for own in self.recovery_cache.values()]
                while len(counts) > MAX_RECOVERIES or (len(counts) > 1 and sum(counts) > self.chunk_size):
                    del self.recovery_cache[next(iter(self.recovery_cache))], counts[0]
        if setup is None:
            return recovery
        if "sections" in reports:
            recovery.compute_loads()
        return recovery.with_cuts(setup)

    @cached_property
    def recovery_cache(self) -> dict[tuple[bytes, bool], Recovery]:
        """The recoveries to be reused, by their instants and whether loads are split by cause."""
        return {}

    def compute_shares(self, times: Array) -> Results:
        """Return the loads by cause at other instants of the same run, (n,) ascending."""
        return self.compute_reports(times, self.options.reports & (SHARED_BLOCKS | {SHARES}))

    def compute_shares_along(self, name: str, times: Array, places: Sequence[CutPosition]) -> Results:
        """Return the loads by cause of a series of cuts at other instants, (n,) ascending, cut at some places."""
        from heuncli.study.search.cuts import cut_at_places

        return self.compute_reports(times, frozenset({"sections", SHARES}), cut_at_places(self.setup, name, places))

    def _recover(self, times: Array, reports: frozenset[str]) -> Recovery:
        """Recover the results at other instants."""
        solutions = resample(self.setup.runner, self.history, times, by_cause=SHARES in reports)
        return recover(self.setup, solutions, self.options.least_norm)

    @property
    def chunk_size(self) -> int:
        """How many instants are solved in one call, so that their numbers fit into memory."""
        mechanism = self.setup.scene.mechanism
        causes = len(mechanism.loads) + 3 if SHARES in self.options.reports else 0
        return max(50, CHUNK // max(1, len(mechanism.bodies) * (1 + causes)))

    def with_whole_cuts(self, is_nonlinear: bool) -> Setup:
        """Return the setup with its series of cuts as whole lengths.

        is_nonlinear: whether they are for numbers that are no polynomial of the loads
        """
        from heuncli.study.search.cuts import replace_series_by_stretches  # only series of cuts are worth it

        return replace_series_by_stretches(self.setup, is_nonlinear)

    def is_searched(self, columns: int) -> bool:
        """Return whether the extremes of that many columns of a whole report are searched between the requested
        instants, too.
        """
        return columns <= extremes.MAX_COLUMNS and columns * len(self.search_times) <= MOST_SEARCHED

    def search_extremes(
        self,
        search: ChannelSearch,
        report_names: frozenset[str] | None,
        *,
        whole: bool = False,
        times: Array | None = None,
    ) -> Extremes:
        """Search the extremes over the run, before its horizon, of channels of its results.

        report_names: the reports that the channels are of, None for any
        whole: of a whole report, which may have so many columns that a search would take longer than the run: then the
        extremes are those of the requested instants
        times: restricts the search to these instants
        """
        reports = frozenset(REPORTS) if report_names is None else add_shared_reports(report_names)
        study_columns = StudyColumns(self, search, reports)
        between = times is None
        times = self.search_times if times is None else times
        if whole and len(study_columns.paths) * len(times) > MOST_SEARCHED:
            times, between = self.results.time, False
        horizon = self.results.horizon
        if horizon is not None:
            times = times[times < horizon] if times[0] < horizon else times[:1]
        # closed chains need both sides, to report where numbers are indeterminate
        is_one_sided = search.sides != BOTH_SIDES and not self.setup.scene.layout.rows
        sides = search.sides if is_one_sided else BOTH_SIDES
        bounds = extremes.search_extremes(
            study_columns.sample,
            times,
            study_columns.groups,
            errors=study_columns.errors,
            is_squared=study_columns.is_squared,
            search_between=between,
            max_groups=extremes.MAX_COLUMNS if whole else None,
            sides=sides,
        )
        bounds = study_columns.finish(bounds)
        self.left_out.update(study_columns.unknown)
        self.later_warnings.update(dict.fromkeys(warn_left_out(study_columns.unknown)))
        if not bounds.is_complete:
            self.later_warnings[CUT_SHORT] = None
        return bounds


def find_partial_friction(study: Study, times: Iterable[float]) -> dict[float, list[PartialFriction]]:
    """Return the friction that is below its full value, by instant; instants without any are left out."""
    mechanism = study.setup.scene.mechanism
    instants = np.array(sorted({t for t in times if math.isfinite(t)}))
    if not len(instants) or not has_smoothed_friction(mechanism) or study.setup.rest is not None:
        return {}
    if study.has_one_instant:
        instants = study.results.time
    return list_partial_friction(mechanism, study.find_recovery(instants, NO_REPORTS).solutions)


def make_friction_warning(study: Study, path: str, time: float | None) -> str | None:
    """Return the warning on a number that depends on friction below its full value at an instant, or None."""
    if time is None or not depends_on_friction(path):
        return None
    found = find_partial_friction(study, [time])
    partial = next(iter(found.values()), None)
    return f"{path} at t = {time:.6g} s: {describe_partial(partial)}" if partial else None
