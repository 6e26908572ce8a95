"""What a search of extremes starts from: instants that bracket each extreme, and the channels as columns over them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.motion.integration.integrated_scene import find_one_sided_limits
from heuncli.results.results import NOWHERE, Array, CutPosition, Extremes, Indices, Results
from heuncli.scene.shapes.rotations import instants_last, squared_lengths
from heuncli.study.compose.recovery import RANK_REPORTS, Recovery
from heuncli.study.model.setup import Setup
from heuncli.study.quantities.channels import Channel
from heuncli.study.search import extremes
from heuncli.study.search.grid import BOTH_SIDES, replace_non_finite, sort_distinct
from heuncli.study.solve.history import History, resample

if TYPE_CHECKING:
    from heuncli.study.compose.unknown_numbers import OpenMarker, VerdictsBetween


class ChannelSearch(NamedTuple):
    """What is searched for its lowest and highest values: channels of the results at any instants, in one order.

    collect: takes the channels from results; those along series of cuts stand last, and are searched as whole lengths
    find_error: gives the error of a channel's numbers
    sides: the extremes that are needed, -1 the lowest, 1 the highest; others are not searched between the samples
    read: the columns of a recovery, (n_t, n_columns), with the bits of those from results, which then need not be
    composed; None where it cannot give them
    """

    collect: Callable[[Results], Sequence[Channel]]
    find_error: Callable[[Channel], float]
    sides: tuple[float, ...] = BOTH_SIDES
    read: Callable[[Recovery], Array | None] = lambda recovery: None


class Sampleable(Protocol):
    """The parts of a solved scene that a search uses (study/queries/study.py)."""

    @property
    def results(self) -> Results:
        """The results at the requested instants."""

    @property
    def chunk_size(self) -> int:
        """How many instants are solved in one call."""

    def with_whole_cuts(self, is_nonlinear: bool) -> Setup:
        """Return the setup with its series of cuts as whole lengths."""

    def compute_reports(self, times: Array, reports: frozenset[str], setup: Setup | None = None) -> Results:
        """Return some reports' blocks at other instants; setup: with other cuts."""

    def find_recovery(
        self, times: Array, reports: frozenset[str], setup: Setup | None = None, *, keep: bool = False
    ) -> Recovery:
        """Return the recovery at other instants; keep: cache it for the next search."""

    def compose_reports(
        self, recovery: Recovery, reports: frozenset[str], open_marker: OpenMarker | None = None
    ) -> Results:
        """Return some reports' blocks of a recovery.

        open_marker: marks indeterminate numbers where the recovery does not look for them
        """


class SeriesSample(NamedTuple):
    """A number along a series of cuts at one instant.

    series: its name
    nodes, values: positions along it [m], and the number there, (9 m,) each
    """

    series: str
    instant: float
    nodes: Array
    values: Array


