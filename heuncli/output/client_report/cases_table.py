"""Tables of extremes over load cases: one row per case, with instants, places, and the stated error of its run.

The value that no other case exceeds governs, and is bold.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.client_report.extremes import (
    CaseExtremes,
    GoverningBounds,
    choose_family_style,
    find_governing,
    format_extreme,
    format_instant,
    format_place_in_unit,
    iter_run_extremes,
)
from heuncli.output.client_report.load_groups import TOTAL, LoadGroup, LoadNumber
from heuncli.output.client_report.report_data import ReportData, ReportedRun
from heuncli.output.documents.document import OutputColumn, OutputTable, TextCell, join_names
from heuncli.output.snapshots.envelopes import Bound
from heuncli.output.tables.extremes_tables import MARK, MAX_FULL_GROUPS, NOT_SEARCHED, PARTLY_OPEN_NOTE
from heuncli.study.quantities.digits import OPEN, OPEN_NOTE, UNKNOWN, UNKNOWN_NOTE, ZERO_NOTE, Style, format_error

MAX_CASES = 12  # with a row each; if there are more, only those that govern
BOLD_NOTE = (
    "bold: minimum and maximum over all load cases, for magnitudes only the maximum; not where a case may be open, the "
    "value is rounding error, or all cases agree"
)
PARTLY_OPEN_MARK = "*"
STEADY_NOTE = "no time given: the same at all {}, to the digits shown"
ERROR_NOTE = "±: stated error of the number, including rounding"
HIDDEN_CASES_NOTE = "cases not shown with open or unknown numbers, which may be larger: {}"
FEW_CASES_NOTE = "only the governing ones of {} load cases are shown; all: heun run SPEC --case all"


def make_cases_table(
    data: ReportData, caption: str, groups: Sequence[LoadGroup], notes: Sequence[str] = (), *, has_places: bool = False
) -> OutputTable:
    """Make the table of some groups of numbers.

    has_places: whether the extremes are along series of cuts, so that their places are shown
    """
    governing_bounds = find_governing(data)
    shown_cases = _choose_cases(data, groups, governing_bounds)
    rows: list[Sequence[TextCell] | str] = []
    zero_groups: list[str] = []
    for group in groups:
        group_rows = list(_iter_group_rows(data, group, shown_cases, governing_bounds, has_places=has_places))
        if not group_rows:
            zero_groups.append(group.name)
        elif len(groups) > MAX_FULL_GROUPS and group.name != TOTAL:
            rows += [(line[0]._replace(text=f"{group.name} {line[0].text}".rstrip()), *line[1:]) for line in group_rows]
        else:
            rows += ["  ".join(filter(None, (group.name, group.note))), *group_rows]
    table_notes = [*_iter_notes(data, rows), *notes]
    table_notes += [NOT_SEARCHED] if not all(run.is_searched for run in data.runs) else []
    table_notes += [FEW_CASES_NOTE.format(len(data.runs))] if len(shown_cases) < len(data.runs) else []
    table_notes += (
        [HIDDEN_CASES_NOTE.format(join_names(hidden_cases))]
        if (hidden_cases := _find_hidden_cases(data, groups, shown_cases))
        else []
    )
    table_notes += [f"all values 0: {join_names(zero_groups)}"] if zero_groups else []
    return OutputTable(caption, _make_columns(data, has_places=has_places) if rows else [], rows, table_notes)


def _choose_cases(data: ReportData, groups: Sequence[LoadGroup], governing_bounds: GoverningBounds) -> set[str]:
    """Choose the cases that get rows: all, or, if these are too many, those that govern some number."""
    if len(data.runs) <= MAX_CASES:
        return {run.name for run in data.runs}
    bounds = [
        find_bound(row.path)
        for group in groups
        for row in group.rows
        for find_bound in (governing_bounds.find_least, governing_bounds.find_greatest)
    ]
    return {case for bound in bounds if bound is not None for case in bound.governing} or {data.runs[0].name}


def _find_hidden_cases(data: ReportData, groups: Sequence[LoadGroup], shown_cases: set[str]) -> list[str]:
    """Find the cases without rows in which some number is indeterminate or not known, so that they may govern after
    all.
    """
    uncertain_cases = [
        run.name
        for group in groups
        for row in group.rows
        for run, ends in iter_run_extremes(data, row.path)
        if not ends.is_known
    ]
    return [name for name in dict.fromkeys(uncertain_cases) if name not in shown_cases]


def _make_columns(data: ReportData, *, has_places: bool) -> list[OutputColumn]:
    """Make the columns; those of instants and of cases only if there are several."""
    heads = [OutputColumn("", "text"), OutputColumn("unit", "text")]
    heads += [OutputColumn("case", "text")] if data.has_cases else []
    unit = data.units.find("m")[0]
    position_heads = [f"at s [{unit}]"] * has_places + ["at t [s]"] * has_instants(data)
    for word in ("min", "max") if has_instants(data) or has_places else ("value",):
        heads += [OutputColumn(word), *(OutputColumn(head) for head in position_heads)]
    return [*heads, OutputColumn("±")]


def has_instants(data: ReportData) -> bool:
    """Return whether some case has several instants."""
    return any(len(run.results.time) > 1 for run in data.runs)


class FormattedNumber(NamedTuple):
    """A number with its extremes in each case and their texts.

    size: factor from SI to `unit`
    texts: by case, the texts of the minimum and the maximum
    """

    row: LoadNumber
    case_extremes: Sequence[tuple[ReportedRun, CaseExtremes]]
    unit: str
    size: float
    texts: Mapping[str, tuple[str, str]]

    @property
    def distinct_texts(self) -> set[str]:
        """The distinct texts of all its extremes."""
        return {text for both in self.texts.values() for text in both}

    @property
    def is_zero(self) -> bool:
        """Whether it is zero at all times in all cases; an indeterminate number is not."""
        return self.distinct_texts == {"0"} and all(ends.is_known for _, ends in self.case_extremes)


def _iter_formatted(data: ReportData, group: LoadGroup) -> Iterator[FormattedNumber]:
    """Yield the numbers of a group as texts; those of one family and unit have the same decimals."""
    case_extremes = [(row, list(iter_run_extremes(data, row.path))) for row in group.rows]
    families: dict[tuple[str, str], list[CaseExtremes]] = {}
    for row, extremes in case_extremes:
        for _, ends in extremes:
            families.setdefault((row.family, ends.unit), []).append(ends)
    for row, extremes in case_extremes:
        first = extremes[0][1]
        unit, size = data.units.find(first.unit)
        style = choose_family_style(families[row.family, first.unit], data, size)
        yield FormattedNumber(
            row, extremes, unit, size, {run.name: _format_extremes(ends, style, size) for run, ends in extremes}
        )


def _iter_group_rows(
    data: ReportData, group: LoadGroup, shown_cases: set[str], governing_bounds: GoverningBounds, *, has_places: bool
) -> Iterator[Sequence[TextCell]]:
    """Yield the rows of a group. Numbers that are zero at all times get none; those always indeterminate share one
    row.
    """
    numbers = list(_iter_formatted(data, group))
    row_numbers = [number for number in numbers if not number.is_zero and number.distinct_texts != {OPEN}]
    component_counts = Counter(number.row.vector for number in row_numbers if not number.row.is_magnitude)
    # a repetition
    row_numbers = [
        number
        for number in row_numbers
        if not (number.row.is_magnitude and number.row.vector and component_counts[number.row.vector] == 1)
    ]
    for number in row_numbers:
        yield from _iter_case_rows(data, number, shown_cases, governing_bounds, has_places=has_places)
    if open_labels := [number.row.label for number in numbers if number.distinct_texts == {OPEN}]:
        yield _make_open_row(_make_columns(data, has_places=has_places), open_labels)


def _make_open_row(columns: Sequence[OutputColumn], labels: Sequence[str]) -> list[TextCell]:
    """Make the row of the numbers that are always indeterminate: the word `open` takes the place of the number."""
    heads = [column.title for column in columns]
    first = next(heads.index(word) for word in ("min", "value") if word in heads)
    texts = {0: ", ".join(labels), first: OPEN}
    return [TextCell(texts.get(i, "")) for i in range(len(columns))]


def _iter_case_rows(
    data: ReportData,
    number: FormattedNumber,
    shown_cases: set[str],
    governing_bounds: GoverningBounds,
    *,
    has_places: bool,
) -> Iterator[Sequence[TextCell]]:
    """Yield one row per case; the first has the name of the number and its unit."""
    low, high = governing_bounds.find_least(number.row.path), governing_bounds.find_greatest(number.row.path)
    is_known = not number.distinct_texts & {OPEN, UNKNOWN} and not any(
        ends.is_partly_open for _, ends in number.case_extremes
    )
    is_compared = is_known and len(data.runs) > 1  # an indeterminate value may be the largest
    leading = [number.row.label, number.unit if number.unit != "1" else ""]
    for run, ends in number.case_extremes:
        if run.name not in shown_cases:
            continue
        bold = is_compared and not number.row.is_magnitude and _governs(low, run), is_compared and _governs(high, run)
        case = [run.case_label] if data.has_cases else []
        texts = number.texts[run.name]
        error = "" if texts == (OPEN, OPEN) else format_error(ends.error * number.size)
        cells = _iter_cells(data, run, ends, _mark_uncertain(run, number, ends, texts), bold, has_places=has_places)
        label = leading[0] + PARTLY_OPEN_MARK * ends.is_partly_open
        yield (TextCell(label), TextCell(leading[1]), *map(TextCell, case), *cells, TextCell(error))
        leading = ["", ""]


def _mark_uncertain(
    run: ReportedRun, number: FormattedNumber, ends: CaseExtremes, texts: tuple[str, str]
) -> tuple[str, str]:
    """Mark the texts at whose instants smoothed friction has not reached its full value."""
    if texts[0] == texts[1]:
        return texts
    kind = number.row.path.split(".")[0]
    both = zip(texts, (ends.low, ends.high), strict=True)
    low, high = (
        text if end.time is None else run.uncertain_instants.add_mark(text, end.time, kind, ends.unit)
        for text, end in both
    )
    return low, high


def _format_extremes(ends: CaseExtremes, style: Style, size: float) -> tuple[str, str]:
    return format_extreme(ends.low.value, style, size), format_extreme(ends.high.value, style, size)


def _governs(extreme: Bound | None, run: ReportedRun) -> bool:
    return extreme is not None and not extreme.is_rounding and run.name in extreme.governing


def _iter_cells(
    data: ReportData,
    run: ReportedRun,
    ends: CaseExtremes,
    texts: tuple[str, str],
    bold: tuple[bool, bool],
    *,
    has_places: bool,
) -> Iterator[TextCell]:
    """Yield the cells of the minimum and the maximum, each with its place and its instant."""
    is_constant = texts[0] == texts[1]
    if not (has_places or has_instants(data)):
        yield TextCell(texts[0], any(bold))
        return
    for k, end in enumerate((ends.low, ends.high)):
        yield TextCell(texts[k], bold[k])
        if has_places:
            yield TextCell("" if is_constant else format_place_in_unit(end.place, data.units, with_unit=False))
        if has_instants(data):
            yield TextCell("" if is_constant or texts[k] in (OPEN, UNKNOWN) else format_instant(end.time, run))


def _iter_notes(data: ReportData, rows: Sequence[Sequence[TextCell] | str]) -> Iterator[str]:
    """Yield the notes that explain the signs in a table."""
    cells = [cell for row in rows if not isinstance(row, str) for cell in row]
    texts = {cell.text for cell in cells}
    if any(cell.is_governing for cell in cells):
        yield BOLD_NOTE
    if cells:
        yield ERROR_NOTE
    if cells and has_instants(data):
        yield STEADY_NOTE.format("times" if all(run.is_searched for run in data.runs) else "output times")
    yield ZERO_NOTE
    if OPEN in texts:
        yield OPEN_NOTE
    if UNKNOWN in texts:
        yield UNKNOWN_NOTE
    if any(cell.text.endswith(PARTLY_OPEN_MARK) for cell in cells):
        yield PARTLY_OPEN_NOTE
    if any(cell.text.endswith(MARK) for cell in cells):
        yield from dict.fromkeys(run.uncertain_instants.note for run in data.runs if run.uncertain_instants.note)
