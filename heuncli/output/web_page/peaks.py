"""When the loads of a run are largest, searched between its samples, too: instants that a page must not miss."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array, Results
from heuncli.results.results_schema import RESULTANT_UNITS, RESULTANTS
from heuncli.study.ask.study import Study
from heuncli.study.quantities.digits import Certainty
from heuncli.study.quantities.labels import Labels
from heuncli.study.search.extremes import ColumnSearch, distinct

REPORTS = frozenset({"joints", "foundation", "sections"})


class LoadColumn(NamedTuple):
    """One load over the instants, (n_t,) or along a run of cuts (n_t, n_cuts); of a vector the square of its size.

    run: the name of the run of cuts; kind and unit: of its error.
    """

    values: Array
    kind: str
    unit: str
    square: bool = False
    run: str = ""


class Peaks(NamedTuple):
    """When loads are largest (n,) [s]; sought: whether that was searched between the instants of the run, too."""

    times: Array
    sought: bool


def peak_times(study: Study, labels: Labels, certain: Certainty) -> Peaks:
    """The instants at which forces and moments of joints and of the foundation, and loads of sections, are largest."""
    searched = list(_loads(study.results))
    if not searched:
        return Peaks(np.zeros(0), sought=True)
    ordered = [load for load in searched if not load.run] + [load for load in searched if load.run]
    own = [load for load in ordered if not load.run]
    errors = np.array([_error(load, labels, certain) for load in ordered])
    search = ColumnSearch(
        _columns, [[k] for k in range(len(own))], errors, np.array([load.square for load in ordered]),
        _along if len(own) < len(ordered) else None,
    )  # fmt: skip
    found = study.extremes(search, REPORTS, whole=True)
    lowest = np.where([load.square for load in ordered], np.nan, found.low_at)  # of a size the largest alone
    times = np.concatenate([lowest, found.high_at])
    return Peaks(np.asarray(distinct(times[np.isfinite(times)])), found.searched or study.of_one_instant)


def _loads(results: Results) -> Iterator[LoadColumn]:
    """The loads of a page that are looked through."""
    blocks: list[tuple[str, Mapping[str, Any]]] = [("reactions", joint) for joint in results.joints.values()]
    blocks += [("foundation", results.foundation)] if results.foundation else []
    for kind, block in blocks:
        for quantity, unit in (("force", "N"), ("moment", "N·m")):
            if quantity in block:
                yield LoadColumn(np.einsum("ij,ij->i", block[quantity], block[quantity]), kind, unit, square=True)
    for name, section in results.sections.items():
        for quantity in RESULTANTS:
            yield LoadColumn(
                section[quantity], "sections", RESULTANT_UNITS[quantity], run=name if "s" in section else ""
            )


def _columns(results: Results) -> Array:
    """What is searched beside runs of cuts, (n_t, n)."""
    columns = [load.values for load in _loads(results) if not load.run]
    return np.stack(columns, axis=1) if columns else np.zeros((len(results.time), 0))


def _along(results: Results) -> list[tuple[str, Array]]:
    """What is searched along runs of cuts, each with the name of its run."""
    return [(load.run, load.values) for load in _loads(results) if load.run]


def _error(load: LoadColumn, labels: Labels, certain: Certainty) -> float:
    """The error of a load, SI."""
    unit, size = labels.units.of(load.unit)
    return certain.error(load.kind, unit) / size
