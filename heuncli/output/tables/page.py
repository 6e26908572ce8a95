"""The whole report of a run as tables: its blocks, and the columns whose extremes have to be searched.

`page_of(results, labels)` first; then either `columns` and `groups` for a search and `extremes` with its outcome, or
`instants`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.tables import cut_runs
from heuncli.output.tables.certain_sums import sums_table
from heuncli.output.tables.extremes_tables import NO_DOUBT, DoubtedInstants, abridged, extremes_table
from heuncli.output.tables.instants_tables import instants_tables
from heuncli.output.tables.run_searches import NONE, RunExtremes, with_stresses
from heuncli.output.tables.table_blocks import NumberRow, TableBlock, build
from heuncli.output.tables.table_plans import PLANS
from heuncli.output.tables.text_table import TextTable
from heuncli.results.results import Array, CertainSum, Extremes, Magnitudes, Mask, Place, Results
from heuncli.results.results_schema import REPORT_OF, REPORTS, quantity
from heuncli.study.quantities.digits import Certainty, certainty, with_axis
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.series import Series, in_units, walk

TABLE_DEFAULT = frozenset(REPORTS) - {"motion", "points"}
EXPORT_DEFAULT = frozenset(REPORTS) - {"points"}


if TYPE_CHECKING:
    from heuncli.output.tables import cause_tables


class SharesAt(Protocol):
    """A run's loads by cause wherever they are asked for."""

    def shares_at(self, times: Array) -> Results:
        """The results with shares at instants (n,), ascending."""

    def shares_along(self, name: str, times: Array, places: Sequence[Place]) -> Results:
        """The results with shares at instants (n,), of a run of cuts that is cut at these places alone."""


