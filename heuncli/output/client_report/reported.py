"""What is reported: a scene in its load cases, each solved, with its numbers, and what was asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.output.snapshots.envelopes import Enveloped, envelope
from heuncli.output.snapshots.kept import KeptRun
from heuncli.output.snapshots.outcomes import Outcome
from heuncli.output.tables.extremes_tables import NO_DOUBT, DoubtedInstants
from heuncli.output.tables.page import Page
from heuncli.results.results import Results
from heuncli.scene.file_format.models import Spec
from heuncli.study.ask.smoothed_friction import partial_friction
from heuncli.study.ask.study import Study
from heuncli.study.compose.smoothed_friction import note_of_partial
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.table_units import Units

AS_IT_STANDS = "as it stands"  # the scene without the values of a case
LOADS = frozenset({"foundation", "joints", "sections", "forces", "impulses", "events"})


@record
class ReportedRun:
    """A load case, solved: its name, empty for the scene as it stands; kept: its numbers with extremes and errors.

    searched: whether its extremes were looked for between the samples, too.
    """

    name: str
    title: str
    study: Study
    kept: KeptRun
    page: Page
    searched: bool

    @property
    def results(self) -> Results:
        """What was solved."""
        return self.study.results

    @cached_property
    def doubted(self) -> DoubtedInstants:
        """The instants of extremes at which smoothed friction is not at its value."""
        times = [t for number in self.kept.numbers.values() for t in (number.least_at, number.greatest_at)]
        found = partial_friction(self.study, [t for t in times if t is not None])
        return DoubtedInstants.of(found, note_of_partial(found)) if found else NO_DOUBT

    @property
    def told(self) -> str:
        """The case as it is called."""
        return self.name or AS_IT_STANDS


class Imprint(NamedTuple):
    """What stands on the first page beside what was solved; nothing of it is made up: what is not given is left out."""

    date: str = ""
    author: str = ""
    project: str = ""


@record
class Reported:
    """All that a report is made of.

    spec: the scene as it stands; text: its file; digests: of the files that it names, by their names; runs: those that
    are told; outcomes: of all that is expected, in their order; given: what --set and the solver's options were; left
    out: the cases of the spec that were not asked for; unchecked: the scenes that expect something and were not solved.
    """

    spec: Spec
    text: str
    digests: Mapping[str, str]
    runs: Sequence[ReportedRun]
    outcomes: Sequence[Outcome]
    given: Sequence[str]
    left_out: Sequence[str]
    unchecked: Sequence[str]
    reduce: bool
    units: Units
    imprint: Imprint

    @cached_property
    def envelope(self) -> list[Enveloped]:
        """The lowest and the highest of each number, with the cases that govern."""
        return envelope({run.name: run.kept for run in self.runs})

    @property
    def labels(self) -> Labels:
        """The kinds of everything that is named."""
        return self.runs[0].page.labels

    @property
    def has_cases(self) -> bool:
        """Whether load cases are told apart."""
        return len(self.runs) > 1 or bool(self.runs[0].name)
