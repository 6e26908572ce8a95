"""The summary of a report: that of `heun run` over its load cases, from the extremes that its tables show."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.client_report.extremes import (
    GreatestOfCases,
    find_extremes,
    find_greatest_of_cases,
    find_uncertain_cases,
)
from heuncli.output.client_report.report_data import ReportData, ReportedRun
from heuncli.output.documents.document import OutputTable, join_names
from heuncli.output.figures.courses import find_span, is_monotonic
from heuncli.output.figures.posed_machine import select_worst
from heuncli.output.tables.nouns import format_count
from heuncli.output.tables.page import SearchedPage
from heuncli.output.tables.summary_document import Summary, group_alike, make_table, merge_cases, summarise
from heuncli.output.tables.summary_rows import MIN_TURN, SummaryRow
from heuncli.results.results import NOWHERE, Extremes
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.cut_series import collect_cut_series

MORE_NOTE = "{}: chapter Loads"
UNCERTAIN_NOTE = "{}: open or unknown in {}, where it may be larger"


class ReportedLoad(NamedTuple):
    """The greatest load of a thing over all cases, and the names of others of its kind with the same one.

    kind: a word before its name, where a thing of another kind has the same one
    """

    name: str
    greatest: GreatestOfCases
    alike: Sequence[str] = ()
    kind: str = ""


def summarise_cases(data: ReportData) -> Summary:
    """Summarise the runs of a report, with the row of the governing case for each thing."""
    return merge_cases([summarise(run.study, _read_extremes(run), run.case_label if data.has_cases else "")
                        for run in data.runs])  # fmt: skip


def _read_extremes(run: ReportedRun) -> SearchedPage:
    """Return the page of a run with the extremes of its snapshot, which were searched for the tables."""
    page = run.page._replace(doubtful=run.uncertain_instants)
    paths = [channel.path for channel in page.make_search().collect(page.results)]
    paths += [channel.path for own in collect_cut_series(page.results, page.labels) for channel in own.stresses]
    rows, places, known = [], [], []
    for path in paths:
        ends = find_extremes(run, path)
        if ends is None:
            continue
        known.append(path)
        first = float(run.results.time[0])
        ends_found = [
            (math.nan if isinstance(end.value, str) else end.value, first if end.time is None else end.time)
            for end in (ends.low, ends.high)
        ]
        rows.append([*ends_found[0], *ends_found[1]])
        places.append((ends.low.place or NOWHERE, ends.high.place or NOWHERE))
    low, low_at, high, high_at = np.array(rows).reshape(-1, 4).T
    column = np.zeros(len(known), dtype=np.intp)
    searched = Extremes(low, low_at, column, high, high_at, column, run.is_searched, True, tuple(places), tuple(known))
    return SearchedPage(page, searched)


def list_loads(data: ReportData) -> list[ReportedLoad]:
    """List the loads that the machine causes in its parts, the largest force first, then moments; without sections and
    given loads.
    """
    rows = [row for row in data.summary.rows if row.kind not in ("", "section") and not row.is_given]
    rows.sort(key=lambda row: (row.unit != "N", -abs(row.value)))
    kinds: dict[str, set[str]] = {}
    for row in rows:
        kinds.setdefault(_name_thing(row, data), set()).add(row.kind)
    found = []
    for group in group_alike(rows, data.summary):
        words = [(row.kind if len(kinds[name]) > 1 else "", name) for row in group for name in [_name_thing(row, data)]]
        names = list(dict.fromkeys(f"{kind} {name}".strip() for kind, name in words))
        greatest = find_greatest_of_cases(data, group[0].path, group[0].name)
        if greatest is not None:
            found.append(ReportedLoad(names[0], greatest, names[1:], words[0][0]))
    return found


def _name_thing(row: SummaryRow, data: ReportData) -> str:
    return describe_object(row.block_path.partition(".")[0], row.name, data.labels)


def choose_drawn_run(data: ReportData) -> tuple[ReportedRun, float | None]:
    """Choose the case and the instant at which the machine is drawn; without a force the first of the first case."""
    worst = select_worst(data.summary.rows)
    run = next((run for run in data.runs if worst is not None and worst.case in ("", run.case_label)), data.runs[0])
    return run, None if worst is None else worst.time


def make_summary_table(data: ReportData) -> OutputTable | None:
    """Make the table of a dozen lines; None without any load."""
    if not data.summary.rows:
        return None
    table, shown, n_further = make_table(data.summary)
    notes = [*table.notes, *([MORE_NOTE.format(format_count(n_further, "smaller load"))] if n_further else [])]
    for row in shown:
        notes += _list_uncertain(data, row)
    return table._replace(notes=notes, fill="page")


def _list_uncertain(data: ReportData, row: SummaryRow) -> list[str]:
    cases = find_uncertain_cases(data, row.path) if data.has_cases else []
    return [UNCERTAIN_NOTE.format(_name_thing(row, data), join_names(cases))] if cases else []


def find_crank(data: ReportData) -> str | None:
    """Find the joint whose angle is the axis of histories: that of the summary, if it keeps turning in all cases."""
    name = data.summary.crank
    angles = [np.asarray(run.results.coordinates.get(name, {}).get("angle", [0.0])) for run in data.runs]
    keeps_turning = all(np.isfinite(own).all() and is_monotonic(own) and find_span(own) > MIN_TURN for own in angles)
    return name if name and keeps_turning else None
