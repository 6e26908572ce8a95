"""Choose the instants that a page holds: the requested ones, and more between them where the motion would look jerky.

Nothing beyond the horizon is shown. Impacts and jumps get an instant on both sides, and an instant is added where a
load is largest, also between the samples.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.motion.integration.integrated_scene import find_one_sided_limits
from heuncli.results.results import Array, Indices, Results
from heuncli.results.results_schema import REPORT_OF, RESULTANTS
from heuncli.study.quantities.channels import Channel, collect_series_loads, iter_channels
from heuncli.study.quantities.digits import StatedErrors
from heuncli.study.quantities.labels import Labels
from heuncli.study.queries.study import Study
from heuncli.study.search.columns import ChannelSearch, find_largest_turns
from heuncli.study.search.grid import sort_distinct

MIN_FRAMES = 120  # frames of a motion
MAX_TURN = 0.3  # rad: how far a body may turn from one frame to the next
MAX_PAGE_FRAMES = 600  # frames, unless the user gives another limit
MAX_JUMPS = 60  # with a frame on both sides; the knots of tables are jumps, too
MIN_PEAK_DISTANCE = 1e-3  # parts of the interval; the error of the peak value is of second order in it
MISSED_PEAKS_NOTE = (
    "This page leaves out {} of the times at which loads are largest: maxima shown here are those at the frames; heun "
    "run gives the actual maxima."
)
FOUNDATION_LOADS = ("foundation.force", "foundation.moment")
REPORTS = frozenset({"joints", "foundation", "sections"})
MAX_BYTES = 24_000_000  # of a page's numbers, before they are encoded as text


class PageFrames(NamedTuple):
    """The instants (n,) [s] of a page, and the notes that the page shows about them."""

    times: Array
    notes: tuple[str, ...]


class Peaks(NamedTuple):
    """The instants (n,) [s] at which loads are largest.

    is_searched: whether the search also covered the time between the instants of the run
    """

    times: Array
    is_searched: bool


def find_peaks(study: Study, labels: Labels, stated_errors: StatedErrors) -> Peaks:
    """Find the instants at which joint and foundation loads and section forces are largest."""
    search = ChannelSearch(lambda results: _collect_loads(results, labels), stated_errors.find_error)
    loads = search.collect(study.results)
    if not loads:
        return Peaks(np.zeros(0), is_searched=True)
    extremes = study.search_extremes(search, REPORTS, whole=True)
    minimum_times = np.where([load.is_magnitude for load in loads], np.nan, extremes.low_at)  # magnitudes: maximum only
    times = np.concatenate([minimum_times, extremes.high_at])
    return Peaks(np.asarray(sort_distinct(times[np.isfinite(times)])), extremes.is_searched or study.has_one_instant)


def _collect_loads(results: Results, labels: Labels) -> list[Channel]:
    """Collect the loads of a page whose peaks are searched: vectors of joints and of the foundation, section forces."""
    channels = [channel for channel in iter_channels(results, labels) if not channel.cause and not channel.has_cuts]
    vectors = [channel for channel in channels if channel.quantity in ("force", "moment", "radial_force")]
    is_shown = {"joints", "sensors"}
    loads = [channel for channel in vectors if channel.kind in is_shown or channel.path in FOUNDATION_LOADS]
    loads += [channel for channel in channels if channel.kind == "sections" and channel.quantity in RESULTANTS]
    return loads + collect_series_loads(results)


def choose_frames(study: Study, peaks: Array, max_frames: int = MAX_PAGE_FRAMES) -> PageFrames:
    """Choose at most `max_frames` instants for a page.

    peaks: instants [s] that are included if the limit permits
    """
    results = study.results
    if study.has_one_instant:
        return PageFrames(results.time, ())
    horizon = results.horizon
    sample_times = results.time if horizon is None else results.time[results.time < horizon]
    if len(sample_times) < 2:
        horizon_note = (
            ("No results are claimed after the start of this motion.",) if len(results.time) > len(sample_times) else ()
        )
        return PageFrames(results.time[:1], horizon_note)
    limit = max(2, min(max_frames, MAX_BYTES // _estimate_frame_bytes(study)))
    extra, missed = _choose_extra_instants(study, peaks, sample_times, max(limit - len(sample_times), limit // 3))
    capacity = limit - len(extra)
    notes = [MISSED_PEAKS_NOTE.format(missed)] if missed else []
    if len(sample_times) > capacity:
        notes.append(f"This page contains {capacity} of the {len(sample_times)} output times.")
        regular = sample_times[np.linspace(0, len(sample_times) - 1, capacity).round().astype(np.intp)]
    else:
        regular = _fill_between(study, sample_times, capacity)
    times = np.asarray(sort_distinct(np.concatenate([regular, extra])))
    largest_turn = float(find_largest_turns(study.setup, study.history, times).max(initial=0.0))
    if largest_turn > tolerances.MAX_INTERPOLATED_TURN:
        notes.append(
            f"A body rotates by up to {math.degrees(largest_turn):.0f}° between frames: only "
            "positions at the frames are exact."
        )
    return PageFrames(times, tuple(notes))


def resample_at_frames(study: Study, times: Array) -> Results:
    """Resample the results at the frames; at instants of the run itself the values are the run's own, bit for bit."""
    original = study.results
    if np.array_equal(times, original.time):
        return original
    frame_results = study.resample(times)
    positions = np.flatnonzero(np.isin(times, original.time))
    source_rows = np.searchsorted(original.time, times[positions])
    blocks = {
        block: _copy_instants(getattr(frame_results, block), getattr(original, block), positions, source_rows)
        for block in REPORT_OF
    }
    return replace(frame_results, **blocks)