class StudyColumns:
    """The columns of a study that are searched; collects the instants at which rounding decides some of them.

    Series of cuts are whole lengths; each channel along them gives two columns, its lowest and its highest.

    The first instants sampled are the grid of the search: between them, what is indeterminate follows from the grid.
    """

    def __init__(
        self, study: Sampleable, search: ChannelSearch, reports: frozenset[str], setup: Setup | None = None
    ) -> None:
        """setup: with series of cuts as whole lengths; by default all of the study's, if channels run along them."""
        self.study, self.reports, self.collect, self.read = study, reports, search.collect, search.read
        channels = search.collect(study.results)
        self.paths = tuple(channel.path for channel in channels)
        self.errors = np.array([search.find_error(channel) for channel in channels])
        self.is_squared = np.array([channel.is_magnitude for channel in channels], dtype=bool)
        along = [channel for channel in channels if channel.has_cuts]
        self.is_nonlinear = any(channel.is_nonlinear for channel in along)
        self.setup = study.with_whole_cuts(self.is_nonlinear) if along and setup is None else setup
        self.unknown: list[float] = []
        self.grid: list[Recovery] = []
        self.n_single = len(channels) - len(along)
        self.groups = [[k] for k in range(self.n_single)]
        self.groups += ([k, k + 1] for k in range(self.n_single, self.n_single + 2 * len(along), 2))

    def compute_results(self, times: Array, setup: Setup | None = None) -> Results:
        """Return the results of the study at some instants, ascending; setup: with other cuts."""
        study, setup = self.study, setup or self.setup
        if setup is None and np.array_equal(times, study.results.time):
            return study.results
        return self._note_unknown(study.compute_reports(times, self.reports, setup))

    def sample(self, times: Array) -> Array:
        """Return the columns at some instants."""
        most = self.study.chunk_size
        parts = [times[i : i + most] for i in range(0, len(times), most)]
        if self.grid:
            return np.concatenate([self._sample_between(part) for part in parts])
        self.grid = [self.study.find_recovery(part, self.reports, self.setup, keep=len(parts) == 1) for part in parts]
        return np.concatenate([self._read_or_compose(recovery) for recovery in self.grid])

    @cached_property
    def grid_verdicts(self) -> VerdictsBetween | None:
        """The verdicts on what is indeterminate between the instants of the grid.

        None if they are not needed, or if it must be found at each instant.
        """
        if not self.reports & RANK_REPORTS or any(recovery.resolution is None for recovery in self.grid):
            # the scene is a tree, or needs no verdicts
            return None
        from heuncli.study.compose.unknown_numbers import (  # where there are closed chains
            VerdictsBetween,
            find_verdicts,
        )

        found = [find_verdicts(recovery, self.reports) for recovery in self.grid]
        known_verdicts = [own for own in found if own is not None]
        return VerdictsBetween(known_verdicts) if len(known_verdicts) == len(found) else None

    def _sample_between(self, times: Array) -> Array:
        """Return the columns at instants between those of the grid."""
        recovery, verdicts = self.study.find_recovery(times, self.reports, self.setup), self.grid_verdicts
        if verdicts is None:
            return self._read_or_compose(recovery)
        is_decided = verdicts.covers(recovery.solutions)
        if is_decided.all():
            return self._rows(self._compose(recovery.without_indeterminacy_search(), verdicts))
        if not is_decided.any():
            return self._rows(self._compose(recovery))
        decided_rows = self._rows(self._compose(recovery.select(is_decided).without_indeterminacy_search(), verdicts))
        other_rows = self._rows(self._compose(recovery.select(~is_decided)))
        rows = np.empty((len(times), decided_rows.shape[1]))
        rows[is_decided], rows[~is_decided] = decided_rows, other_rows
        return rows

    def _read_or_compose(self, recovery: Recovery) -> Array:
        """Return the columns of a recovery, read where that is possible."""
        rows = self.read(recovery)
        return self._rows(self._compose(recovery)) if rows is None else rows

    def _compose(self, recovery: Recovery, verdicts: VerdictsBetween | None = None) -> Results:
        """Compose the results of a recovery; those of the study's own instants are known."""
        results = self.study.results
        if self.setup is None and verdicts is None and np.array_equal(recovery.solutions.times, results.time):
            return results
        return self._note_unknown(self.study.compose_reports(recovery, self.reports, verdicts))

    def _note_unknown(self, results: Results) -> Results:
        """Note the instants at which rounding decides some numbers."""
        self.unknown.extend(results.accuracy.get("unknown", []))
        return results

    def _rows(self, results: Results) -> Array:
        """Return the columns of results: single channels, then the ranges along series of cuts."""
        channels = self.collect(results)
        columns = [channel.searched_values for channel in channels[: self.n_single]]
        if self.setup is not None:
            from heuncli.study.search.cuts import compute_envelope

            columns += [compute_envelope(channel.searched_values) for channel in channels[self.n_single :]]
        return np.concatenate(columns, axis=1) if columns else np.zeros((len(results.time), 0))

    def finish(self, peaks: Extremes) -> Extremes:
        """Complete the extremes: with the paths, the places along series of cuts, and magnitudes in place of squares.

        Quantities along runs that are no polynomial of loads are searched there again.
        """
        if self.setup is not None:
            peaks = self._add_places(peaks)
        low, high = (np.where(self.is_squared, np.sqrt(np.abs(bound)), bound) for bound in (peaks.low, peaks.high))
        return peaks._replace(low=low, high=high, paths=self.paths)

    def _add_places(self, peaks: Extremes) -> Extremes:
        """Add where along a series of cuts each extreme is, and search it there again if need be."""
        first = self.n_single
        low, high, places = peaks.low.copy(), peaks.high.copy(), [(NOWHERE, NOWHERE)] * first
        peak_times = np.stack([peaks.low_at, peaks.high_at])[:, first:]
        instants = sort_distinct(peak_times)
        results = self.compute_results(instants)
        for k, channel in enumerate(self.collect(results)[first:]):
            name, values, side_places = channel.name.split(".")[0], channel.searched_values, []
            for side, bounds in ((-1.0, low), (1.0, high)):
                i = int(np.searchsorted(instants, peak_times[int(side > 0.0), k]))
                s = np.broadcast_to(results.sections[name]["s"], values.shape)[i]
                series_sample = SeriesSample(name, float(instants[i]), s, values[i])
                bounds[first + k], place = self._find_place(first + k, side, series_sample, float(bounds[first + k]))
                side_places.append(place)
            places.append((side_places[0], side_places[1]))
        return peaks._replace(low=low, high=high, places=tuple(places))

    def _find_place(self, k: int, side: float, series_sample: SeriesSample, value: float) -> tuple[float, CutPosition]:
        """Return the value of an extreme of the k-th channel, along a series of cuts, and its place."""
        assert self.setup is not None
        from heuncli.study.search.cuts import cut_at, find_sides, find_stretch, locate_summit

        setup, (name, instant, nodes, values) = self.setup, series_sample
        s, load_side, ends = locate_summit(nodes, values, side)  # ends: of the smooth piece
        if self.is_nonlinear and math.isfinite(value):

            def sample_places(s: Array) -> Array:
                """Return the channel at some places along the bar."""
                cut_results = self.compute_results(np.array([instant]), cut_at(setup, name, s, ends))
                return self.collect(cut_results)[k].searched_values.T

            errors, is_squared = self.errors[k : k + 1], self.is_squared[k : k + 1]
            search_result = extremes.search_extremes(
                sample_places, np.linspace(*ends, 17), errors=errors, is_squared=is_squared, sides=(side,)
            )
            value, s = (
                float(x[0])
                for x in (
                    (search_result.high, search_result.high_at)
                    if side > 0.0
                    else (search_result.low, search_result.low_at)
                )
            )
            load_side = float(find_sides(np.array(s), ends))
        return value, find_stretch(setup, name).make_place(s, load_side)


