"""Make the document of the findings of `heun find`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from heuncli.analyses.find.results import (
    Crossing,
    IntervalFindings,
    MeasureJump,
    MetEdge,
    PossibleMeeting,
    Touch,
    UnresolvedBracket,
    UnsolvedStretch,
)
from heuncli.analyses.variants.measures import Comparison
from heuncli.analyses.variants.parameters import DesignVariable
from heuncli.analyses.variants.samples import Sample
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.units import parse_unit
from heuncli.output.documents.as_data import make_columns
from heuncli.output.documents.document import Cell, NumberCell, OutputColumn, OutputDocument, OutputTable, append_unit
from heuncli.output.tables.nouns import format_count
from heuncli.study.quantities.digits import format_error, format_with_error
from heuncli.study.quantities.table_units import Units

DIRECTIONS = {1: "rises", -1: "falls", 0: "at the end"}
SCAN = (
    "a scan of {} at most {} apart, refined where neighbouring values require it; crossings closer together than that "
    "may be missed if nothing nearby indicates them"
)
ENDED = "stopped after {}: there may be more, and those shown may not be fully refined (--evaluations)"
MAX_WITHHELD = 2  # variants in singular poses that are listed one by one
CSV_COLUMNS = make_columns("kind value error unit measure measure_error measure_unit word reason")


class FindPage(NamedTuple):
    """The content of the page: scene, condition, interval and findings.

    scan: number of values in the scan
    max_variants: the largest number of variants
    units: units in which it is shown
    """

    title: str
    condition: Comparison
    interval: DesignVariable
    findings: IntervalFindings
    scan: int
    max_variants: int
    units: Units

    def format_place(self, x: float, error: float = 0.0) -> str:
        """Format a value of the unknown with its name and unit."""
        return f"{self.interval.name} = {format_with_error(x, error)} {self.interval.unit}".rstrip()

    def format_measure(self, gap: float, error: float) -> str:
        """Format the measure in its unit; `gap` is its distance above the value of the condition."""
        unit, size = self.units.find(self.condition.unit)
        return append_unit(format_with_error((gap + self.condition.value) * size, error * size), unit)


def make_document(page: FindPage) -> OutputDocument:
    """Make the document: crossings, where the condition is met, other findings in sentences; all of them as data."""
    tables = [table for table in (_make_crossings_table(page), _make_met_table(page)) if table.rows]
    notes = OutputTable("", notes=list(iter_notes(page)))
    return OutputDocument(
        page.title,
        list_facts(page),
        [*tables, notes],
        lambda: to_block(page),
        lambda: OutputTable("", CSV_COLUMNS, list(iter_records(page))),
    )


def list_facts(page: FindPage) -> list[tuple[str, str]]:
    """Return label and text of the lines above the table."""
    interval, condition, findings = page.interval, page.condition, page.findings
    value = page.format_measure(0.0, 0.0)
    ends = f"{interval.low:.10g} to {interval.high:.10g} {interval.unit}".rstrip()
    scan = SCAN.format(page.scan, f"{findings.spacing:.4g} {interval.unit}".rstrip())
    return [
        ("find", f"{condition.measure} {condition.relation} {value}, {interval.name} from {ends}"),
        ("runs", f"{format_count(len(findings.samples), 'variant')}: {scan}"),
    ]


def _make_crossings_table(page: FindPage) -> OutputTable:
    unit = page.units.find(page.condition.unit)[0]
    columns = (
        OutputColumn(page.interval.name, unit=page.interval.unit), OutputColumn("error"),
        OutputColumn("measure", unit=unit), OutputColumn("error"), OutputColumn("", "verdict"),
        OutputColumn("", "text"),
    )  # fmt: skip
    rows = [_make_crossing_row(page, each) for each in page.findings.crossings]
    return OutputTable("CROSSINGS  where the measure passes the value, as the parameter increases", columns, rows)


def _make_crossing_row(page: FindPage, each: Crossing) -> tuple[Cell, ...]:
    size = page.units.find(page.condition.unit)[1]
    value = ((each.sample.gap or 0.0) + page.condition.value) * size
    error = each.sample.error * size
    word = DIRECTIONS[each.direction] + (", too flat to be located more closely" if each.flat else "")
    cells = (
        NumberCell(each.sample.x, each.error), NumberCell(each.error, write=format_error),
        NumberCell(value, error), NumberCell(error, write=format_error),
    )  # fmt: skip
    return (*cells, word, format_set_option(page, each.sample.x))


def format_set_option(page: FindPage, x: float) -> str:
    """Format the option that sets the unknown to a value, as it is typed."""
    text = page.interval.format_value(x)
    return f"--set {page.interval.name}='{text}'" if " " in text else f"--set {page.interval.name}={text}"


def _make_met_table(page: FindPage) -> OutputTable:
    interval = page.interval
    columns = [
        column
        for word in ("from", "to")
        for column in (OutputColumn(f"{word} {interval.name}", unit=interval.unit), OutputColumn("", "verdict"))
    ]
    rows = [(*_make_edge(each.low), *_make_edge(each.high)) for each in page.findings.met_stretches]
    return OutputTable(f"MET  where the measure is {page.condition.relation} the value", columns, rows)


def _make_edge(edge: MetEdge) -> tuple[NumberCell, str]:
    error = f", ± {format_error(edge.error)}" if edge.error else ""
    words = {
        "end": "end of the interval", "unsolved": "last solved variant", "bracket": "not resolved",
    }  # fmt: skip
    return NumberCell(edge.x, edge.error), words.get(edge.kind, edge.kind) + error


def iter_notes(page: FindPage) -> Iterator[str]:
    """Yield sentences on findings that are not rows of a table."""
    findings, condition = page.findings, page.condition
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
    least, greatest = page.findings.least, page.findings.greatest
    if least is None or greatest is None:
        return ""
    ends = (
        f"{page.format_measure(each.gap or 0.0, each.error)} at {page.format_place(each.x, 0.0)}"
        for each in (least, greatest)
    )
    return f": minimum {next(ends)}, maximum {next(ends)}"


def _describe_touch(page: FindPage, each: Touch) -> str:
    ends = f"{page.format_place(each.low)} and {format_with_error(each.high, 0.0)}"
    if not each.side:
        ends = (
            f"from {page.format_place(each.low)} to {format_with_error(each.high, 0.0)}"
            if each.low < each.high
            else "there"
        )
        return f"equal to the value within its error wherever known: {ends}"
    side = "above" if each.side > 0 else "below"
    place = f"touches the value at {page.format_place(each.sample.x)}, {side} it nearby"
    return f"{place}: equal to it within its error between {ends}"


def _describe_jump(page: FindPage, each: MeasureJump) -> str:
    value_before, value_after = (page.format_measure(one.gap or 0.0, one.error) for one in each)
    width = format_error(each.right.x - each.left.x)
    return (
        f"jumps from {value_before} to {value_after} at {page.format_place(each.left.x)} (within "
        f"{width}): the value is not met there"
    )


def _describe_bracket(page: FindPage, each: UnresolvedBracket) -> str:
    value_before, value_after = (page.format_measure(one.gap or 0.0, one.error) for one in each)
    ends = f"{page.format_place(each.left.x)}, and {value_after} at {page.format_place(each.right.x)}"
    return f"passes the value between {value_before} at {ends}: a crossing or a jump that the search did not resolve"


def _describe_not_excluded(page: FindPage, each: PossibleMeeting) -> str:
    value_before, value_after = (page.format_measure(one.gap or 0.0, one.error) for one in each)
    ends = (
        f"{page.format_place(each.left.x)} ({value_before}) and {format_with_error(each.right.x, 0.0)} ({value_after})"
    )
    return f"not excluded between {ends}: the variants and their errors do not decide whether the value is met there"


def _describe_unsolved(page: FindPage, each: UnsolvedStretch) -> Iterator[str]:
    """Describe where the measure is not known, and how well the ends of that stretch are."""
    stretch = f"{page.format_place(each.low)} to {format_with_error(each.high, 0.0)}"
    yield f"no result from {stretch} ({format_count(each.variants, 'variant')}): {each.reason} [{each.code}]"
    ends = [(each.low, each.first, "last", "first"), (each.high, each.last, "first", "last")]
    for solved, failed, of_solved, of_failed in ends:
        if solved != failed:
            error = format_error(abs(solved - failed))
            text = f"{of_solved} solved at {page.interval.format_value(solved)}, {of_failed} not solved at"
            yield f"  {text} {page.interval.format_value(failed)} (± {error})"
    for one in each.withheld[:MAX_WITHHELD]:
        yield (
            f"  at {page.interval.format_value(one.x)} only: {page.format_measure(one.withheld_gap or 0.0, one.error)}"
        )
    if len(each.withheld) > MAX_WITHHELD:
        yield f"  and {format_count(len(each.withheld) - MAX_WITHHELD, 'more variant')} in singular positions"


def to_block(page: FindPage) -> dict[str, Any]:
    """Return all findings as the JSON has them; measures in SI, places in the unit of the interval and in SI."""
    interval, condition, findings = page.interval, page.condition, page.findings
    return {
        "heun": 1,
        "title": page.title,
        "measure": condition.measure,
        "relation": condition.relation,
        "value": condition.value,
        "unit": condition.unit,
        "unknown": {"name": interval.name, "from": interval.low, "to": interval.high, "unit": interval.unit},
        "runs": len(findings.samples),
        "scan": page.scan,
        "spacing": findings.spacing,
        "complete": findings.is_complete,
        "crossings": [_make_crossing_block(page, each) for each in findings.crossings],
        "touches": [
            {**_make_place_block(page, each.sample), "from": each.low, "to": each.high, "side": each.side}
            for each in findings.touches
        ],
        **{
            key: [
                {"from": _make_place_block(page, each.left), "to": _make_place_block(page, each.right)}
                for each in pairs
            ]
            for key, pairs in _list_pairs(findings).items()
        },
        "met": [{"from": each.low._asdict(), "to": each.high._asdict()} for each in findings.met_stretches],
        "unsolved": [
            {
                "from": each.low,
                "to": each.high,
                "code": each.code,
                "reason": each.reason,
                "variants": each.variants,
                "first": each.first,
                "last": each.last,
                "from_error": each.first - each.low,
                "to_error": each.high - each.last,
                "alone": [_make_withheld_block(page, one) for one in each.withheld],
            }
            for each in findings.unsolved_stretches
        ],
        **{word: _make_place_block(page, each) for word, each in _iter_extremes(findings)},
        "refined": findings.is_refined,
        "course": [_make_place_block(page, each) for each in findings.samples],
    }


def _list_pairs(
    findings: IntervalFindings,
) -> Mapping[str, Sequence[MeasureJump | UnresolvedBracket | PossibleMeeting]]:
    """Return the findings between two neighbouring samples, by their keys in JSON."""
    return {"jumps": findings.jumps, "brackets": findings.brackets, "not_excluded": findings.not_excluded}


def _iter_extremes(findings: IntervalFindings) -> Iterator[tuple[str, Sample]]:
    """Yield the least and the greatest sample that were found."""
    yield from ((word, each) for word, each in (("least", findings.least), ("greatest", findings.greatest)) if each)


def _make_crossing_block(page: FindPage, each: Crossing) -> dict[str, Any]:
    direction = DIRECTIONS[each.direction] if each.direction else None
    line = f"{page.interval.name}={page.interval.format_value(each.sample.x)}"
    return {
        **_make_place_block(page, each.sample),
        "error": each.error,
        "way": direction,
        "flat": each.flat,
        "set": line,
    }


def _make_place_block(page: FindPage, sample: Sample) -> dict[str, Any]:
    """Make the JSON of a value of the unknown with the measure there."""
    size = parse_unit(page.interval.unit or "1")[0]
    block = {"x": sample.x, "si": sample.x * size}
    if sample.gap is None:
        return {**block, "measure": None, "code": sample.why[0]}
    return {**block, "measure": sample.gap + page.condition.value, "measure_error": sample.error}


def _make_withheld_block(page: FindPage, sample: Sample) -> dict[str, Any]:
    """Return a variant in a singular pose, whose measure does not continue that of its neighbours."""
    return _make_place_block(page, sample._replace(gap=sample.withheld_gap, withheld_gap=None))


def iter_records(page: FindPage) -> Iterator[tuple[Cell, ...]]:
    """Yield the rows of the CSV: crossings, touches, ends of jumps and of met intervals, extremes, every variant."""
    findings = page.findings
    for crossing in findings.crossings:
        yield _make_record(page, "crossing", crossing.sample, crossing.error, DIRECTIONS[crossing.direction])
    for touch in findings.touches:
        yield _make_record(page, "touch", touch.sample, touch.high - touch.low, "")
    for key, pairs in _list_pairs(findings).items():
        kind = key.removesuffix("s").replace("_", " ")
        for each in pairs:
            yield _make_record(page, kind, each.left, 0.0, "before")
            yield _make_record(page, kind, each.right, 0.0, "after")
    for met in findings.met_stretches:
        for edge, word in zip(met, ("from", "to"), strict=True):
            yield "met", edge.x, edge.error, page.interval.unit, "", "", "", word, edge.kind
    for word, sample in _iter_extremes(findings):
        yield _make_record(page, "extreme", sample, 0.0, word)
    for sample in findings.samples:
        yield _make_record(page, "course", sample, 0.0, sample.why[0])


def _make_record(page: FindPage, kind: str, sample: Sample, error: float, word: str) -> tuple[Cell, ...]:
    known = sample.gap is not None
    measure = (sample.gap or 0.0) + page.condition.value if known else None
    cells = (kind, sample.x, error, page.interval.unit, measure, sample.error if known else None, page.condition.unit)
    return (*cells, word, sample.why[1])
