"""A solved scene, of which more can be asked: its results at other instants, their extremes between the samples."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base.records import record
from heuncli.results.results import Accuracy, Array, Block, Extremes, Magnitudes, Place, Results
from heuncli.results.results_paths import Numbers, find
from heuncli.results.results_schema import REPORTS, SHARED, SHARES, with_shared
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.finiteness import require_finite
from heuncli.study.compose.recovery import Recovery, recover
from heuncli.study.compose.results import compose, known_blocks
from heuncli.study.compose.warnings import left_out
from heuncli.study.model.options import Options
from heuncli.study.model.setup import Setup
from heuncli.study.search import extremes
from heuncli.study.search.columns import StudyColumns
from heuncli.study.search.extremes import ColumnSearch
from heuncli.study.search.instants import MOST_SEARCHED as MOST_INSTANTS
from heuncli.study.search.instants import search_times
from heuncli.study.solve.history import History, resample

if TYPE_CHECKING:  # loaded where there are conditions, or something strikes
    from heuncli.motion.integration.check.changes import Changes
    from heuncli.study.compose.impulses import Impulses
    from heuncli.study.compose.near_singular import TellsOpen

MOST_SEARCHED = 5_000_000  # numbers to look at for the extremes of a whole report, a second; a measure has no bound
NONE: frozenset[str] = frozenset()
CHUNK = 200_000  # body-instants whose answers are kept at a time
TOO_FEW = "extremes are searched from {} instants: too few to see every turn and step of this motion"
CUT_SHORT = "the search for extremes was ended before all was looked at that may lie higher"


@record
class Study:
    """A solved scene: `results` at the asked instants, `resample` for any others of the same run.

    Impure: keeps what its answers at other instants are warned of.
    """

    spec: Spec
    options: Options
    setup: Setup
    history: History
    composed: Recovery | None  # what the results were composed of; None where that went part by part
    results: Results
    struck: Impulses | None = None
    changes: Mapping[str, Changes] = MappingProxyType({})

    @cached_property
    def recovery(self) -> Recovery:
        """What follows from the answers at the asked instants."""
        return self.composed or recover(self.setup, self.history.recovered, self.options.least_norm)

    @property
    def magnitudes(self) -> Magnitudes:
        """What the numbers at the asked instants, and those of blows, are summed from, and their errors."""
        own = self.recovery.magnitudes
        errors = {**self.history.errors, **self.results.errors_of_places(own.size)}
        if self.struck is None:
            return own._replace(errors=errors)
        return own._replace(by_unit={**self.struck.by_unit, **own.by_unit}, errors=errors | self.struck.errors)

    @property
    def load_magnitudes(self) -> Magnitudes:
        """As much of them as errors of loads hang on."""
        if self.struck is not None:
            return self.magnitudes
        return self.recovery.load_magnitudes._replace(errors=dict(self.history.errors))

    @property
    def of_one_instant(self) -> bool:
        """Whether there is no motion: a state, or a blow."""
        return self.history.checked is None

    def numbers(self, path: str) -> Numbers:
        """The numbers at a path of the results, found once. Raises SpecError [unknown-path]."""
        found = self._numbers.get(path)
        if found is None:
            found = self._numbers[path] = find(self.results, path)
        return found

    @cached_property
    def _numbers(self) -> dict[str, Numbers]:
        return {}

    @cached_property
    def search_times(self) -> Array:
        """Instants close enough to bracket every extreme, (n,) ascending."""
        times, enough = self.close_times()
        if not enough:
            self.later_warnings[TOO_FEW.format(len(times))] = None
        return times

    def close_times(self, most: int = MOST_INSTANTS) -> tuple[Array, bool]:
        """Instants close enough to bracket every turn, (n,) ascending, so many at most; whether that is enough."""
        times, enough = search_times(self.setup, self.history, most)
        if self.setup.cuts and len(times) > 1:
            from heuncli.study.search.passages import may_pass, passages  # where there are sections

            if may_pass(self.setup):
                times = extremes.distinct(np.concatenate([times, passages(lambda at: self._recovery(at, NONE), times)]))
        return extremes.filled(times), enough

    def resample(self, times: Array) -> Results:
        """The results of the run at other instants within it, (n,) ascending; of a state those of its one instant."""
        if self.of_one_instant:
            return self.results
        wanted = self.options.reports
        results = compose(self.setup, self.history, self._recovery(times, wanted), wanted, self.struck)
        results.work["seconds"] = dict(self.results.work["seconds"])
        self.unknown.update(results.accuracy.get("unknown", ()))
        self.later_warnings.update(dict.fromkeys(w for w in results.warnings if w not in self.results.warnings))
        return results

    @cached_property
    def later_warnings(self) -> dict[str, None]:
        """What was warned of since the run, at other instants and in searches: sentences, in their order."""
        return {}

    @cached_property
    def unknown(self) -> set[float]:
        """The instants looked at since the run at which rounding beside a singular pose reaches some numbers."""
        return set(self.results.accuracy.get("unknown", ()))

    @cached_property
    def left_out(self) -> set[float]:
        """The instants that searches for extremes left out, with what lies between them and their neighbours."""
        return set()

    def impulses(self, setup: Setup | None = None) -> list[Block]:
        """The blocks of the blows; setup: with other cuts."""
        if self.struck is None:
            return []
        return (self.struck if setup is None else self.struck.cut_by(setup)).blocks()

    def struck_along(self, quantities: Sequence[str]) -> list[dict[str, Extremes]]:
        """The lowest and highest of some quantities along whole runs of cuts: a mapping by run for each blow."""
        if not any(cuts.s is not None for cuts in self.setup.cuts):
            return []
        from heuncli.study.search.stretches import extremes_at_a_blow  # only runs of cuts are worth it

        setup = self.stretched(False)
        return [extremes_at_a_blow(setup, block, quantities) for block in self.impulses(setup)]

    def reports_at(self, times: Array, wanted: frozenset[str], setup: Setup | None = None) -> Results:
        """Some reports' blocks at other instants of the same run, and nothing beside them; setup: with other cuts."""
        return self.reports_of(self.recovery_at(times, wanted, setup), wanted)

    def reports_of(self, recovery: Recovery, wanted: frozenset[str], tells: TellsOpen | None = None) -> Results:
        """Some reports' blocks of what was recovered; tells: puts in what is open, where that was not looked for."""
        own = self.results
        shown, unknown = known_blocks(self.history, recovery, wanted, tells)
        accuracy: Accuracy = {"unknown": unknown.tolist()} if len(unknown) else {}
        times = recovery.recovered.times
        results = Results(own.title, own.spec, own.version, own.model, own.status, times, accuracy=accuracy, **shown)
        return require_finite(results)

    def recovery_at(
        self, times: Array, wanted: frozenset[str], setup: Setup | None = None, *, keep: bool = False
    ) -> Recovery:
        """What follows from the kernel's answers at some instants of the run, (n,) ascending; setup: with other cuts.

        keep: for the next search, which begins at the same instants.
        """
        key = times.tobytes(), SHARES in wanted
        found = self.kept.get(key)
        if found is None:
            found = self._recovery(times, wanted)
            if keep:
                self.kept[key] = found
        return found if setup is None else found.with_cuts(setup)

    @cached_property
    def kept(self) -> dict[tuple[bytes, bool], Recovery]:
        """What was recovered and is asked for again, by its instants and whether loads are told by cause."""
        return {}

    def shares_at(self, times: Array) -> Results:
        """Loads by cause at other instants of the same run, (n,) ascending."""
        return self.reports_at(times, self.options.reports & (SHARED | {SHARES}))

    def shares_along(self, name: str, times: Array, places: Sequence[Place]) -> Results:
        """Loads by cause of a run of cuts at other instants, (n,) ascending, cut at some places along it."""
        from heuncli.study.search.stretches import at_places

        return self.reports_at(times, frozenset({"sections", SHARES}), at_places(self.setup, name, places))

    def _recovery(self, times: Array, wanted: frozenset[str]) -> Recovery:
        recovered = resample(self.setup.runner, self.history, times, by_cause=SHARES in wanted)
        return recover(self.setup, recovered, self.options.least_norm)

    @property
    def instants_at_once(self) -> int:
        """How many instants are answered in one go: so many that memory holds their numbers."""
        mechanism = self.setup.scene.mechanism
        causes = len(mechanism.loads) + 3 if SHARES in self.options.reports else 0
        return max(50, CHUNK // max(1, len(mechanism.bodies) * (1 + causes)))

    def stretched(self, bent: bool) -> Setup:
        """The scene with its runs of cuts as whole stretches; bent: for what is no polynomial of the loads."""
        from heuncli.study.search.stretches import stretched  # only runs of cuts are worth it

        return stretched(self.setup, bent)

    def is_searched(self, columns: int) -> bool:
        """Whether the extremes of so many columns of a whole report are sought between the asked instants, too."""
        return columns <= extremes.MOST_COLUMNS and columns * len(self.search_times) <= MOST_SEARCHED

    def extremes(
        self, searched: ColumnSearch, wanted: frozenset[str] | None, *, whole: bool = False, times: Array | None = None
    ) -> Extremes:
        """The extremes over the run, before its horizon, of the columns made of its results.

        wanted: the reports that the columns are made of, None for any. whole: of a whole report, where
        there may be so many columns that a search would outweigh the run: then they are those of the asked instants.
        times: of these instants alone.
        """
        between = times is None
        times = self.search_times if times is None else times
        if whole and len(searched.errors) * len(times) > MOST_SEARCHED:
            times, between = self.results.time, False
        horizon = self.results.horizon
        if horizon is not None:
            times = times[times < horizon] if times[0] < horizon else times[:1]
        reports = frozenset(REPORTS) if wanted is None else with_shared(wanted)
        # of closed chains it is told, too, where numbers are open on the other side
        one = searched.sides != extremes.BOTH and not self.setup.scene.layout.rows
        sides = searched.sides if one else extremes.BOTH
        sampled = StudyColumns(self, searched, reports, self.stretched(searched.bent) if searched.along else None)
        found = extremes.search(
            sampled.columns, times, sampled.groups, errors=searched.errors, even=searched.even, between=between,
            most=extremes.MOST_COLUMNS if whole else None, sides=sides,
        )  # fmt: skip
        found = sampled.placed(found)
        self.left_out.update(sampled.unknown)
        self.later_warnings.update(dict.fromkeys(left_out(sampled.unknown)))
        if not found.complete:
            self.later_warnings[CUT_SHORT] = None
        return found
