"""A study as columns of numbers over the instants, for a search of their extremes."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np

from heuncli.results.results import Array, Extremes, Place, Results
from heuncli.study.compose.recovery import HUNG_ON_RANK, Recovery
from heuncli.study.model.setup import Setup
from heuncli.study.search import extremes
from heuncli.study.search.extremes import ColumnSearch

if TYPE_CHECKING:  # loaded where a scene has closed chains
    from heuncli.study.compose.near_singular import TellsOpen
    from heuncli.study.search.open_between import OpenBetween


class Sampleable(Protocol):
    """What a search asks of a solved scene (study/ask/study.py)."""

    @property
    def results(self) -> Results:
        """The results at the instants that the spec asks for."""

    @property
    def instants_at_once(self) -> int:
        """How many instants are answered in one go."""

    def reports_at(self, times: Array, wanted: frozenset[str], setup: Setup | None = None) -> Results:
        """Some reports' blocks at other instants; setup: with other cuts."""

    def recovery_at(
        self, times: Array, wanted: frozenset[str], setup: Setup | None = None, *, keep: bool = False
    ) -> Recovery:
        """What follows from the kernel's answers at other instants; keep: for the next search."""

    def reports_of(self, recovery: Recovery, wanted: frozenset[str], tells: TellsOpen | None = None) -> Results:
        """Some reports' blocks of what was recovered; tells: what knows what is open, if that is not looked for."""


class StudyColumns:
    """A study as the columns that are searched; keeps the instants at which rounding reached some of them.

    setup: with runs of cuts as whole stretches, of which each quantity is two columns, its lowest and its highest.
    The first instants asked for are the grid of the search: between these what is open follows from what it is there.
    """

    def __init__(self, study: Sampleable, searched: ColumnSearch, wanted: frozenset[str], setup: Setup | None) -> None:
        self.study, self.searched, self.wanted, self.setup = study, searched, wanted, setup
        self.unknown: list[float] = []
        self.grid: list[Recovery] = []
        first = sum(map(len, searched.groups))
        runs = len(searched.errors) - len(searched.groups)
        self.groups = [*searched.groups, *([first + 2 * k, first + 2 * k + 1] for k in range(runs))]

    def results(self, at: Array, setup: Setup | None = None) -> Results:
        """The results of the study at some instants, ascending; setup: with other cuts."""
        study, setup = self.study, setup or self.setup
        if setup is None and np.array_equal(at, study.results.time):
            return study.results
        return self._noted(study.reports_at(at, self.wanted, setup))

    def columns(self, at: Array) -> Array:
        """The columns at some instants."""
        most = self.study.instants_at_once
        parts = [at[i : i + most] for i in range(0, len(at), most)]
        if self.grid:
            return np.concatenate([self._between(part) for part in parts])
        self.grid = [self.study.recovery_at(part, self.wanted, self.setup, keep=len(parts) == 1) for part in parts]
        return np.concatenate([self._rows(self._of(recovery)) for recovery in self.grid])

    @cached_property
    def verdicts(self) -> OpenBetween | None:
        """What is open between the instants of the grid; None where it is looked for at each, or nobody asks for it."""
        if not self.wanted & HUNG_ON_RANK or any(recovery.decided is None for recovery in self.grid):  # of a tree
            return None
        from heuncli.study.search.open_between import OpenBetween, verdicts  # where there are closed chains

        found = [verdicts(recovery, self.wanted) for recovery in self.grid]
        known = [own for own in found if own is not None]
        return OpenBetween(known) if len(known) == len(found) else None

    def _between(self, at: Array) -> Array:
        """The columns at instants between those of the grid."""
        recovery, tells = self.study.recovery_at(at, self.wanted, self.setup), self.verdicts
        if tells is None:
            return self._rows(self._of(recovery))
        told = tells.tells(recovery.recovered)
        if told.all():
            return self._rows(self._of(recovery.as_told(), tells))
        if not told.any():
            return self._rows(self._of(recovery))
        some = self._rows(self._of(recovery.at(told).as_told(), tells))
        others = self._rows(self._of(recovery.at(~told)))
        rows = np.empty((len(at), some.shape[1]))
        rows[told], rows[~told] = some, others
        return rows

    def _of(self, recovery: Recovery, tells: OpenBetween | None = None) -> Results:
        results = self.study.results
        if self.setup is None and tells is None and np.array_equal(recovery.recovered.times, results.time):
            return results
        return self._noted(self.study.reports_of(recovery, self.wanted, tells))

    def _noted(self, results: Results) -> Results:
        self.unknown.extend(results.accuracy.get("unknown", []))
        return results

    def _rows(self, results: Results) -> Array:
        if self.searched.along is None:
            return self.searched.columns(results)
        from heuncli.study.search.stretches import envelope

        along = [envelope(values) for _, values in self.searched.along(results)]
        return np.concatenate([self.searched.columns(results), *along], axis=1)

    def placed(self, found: Extremes) -> Extremes:
        """The extremes with their places along runs of cuts; what is no polynomial of loads is searched there anew."""
        if self.searched.along is None:
            return found
        first, n = len(self.searched.groups), len(self.searched.errors)
        low, high, places = found.low.copy(), found.high.copy(), []
        at = np.stack([found.low_at, found.high_at])[:, first:]
        instants = extremes.distinct(at)
        results = self.results(instants)
        for k, (name, values) in enumerate(self.searched.along(results)):
            both = []
            for side, bounds in ((-1.0, low), (1.0, high)):
                i = int(np.searchsorted(instants, at[int(side > 0.0), k]))
                s = np.broadcast_to(results.sections[name]["s"], values.shape)[i]
                own = name, float(instants[i]), s, values[i]
                bounds[first + k], place = self._place(k, side, own, float(bounds[first + k]))
                both.append(place)
            places.append((both[0], both[1]))
        assert first + len(places) == n
        return found._replace(low=low, high=high, places=tuple(places))

    def _place(self, k: int, side: float, own: tuple[str, float, Array, Array], value: float) -> tuple[float, Place]:
        """The value of an extreme of a run, and where it is; own: its run and instant, the nodes, their values."""
        assert self.searched.along is not None and self.setup is not None
        from heuncli.study.search.stretches import cut_at, side_of, stretch_named, summit

        name, at, nodes, values = own
        s, end, ends = summit(nodes, values, side)
        if self.searched.bent and math.isfinite(value):

            def along(s: Array) -> Array:
                assert self.searched.along is not None and self.setup is not None
                return self.searched.along(self.results(np.array([at]), cut_at(self.setup, name, s, ends)))[k][1].T

            one = slice(len(self.searched.groups) + k, len(self.searched.groups) + k + 1)
            errors, even = self.searched.errors[one], self.searched.even[one]
            there = extremes.search(along, np.linspace(*ends, 17), errors=errors, even=even, sides=(side,))
            value, s = (float(x[0]) for x in ((there.high, there.high_at) if side > 0.0 else (there.low, there.low_at)))
            end = float(side_of(np.array(s), ends))
        return value, stretch_named(self.setup, name).place(s, end)