def _copy_instants(block: Any, source: Any, positions: Indices, source_rows: Indices) -> Any:
    """Return a block of results whose rows at `positions` are copied from `source_rows` of another block.

    The blocks have different numbers of instants, so an array runs over the instants if and only if the lengths differ.
    """
    if isinstance(block, dict):
        return {
            key: _copy_instants(value, source[key], positions, source_rows) if key in source else value
            for key, value in block.items()
        }
    if not isinstance(block, np.ndarray) or len(block) == len(source):
        return block
    block_copy = block.copy()
    block_copy[positions] = source[source_rows]
    return block_copy


def _fill_between(study: Study, sample_times: Array, limit: int) -> Array:
    """Return the requested instants with so many between each two of them that the motion can be followed."""
    target_counts = find_largest_turns(study.setup, study.history, sample_times) / MAX_TURN
    if len(sample_times) < MIN_FRAMES:
        target_counts = np.maximum(
            target_counts, np.diff(sample_times) / (sample_times[-1] - sample_times[0]) * MIN_FRAMES
        )
    counts = _round_counts(target_counts, limit - 1)
    interval = np.repeat(np.arange(len(counts)), counts)
    fraction = (np.arange(len(interval)) - np.repeat(np.cumsum(counts) - counts, counts)) / counts[interval]
    return np.append(sample_times[interval] + fraction * np.diff(sample_times)[interval], sample_times[-1])


def _round_counts(target_counts: Array, max_total: int) -> Indices:
    """Round the target counts (n,) up to whole numbers, at least 1; less if their sum would exceed `max_total`."""
    extra = np.maximum(np.ceil(target_counts) - 1.0, 0.0)
    spare = max_total - len(target_counts)
    if extra.sum() > spare:
        extra = np.floor(extra * (spare / extra.sum()))
    return np.asarray(1 + extra.astype(np.intp))


def _choose_extra_instants(study: Study, peaks: Array, sample_times: Array, max_count: int) -> tuple[Array, int]:
    """Choose at most `max_count` extra instants: both sides of impacts, then both sides of jumps, then peaks.

    Each kind is included completely or not at all. Also returns the number of peaks that were left out.
    """
    impact_times = [float(impulse["time"]) for impulse in study.results.impulses]
    jumps = study.history.jumps if len(study.history.jumps) <= MAX_JUMPS else []
    extra_times: Array = np.zeros(0)
    missed = 0
    for kind in (
        _make_side_instants(impact_times, sample_times),
        _make_side_instants(jumps, sample_times),
        separate_peaks := _select_separate_peaks(peaks, sample_times),
    ):
        candidates = np.asarray(sort_distinct(np.concatenate([extra_times, kind])))
        missed = len(separate_peaks) if kind is separate_peaks and len(candidates) > max_count else 0
        extra_times = candidates if len(candidates) <= max_count else extra_times
    return extra_times, missed


def _make_side_instants(instants: Sequence[float] | Array, sample_times: Array) -> Array:
    """Make the last instants before the given ones and the first after them, for those within the requested range."""
    inside = sort_distinct(np.array([t for t in instants if sample_times[0] < t <= sample_times[-1]], dtype=np.float64))
    return np.concatenate(find_one_sided_limits(inside)) if len(inside) else inside


def _select_separate_peaks(peaks: Array, sample_times: Array) -> Array:
    """Select the peaks that are not requested instants, nor so close to one that it shows the same value."""
    inside = peaks[(peaks > sample_times[0]) & (peaks < sample_times[-1])]
    after = np.searchsorted(sample_times, inside)
    distance = np.minimum(inside - sample_times[after - 1], sample_times[after] - inside)
    return np.asarray(inside[distance > MIN_PEAK_DISTANCE * (sample_times[after] - sample_times[after - 1])])


def _estimate_frame_bytes(study: Study) -> int:
    """Estimate the size of the numbers of one instant, in bytes."""
    results = study.results
    count = sum(_count_numbers(getattr(results, block)) for block in REPORT_OF if block not in ("bodies", "points"))
    return 8 * count // len(results.time) + 28 * len(results.bodies) + 1


def _count_numbers(block: object) -> int:
    """Count the numbers in a block, including nested blocks."""
    if isinstance(block, dict):
        return sum(_count_numbers(member) for member in block.values())
    return int(block.size) if isinstance(block, np.ndarray) else 0
