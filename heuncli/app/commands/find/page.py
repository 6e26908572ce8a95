"""Make the document of the findings of `heun find`."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.analyses.find.results import (
    Crossing,
    FindResults,
    MeasureJump,
    MetEdge,
    PossibleMeeting,
    Touch,
    UnresolvedBracket,
    UnsolvedStretch,
)
from heuncli.app.commands.find.as_json import CSV_COLUMNS, DIRECTIONS, iter_records, to_block
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.document import Cell, NumberCell, OutputColumn, OutputDocument, OutputTable, append_unit
from heuncli.output.tables.nouns import format_count
from heuncli.study.quantities.digits import format_error, format_with_error
from heuncli.study.quantities.table_units import Units

SCAN = (
    "a scan of {} at most {} apart, refined where neighbouring values require it; crossings closer together than that "
    "may be missed if nothing nearby indicates them"
)
ENDED = "stopped after {}: there may be more, and those shown may not be fully refined (--evaluations)"
MAX_WITHHELD = 2  # variants in singular poses that are listed one by one


class FindPage(NamedTuple):
    """What was found, and the units in which it is shown."""

    results: FindResults
    units: Units

    def format_place(self, x: float, error: float = 0.0) -> str:
        """Format a value of the unknown with its name and unit."""
        return f"{self.results.interval.name} = {format_with_error(x, error)} {self.results.interval.unit}".rstrip()

    def format_measure(self, gap: float, error: float) -> str:
        """Format the measure in its unit; `gap` is its distance above the value of the condition."""
        unit, size = self.units.find(self.results.condition.unit)
        return append_unit(format_with_error((gap + self.results.condition.value) * size, error * size), unit)


def make_document(page: FindPage) -> OutputDocument:
    """Make the document: crossings, where the condition is met, other findings in sentences; all of them as data."""
    tables = [table for table in (_make_crossings_table(page), _make_met_table(page)) if table.rows]
    notes = OutputTable("", notes=list(iter_notes(page)))
    return OutputDocument(
        page.results.title,
        list_facts(page),
        [*tables, notes],
        lambda: to_block(page.results),
        lambda: OutputTable("", CSV_COLUMNS, list(iter_records(page.results))),
    )


def list_facts(page: FindPage) -> list[tuple[str, str]]:
    """Return label and text of the lines above the table."""
    interval, condition, findings = page.results.interval, page.results.condition, page.results.findings
    value = page.format_measure(0.0, 0.0)
    ends = f"{interval.low:.10g} to {interval.high:.10g} {interval.unit}".rstrip()
    scan = SCAN.format(page.results.scan, f"{findings.spacing:.4g} {interval.unit}".rstrip())
    return [
        ("find", f"{condition.measure} {condition.relation} {value}, {interval.name} from {ends}"),
        ("runs", f"{format_count(len(findings.samples), 'variant')}: {scan}"),
    ]


def _make_crossings_table(page: FindPage) -> OutputTable:
    """Make the table of the crossings, a row each, with the measure there and its error."""
    unit = page.units.find(page.results.condition.unit)[0]
    columns = (
        OutputColumn(page.results.interval.name, unit=page.results.interval.unit), OutputColumn("error"),
        OutputColumn("measure", unit=unit), OutputColumn("error"), OutputColumn("", "verdict"),
        OutputColumn("", "text"),
    )  # fmt: skip
    rows = [_make_crossing_row(page, each) for each in page.results.findings.crossings]
    return OutputTable("CROSSINGS  where the measure passes the value, as the parameter increases", columns, rows)


def _make_crossing_row(page: FindPage, crossing: Crossing) -> tuple[Cell, ...]:
    """Make the row of a crossing, with the option that sets it."""
    size = page.units.find(page.results.condition.unit)[1]
    value = ((crossing.sample.gap or 0.0) + page.results.condition.value) * size
    error = crossing.sample.error * size
    word = DIRECTIONS[crossing.direction] + (", too flat to be located more closely" if crossing.flat else "")
    cells = (
        NumberCell(crossing.sample.x, crossing.error), NumberCell(crossing.error, write=format_error),
        NumberCell(value, error), NumberCell(error, write=format_error),
    )  # fmt: skip
    return (*cells, word, format_set_option(page, crossing.sample.x))


def format_set_option(page: FindPage, x: float) -> str:
    """Format the option that sets the unknown to a value, as it is typed."""
    text = page.results.interval.format_value(x)
    return (
        f"--set {page.results.interval.name}='{text}'" if " " in text else f"--set {page.results.interval.name}={text}"
    )


def _make_met_table(page: FindPage) -> OutputTable:
    """Make the table of the stretches where an inequality is met."""
    interval = page.results.interval
    columns = [
        column
        for word in ("from", "to")
        for column in (OutputColumn(f"{word} {interval.name}", unit=interval.unit), OutputColumn("", "verdict"))
    ]
    rows = [(*_make_edge(each.low), *_make_edge(each.high)) for each in page.results.findings.met_stretches]
    return OutputTable(f"MET  where the measure is {page.results.condition.relation} the value", columns, rows)


def _make_edge(edge: MetEdge) -> tuple[NumberCell, str]:
    """Make the two cells of an end of a stretch: its place, and what it is."""
    error = f", ± {format_error(edge.error)}" if edge.error else ""
    words = {
        "end": "end of the interval", "unsolved": "last solved variant", "bracket": "not resolved",
    }  # fmt: skip
    return NumberCell(edge.x, edge.error), words.get(edge.kind, edge.kind) + error


def iter_notes(page: FindPage) -> Iterator[str]:
    """Yield sentences on findings that are not rows of a table."""
    findings, condition = page.results.findings, page.results.condition
    if condition.side and not (findings.met_stretches or ("=" in condition.relation and not findings.is_met_nowhere)):
        is_whole = findings.is_complete and not findings.not_excluded
        yield ("met nowhere" if is_whole else "not met in the searched part") + _format_extremes(page)
    elif findings.is_met_nowhere:
        yield ("no crossing" if condition.side else "met nowhere") + _format_extremes(page)
    elif not (findings.crossings or findings.touches or findings.brackets or findings.not_excluded):
        yield "not met in the searched part" + _format_extremes(page)
    yield from (_describe_touch(page, each) for each in findings.touches)
    yield from (_describe_jump(page, each) for each in findings.jumps)
    yield from (_describe_bracket(page, each) for each in findings.brackets)
    yield from (_describe_not_excluded(page, each) for each in findings.not_excluded)
    for each in findings.unsolved_stretches:
        yield from _describe_unsolved(page, each)
    if not findings.is_complete:
        yield ENDED.format(format_count(len(findings.samples), "variant"))


def _format_extremes(page: FindPage) -> str:
    """Format the least and the greatest value that were found, and where."""
    least, greatest = page.results.findings.least, page.results.findings.greatest
    if least is None or greatest is None:
        return ""
    ends = (
        f"{page.format_measure(each.gap or 0.0, each.error)} at {page.format_place(each.x, 0.0)}"
        for each in (least, greatest)
    )
    return f": minimum {next(ends)}, maximum {next(ends)}"


def _describe_touch(page: FindPage, touch: Touch) -> str:
    """Describe where the measure touches the value."""
    ends = f"{page.format_place(touch.low)} and {format_with_error(touch.high, 0.0)}"
    if not touch.side:
        ends = (
            f"from {page.format_place(touch.low)} to {format_with_error(touch.high, 0.0)}"
            if touch.low < touch.high
            else "there"
        )
        return f"equal to the value within its error wherever known: {ends}"
    side = "above" if touch.side > 0 else "below"
    place = f"touches the value at {page.format_place(touch.sample.x)}, {side} it nearby"
    return f"{place}: equal to it within its error between {ends}"


def _describe_jump(page: FindPage, jump: MeasureJump) -> str:
    """Describe where the measure jumps across the value."""
    value_before, value_after = (page.format_measure(sample.gap or 0.0, sample.error) for sample in jump)
    width = format_error(jump.right.x - jump.left.x)
    return (
        f"jumps from {value_before} to {value_after} at {page.format_place(jump.left.x)} (within "
        f"{width}): the value is not met there"
    )


def _describe_bracket(page: FindPage, bracket: UnresolvedBracket) -> str:
    """Describe where the measure passes the value in a way that the search did not resolve."""
    value_before, value_after = (page.format_measure(sample.gap or 0.0, sample.error) for sample in bracket)
    ends = f"{page.format_place(bracket.left.x)}, and {value_after} at {page.format_place(bracket.right.x)}"
    return f"passes the value between {value_before} at {ends}: a crossing or a jump that the search did not resolve"


def _describe_not_excluded(page: FindPage, meeting: PossibleMeeting) -> str:
    """Describe where the value may be met, as far as samples and errors tell."""
    value_before, value_after = (page.format_measure(sample.gap or 0.0, sample.error) for sample in meeting)
    right = format_with_error(meeting.right.x, 0.0)
    ends = f"{page.format_place(meeting.left.x)} ({value_before}) and {right} ({value_after})"
    return f"not excluded between {ends}: the variants and their errors do not decide whether the value is met there"


def _describe_unsolved(page: FindPage, each: UnsolvedStretch) -> Iterator[str]:
    """Describe where the measure is not known, and how well the ends of that stretch are."""
    stretch = f"{page.format_place(each.low)} to {format_with_error(each.high, 0.0)}"
    yield f"no result from {stretch} ({format_count(each.variants, 'variant')}): {each.reason} [{each.code}]"
    ends = [(each.low, each.first, "last", "first"), (each.high, each.last, "first", "last")]
    for solved, failed, of_solved, of_failed in ends:
        if solved != failed:
            error = format_error(abs(solved - failed))
            text = f"{of_solved} solved at {page.results.interval.format_value(solved)}, {of_failed} not solved at"
            yield f"  {text} {page.results.interval.format_value(failed)} (± {error})"
    for one in each.withheld[:MAX_WITHHELD]:
        measure = page.format_measure(one.withheld_gap or 0.0, one.error)
        yield f"  at {page.results.interval.format_value(one.x)} only: {measure}"
    if len(each.withheld) > MAX_WITHHELD:
        yield f"  and {format_count(len(each.withheld) - MAX_WITHHELD, 'more variant')} in singular positions"
