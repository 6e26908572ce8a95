"""The tables by cause of a whole page: of its blocks, and of its series of cuts.

Along a series of cuts the minimum and the maximum among the cuts have a row each. Few runs ask for tables by cause: the
page imports this module only then.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.document import OutputTable
from heuncli.output.tables.cause_tables import (
    ShareLine,
    collect_shares,
    make_extremes_tables,
    make_instants_tables,
    make_share_table,
    make_shares_heading,
)
from heuncli.output.tables.cut_tables import format_place
from heuncli.output.tables.table_blocks import TableBlock
from heuncli.results.results import Array, CutPosition, Extremes, Results
from heuncli.results.results_schema import SHARES
from heuncli.study.quantities.channels import Channel, iter_channels
from heuncli.study.quantities.cut_series import CutSeries
from heuncli.study.quantities.digits import StatedErrors, write_times
from heuncli.study.quantities.labels import Labels


class ShareSource(Protocol):
    """Solves a run's loads by cause at any instants."""

    def compute_shares(self, times: Array) -> Results:
        """Return the results with shares at instants (n,), in ascending order."""

    def compute_shares_along(self, name: str, times: Array, places: Sequence[CutPosition]) -> Results:
        """Return the results with shares at instants (n,), with a series of cuts that is cut only at these places."""


class PageContents(NamedTuple):
    """The blocks and the series of cuts of a page, with the labels and the stated errors of its run."""

    blocks: Sequence[TableBlock]
    cut_series: Sequence[CutSeries]
    labels: Labels
    stated_errors: StatedErrors


def make_page_extremes_tables(
    contents: PageContents, search_result: Extremes, shares: ShareSource, span: float
) -> list[OutputTable]:
    """Make the tables of what each cause contributes to the extremes; span: of the run [s]."""
    found = search_result.find([path for block in contents.blocks for path in block.paths])
    instants = np.unique(np.concatenate([found.low_at, found.high_at]))
    results = shares.compute_shares(instants) if len(instants) else None
    numbers = {} if results is None else collect_shares(iter_channels(results, contents.labels), results)
    tables: list[OutputTable] = []
    for block in contents.blocks:
        tables += make_extremes_tables(block, numbers, instants, found, contents.stated_errors, span)
    for series in contents.cut_series:
        tables += find_series_extremes_tables(series, contents.stated_errors, search_result, shares)
    return tables


def make_page_instants_tables(
    contents: PageContents, results: Results, horizon: float | None, instant_errors: StatedErrors
) -> list[OutputTable]:
    """Make the tables of what each cause contributes to the blocks at the instants of results with shares.

    instant_errors: of the results at these instants
    """
    numbers = collect_shares(iter_channels(results, contents.labels), results)
    tables: list[OutputTable] = []
    for block in contents.blocks:
        tables += make_instants_tables(block, numbers, results.time, horizon, instant_errors)
    return tables


def find_series_extremes_tables(
    series: CutSeries, stated_errors: StatedErrors, search_result: Extremes, shares: ShareSource
) -> list[OutputTable]:
    """Solve the shares where the section forces along a series of cuts are extreme, and make their tables."""
    found = search_result.find([load.path for load in series.loads])
    instants = np.unique(np.concatenate([found.low_at, found.high_at]))
    results = shares.compute_shares_along(series.name, instants, [place for both in found.places for place in both])
    return make_series_extremes_tables(series, results, found, stated_errors)


def make_series_extremes_tables(
    series: CutSeries, results: Results, extremes: Extremes, stated_errors: StatedErrors
) -> list[OutputTable]:
    """Make the table of the minimum and maximum of each section force along a series of cuts, with their shares.

    results: with the series cut at the places of the minimum and maximum of every section force, in this order
    extremes: of the section forces
    """
    lines: list[ShareLine] = []
    span = float(np.ptp(np.concatenate([extremes.low_at, extremes.high_at])))
    for i, load in enumerate(series.loads):
        ends = (("min", extremes.low, extremes.low_at), ("max", extremes.high, extremes.high_at))
        for j, (word, value, instants) in enumerate(ends):
            k = int(np.searchsorted(results.time, instants[i]))
            clock = [f"{write_times([float(instants[i])], span)[0]} s"] if span > 0.0 else []
            where = ", ".join([f"s = {format_place(extremes.places[i][j], series)} {series.length[0]}", *clock])
            lines.append(make_series_line(results, series.name, load, f"{load.label} {word}", (k, 2 * i + j), where)
                         ._replace(total=float(value[i])))  # fmt: skip
    return make_series_tables(series, lines, stated_errors)


def make_series_instants_tables(
    series: CutSeries, results: Results, horizon: float | None, stated_errors: StatedErrors
) -> list[OutputTable]:
    """Make the table of the minimum and maximum of each section force among the cuts at every instant."""
    times = results.time.tolist()
    clock = [] if len(times) == 1 else [f", {text} s" for text in write_times(times, float(np.ptp(results.time)))]
    lines: list[ShareLine] = []
    for k, t in enumerate(times):
        for load in series.loads:
            values = np.nan_to_num(load.values[k])
            for word, cut in (("min", int(np.argmin(values))), ("max", int(np.argmax(values)))):
                where = f"s = {format_place(CutPosition(float(series.s[cut]), None, cut), series)} {series.length[0]}"
                where += clock[k] if clock else ""
                line = make_series_line(results, series.name, load, f"{load.label} {word}", (k, cut), where)
                lines.append(line._replace(is_beyond_horizon=horizon is not None and t >= horizon))
    return make_series_tables(series, lines, stated_errors)


def make_series_line(
    results: Results, name: str, load: Channel, label: str, index: tuple[int, int], where: str
) -> ShareLine:
    """Make the row of a section force at one instant and cut.

    index: of the instant and of the cut
    where: the place and instant as text
    """
    section = results.sections[name]
    shares = {
        cause: float(section_forces[load.quantity][index]) for cause, section_forces in section.get(SHARES, {}).items()
    }
    return ShareLine(label, where, load, shares, float(section[load.quantity][index]))


def make_series_tables(series: CutSeries, lines: Sequence[ShareLine], stated_errors: StatedErrors) -> list[OutputTable]:
    """Make the table of a series of cuts. Empty list if no row has shares."""
    if not any(line.shares for line in lines):
        return []
    return [make_share_table(make_shares_heading(series.heading), [("", lines)], stated_errors)]
