"""The whole report of a run as tables: its blocks, and the columns whose extremes have to be searched.

`page_of(results, labels)` first; then either `columns` and `groups` for a search and `extremes` with its outcome, or
`instants`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from heuncli.report import extremes, instants, runs
from heuncli.report.blocks import Block, build
from heuncli.report.labels import Labels
from heuncli.report.numbers import Certainty, certainty, with_axis
from heuncli.report.plans import PLANS
from heuncli.report.quantities import Series, walk, walk_impulse
from heuncli.report.sums import sums_table
from heuncli.report.table import Table
from heuncli.results import Array, CertainSum, Extremes, Magnitudes, Results
from heuncli.results_schema import REPORT_OF, REPORTS, quantity

TABLE_DEFAULT = frozenset(REPORTS) - {"motion", "points"}
EXPORT_DEFAULT = frozenset(REPORTS) - {"points"}


class Page(NamedTuple):
    """The tables of a run: blocks and runs of cuts up to the horizon, before they are laid out.

    of: what its numbers are summed from; beyond: the last instant alone, where the run ends beyond its horizon.
    """

    results: Results
    labels: Labels
    certain: Certainty
    of: Magnitudes
    beyond: Results | None = None

    def columns(self, results: Results) -> Array:
        """What is searched, (n_t, n): all rows of all blocks (magnitudes squared), then the cuts of runs."""
        columns = [
            (row.values**2 if row.even else row.values)[:, None]
            for block in self._lasting(results)
            for group in block.groups
            for row in group.rows
        ]
        columns += [runs.columns(run) for run in runs.runs_of(results, self.labels)]
        return np.concatenate(columns, axis=1) if columns else np.zeros((len(results.time), 0))

    def groups(self) -> list[list[int]]:
        """Which columns are compared with each other: a row alone, a resultant over all cuts of its run."""
        n = sum(len(group.rows) for block in self._lasting(self.results) for group in block.groups)
        groups = [[column] for column in range(n)]
        for run in runs.runs_of(self.results, self.labels):
            for _ in runs.RESULTANTS:
                groups.append(list(range(n, n + len(run.s))))
                n += len(run.s)
        return groups

    def extremes(self, searched: Extremes) -> list[Table]:
        """The tables with extremes, from those searched for each of `groups`."""
        tables: list[Table] = []
        start = 0
        times, last = self.results.time, self._last_values()
        for block in self._lasting(self.results):
            rows = [row for group in block.groups for row in group.rows]
            own = slice(start, start + len(rows))
            even = np.array([row.even for row in rows], dtype=bool)
            part = searched.part(own)
            low, high = (np.where(even, np.sqrt(np.abs(bound)), bound) for bound in (part.low, part.high))
            beyond = last[own] if last is not None else None
            tables += extremes.extremes_table(block, times, part._replace(low=low, high=high), self.certain, beyond)
            start += len(rows)
        column = start
        for run in runs.runs_of(self.results, self.labels):
            own = slice(start, start + len(runs.RESULTANTS))
            first = column + len(run.s) * np.arange(len(runs.RESULTANTS))
            part = searched.part(own)
            cuts = part._replace(low_column=part.low_column - first, high_column=part.high_column - first)
            tables += runs.extremes_tables(run, times, cuts, self.certain)
            start, column = own.stop, column + len(run.s) * len(runs.RESULTANTS)
        return [*tables, *self._ending()]

    def instants(self, results: Results, *, every_cut: bool = False) -> list[Table]:
        """The tables at the instants of `results`, which is the same run at any instants."""
        horizon = self.results.accuracy.get("horizon")
        unknown = frozenset(results.accuracy.get("unknown", ()))
        certain = with_axis(self.certain._replace(beside=unknown), results, self.of)
        tables: list[Table] = []
        for block in _blocks(results, self.labels):
            tables += instants.instants_tables(block, results.time, horizon, certain)
        for run in runs.runs_of(results, self.labels):
            tables += runs.instants_tables(run, results.time, horizon, self.certain, every=every_cut)
        return [*tables, *self._ending()]

    def _last_values(self) -> Array | None:
        """The values of all rows at the last instant, where that is beyond the horizon."""
        if self.beyond is None:
            return None
        blocks = self._lasting(self.beyond)
        return np.array([row.values[-1] for block in blocks for group in block.groups for row in group.rows])

    def _lasting(self, results: Results) -> list[Block]:
        return _blocks(results, self.labels, lasting=True)

    def _ending(self) -> list[Table]:
        sums = sums_table(self.results, self.certain, self.beyond)
        return [*self._impulses(), *([sums] if sums else [])]

    def _impulses(self) -> list[Table]:
        tables: list[Table] = []
        for impulse in self.results.impulses:
            series = list(walk_impulse(impulse, self.labels))
            for plan in PLANS:
                block = build(plan, self.results, self.labels, series)
                if block is not None:
                    heading = f"IMPULSE at t = {float(impulse['time']):.6g} s  {block.heading}"
                    named = block._replace(heading=heading, notes=())
                    time, horizon = np.array([float(impulse["time"])]), self.results.accuracy.get("horizon")
                    tables += instants.instants_tables(named, time, horizon, self.certain)
        return tables


def page_of(results: Results, labels: Labels, of: Magnitudes) -> Page:
    """The page of a run, ending before its horizon; `of`: what its numbers are summed from."""
    horizon = results.accuracy.get("horizon")
    certain = certainty(results, labels, of)
    if horizon is None or results.time[-1] < horizon:
        return Page(results, labels, certain, of)
    known = max(1, int(np.searchsorted(results.time, horizon)))
    return Page(some_instants(results, slice(known)), labels, certain, of, some_instants(results, slice(-1, None)))


def some_instants(results: Results, which: slice) -> Results:
    """The results at some of their instants."""

    def those(keys: tuple[str, ...], value: Any) -> Any:
        if isinstance(value, dict):
            return {key: those((*keys, key), member) for key, member in value.items()}
        row = quantity(keys)
        return value[which] if row is not None and row.timed else value

    blocks = {block: those((block,), getattr(results, block)) for block in REPORT_OF}
    sums = [_some_of_sum(block, which) for block in results.certain_sums]
    return replace(results, time=results.time[which], certain_sums=sums, **blocks)


def _some_of_sum(block: CertainSum, which: slice) -> CertainSum:
    """A certain sum at some instants; a factor that turns with the pose is an array over them."""
    factors = {
        path: factor[which] if isinstance(factor, np.ndarray) else factor for path, factor in block["terms"].items()
    }
    return {"terms": factors, "value": block["value"][which]}


def _blocks(results: Results, labels: Labels, *, lasting: bool = False) -> list[Block]:
    series: Sequence[Series] = list(walk(results, labels))
    blocks = [build(plan, results, labels, series) for plan in PLANS if plan.lasting or not lasting]
    made = [block for block in blocks if block is not None]
    return [extremes.abridged(block) for block in made] if lasting else made
