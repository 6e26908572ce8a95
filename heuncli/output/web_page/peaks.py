"""Find when the loads of a run are largest, also between its samples, so that a page includes these instants."""

from __future__ import annotations

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Results
from heuncli.results.results_schema import RESULTANTS
from heuncli.study.quantities.channels import Channel, collect_run_loads, iter_channels
from heuncli.study.quantities.digits import StatedErrors
from heuncli.study.quantities.labels import Labels
from heuncli.study.queries.study import Study
from heuncli.study.search.columns import ChannelSearch
from heuncli.study.search.extremes import sort_distinct

FOUNDATION_LOADS = ("foundation.force", "foundation.moment")
REPORTS = frozenset({"joints", "foundation", "sections"})


class Peaks(NamedTuple):
    """The instants (n,) [s] at which loads are largest.

    is_searched: whether the search also covered the time between the instants of the run
    """

    times: Array
    is_searched: bool


def find_peaks(study: Study, labels: Labels, certain: StatedErrors) -> Peaks:
    """Find the instants at which joint and foundation loads and section forces are largest."""
    search = ChannelSearch(lambda results: _collect_loads(results, labels), certain.find_error)
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
    vectors = [channel for channel in channels if channel.quantity in ("force", "moment")]
    loads = [channel for channel in vectors if channel.kind == "joints" or channel.path in FOUNDATION_LOADS]
    loads += [channel for channel in channels if channel.kind == "sections" and channel.quantity in RESULTANTS]
    return loads + collect_run_loads(results)
