"""The tables of a solved scene: those of `heun run`, at instants or with the extremes between the samples."""

from __future__ import annotations

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.snapshots import searches
from heuncli.output.tables.cut_runs import LOADS
from heuncli.output.tables.extremes_tables import MARK, NOT_SEARCHED, DoubtedInstants
from heuncli.output.tables.page import page_of
from heuncli.output.tables.text_table import TextTable
from heuncli.results.results import Array
from heuncli.results.results_schema import SHARES
from heuncli.study.ask.smoothed_friction import partial_friction
from heuncli.study.ask.study import Study
from heuncli.study.compose.smoothed_friction import has_smoothed_friction, note_of_partial
from heuncli.study.model.selection import EntryKeys, Selection
from heuncli.study.quantities.labels import Labels

AXIS: EntryKeys = ("foundation", "axis")
OF_SOME = ", of some of the extremes along runs of cuts"
AT_INSTANTS = "a line in space has no extremes: the central axis is shown at instants, by --at or --all"


class TablesAsked(NamedTuple):
    """What tables are to tell: the reports and entries; at (n,) the instants, None for the extremes.

    every: all instants, and every cut of a run of cuts; details: what only those want who ask for it by name.
    """

    what: Selection
    at: Array | None = None
    every: bool = False
    details: bool = False


def tables_of(study: Study, labels: Labels, asked: TablesAsked) -> list[TextTable]:
    """The tables, as they are before they are fitted to a width; not empty."""
    wanted = asked.what.reports
    page = page_of(study.results, labels, study.magnitudes, details=asked.details)
    if study.results.impulses:
        page = page._replace(struck=study.struck_along([load.name for load in LOADS]))
    one = len(study.results.time) == 1
    extremes = None
    if not (asked.every or asked.at is not None or (one and not page.has_runs)):
        extremes = searches.rows(page, study, wanted)
        if page.has_runs:
            page = page._replace(along_runs=searches.along_runs(page, study))
        if has_smoothed_friction(study.setup.scene.mechanism):
            found = partial_friction(study, [*extremes.low_at.tolist(), *extremes.high_at.tolist()])
            page = page._replace(doubted=DoubtedInstants.of(found, note_of_partial(found)))
    shares = study if SHARES in wanted else None
    if extremes is None or one:
        shown = study.results if asked.at is None else study.resample(asked.at)
        tables = page.instants(shown, every_cut=asked.every, searched=extremes, shares=shares)
    else:
        tables = page.extremes(extremes, shares)
        if not extremes.searched:
            tables.insert(0, TextTable("", notes=(NOT_SEARCHED,)))
        if page.has_runs and page.doubted.instants:
            tables.append(TextTable("", notes=(page.doubted.note.removeprefix(f"{MARK} ") + OF_SOME,)))
        if AXIS in asked.what.entries:
            tables.append(TextTable("", notes=(AT_INSTANTS,)))
    if not tables:
        tables = [TextTable("", notes=(f"nothing to show of {', '.join(sorted(wanted))}: the scene has none",))]
    return tables
