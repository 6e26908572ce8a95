"""Tables of extremes: a row for each number of the results, with its least and greatest value in each load case.

The numbers come in groups, one for each joint, support and load, as in the tables of `heun run`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.client_report.extremes import (
    DASH,
    CaseExtreme,
    CaseExtremes,
    GoverningBounds,
    choose_family,
    find_governing,
    format_instant,
    format_place,
    iter_run_extremes,
)
from heuncli.output.client_report.report_data import ReportData, ReportedRun
from heuncli.output.documents.document import Fill, OutputColumn, OutputTable, TextCell, join_names
from heuncli.output.snapshots.envelopes import Bound
from heuncli.output.tables.extremes_tables import MARK, NOT_SEARCHED, PARTLY_OPEN_NOTE
from heuncli.output.tables.table_blocks import format_component
from heuncli.output.tables.table_plans import TablePlan
from heuncli.results.results import Results
from heuncli.results.results_schema import MAGNITUDES, XYZ
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.channels import DECIMALS_OF
from heuncli.study.quantities.digits import OPEN, OPEN_NOTE, UNKNOWN, UNKNOWN_NOTE

MAGNITUDE_LABELS = {"force": "|F|", "moment": "|M|"}  # of a vector
TOTAL = "total"  # of the foundation
MAX_NUMBER_COLUMNS = 8  # of cases beside each other; if there are more, their envelope
MAX_HALF_COLUMNS = 4  # columns of numbers with which a table runs through two columns of a page
MIN_SPLIT_ROWS = 9  # rows of a table that runs through two columns
PARTLY_OPEN_MARK = "*"
BOLD_NOTE = (
    "bold: minimum and maximum over all load cases, for magnitudes only the maximum; not where a case may be open, the "
    "value is rounding error, or all cases agree"
)
NOISE_NOTE = f"{DASH}: below 1/1000 of the largest of its kind; rows of dashes only are left out"
STEADY_NOTE = "one value: the same at all {}"
ENVELOPE_NOTE = "least and greatest value of {} load cases; each case: heun run SPEC --case all"
HIDDEN_CASES_NOTE = "open or unknown, where it may be larger: {}"


class LoadNumber(NamedTuple):
    """A number of the results: label, path, and the family of numbers with which it shares its decimals.

    is_magnitude: whether it is a magnitude, whose minimum governs nothing
    vector: path of the vector of which it is a component or the magnitude
    """

    label: str
    path: str
    family: str
    is_magnitude: bool = False
    vector: str = ""


class LoadGroup(NamedTuple):
    """The numbers of one object, with its words and the note next to it; key: its name in the spec."""

    name: str
    note: str
    rows: Sequence[LoadNumber]
    key: str = ""


def iter_groups(data: ReportData, plan: TablePlan) -> Iterator[LoadGroup]:
    """Yield the objects of a kind, each with its numbers."""
    results = data.runs[0].results
    for name, prefix in _iter_objects(results, plan):
        rows = list(_iter_numbers(data, prefix, plan.quantities))
        if rows:
            words = name if plan.is_foundation else describe_object(plan.kind, name, data.labels)
            yield LoadGroup(words, plan.note(name, data.labels), rows, name)


def _iter_objects(results: Results, plan: TablePlan) -> Iterator[tuple[str, str]]:
    """Yield the names of the objects of a kind, each with the prefix of its paths."""
    block = getattr(results, plan.kind)
    if not plan.is_foundation:
        yield from ((name, f"{plan.kind}.{name}") for name in block)
        return
    yield TOTAL, "foundation"
    for part, word in (("supports", "support"), ("elements", "element")):
        yield from ((f"{word} {name}", f"foundation.{part}.{name}") for name in block.get(part, {}))


def _iter_numbers(data: ReportData, prefix: str, quantities: Sequence[str]) -> Iterator[LoadNumber]:
    """Yield the numbers of one object; for a vector its components and its magnitude."""
    numbers = data.runs[0].snapshot.numbers
    for quantity in quantities:
        path, family = f"{prefix}.{quantity}", DECIMALS_OF.get(quantity, quantity)
        components = [f"{path}.{axis}" for axis in XYZ]
        is_vector = all(component in numbers for component in components)
        for axis, component in zip(XYZ, components, strict=True):
            if is_vector:
                yield LoadNumber(format_component(f"{quantity}.{axis}"), component, family, vector=path)
        if is_vector:
            yield LoadNumber(
                MAGNITUDE_LABELS.get(quantity, f"|{quantity}|"), path, family, is_magnitude=True, vector=path
            )
        elif path in numbers:
            yield LoadNumber(quantity.replace("_", " "), path, family, quantity in MAGNITUDES)


def drop_components(group: LoadGroup) -> LoadGroup:
    """Drop the components of vectors from a group, keeping their magnitudes."""
    return group._replace(rows=[row for row in group.rows if row.is_magnitude or not row.vector])


def make_cases_table(
    data: ReportData, heading: str, groups: Sequence[LoadGroup], notes: Sequence[str] = (), *, has_places: bool = False
) -> OutputTable:
    """Make the table of some groups of numbers.

    has_places: whether the extremes are along series of cuts, so that their places are shown
    """
    layout = _Layout(data, has_places)
    governing_bounds = find_governing(data)
    rows: list[Sequence[TextCell] | str] = []
    zero_groups: list[str] = []
    for group in groups:
        group_rows = list(_iter_group_rows(layout, group, governing_bounds))
        if not group_rows:
            zero_groups.append(group.name)
        elif len(group_rows) == 1:
            (line,) = group_rows
            rows.append((line[0]._replace(text=f"{group.name}, {line[0].text}".rstrip()), *line[1:]))
        else:
            rows += ["  ".join(filter(None, (group.name, group.note))), *group_rows]
    table_notes = [*_iter_notes(layout, groups, rows), *notes]
    table_notes += [f"no load: {join_names(zero_groups)}"] if zero_groups else []
    fill: Fill = "half" if len(rows) < MIN_SPLIT_ROWS and layout.fill == "columns" else layout.fill
    return OutputTable(heading, layout.columns if rows else [], rows, table_notes, fill)


class _Layout:
    """The columns of a table: of one case with instants and places, of a few cases, or of the envelope of many."""

    def __init__(self, data: ReportData, has_places: bool) -> None:
        self.data = data
        self.has_instants = has_instants(data)
        self.is_ranged = self.has_instants or has_places
        self.has_places = has_places and len(data.runs) == 1
        n_columns = len(data.runs) * (2 if self.is_ranged else 1)
        self.is_envelope = n_columns > MAX_NUMBER_COLUMNS
        self.fill: Fill = (
            "columns" if n_columns <= MAX_HALF_COLUMNS and not (self.has_places and self.has_instants) else "page"
        )

    @property
    def columns(self) -> list[OutputColumn]:
        """The heads of the table."""
        heads = [OutputColumn("", "text"), OutputColumn("", "text")]
        words = ("min", "max") if self.is_ranged else ("value",)
        if self.is_envelope:
            both = [[OutputColumn(word), OutputColumn("case", "text")] for word in ("min", "max")]
            return [*heads, *both[0], *both[1]]
        if len(self.data.runs) > 1:
            for run in self.data.runs:
                case = run.case_label.replace("_", " ")
                heads += [OutputColumn(f"{case} {word}" if self.is_ranged else case) for word in words]
            return heads
        for word in words:
            heads += [OutputColumn(word), *(OutputColumn(head) for head in self.position_heads)]
        return heads

    @property
    def position_heads(self) -> list[str]:
        """The heads of the places and instants of an extreme of the only case."""
        heads = [f"at s [{self.data.units.find('m')[0]}]"] * self.has_places
        return heads + ["at t [s]"] * self.has_instants


def has_instants(data: ReportData) -> bool:
    """Return whether some case has several instants."""
    return any(len(run.results.time) > 1 for run in data.runs)


class FormattedNumber(NamedTuple):
    """A number with its extremes in each case and their texts.

    texts: by case, the texts of the minimum and the maximum
    """

    row: LoadNumber
    case_extremes: Sequence[tuple[ReportedRun, CaseExtremes]]
    unit: str
    texts: Mapping[str, tuple[str, str]]

    @property
    def distinct_texts(self) -> set[str]:
        """The distinct texts of all its extremes."""
        return {text for both in self.texts.values() for text in both}

    @property
    def is_noise(self) -> bool:
        """Whether it is noise at all times in all cases; an indeterminate number is not."""
        return self.distinct_texts == {DASH} and all(ends.is_known for _, ends in self.case_extremes)

    @property
    def is_known(self) -> bool:
        """Whether it is known at all instants of all cases."""
        return all(ends.is_known and not ends.is_partly_open for _, ends in self.case_extremes)


def _iter_formatted(data: ReportData, group: LoadGroup) -> Iterator[FormattedNumber]:
    """Yield the numbers of a group as texts; those of one family have the same unit, and in a case the same digits."""
    case_extremes = [(row, list(iter_run_extremes(data, row.path))) for row in group.rows]
    families: dict[tuple[str, str], dict[str, list[CaseExtremes]]] = {}
    for row, extremes in case_extremes:
        for run, ends in extremes:
            families.setdefault((row.family, ends.unit), {}).setdefault(run.name, []).append(ends)
    for row, extremes in case_extremes:
        by_case = families[row.family, extremes[0][1].unit]
        all_ends = [ends for case in by_case.values() for ends in case]
        written = {name: choose_family(ends, data, all_ends) for name, ends in by_case.items()}
        texts = {
            run.name: (written[run.name].write(ends.low.value), written[run.name].write(ends.high.value))
            for run, ends in extremes
        }
        yield FormattedNumber(row, extremes, written[extremes[0][0].name].unit, texts)


def _iter_group_rows(
    layout: _Layout, group: LoadGroup, governing_bounds: GoverningBounds
) -> Iterator[Sequence[TextCell]]:
    """Yield the rows of a group. Numbers that are noise at all times get none; those always indeterminate share one
    row; what repeats another number is left out.
    """
    numbers = list(_iter_formatted(layout.data, group))
    shown = [number for number in numbers if not number.is_noise and number.distinct_texts != {OPEN}]
    counts = Counter(number.row.vector for number in shown if not number.row.is_magnitude)
    for number in shown:
        is_vector_length = number.row.is_magnitude and number.row.vector
        if (is_vector_length and counts[number.row.vector] == 1) or _repeats_one(number, shown):
            continue
        yield _make_row(layout, number, governing_bounds)
    if open_labels := [number.row.label for number in numbers if number.distinct_texts == {OPEN}]:
        blank = [TextCell("")] * (len(layout.columns) - 3)
        yield [TextCell(", ".join(open_labels)), TextCell(""), TextCell(OPEN), *blank]


def _repeats_one(number: FormattedNumber, others: Sequence[FormattedNumber]) -> bool:
    """Return whether a number that belongs to no vector, such as `radial`, equals one of a vector in all cases."""
    return not number.row.vector and any(
        other.row.vector and other.unit == number.unit and other.texts == number.texts for other in others
    )


def _make_row(layout: _Layout, number: FormattedNumber, governing_bounds: GoverningBounds) -> Sequence[TextCell]:
    """Make the row of a number."""
    low, high = governing_bounds.find_least(number.row.path), governing_bounds.find_greatest(number.row.path)
    is_compared = number.is_known and len(layout.data.runs) > 1  # an indeterminate value may be the largest
    label = number.row.label + PARTLY_OPEN_MARK * any(ends.is_partly_open for _, ends in number.case_extremes)
    leading = [TextCell(label), TextCell(number.unit)]
    if layout.is_envelope:
        return [*leading, *_iter_envelope_cells(number, low, high)]
    extremes = {run.name: (run, ends) for run, ends in number.case_extremes}
    for run in layout.data.runs:
        if run.name not in extremes:
            leading += [TextCell("")] * (2 if layout.is_ranged else 1)
            continue
        _, ends = extremes[run.name]
        texts = _mark_uncertain(run, number, ends, number.texts[run.name])
        bold = is_compared and not number.row.is_magnitude and _governs(low, run), is_compared and _governs(high, run)
        leading += _iter_cells(layout, run, ends, texts, bold)
    return leading


def _iter_envelope_cells(number: FormattedNumber, low: Bound | None, high: Bound | None) -> Iterator[TextCell]:
    """Yield the least and greatest value of all cases, each with its case."""
    for k, bound in enumerate((low, high)):
        governing = bound.governing if bound is not None else ()
        shown = [*governing, *(bound.similar if bound is not None else ()), *number.texts][0]
        yield TextCell(number.texts[shown][k])
        yield TextCell(governing[0] if governing else "")


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


def _governs(extreme: Bound | None, run: ReportedRun) -> bool:
    return extreme is not None and not extreme.is_rounding and run.name in extreme.governing


def _iter_cells(
    layout: _Layout, run: ReportedRun, ends: CaseExtremes, texts: tuple[str, str], bold: tuple[bool, bool]
) -> Iterator[TextCell]:
    """Yield the cells of the minimum and the maximum in a case; a constant has one."""
    is_constant = texts[0] == texts[1]
    if not layout.is_ranged:
        yield TextCell(texts[0], any(bold))
        return
    for k, end in enumerate((ends.low, ends.high)):
        yield TextCell("" if is_constant and k == 0 else texts[k], bold[k] or (is_constant and any(bold)))
        if len(layout.data.runs) == 1:
            yield from _iter_position_cells(layout, run, end, is_blank=is_constant or texts[k] in (OPEN, UNKNOWN, DASH))


def _iter_position_cells(layout: _Layout, run: ReportedRun, end: CaseExtreme, *, is_blank: bool) -> Iterator[TextCell]:
    """Yield the place and the instant of an extreme, where the table has them."""
    if layout.has_places:
        yield TextCell("" if is_blank else format_place(end.place, layout.data.units))
    if layout.has_instants:
        yield TextCell("" if is_blank else format_instant(end.time, run))


def _iter_notes(
    layout: _Layout, groups: Sequence[LoadGroup], rows: Sequence[Sequence[TextCell] | str]
) -> Iterator[str]:
    """Yield the notes that explain the signs in a table."""
    data = layout.data
    cells = [cell for row in rows if not isinstance(row, str) for cell in row]
    texts = {cell.text for cell in cells}
    if any(cell.is_governing for cell in cells):
        yield BOLD_NOTE
    if cells and layout.is_envelope:
        yield ENVELOPE_NOTE.format(len(data.runs))
        if hidden := _find_hidden_cases(data, groups):
            yield HIDDEN_CASES_NOTE.format(join_names(hidden))
    if cells and layout.has_instants:
        yield STEADY_NOTE.format("times" if all(run.is_searched for run in data.runs) else "output times")
    if DASH in texts:
        yield NOISE_NOTE
    if OPEN in texts:
        yield OPEN_NOTE
    if UNKNOWN in texts:
        yield UNKNOWN_NOTE
    if any(cell.text.endswith(PARTLY_OPEN_MARK) for cell in cells):
        yield PARTLY_OPEN_NOTE
    if any(cell.text.endswith(MARK) for cell in cells):
        yield from dict.fromkeys(run.uncertain_instants.note for run in data.runs if run.uncertain_instants.note)
    if not all(run.is_searched for run in data.runs):
        yield NOT_SEARCHED


def _find_hidden_cases(data: ReportData, groups: Sequence[LoadGroup]) -> list[str]:
    """Find the cases in which some number is indeterminate or not known, so that they may govern after all."""
    names = [
        run.name
        for group in groups
        for row in group.rows
        for run, ends in iter_run_extremes(data, row.path)
        if not ends.is_known
    ]
    return list(dict.fromkeys(names))
