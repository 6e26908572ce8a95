"""What is searched along runs of cuts besides the section forces: stresses, and all quantities at each cut shown.

Magnitudes are searched as squares, which have no kink at zero.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.tables.cut_runs import CutRun, RunQuantity, choose_cuts, collect_runs
from heuncli.results.results import Array, CutPosition, Extremes, Indices, Mask, Results
from heuncli.study.quantities.digits import StatedErrors
from heuncli.study.quantities.labels import Labels


class RunExtremes(NamedTuple):
    """Extremes of the stresses along a run, and of forces and stresses at the cuts that are shown."""

    stresses: Extremes | None = None
    cuts: Extremes | None = None


NO_EXTREMES: Mapping[str, RunExtremes] = MappingProxyType({})


class RunSearch(NamedTuple):
    """Quantities of one run of cuts as columns of a search.

    cuts: those that are shown; none if the whole run is searched
    """

    run: CutRun
    labels: Labels
    quantities: tuple[RunQuantity, ...]
    cuts: Indices

    def evaluate(self, results: Results) -> Array:
        """Return the values at the instants of other results, (n, n_t, n_cuts), magnitudes squared."""
        same_run = next(run for run in collect_runs(results, self.labels) if run.name == self.run.name)
        first = self.run.quantities.index(self.quantities[0])
        values = same_run.values[first : first + len(self.quantities)]
        is_magnitude = np.array([quantity.is_magnitude for quantity in self.quantities])[:, None, None]
        return np.where(is_magnitude, values * values, values)

    def make_columns(self, results: Results) -> Array:
        """Return the quantities at the cuts as columns, (n_t, n * n_cuts), with the cuts of one quantity side by
        side.
        """
        values = self.evaluate(results)[:, :, self.cuts]
        return values.transpose(1, 0, 2).reshape(values.shape[1], -1)

    def run_columns(self, results: Results) -> list[tuple[str, Array]]:
        """Return each quantity along the whole run, (n_t, n_nodes), with the name of the run."""
        return [(self.run.name, values) for values in self.evaluate(results)]

    def find_errors(self, certain: StatedErrors) -> Array:
        """Return the error of each column, (n * n_cuts,), or of each quantity along the run, (n,)."""
        return self._repeat_for_cuts([certain.error_of("sections", quantity.unit) for quantity in self.quantities])

    @property
    def magnitude_columns(self) -> Mask:
        """The mask of columns that are squares of magnitudes."""
        return self._repeat_for_cuts([quantity.is_magnitude for quantity in self.quantities]).astype(bool)

    @property
    def groups(self) -> list[list[int]]:
        """The groups of columns that are compared with each other: each column is its own group."""
        return [[column] for column in range(len(self.quantities) * len(self.cuts))]

    def take_roots(self, extremes: Extremes) -> Extremes:
        """Replace the extremes of squared magnitudes by those of the magnitudes."""
        low, high = (
            np.where(self.magnitude_columns, np.sqrt(np.abs(bound)), bound) for bound in (extremes.low, extremes.high)
        )
        return extremes._replace(low=low, high=high)

    def _repeat_for_cuts(self, values: Sequence[float]) -> Array:
        return np.repeat(np.array(values, dtype=np.float64), len(self.cuts) or 1)


def search_cuts(run: CutRun, labels: Labels) -> RunSearch:
    """Make the search of all quantities at the cuts that are shown."""
    return RunSearch(run, labels, run.quantities, choose_cuts(run))


def search_stresses(run: CutRun, labels: Labels) -> RunSearch:
    """Make the search of the stresses along the run."""
    return RunSearch(run, labels, run.stresses, np.zeros(0, dtype=np.intp))


def append_stresses(
    run: CutRun, loads: Extremes, places: tuple[tuple[CutPosition, CutPosition], ...], stresses: Extremes | None
) -> tuple[Extremes, tuple[tuple[CutPosition, CutPosition], ...]]:
    """Append the extremes of the stresses along a run to those of its section forces."""
    if stresses is None or not run.stresses:
        return loads, places
    low, low_at, low_column, high, high_at, high_column = (
        np.concatenate([of_loads, of_stresses]) for of_loads, of_stresses in zip(loads[:6], stresses[:6], strict=True)
    )
    both = Extremes(low, low_at, low_column, high, high_at, high_column, loads.is_searched, loads.is_complete)
    return both, (*places, *stresses.places)
