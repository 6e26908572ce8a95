"""The summary of a run, or of all its load cases, as a short table, as data and as CSV; the document of a run."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.as_data import FORMAT
from heuncli.output.documents.document import Cell, OutputColumn, OutputDocument, OutputTable, TextCell
from heuncli.output.tables.extremes_tables import CONSTANT, MARK, NOT_SEARCHED, PARTLY_OPEN_NOTE
from heuncli.output.tables.indeterminate import IndeterminateGroup, find_indeterminate_groups, format_indeterminate
from heuncli.output.tables.nouns import join_ranges
from heuncli.output.tables.page import SearchedPage, TablesQuery, make_tables_of_page, search_run
from heuncli.output.tables.run_description import make_heading
from heuncli.output.tables.summary_rows import DIRECTION_DECIMALS, KINDS, SummaryRow, make_run_summary
from heuncli.results.results_schema import XYZ
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.cut_series import collect_cut_series
from heuncli.study.quantities.digits import ReaderStyle, choose_reader_style
from heuncli.study.quantities.labels import Labels
from heuncli.study.queries.study import Study
from heuncli.version import VERSION

HEADING = 'SUMMARY  greatest loads; for a joint, the reaction of "from" on "to"'
MAX_LINES = 12  # rows, and lines on what is indeterminate
ALIKE_NOTE = "several names: the same greatest load; direction and instant of the first"
PLAIN_WORDS = ("force", "load", "drive", "drive force", "drive torque")  # which the kind and the unit tell
DIGITS = re.compile(r"\d+")
MAX_GROUPS = 4  # of what is indeterminate
ALONG_AXIS = 0.9995  # cosine: a direction is that of an axis, to the decimals shown
TIME_DIGITS = 4
MIN_DIGITS = 2  # of a number far smaller than others of its unit
EXCEEDED = 1.0  # utilisation


class Summary(NamedTuple):
    """The summary of a run, or the governing rows of its cases.

    axes: in which directions are given, in words
    redundant: number of redundant constraints
    span: length of the longest run [s]
    """

    rows: Sequence[SummaryRow]
    groups: Sequence[IndeterminateGroup]
    labels: Labels
    axes: str
    redundant: int = 0
    span: float = 0.0
    crank: str = ""
    notes: Sequence[str] = ()

    @property
    def is_empty(self) -> bool:
        """Whether nothing is loaded and nothing indeterminate."""
        return not (self.rows or self.groups)


def merge_cases(summaries: Sequence[Summary]) -> Summary:
    """Return the summary of several cases: of each thing the row that governs."""
    governing: dict[tuple[str, str], SummaryRow] = {}
    for row in (row for summary in summaries for row in summary.rows):
        best = governing.get((row.kind, row.name))
        if best is None or _rank(row) > _rank(best):
            governing[row.kind, row.name] = row
    groups = dict.fromkeys(group for summary in summaries for group in summary.groups)
    notes = dict.fromkeys(note for summary in summaries for note in summary.notes)
    cranks = {summary.crank for summary in summaries}
    return summaries[0]._replace(
        rows=list(governing.values()), groups=list(groups), notes=list(notes),
        redundant=max(summary.redundant for summary in summaries), span=max(summary.span for summary in summaries),
        crank=cranks.pop() if len(cranks) == 1 else "",
    )  # fmt: skip


def _rank(row: SummaryRow) -> tuple[int, float]:
    """Return what decides between the rows of one thing: an earlier alternative, then the larger value."""
    quantity = row.block_path.partition(".")[2].removeprefix(row.name).lstrip(".")
    kind = next(kind for kind in KINDS if kind.word == row.kind)
    place = next(i for i, quantities in enumerate(kind.alternatives) if quantity in quantities)
    return -place, abs(row.value)


def choose_rows(rows: Sequence[SummaryRow], count: int) -> list[SummaryRow]:
    """Choose the rows of a short summary: the largest of each kind, then of all, given loads last.

    They stand in the order of the kinds, the largest of each first.
    """
    order = {kind.word: i for i, kind in enumerate(KINDS)}
    ranked = sorted(rows, key=lambda row: -row.share)
    firsts = {row.kind: row for row in reversed(ranked)}
    others = [row for row in ranked if row is not firsts[row.kind]]
    chosen = [*firsts.values(), *sorted(others, key=lambda row: row.is_given)][:count]
    return sorted(chosen, key=lambda row: (order[row.kind], -row.share))


def group_alike(rows: Sequence[SummaryRow], summary: Summary) -> list[list[SummaryRow]]:
    """Group the rows of things whose names differ by a number alone and whose greatest loads read the same."""
    groups: dict[tuple[object, ...], list[SummaryRow]] = {}
    for row in rows:
        stem = DIGITS.sub("", name_row(row, summary.labels))
        value = _choose_style(row, summary).write(abs(row.value))
        key = stem, row.unit, value, row.case, row.is_partly_open, row.is_doubtful, row.is_constant
        groups.setdefault(key, []).append(row)
    return list(groups.values())


def make_summary_table(summary: Summary, *, full: bool = False) -> OutputTable:
    """Make the table; full: with every row."""
    table, _, n_further = make_table(summary, full=full)
    further = [f"and {n_further} further: --full"] if n_further else []
    return table._replace(notes=(*table.notes, *further))


def make_table(summary: Summary, *, full: bool = False) -> tuple[OutputTable, list[SummaryRow], int]:
    """Make the table; return its rows, one for those alike, and the number of things that are left out, too."""
    lines = format_indeterminate(summary.groups, summary.labels, summary.redundant)
    lines_shown = lines if full else lines[:MAX_GROUPS]
    groups = [[row] for row in summary.rows] if full else group_alike(summary.rows, summary)
    alike = {group[0]: group for group in groups}
    rows = choose_rows(list(alike), len(alike) if full else MAX_LINES - len(lines_shown))
    has_cases = any(row.case for row in rows)
    crank = summary.crank and any(row.angle is not None for row in rows)
    columns = [
        OutputColumn("", "text"), OutputColumn("greatest"), OutputColumn("", "text"), OutputColumn("direction", "text"),
        OutputColumn("at [s]"), *([OutputColumn(_format_crank_head(summary))] if crank else []),
        *([OutputColumn("case", "text")] if has_cases else []),
    ]  # fmt: skip
    body: list[tuple[Cell, ...]] = []
    for row in rows:
        angle = [_format_angle(row, summary.labels)] if crank else []
        names = join_ranges(dict.fromkeys(name_row(each, summary.labels, has_kind=False) for each in alike[row]))
        cells = (f"{row.kind} {', '.join(names)}".strip(), *_make_cells(row, summary), *angle)
        body.append((*cells, *([row.case] if has_cases else [])))
    notes = [*([ALIKE_NOTE] if any(len(alike[row]) > 1 for row in rows) else []), *lines_shown, *summary.notes]
    if any(row.is_partly_open for row in rows):
        notes.append(PARTLY_OPEN_NOTE)
    shown = [i for i in range(len(columns)) if i < 3 or any(row[i] for row in body)]
    table = OutputTable(
        f"{HEADING}; {summary.axes}", tuple(columns[i] for i in shown),
        tuple(tuple(row[i] for i in shown) for row in body), tuple(notes),
    )  # fmt: skip
    further = len(summary.rows) - sum(len(alike[row]) for row in rows) + len(lines) - len(lines_shown)
    return table, rows, further


def _make_cells(row: SummaryRow, summary: Summary) -> tuple[Cell, ...]:
    """Make the cells of value, unit, direction or place, and instant."""
    style = _choose_style(row, summary)
    text = style.write_with_error(row.value) + "*" * row.is_partly_open + MARK * row.is_doubtful
    value = TextCell(text, is_governing=row.unit == "1" and row.value > EXCEEDED)
    where = format_direction(row.direction) if row.direction is not None else _format_place(row, summary)
    time = CONSTANT if row.is_constant and summary.span > 0.0 else _format_time(row.time, summary.span)
    return value, "" if row.unit == "1" else style.unit, where, time


def _choose_style(row: SummaryRow, summary: Summary) -> ReaderStyle:
    """Choose unit and decimals by the largest number of the same SI unit, with two significant digits at least."""
    units = summary.labels.units
    largest = max(abs(other.value) for other in summary.rows if other.unit == row.unit)
    style = choose_reader_style(row.unit, largest, units, row.error)
    digits = MIN_DIGITS - 1 - math.floor(math.log10(style.per_si * abs(row.value)))
    return style._replace(decimals=max(style.decimals, digits))


def name_row(row: SummaryRow, labels: Labels, *, has_kind: bool = True) -> str:
    """Name what a row is of: "joint main", "section rod, bending moment M1"; has_kind: begin with its kind."""
    if not row.name:
        return row.label.removesuffix(", force")
    words = describe_object(row.block_path.partition(".")[0], row.name, labels)
    quantity = row.label.removeprefix(words).removeprefix(", ")
    is_plain = quantity in PLAIN_WORDS or not row.label.startswith(words)
    return f"{row.kind} " * has_kind + words + ("" if is_plain else f", {quantity}")


def format_direction(direction: Sequence[float]) -> str:
    """Format a unit vector: an axis where it is one, else its components."""
    for axis, component in zip(XYZ, direction, strict=True):
        if abs(component) > ALONG_AXIS:
            return f"{'+' if component > 0.0 else '−'}{axis}"
    numbers = (f"{component:.{DIRECTION_DECIMALS}f}" for component in direction)
    return f"({', '.join('0' if float(text) == 0.0 else text.replace('-', '−') for text in numbers)})"


def _format_place(row: SummaryRow, summary: Summary) -> str:
    if row.place is None or math.isnan(row.place.s):
        return ""
    style = choose_reader_style("m", row.place.s, summary.labels.units)
    side = f"just {row.place.side} " if row.place.side else ""
    return f"{side}s = {style.write(row.place.s)} {style.unit}"


def _format_time(time: float, span: float) -> str:
    if span <= 0.0:
        return ""
    decimals = max(0, TIME_DIGITS - 1 - math.floor(math.log10(span)))
    return f"{time:.{decimals}f}"


def _format_crank_head(summary: Summary) -> str:
    name = describe_object("joints", summary.crank, summary.labels)
    return f"{name} [{_find_angle_unit(summary.labels)[0]}]"


def _find_angle_unit(labels: Labels) -> tuple[str, float]:
    """Return the display unit of angles: degrees unless the user chose another."""
    return labels.units.find("rad") if labels.units.is_chosen("rad") else ("deg", 180.0 / math.pi)


def _format_angle(row: SummaryRow, labels: Labels) -> str:
    if row.angle is None or row.is_constant:
        return ""
    unit, per_si = _find_angle_unit(labels)
    decimals = 1 if unit == "deg" else 3
    angle = round(per_si * row.angle, decimals) + 0.0  # no -0.0
    return f"{angle:.{decimals}f}".replace("-", "−")


# As data, SI


def make_blocks(title: str, summary: Summary) -> dict[str, Any]:
    """Make the rows for JSON, with full digits, and what is indeterminate."""
    return {
        "heun": FORMAT,
        "version": VERSION,
        "title": title,
        "summary": [_make_block(row) for row in summary.rows],
        "indeterminate": [
            {"what": group.what, "names": list(group.names), "paths": list(group.paths)} for group in summary.groups
        ],
    }


def _make_block(row: SummaryRow) -> dict[str, Any]:
    direction = None if row.direction is None else list(row.direction)
    block: dict[str, Any] = {"path": row.path, "label": row.label, "unit": row.unit, "value": row.value}
    block |= {"error": row.error, "direction": direction, "time": row.time, "angle": row.angle}
    block |= {"case": row.case or None}
    if row.place is not None:
        block |= {"s": row.place.s, "side": row.place.side}
    return block | ({"open_at_times": True} if row.is_partly_open else {})


CSV_NAMES = (
    "path",
    "label",
    "unit",
    "value",
    "error",
    *(f"direction_{axis}" for axis in XYZ),
    "time",
    "angle",
    "case",
    "s",
)


def make_records(summary: Summary) -> OutputTable:
    """Make the rows for CSV, with full digits."""
    rows = []
    for row in summary.rows:
        direction: Sequence[Cell] = (None, None, None) if row.direction is None else row.direction
        place = None if row.place is None else row.place.s
        rows.append(
            (row.path, row.label, row.unit, row.value, row.error, *direction, row.time, row.angle, row.case, place)
        )
    return OutputTable("", tuple(OutputColumn(name) for name in CSV_NAMES), tuple(rows))


class RunParts(NamedTuple):
    """The parts of the document of a run.

    summary: None where instants are given or parts of the results are chosen
    """

    title: str
    facts: Sequence[tuple[str, str]]
    summary: Summary | None
    tables: Sequence[OutputTable]

    def make_document(self, *, full: bool = False) -> OutputDocument:
        """Make the document; full: with every row of the summary."""
        return OutputDocument(self.title, self.facts, self.collect_tables(full=full))

    def collect_tables(self, *, full: bool = False) -> list[OutputTable]:
        """Return the table of the summary, if there is one, and the others."""
        if self.summary is None or self.summary.is_empty:
            return [*self.tables]
        return [make_summary_table(self.summary, full=full), *self.tables]


def make_run_parts(
    study: Study, labels: Labels, query: TablesQuery, case: str = "", *, has_summary: bool = True,
    show_reductions: bool = False,
) -> RunParts:  # fmt: skip
    """Make the parts of the document of a run.

    case: name of its load case, if there are several
    has_summary: whether to summarise it, unless instants are given
    """
    searched = search_run(study, labels, query)
    is_summarised = has_summary and query.instants is None and not query.show_all
    summary = summarise(study, searched, case) if is_summarised else None
    facts = make_heading(study.results, show_reductions, brief=not query.full)
    return RunParts(study.results.title, facts, summary, make_tables_of_page(study, searched, query))


def summarise(study: Study, searched: SearchedPage, case: str = "") -> Summary:
    """Summarise a searched run.

    case: name of its load case, if there are several
    """
    page, model = searched.page, study.results.model
    channels = page.make_search().collect(page.results)
    found = make_run_summary(study, searched, channels, case)
    body = model.get("axes")
    axes = f'axes of the "{body}" body' if body else "world axes"
    notes = [] if found.is_searched else [NOT_SEARCHED]
    notes += [found.doubtful_note] if found.doubtful_note else []
    span = float(np.ptp(study.results.time))
    groups = []
    if any(np.isnan(channel.values).any() for channel in channels):
        blocks = page.make_blocks(page.results, only_searched=True)
        groups = find_indeterminate_groups(blocks, collect_cut_series(page.results, page.labels))
    redundant = int(model.get("redundant", 0))
    return Summary(found.rows, groups, page.labels, axes, redundant, span, found.crank, notes)
