"""A table of extremes over load cases: a line a case, with instants, places, and the error that its run states.

What no other case exceeds governs, and is bold.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.client_report.extremes import (
    Ends,
    Governing,
    governing,
    instant_text,
    place_text,
    runs_in,
    style_of,
    text_of,
)
from heuncli.output.client_report.load_groups import TOTAL, LoadGroup, LoadNumber
from heuncli.output.client_report.parts import ReportCell, ReportTable, some
from heuncli.output.client_report.reported import Reported, ReportedRun
from heuncli.output.snapshots.envelopes import Bound
from heuncli.output.tables.extremes_tables import MANY, MARK, NOT_SEARCHED, PARTLY_OPEN_NOTE
from heuncli.output.tables.text_table import TextColumn
from heuncli.study.quantities.digits import OPEN, OPEN_NOTE, UNKNOWN, UNKNOWN_NOTE, ZERO_NOTE, Style, rough

MOST_CASES = 12  # told in a line each; of more those that govern
GOVERNS = (
    "bold: the least and the greatest of all load cases, of magnitudes the greatest alone; none that may be open, "
    "that is rounding, or in which all cases are alike"
)
PARTLY = "*"
STEADY = "without an instant: the same at all {}, to the digits shown"
ERRORS = "±: the error that the run states of the number, rounding included"
LACKING = "numbers that are open or not known, and may be larger, stand in the cases left out here: {}"
FEW_CASES = "of {} load cases those that govern a number; heun run SPEC --case all has all"


def cases_table(
    of: Reported, caption: str, groups: Sequence[LoadGroup], notes: Sequence[str] = (), *, along: bool = False
) -> ReportTable:
    """The table of some groups; along: with the places of extremes along runs of cuts."""
    governs = governing(of)
    shown = _shown(of, groups, governs)
    rows: list[Sequence[ReportCell] | str] = []
    nothing: list[str] = []
    for group in groups:
        lines = list(_lines(of, group, shown, governs, along=along))
        if not lines:
            nothing.append(group.name)
        elif len(groups) > MANY and group.name != TOTAL:
            rows += [(line[0]._replace(text=f"{group.name} {line[0].text}".rstrip()), *line[1:]) for line in lines]
        else:
            rows += ["  ".join(filter(None, (group.name, group.note))), *lines]
    below = [*_notes(of, rows), *notes]
    below += [NOT_SEARCHED] if not all(run.searched for run in of.runs) else []
    below += [FEW_CASES.format(len(of.runs))] if len(shown) < len(of.runs) else []
    below += [LACKING.format(some(hidden))] if (hidden := _hidden(of, groups, shown)) else []
    below += [f"0 throughout: {some(nothing)}"] if nothing else []
    return ReportTable(caption, _columns(of, along=along) if rows else [], rows, below)


def _shown(of: Reported, groups: Sequence[LoadGroup], governs: Governing) -> set[str]:
    """The cases with a line of their own: all, or where these are many those that govern something."""
    if len(of.runs) <= MOST_CASES:
        return {run.name for run in of.runs}
    bounds = [found(row.path) for group in groups for row in group.rows for found in (governs.low, governs.high)]
    return {case for bound in bounds if bound is not None for case in bound.governing} or {of.runs[0].name}


def _hidden(of: Reported, groups: Sequence[LoadGroup], shown: set[str]) -> list[str]:
    """The cases without a line in which some number is open or not known, and so may govern after all."""
    found = [
        run.name for group in groups for row in group.rows for run, ends in runs_in(of, row.path) if not ends.whole
    ]
    return [name for name in dict.fromkeys(found) if name not in shown]


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

    row: LoadNumber
    found: Sequence[tuple[ReportedRun, Ends]]
    unit: str
    size: float
    texts: Mapping[str, tuple[str, str]]

    @property
    def words(self) -> set[str]:
        """All that stands for it."""
        return {text for both in self.texts.values() for text in both}

    @property
    def is_nothing(self) -> bool:
        """Whether it is 0 throughout; what is open at some instants need not be."""
        return self.words == {"0"} and all(ends.whole for _, ends in self.found)


def _written(of: Reported, group: LoadGroup) -> Iterator[WrittenRow]:
    """The numbers of a group; those of one family and unit share their decimals."""
    found = [(row, list(runs_in(of, row.path))) for row in group.rows]
    families: dict[tuple[str, str], list[Ends]] = {}
    for row, own in found:
        for _, ends in own:
            families.setdefault((row.family, ends.unit), []).append(ends)
    for row, own in found:
        first = own[0][1]
        unit, size = of.units.of(first.unit)
        how = style_of(families[row.family, first.unit], of, size)
        yield WrittenRow(row, own, unit, size, {run.name: _texts(ends, how, size) for run, ends in own})


def _lines(
    of: Reported, group: LoadGroup, shown: set[str], governs: Governing, *, along: bool
) -> Iterator[Sequence[ReportCell]]:
    """The lines of a group; what is 0 throughout takes none, what is open throughout one together."""
    written = list(_written(of, group))
    told = [one for one in written if not one.is_nothing and one.words != {OPEN}]
    beside = Counter(one.row.vector for one in told if not one.row.even)
    told = [one for one in told if not (one.row.even and one.row.vector and beside[one.row.vector] == 1)]  # nothing new
    for one in told:
        yield from _of_cases(of, one, shown, governs, along=along)
    if opened := [one.row.label for one in written if one.words == {OPEN}]:
        yield _opened(_columns(of, along=along), opened)


def _opened(columns: Sequence[TextColumn], labels: Sequence[str]) -> list[ReportCell]:
    """The line of what is open throughout: the word stands where the numbers do."""
    heads = [column.head for column in columns]
    first = next(heads.index(word) for word in ("least", "value") if word in heads)
    words = {0: ", ".join(labels), first: OPEN}
    return [ReportCell(words.get(i, "")) for i in range(len(columns))]


def _of_cases(
    of: Reported, one: WrittenRow, shown: set[str], governs: Governing, *, along: bool
) -> Iterator[Sequence[ReportCell]]:
    """A line a case; the first has the name of the number and its unit."""
    low, high = governs.low(one.row.path), governs.high(one.row.path)
    known = not one.words & {OPEN, UNKNOWN} and not any(ends.parts_open for _, ends in one.found)
    several = known and len(of.runs) > 1  # what is open in a case may be larger there
    lead = [one.row.label, one.unit if one.unit != "1" else ""]
    for run, ends in one.found:
        if run.name not in shown:
            continue
        bold = several and not one.row.even and _is(low, run), several and _is(high, run)
        case = [run.told] if of.has_cases else []
        texts = one.texts[run.name]
        error = "" if texts == (OPEN, OPEN) else rough(ends.error * one.size)
        cells = _cells(of, run, ends, _marked(run, one, ends, texts), bold, along=along)
        label = lead[0] + PARTLY * ends.parts_open
        yield (ReportCell(label), ReportCell(lead[1]), *map(ReportCell, case), *cells, ReportCell(error))
        lead = ["", ""]


def _marked(run: ReportedRun, one: WrittenRow, ends: Ends, texts: tuple[str, str]) -> tuple[str, str]:
    """The texts with a mark where smoothed friction is not at its value at their instants."""
    if texts[0] == texts[1]:
        return texts
    kind = one.row.path.split(".")[0]
    both = zip(texts, (ends.low, ends.high), strict=True)
    low, high = (text if end.at is None else run.doubted.mark(text, end.at, kind, ends.unit) for text, end in both)
    return low, high


def _texts(ends: Ends, how: Style, size: float) -> tuple[str, str]:
    return text_of(ends.low.value, how, size), text_of(ends.high.value, how, size)


def _is(bound: Bound | None, run: ReportedRun) -> bool:
    return bound is not None and not bound.is_rounding and run.name in bound.governing


def _cells(
    of: Reported, run: ReportedRun, ends: Ends, texts: tuple[str, str], bold: tuple[bool, bool], *, along: bool
) -> Iterator[ReportCell]:
    """The cells of the lowest and the highest, each with its place and its instant."""
    steady = texts[0] == texts[1]
    if not (along or timed(of)):
        yield ReportCell(texts[0], any(bold))
        return
    for k, end in enumerate((ends.low, ends.high)):
        yield ReportCell(texts[k], bold[k])
        if along:
            yield ReportCell("" if steady else place_text(end.place, of.units, named=False))
        if timed(of):
            yield ReportCell("" if steady or texts[k] in (OPEN, UNKNOWN) else instant_text(end.at, run))


def _notes(of: Reported, rows: Sequence[Sequence[ReportCell] | str]) -> Iterator[str]:
    """What the signs of a table mean."""
    cells = [cell for row in rows if not isinstance(row, str) for cell in row]
    words = {cell.text for cell in cells}
    if any(cell.governs for cell in cells):
        yield GOVERNS
    if cells:
        yield ERRORS
    if cells and timed(of):
        yield STEADY.format("instants" if all(run.searched for run in of.runs) else "samples")
    yield ZERO_NOTE
    if OPEN in words:
        yield OPEN_NOTE
    if UNKNOWN in words:
        yield UNKNOWN_NOTE
    if any(cell.text.endswith(PARTLY) for cell in cells):
        yield PARTLY_OPEN_NOTE
    if any(cell.text.endswith(MARK) for cell in cells):
        yield from dict.fromkeys(run.doubted.note for run in of.runs if run.doubted.note)
