"""The data of a report: a scene solved in its load cases, and the options of the report."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.output.snapshots.envelopes import NumberEnvelope, make_envelope
from heuncli.output.snapshots.golden_file import RunSnapshot
from heuncli.output.snapshots.outcomes import Outcome
from heuncli.output.tables.extremes_tables import NO_DOUBT, DoubtfulInstants
from heuncli.output.tables.page import Page
from heuncli.output.tables.summary_document import Summary
from heuncli.results.results import Array, Results
from heuncli.results.results_paths import find_values
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.warnings import make_partial_note
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.study import Study, find_partial_friction

AS_IT_STANDS = "base model"  # the scene without the values of a case
LOADS = frozenset({"foundation", "joints", "sections", "forces", "impulses", "events"})
CHAPTER_NAMES = (
    "machine", "loads", "sections", "histories", "polar", "events", "checks", "open", "model", "accuracy", "spec",
)  # fmt: skip
ON_REQUEST = frozenset({"machine", "spec"})  # chapters that are printed only by name
AT_WORST = frozenset({"motion", "foundation", "joints", "forces"})  # computed at the instants of extremes
KINDS_AT_WORST = ("foundation.force", "foundation.moment", "joints.", "forces.", "couplings.", "stops.")


@record
class ReportedRun:
    """A solved load case.

    name: empty for the scene without the values of a case
    snapshot: its numbers with extremes and errors
    is_searched: whether its extremes were also searched between the samples
    """

    name: str
    title: str
    study: Study
    snapshot: RunSnapshot
    page: Page
    is_searched: bool

    @property
    def results(self) -> Results:
        """The results of the run."""
        return self.study.results

    @cached_property
    def uncertain_instants(self) -> DoubtfulInstants:
        """The instants of extremes at which smoothed friction has not reached its full value."""
        times = [t for number in self.snapshot.numbers.values() for t in (number.least_at, number.greatest_at)]
        partial = find_partial_friction(self.study, [t for t in times if t is not None])
        return DoubtfulInstants.with_reason(partial, make_partial_note(partial)) if partial else NO_DOUBT

    @cached_property
    def worst_times(self) -> Array:
        """The instants of the extremes of forces and moments, (n,) ascending."""
        numbers = (n for path, n in self.snapshot.numbers.items() if path.startswith(KINDS_AT_WORST))
        times = {t for number in numbers for t in (number.least_at, number.greatest_at) if t is not None}
        return np.array(sorted({float(self.results.time[0]), *times}))

    @cached_property
    def worst_results(self) -> Results:
        """The results at these instants, solved in one call."""
        if self.study.has_one_instant:
            return self.results
        return self.study.compute_reports(self.worst_times, AT_WORST)

    def find_index(self, time: float | None) -> int:
        """Find the number of one of these instants; None: the first of the run."""
        if time is None or self.study.has_one_instant:
            return 0
        return int(np.argmin(np.abs(self.worst_times - time)))

    def find_vector(self, path: str, time: float | None) -> Array:
        """Return the vector (3,) at a path at the instant of one of the extremes."""
        return np.asarray(find_values(self.worst_results, path).values[self.find_index(time)])

    @property
    def case_label(self) -> str:
        """The name of the case as it is shown."""
        return self.name.replace("_", " ") or AS_IT_STANDS


class Imprint(NamedTuple):
    """Entries of the title block that the user states; those not given are left out.

    logo: a data URI
    """

    company: str = ""
    project: str = ""
    part: str = ""
    revision: str = ""
    author: str = ""
    date: str = ""
    logo: str = ""


@record
class ReportData:
    """All data of a report.

    spec: the scene without the values of a case
    text: the spec file
    digests: of the files that the spec refers to, by their names
    runs: the load cases of the report
    outcomes: of all expected values, in their order
    options: the values of --set and of the solver's options
    omitted_cases: load cases of the spec that were not requested
    unchecked_scenes: scenes with expected values that were not solved
    summarise: makes the summary of these data when it is needed
    chapters: names of those that are printed, in their order; none: all but the spec
    """

    spec: Spec
    text: str
    digests: Mapping[str, str]
    runs: Sequence[ReportedRun]
    outcomes: Sequence[Outcome]
    options: Sequence[str]
    omitted_cases: Sequence[str]
    unchecked_scenes: Sequence[str]
    reduce: bool
    units: Units
    imprint: Imprint
    summarise: Callable[[ReportData], Summary]
    chapters: Sequence[str] = ()

    @cached_property
    def envelope(self) -> list[NumberEnvelope]:
        """The minimum and maximum of each number, with the cases that govern."""
        return make_envelope({run.name: run.snapshot for run in self.runs})

    @cached_property
    def summary(self) -> Summary:
        """The greatest load of each thing over all cases."""
        return self.summarise(self)

    @property
    def labels(self) -> Labels:
        """The kinds of all named objects."""
        return self.runs[0].page.labels

    @property
    def file_name(self) -> str:
        """The name of the spec's file, without folders."""
        return self.spec.path.replace("\\", "/").rpartition("/")[2]

    @property
    def has_cases(self) -> bool:
        """Whether the report names load cases."""
        return len(self.runs) > 1 or bool(self.runs[0].name)
