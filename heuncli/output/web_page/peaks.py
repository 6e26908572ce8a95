"""Find when the loads of a run are largest, also between its samples, so that a page includes these instants."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Results
from heuncli.results.results_schema import RESULTANT_UNITS, RESULTANTS
from heuncli.study.quantities.digits import StatedErrors
from heuncli.study.quantities.labels import Labels
from heuncli.study.queries.study import Study
from heuncli.study.search.extremes import ColumnSearch, sort_distinct

REPORTS = frozenset({"joints", "foundation", "sections"})


class LoadColumn(NamedTuple):
    """One load over the instants, (n_t,), or along a run of cuts, (n_t, n_cuts); for a vector its squared magnitude.

    cut_run: name of the run of cuts, else empty
    kind, unit: those of its error
    """

    values: Array
    kind: str
    unit: str
    is_squared: bool = False
    cut_run: str = ""


class Peaks(NamedTuple):
    """The instants (n,) [s] at which loads are largest.

    is_searched: whether the search also covered the time between the instants of the run
    """

    times: Array
    is_searched: bool


def find_peaks(study: Study, labels: Labels, certain: StatedErrors) -> Peaks:
    """Find the instants at which joint and foundation loads and section forces are largest."""
    loads = list(_iter_loads(study.results))
    if not loads:
        return Peaks(np.zeros(0), is_searched=True)
    ordered = [load for load in loads if not load.cut_run] + [load for load in loads if load.cut_run]
    single_loads = [load for load in ordered if not load.cut_run]
    errors = np.array([_find_error(load, labels, certain) for load in ordered])
    search = ColumnSearch(
        _stack_columns,
        [[k] for k in range(len(single_loads))],
        errors,
        np.array([load.is_squared for load in ordered]),
        _collect_cut_run_loads if len(single_loads) < len(ordered) else None,
    )
    extremes = study.search_extremes(search, REPORTS, whole=True)
    minimum_times = np.where([load.is_squared for load in ordered], np.nan, extremes.low_at)  # magnitudes: maximum only
    times = np.concatenate([minimum_times, extremes.high_at])
    return Peaks(np.asarray(sort_distinct(times[np.isfinite(times)])), extremes.is_searched or study.has_one_instant)


def _iter_loads(results: Results) -> Iterator[LoadColumn]:
    """Yield the loads of a page whose peaks are searched."""
    blocks: list[tuple[str, Mapping[str, Any]]] = [("reactions", joint) for joint in results.joints.values()]
    blocks += [("foundation", results.foundation)] if results.foundation else []
    for kind, block in blocks:
        for quantity, unit in (("force", "N"), ("moment", "N·m")):
            if quantity in block:
                yield LoadColumn(np.einsum("ij,ij->i", block[quantity], block[quantity]), kind, unit, is_squared=True)
    for name, section in results.sections.items():
        for quantity in RESULTANTS:
            yield LoadColumn(
                section[quantity], "sections", RESULTANT_UNITS[quantity], cut_run=name if "s" in section else ""
            )


def _stack_columns(results: Results) -> Array:
    """Stack the loads that do not belong to runs of cuts, (n_t, n)."""
    columns = [load.values for load in _iter_loads(results) if not load.cut_run]
    return np.stack(columns, axis=1) if columns else np.zeros((len(results.time), 0))


def _collect_cut_run_loads(results: Results) -> list[tuple[str, Array]]:
    """Collect the loads along runs of cuts, each with the name of its run."""
    return [(load.cut_run, load.values) for load in _iter_loads(results) if load.cut_run]


def _find_error(load: LoadColumn, labels: Labels, certain: StatedErrors) -> float:
    """Find the stated error of a load, SI."""
    unit, size = labels.units.find(load.unit)
    return certain.error_of(load.kind, unit) / size
