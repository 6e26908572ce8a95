"""What is searched of runs of cuts beside the loads along them: stresses along them, and all of it at each cut shown.

Squares stand for magnitudes, whose kinks at zero they do not have.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.tables.cut_runs import CutRun, RunQuantity, runs_of, thinned
from heuncli.results.results import Array, Extremes, Indices, Mask, Place, Results
from heuncli.study.quantities.digits import Certainty
from heuncli.study.quantities.labels import Labels


class RunExtremes(NamedTuple):
    """Extremes of the stresses along a run; of loads and stresses at its cuts that are shown."""

    stresses: Extremes | None = None
    cuts: Extremes | None = None


NONE: Mapping[str, RunExtremes] = MappingProxyType({})


class RunSearch(NamedTuple):
    """Quantities of one run as columns of a search; cuts: those that are shown, none for the run as a whole."""

    run: CutRun
    labels: Labels
    quantities: tuple[RunQuantity, ...]
    cuts: Indices

    def of(self, results: Results) -> Array:
        """The values at other instants, (n, n_t, n_cuts)."""
        found = next(run for run in runs_of(results, self.labels) if run.name == self.run.name)
        first = self.run.quantities.index(self.quantities[0])
        values = found.values[first : first + len(self.quantities)]
        even = np.array([own.even for own in self.quantities])[:, None, None]
        return np.where(even, values * values, values)

    def columns(self, results: Results) -> Array:
        """The quantities at the cuts as columns, (n_t, n * n_cuts), the cuts of one quantity side by side."""
        values = self.of(results)[:, :, self.cuts]
        return values.transpose(1, 0, 2).reshape(values.shape[1], -1)

    def along(self, results: Results) -> list[tuple[str, Array]]:
        """Each quantity along the whole run, (n_t, n_nodes), with the name of the run."""
        return [(self.run.name, values) for values in self.of(results)]

    def errors(self, certain: Certainty) -> Array:
        """How well they are known, (n * n_cuts,), or (n,) along the run."""
        return self._each([certain.error("sections", own.unit) for own in self.quantities])

    @property
    def even(self) -> Mask:
        """Which columns are squares of magnitudes."""
        return self._each([own.even for own in self.quantities]).astype(bool)

    @property
    def groups(self) -> list[list[int]]:
        """Each column on its own."""
        return [[column] for column in range(len(self.quantities) * len(self.cuts))]

    def roots(self, found: Extremes) -> Extremes:
        """The extremes of the quantities themselves, not of squares."""
        low, high = (np.where(self.even, np.sqrt(np.abs(bound)), bound) for bound in (found.low, found.high))
        return found._replace(low=low, high=high)

    def _each(self, values: Sequence[float]) -> Array:
        return np.repeat(np.array(values, dtype=np.float64), len(self.cuts) or 1)


def at_cuts(run: CutRun, labels: Labels) -> RunSearch:
    """All quantities at the cuts that are shown."""
    return RunSearch(run, labels, run.quantities, thinned(run))


def stresses_along(run: CutRun, labels: Labels) -> RunSearch:
    """The stresses along the run."""
    return RunSearch(run, labels, run.stresses, np.zeros(0, dtype=np.intp))


def with_stresses(
    run: CutRun, loads: Extremes, places: tuple[tuple[Place, Place], ...], stresses: Extremes | None
) -> tuple[Extremes, tuple[tuple[Place, Place], ...]]:
    """The extremes of the loads along a run and of its stresses, one after the other."""
    if stresses is None or not run.stresses:
        return loads, places
    low, low_at, low_column, high, high_at, high_column = (
        np.concatenate([mine, its]) for mine, its in zip(loads[:6], stresses[:6], strict=True)
    )
    both = Extremes(low, low_at, low_column, high, high_at, high_column, loads.searched, loads.complete)
    return both, (*places, *stresses.places)
