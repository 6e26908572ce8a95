"""The table of loads: of each joint, support and load its lowest and highest number, in every case that is reported.

A line a case: its extremes with their instants, and the error that its run states. What no other case exceeds governs.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from heuncli.client_report.extremes import (
    Ends,
    Governing,
    governing,
    instant_text,
    place_text,
    runs_in,
    style_of,
    text_of,
)
from heuncli.client_report.parts import Cell, Grid, Part, Sentence
from heuncli.client_report.reported import Reported, ReportedRun
from heuncli.named_tuples import NamedTuple
from heuncli.report.digits import OPEN, OPEN_NOTE, UNKNOWN, UNKNOWN_NOTE, ZERO_NOTE, Style, rough
from heuncli.report.extremes_tables import MANY, PARTLY_OPEN_NOTE
from heuncli.report.table_blocks import FAMILIES, short
from heuncli.report.table_plans import FOUNDATION, JOINTS, STOPS, TablePlan
from heuncli.report.text_table import TextColumn
from heuncli.results import Results
from heuncli.results_schema import MAGNITUDES, XYZ
from heuncli.telling.envelopes import Bound

UNHELD = "There are no joints, and nothing stands on the ground."
OF_BLOWS = "The scene is struck and nothing else is asked for: see the blows for its joints and the ground."
WHOLE = {"force": "|F|", "moment": "|M|"}  # of a vector
MOST_CASES = 12  # told in a line each; of more those that govern
GOVERNS = "bold: the least and the greatest of all load cases; of magnitudes the greatest alone"
PARTLY = "*"
STEADY = "without an instant: the same at all instants, to the digits shown"
ERRORS = "±: the error that the run states of the number, rounding included"
TOO_MANY = "{} of {}: magnitudes alone; heun run SPEC --format csv has the components"
FEW_CASES = "of {} load cases those that govern a number; heun run SPEC --case all has all"


class LoadRow(NamedTuple):
    """A number of the results: its label, its path, and to which family of numbers it belongs.

    even: a magnitude, of which the least governs nothing; vector: of which it is a component or the magnitude.
    """

    label: str
    path: str
    family: str
    even: bool = False
    vector: str = ""


class LoadGroup(NamedTuple):
    """The numbers of one thing, under its title."""

    title: str
    rows: Sequence[LoadRow]


def load_tables(of: Reported) -> list[Part]:
    """The tables of the foundation, the joints, the stops and the applied loads."""
    plans = (FOUNDATION, JOINTS, STOPS)
    found = [part for plan in plans for part in _table(of, plan)]
    return found or [Sentence(UNHELD if not of.spec.joints else OF_BLOWS)]


def _table(of: Reported, plan: TablePlan) -> Iterator[Part]:
    """The table of one kind of results, if the scene has it."""
    groups = list(_groups(of, plan))
    if not groups:
        return
    notes: list[str] = []
    if len(groups) > MANY:
        groups = [group._replace(rows=[row for row in group.rows if not _is_component(row)]) for group in groups]
        notes.append(TOO_MANY.format(len(groups), f"{plan.what or plan.kind}s"))
    yield grid(of, plan.heading(of.runs[0].results, of.labels), groups, notes)


def _groups(of: Reported, plan: TablePlan) -> Iterator[LoadGroup]:
    """What there is of a kind, each with its numbers."""
    results = of.runs[0].results
    for name, prefix in _things(results, plan):
        rows = list(_rows(of, prefix, plan.quantities))
        if rows:
            yield LoadGroup("  ".join(filter(None, (name, plan.note(name, of.labels)))), rows)


def _things(results: Results, plan: TablePlan) -> Iterator[tuple[str, str]]:
    """The names of a kind of results with what their paths begin with."""
    block = getattr(results, plan.kind)
    if not plan.of_foundation:
        yield from ((name, f"{plan.kind}.{name}") for name in block)
        return
    yield "total", "foundation"
    for part, word in (("supports", "support"), ("elements", "element")):
        yield from ((f"{word} {name}", f"foundation.{part}.{name}") for name in block.get(part, {}))


def _rows(of: Reported, prefix: str, quantities: Sequence[str]) -> Iterator[LoadRow]:
    """The numbers of one thing: of a vector its components and its magnitude."""
    numbers = of.runs[0].kept.numbers
    for quantity in quantities:
        path, family = f"{prefix}.{quantity}", FAMILIES.get(quantity, quantity)
        parts = [f"{path}.{axis}" for axis in XYZ]
        vector = all(part in numbers for part in parts)
        for axis, part in zip(XYZ, parts, strict=True):
            if vector:
                yield LoadRow(short(f"{quantity}.{axis}"), part, family, vector=path)
        if vector:
            yield LoadRow(WHOLE[quantity], path, family, even=True, vector=path)
        elif path in numbers:
            yield LoadRow(quantity, path, family, quantity in MAGNITUDES)


def _is_component(row: LoadRow) -> bool:
    return bool(row.vector) and not row.even


def grid(
    of: Reported, caption: str, groups: Sequence[LoadGroup], notes: Sequence[str] = (), *, along: bool = False
) -> Grid:
    """The table of some groups; along: with the places of extremes along runs of cuts."""
    governs = governing(of)
    shown = _shown(of, groups, governs)
    rows: list[Sequence[Cell] | str] = []
    for group in groups:
        rows += [group.title, *(_lines(of, group, shown, governs, along=along))]
    if len(shown) < len(of.runs):
        notes = [*notes, FEW_CASES.format(len(of.runs))]
    return Grid(caption, _columns(of, along=along), rows, [*_notes(of, rows), *notes])


def _shown(of: Reported, groups: Sequence[LoadGroup], governs: Governing) -> set[str]:
    """The cases with a line of their own: all, or where these are many those that govern something."""
    if len(of.runs) <= MOST_CASES:
        return {run.name for run in of.runs}
    bounds = [found(row.path) for group in groups for row in group.rows for found in (governs.low, governs.high)]
    return {bound.case for bound in bounds if bound is not None}


def _columns(of: Reported, *, along: bool) -> list[TextColumn]:
    """The heads: of instants where there are several, of cases where these are told apart."""
    heads = [TextColumn("", "left"), TextColumn("unit", "left")]
    heads += [TextColumn("case", "left")] if of.has_cases else []
    unit = of.units.of("m")[0]
    beside = [f"at s [{unit}]"] * along + ["at t [s]"] * timed(of)
    for word in ("least", "greatest") if timed(of) or along else ("value",):
        heads += [TextColumn(word), *(TextColumn(head) for head in beside)]
    return [*heads, TextColumn("±")]


def timed(of: Reported) -> bool:
    """Whether some case has several instants."""
    return any(len(run.results.time) > 1 for run in of.runs)


class WrittenRow(NamedTuple):
    """A number in its unit: of each case its extremes, and the two as they are written."""

    row: LoadRow
    found: Sequence[tuple[ReportedRun, Ends]]
    unit: str
    size: float
    texts: Mapping[str, tuple[str, str]]

    @property
    def words(self) -> set[str]:
        """All that stands for it."""
        return {text for both in self.texts.values() for text in both}


def _written(of: Reported, group: LoadGroup) -> Iterator[WrittenRow]:
    """The numbers of a group; those of one family and unit share their decimals."""
    found = [(row, list(runs_in(of, row.path))) for row in group.rows]
    families: dict[tuple[str, str], list[Ends]] = {}
    for row, own in found:
        for _, ends in own:
            families.setdefault((row.family, ends.unit), []).append(ends)
    for row, own in found:
        run, first = own[0]
        unit, size = of.units.of(first.unit)
        how = style_of(families[row.family, first.unit], run, size)
        yield WrittenRow(row, own, unit, size, {run.name: _texts(ends, how, size) for run, ends in own})


def _lines(
    of: Reported, group: LoadGroup, shown: set[str], governs: Governing, *, along: bool
) -> Iterator[Sequence[Cell] | str]:
    """The lines of a group; what is 0 or open throughout takes none."""
    written = list(_written(of, group))
    told = [one for one in written if one.words not in ({"0"}, {OPEN})]
    beside = Counter(one.row.vector for one in told if not one.row.even)
    told = [one for one in told if not (one.row.even and beside[one.row.vector] == 1)]  # says nothing new
    for one in told:
        yield from _of_cases(of, one, shown, governs, along=along)
    if opened := [one.row.label for one in written if one.words == {OPEN}]:
        columns = _columns(of, along=along)
        first = next(i for i, column in enumerate(columns) if column.head in ("least", "value"))
        yield [Cell(", ".join(opened)), *[Cell("")] * (first - 1), Cell(OPEN), *[Cell("")] * (len(columns) - first - 1)]
    elif not told:
        yield "0 throughout"


def _of_cases(
    of: Reported, one: WrittenRow, shown: set[str], governs: Governing, *, along: bool
) -> Iterator[Sequence[Cell]]:
    """A line a case; the first has the name of the number and its unit."""
    low, high = governs.low(one.row.path), governs.high(one.row.path)
    several = len(of.runs) > 1
    lead = [one.row.label, one.unit if one.unit != "1" else ""]
    for run, ends in one.found:
        if run.name not in shown:
            continue
        bold = several and not one.row.even and _is(low, run), several and _is(high, run)
        case = [run.told] if of.has_cases else []
        error = rough(ends.error * one.size)
        cells = _cells(of, run, ends, one.texts[run.name], bold, along=along)
        label = lead[0] + PARTLY * ends.parts_open
        yield (Cell(label), Cell(lead[1]), *map(Cell, case), *cells, Cell(error))
        lead = ["", ""]


def _texts(ends: Ends, how: Style, size: float) -> tuple[str, str]:
    return text_of(ends.low.value, how, size), text_of(ends.high.value, how, size)


def _is(bound: Bound | None, run: ReportedRun) -> bool:
    return bound is not None and bound.case == run.name


def _cells(
    of: Reported, run: ReportedRun, ends: Ends, texts: tuple[str, str], bold: tuple[bool, bool], *, along: bool
) -> Iterator[Cell]:
    """The cells of the lowest and the highest, each with its place and its instant."""
    steady = texts[0] == texts[1]
    if not (along or timed(of)):
        yield Cell(texts[0], any(bold))
        return
    for k, end in enumerate((ends.low, ends.high)):
        yield Cell(texts[k], bold[k])
        if along:
            yield Cell("" if steady else place_text(end.place, of.units, named=False))
        if timed(of):
            yield Cell("" if steady or texts[k] in (OPEN, UNKNOWN) else instant_text(end.at, run))


def _notes(of: Reported, rows: Sequence[Sequence[Cell] | str]) -> Iterator[str]:
    """What the signs of a table mean."""
    cells = [cell for row in rows if not isinstance(row, str) for cell in row]
    words = {cell.text for cell in cells}
    if any(cell.governs for cell in cells):
        yield GOVERNS
    if cells:
        yield ERRORS
    if cells and timed(of):
        yield STEADY
    yield ZERO_NOTE
    if OPEN in words:
        yield OPEN_NOTE
    if UNKNOWN in words:
        yield UNKNOWN_NOTE
    if any(cell.text.endswith(PARTLY) for cell in cells):
        yield PARTLY_OPEN_NOTE