class Page(NamedTuple):
    """The tables of a run: blocks and runs of cuts up to the horizon, before they are laid out.

    of: what its numbers are summed from; beyond: the last instant alone, where the run ends beyond its horizon; struck:
    of each blow the extremes along its runs of cuts; along_runs: of the whole run, what else was searched of them;
    details: whether tables are shown that only those want who ask for them; doubted: instants of marked extremes.
    """

    results: Results
    labels: Labels
    certain: Certainty
    of: Magnitudes
    beyond: Results | None = None
    struck: Sequence[Mapping[str, Extremes]] = ()
    along_runs: Mapping[str, RunExtremes] = NONE
    details: bool = True
    doubted: DoubtedInstants = NO_DOUBT

    def columns(self, results: Results) -> Array:
        """What is searched, (n_t, n): all rows of all blocks, magnitudes squared."""
        rows = [row.values**2 if row.even else row.values for row in self._rows(results)]
        return np.stack(rows, axis=1) if rows else np.zeros((len(results.time), 0))

    def along(self, results: Results) -> list[tuple[str, Array]]:
        """The resultants of the runs of cuts, each (n_t, n_cuts), with the names of their runs."""
        made = cut_runs.runs_of(results, self.labels)
        return [(run.name, values) for run in made for values in run.values[: len(cut_runs.LOADS)]]

    @property
    def has_runs(self) -> bool:
        """Whether there are runs of cuts."""
        return any("s" in section for section in self.results.sections.values())

    def groups(self) -> list[list[int]]:
        """Which columns are compared with each other: each is on its own."""
        return [[column] for column in range(len(self._rows(self.results)))]

    def errors(self) -> Array:
        """How well the numbers are known, of all rows and of the resultants of runs, (n,)."""
        errors = [self.certain.error(row.kind, row.unit) for row in self._rows(self.results)]
        for _ in cut_runs.runs_of(self.results, self.labels):
            errors += [self.certain.error("sections", load.unit) for load in cut_runs.LOADS]
        return np.array(errors)

    def even(self) -> Mask:
        """Which columns are squares of magnitudes, (n,)."""
        rows = [row.even for row in self._rows(self.results)]
        more = len(cut_runs.LOADS) * len(cut_runs.runs_of(self.results, self.labels))
        return np.array(rows + [False] * more, dtype=bool)

    def extremes(self, searched: Extremes, shares: SharesAt | None = None) -> list[TextTable]:
        """The tables with extremes, from those searched for each of `groups`; shares: by cause, at any instants."""
        tables: list[TextTable] = []
        start = 0
        times, last = self.results.time, self._last_values()
        for block in self._lasting(self.results):
            rows = [row for group in block.groups for row in group.rows]
            own = slice(start, start + len(rows))
            part = self._roots(block, searched.part(own))
            beyond = last[own] if last is not None else None
            tables += extremes_table(block, times, part, self.certain, beyond, self.doubted)
            start += len(rows)
        for k, run in enumerate(cut_runs.runs_of(self.results, self.labels)):
            of = self.along_runs.get(run.name, RunExtremes())
            whole = with_stresses(run, *self._of_run(searched, k), of.stresses)
            tables += cut_runs.extremes_tables(run, times, *whole, self.certain, of.cuts)
        more = self._by_cause(searched, shares) if shares is not None else []
        return [*tables, *more, *self._ending()]

    def _by_cause(self, searched: Extremes, shares: SharesAt) -> list[TextTable]:
        """What each cause does of the extremes."""
        from heuncli.output.tables import cause_tables  # few runs ask for them

        n = len(searched.low) - len(searched.places)
        instants = np.unique(np.concatenate([searched.low_at[:n], searched.high_at[:n]]))
        shared = self._shared(shares.shares_at(instants)) if n else {}
        span, tables, start = float(np.ptp(self.results.time)), list[TextTable](), 0
        for block in self._lasting(self.results):
            count = sum(len(group.rows) for group in block.groups)
            own = self._roots(block, searched.part(slice(start, start + count)))
            tables += cause_tables.extremes_table(block, shared, instants, own, self.certain, span)
            start += count
        for k, run in enumerate(cut_runs.runs_of(self.results, self.labels)):
            tables += self._run_by_cause(run, searched, k, shares)
        return tables

    def _shared(self, results: Results) -> dict[cause_tables.Key, cause_tables.SharedNumber]:
        from heuncli.output.tables import cause_tables

        return cause_tables.shared_rows(results, in_units(walk(results, self.labels), self.labels.units))

    def _run_by_cause(self, run: cut_runs.CutRun, searched: Extremes, k: int, shares: SharesAt) -> list[TextTable]:
        """What each cause does of the extremes along a run."""
        from heuncli.output.tables import cause_tables

        found, places = self._of_run(searched, k)
        at = np.unique(np.concatenate([found.low_at, found.high_at]))
        results = shares.shares_along(run.name, at, [place for both in places for place in both])
        return cause_tables.run_extremes_table(run, results, found, places, self.certain)

    @staticmethod
    def _roots(block: TableBlock, part: Extremes) -> Extremes:
        """The extremes of a block's rows, magnitudes themselves and not their squares."""
        even = np.array([row.even for group in block.groups for row in group.rows], dtype=bool)
        low, high = (np.where(even, np.sqrt(np.abs(bound)), bound) for bound in (part.low, part.high))
        return part._replace(low=low, high=high)

    def instants(
        self,
        results: Results,
        *,
        every_cut: bool = False,
        searched: Extremes | None = None,
        shares: SharesAt | None = None,
    ) -> list[TextTable]:
        """The tables at the instants of `results`, which is the same run at any instants; searched: where it is one."""
        horizon = self.results.horizon
        unknown = frozenset(results.accuracy.get("unknown", ()))
        certain = with_axis(self.certain._replace(beside=unknown), results, self.of, self.labels.units)
        tables: list[TextTable] = []
        for block in self._blocks(results):
            tables += instants_tables(block, results.time, horizon, certain)
        for k, run in enumerate(cut_runs.runs_of(results, self.labels)):
            if searched is not None:
                of = self.along_runs.get(run.name, RunExtremes())
                whole = with_stresses(run, *self._of_run(searched, k), of.stresses)
                tables.append(cut_runs.extremes_table(run, results.time, *whole, self.certain))
            made = cut_runs.instants_tables(run, results.time, horizon, self.certain, every=every_cut)
            tables += [made[0]._replace(heading=""), *made[1:]] if searched is not None else made
        if shares is not None:
            tables += self._instants_by_cause(results, certain, searched, shares)
        return [*tables, *self._ending(every_cut)]

    def _instants_by_cause(
        self, results: Results, certain: Certainty, searched: Extremes | None, shares: SharesAt
    ) -> list[TextTable]:
        """What each cause does at some instants."""
        from heuncli.output.tables import cause_tables  # few runs ask for them

        horizon = self.results.horizon
        shared, tables = self._shared(results), list[TextTable]()
        for block in self._blocks(results):
            tables += cause_tables.instants_table(block, shared, results.time, horizon, certain)
        for k, run in enumerate(cut_runs.runs_of(results, self.labels)):
            if searched is not None:
                tables += self._run_by_cause(run, searched, k, shares)
            else:
                tables += cause_tables.run_instants_table(run, results, horizon, certain)
        return tables

    def _of_run(self, searched: Extremes, k: int) -> tuple[Extremes, tuple[tuple[Place, Place], ...]]:
        """The extremes of the resultants of a run, and their places."""
        n = len(cut_runs.LOADS)
        first = len(searched.low) - len(searched.places) + n * k
        return searched.part(slice(first, first + n)), searched.places[n * k : n * (k + 1)]

    def _last_values(self) -> Array | None:
        """The values of all rows at the last instant, where that is beyond the horizon."""
        if self.beyond is None:
            return None
        blocks = self._lasting(self.beyond)
        return np.array([row.values[-1] for block in blocks for group in block.groups for row in group.rows])

    def _rows(self, results: Results) -> list[NumberRow]:
        return [row for block in self._lasting(results) for group in block.groups for row in group.rows]

    def _lasting(self, results: Results) -> list[TableBlock]:
        return self._blocks(results, lasting=True)

    def _blocks(self, results: Results, *, lasting: bool = False) -> list[TableBlock]:
        series: Sequence[Series] = in_units(walk(results, self.labels), self.labels.units)
        plans = [plan for plan in PLANS if (plan.lasting or not lasting) and (self.details or not plan.detail)]
        made = [block for plan in plans if (block := build(plan, results, self.labels, series)) is not None]
        return [abridged(block) for block in made] if lasting else made

    def _ending(self, every: bool = False) -> list[TextTable]:
        sums = sums_table(self.results, self.certain, self.beyond, self.labels.units.of("N"))
        return [*([sums] if sums else []), *self._events(every), *self._impulses(every)]

    def _events(self, every: bool) -> list[TextTable]:
        if not self.results.events:
            return []
        from heuncli.output.tables.event_table import events_table  # where there are conditions

        return [events_table(self.results, every=every)]

    def _impulses(self, every: bool) -> list[TextTable]:
        if not self.results.impulses:
            return []
        from heuncli.output.tables.impulse_tables import BlowReport, impulse_tables  # where something strikes

        of = BlowReport(self.results, self.labels, self.certain, self.of, self.struck, self.details)
        return impulse_tables(of, every=every)


def page_of(results: Results, labels: Labels, of: Magnitudes, *, details: bool = True) -> Page:
    """The page of a run, ending before its horizon; `of`: what its numbers are summed from."""
    horizon = results.horizon
    certain = certainty(results, labels, of)
    if horizon is None or results.time[-1] < horizon:
        return Page(results, labels, certain, of, details=details)
    known = max(1, int(np.searchsorted(results.time, horizon)))
    beyond = some_instants(results, slice(-1, None))
    return Page(some_instants(results, slice(known)), labels, certain, of, beyond, details=details)


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