WITHIN_STEP = (0.0, 0.23, 0.52, 0.77)  # shares of each step of the integrator: where extremes are sampled first
MAX_TURN = np.pi / 8.0  # rad: largest turn of a body between two of these instants, 1/8 period of the second order
MAX_INSTANTS = 100_000


def choose_search_times(setup: Setup, history: History, max_instants: int = MAX_INSTANTS) -> tuple[Array, bool]:
    """Choose instants close enough to bracket every extreme, (n,) ascending; and whether there are enough of them.

    They are the requested ones; some within each step, at uneven distances, so that nothing periodic looks constant;
    both sides of all jumps; enough to show how loads and drives change; and so many that no body turns far between two
    of them: a rotor that is driven, or spins on, needs no steps, but its loads turn. max_instants: approximate limit of
    their number.
    """
    times = history.times
    if history.checked_run is None:
        return times, True
    marks = np.concatenate([[0.0], history.checked_run.run.ends])
    per_step = max(1, min(len(WITHIN_STEP), max_instants // max(len(marks), 1)))
    inside_steps = (marks[:-1, None] + np.diff(marks)[:, None] * np.array(WITHIN_STEP[:per_step])).ravel()
    # a jump has a value on either side of it
    grid = inside_steps
    if history.jumps:
        before, after = find_one_sided_limits(history.jumps)
        grid = np.concatenate([inside_steps, before[before > 0.0], after[before > 0.0]])
    grid = sort_distinct(np.concatenate([times, grid[(grid > times[0]) & (grid < times[-1])]]))
    grid, is_followed = add_time_law_instants(setup, grid, max_instants)
    turn_parts = np.ceil(find_largest_turns(setup, history, grid) / MAX_TURN)
    parts = np.clip(turn_parts, 1, max_instants + 1).astype(int)  # for faster turning the search is incomplete
    enough = is_followed and per_step == len(WITHIN_STEP) and int(parts.sum()) <= max_instants
    parts = np.minimum(parts, max(1, max_instants // len(grid))) if not enough else parts
    times = divide_evenly(grid, parts) if (parts > 1).any() else grid
    if not enough or not has_loads_along_coordinates(setup):
        return times, enough
    from heuncli.study.search.law_instants import refine_for_loads

    return refine_for_loads(setup, history, times, max_instants)


def divide_evenly(grid: Array, parts: Indices) -> Array:
    """Divide the intervals between instants (n,) into so many equal parts each, (n - 1,); return all instants."""
    first = np.repeat(np.arange(len(parts)), parts)
    share = (np.arange(len(first)) - np.repeat(np.cumsum(parts) - parts, parts)) / parts[first]
    return np.append(grid[first] + share * np.diff(grid)[first], grid[-1:])


def has_loads_along_coordinates(setup: Setup) -> bool:
    """Return whether loads depend on coordinates or points.

    If they push along a constrained direction, no integration step shows how fast they change.
    """
    return any(value.uses for load in setup.scene.mechanism.loads for value in load.values)


def add_time_law_instants(setup: Setup, grid: Array, max_instants: int) -> tuple[Array, bool]:
    """Add instants to the grid where loads and drives in time need them; and whether `max_instants` are enough."""
    if not any(e.time_dependent and not e.uses for e in setup.scene.mechanism.iter_expressions()):
        return grid, True
    from heuncli.study.search.law_instants import refine_for_time_laws

    return refine_for_time_laws(setup.scene.mechanism, grid, max_instants)


def find_largest_turns(setup: Setup, history: History, grid: Array) -> Array:
    """Return the largest angle [rad] by which any body turns between neighbouring instants, (n - 1,)."""
    driven = setup.scene.layout.has_laws
    known = resample(setup.runner, history, grid) if driven else history.solutions
    omega = np.sqrt(replace_non_finite(squared_lengths(instants_last(known.bodies["omega"]))).max(axis=0, initial=0.0))
    omega = np.interp(grid, known.times, omega)
    return np.asarray(np.maximum(omega[1:], omega[:-1]) * np.diff(grid))
