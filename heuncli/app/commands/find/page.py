"""What was found, as a table, JSON and CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator
from typing import Any

from heuncli.analyses.find.results import (
    CourseFindings,
    CourseJump,
    Crossing,
    FindCondition,
    MetEdge,
    NotExcluded,
    OpenBracket,
    Touch,
    UnsolvedStretch,
)
from heuncli.analyses.find.study import SIDES
from heuncli.analyses.variants.axes import Interval
from heuncli.analyses.variants.course import Sample
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.units import parse_unit
from heuncli.output.tables.export import dump
from heuncli.output.tables.page_width import fit
from heuncli.output.tables.plurals import count
from heuncli.output.tables.text_table import WIDTH, TextColumn, TextTable, head, labelled, plain
from heuncli.study.quantities.digits import rough
from heuncli.study.quantities.error_digits import with_digits
from heuncli.study.quantities.table_units import Units
from heuncli.version import VERSION

WAYS = {1: "rises", -1: "falls", 0: "at the end"}
SCAN = (
    "a scan of {} at most {} apart, and more where the course beside them asks for it; crossings nearer together than "
    "that may be missed where nothing beside them tells of them"
)
ENDED = "ended after {}: there may be more, and what stands here may be unfinished (--evaluations)"
MOST_ALONE = 2  # variants in singular poses that are told one by one
CSV_COLUMNS = ("kind", "value", "error", "unit", "measure", "measure_error", "measure_unit", "word", "reason")


class FoundPage(NamedTuple):
    """What is told: of which scene and condition, over which interval; places of the scan and at most; units."""

    title: str
    condition: FindCondition
    interval: Interval
    found: CourseFindings
    scan: int
    most: int
    units: Units

    def at(self, x: float, error: float = 0.0) -> str:
        """A place with the name and unit of the unknown."""
        return f"{self.interval.name} = {with_digits(x, error)} {self.interval.unit}".rstrip()

    def measure(self, gap: float, error: float) -> str:
        """The measure in its unit, from how far it lies above the value."""
        unit, size = self.units.of(self.condition.unit)
        text = with_digits((gap + self.condition.value) * size, error * size)
        return f"{text} {unit}".rstrip() if unit != "1" else text


def table(page: FoundPage) -> str:
    """The page as text."""
    parts = [labelled(heading(page))]
    tables = [made for made in (_crossings(page), _met(page)) if made.rows]
    tables.append(TextTable("", notes=tuple(notes(page))))
    return "\n".join([*parts, *("".join(plain(part, WIDTH) for part in fit(one, WIDTH)) for one in tables)])


def heading(page: FoundPage) -> list[tuple[str, str]]:
    """Label and text of the lines above the table."""
    interval, condition, found = page.interval, page.condition, page.found
    value = page.measure(0.0, 0.0)
    ends = f"{interval.low:.10g} to {interval.high:.10g} {interval.unit}".rstrip()
    scan = SCAN.format(page.scan, f"{found.spacing:.4g} {interval.unit}".rstrip())
    return [
        ("heun", f"{VERSION}  {page.title}"),
        ("find", f"{condition.text} {condition.relation} {value}, {interval.name} from {ends}"),
        ("runs", f"{count(len(found.samples), 'variant')}: {scan}"),
    ]


def _crossings(page: FoundPage) -> TextTable:
    unit = page.units.of(page.condition.unit)[0]
    columns = (
        TextColumn(head(page.interval.name, page.interval.unit or "1")), TextColumn("error"),
        TextColumn(head("measure", unit or "1")), TextColumn("error"), TextColumn("", "left"), TextColumn("", "left"),
    )  # fmt: skip
    rows = tuple(_crossing(page, each) for each in page.found.crossings)
    return TextTable("CROSSINGS  where the measure passes the value, as the unknown grows", columns, rows)


def _crossing(page: FoundPage, each: Crossing) -> tuple[str, ...]:
    size = page.units.of(page.condition.unit)[1]
    value = ((each.sample.gap or 0.0) + page.condition.value) * size
    error = each.sample.error * size
    word = WAYS[each.way] + (", so flat that it is not told better" if each.flat else "")
    cells = (with_digits(each.sample.x, each.error), rough(each.error), with_digits(value, error), rough(error))
    return (*cells, word, set_line(page, each.sample.x))


def set_line(page: FoundPage, x: float) -> str:
    """What sets the unknown to a place, as it is typed."""
    text = page.interval.text(x)
    return f"--set {page.interval.name}='{text}'" if " " in text else f"--set {page.interval.name}={text}"


def _met(page: FoundPage) -> TextTable:
    name = head(page.interval.name, page.interval.unit or "1")
    columns = (TextColumn(f"from {name}"), TextColumn("", "left"), TextColumn(f"to {name}"), TextColumn("", "left"))
    rows = tuple((*_edge(page, each.low), *_edge(page, each.high)) for each in page.found.met)
    return TextTable(f"MET  where the measure is {page.condition.relation} the value", columns, rows)


def _edge(page: FoundPage, edge: MetEdge) -> tuple[str, str]:
    error = f", ± {rough(edge.error)}" if edge.error else ""
    words = {
        "end": "end of the interval", "unsolved": "last variant that is solved", "bracket": "not closed",
    }  # fmt: skip
    return with_digits(edge.x, edge.error), words.get(edge.kind, edge.kind) + error


def notes(page: FoundPage) -> Iterator[str]:
    """Sentences on what is no row."""
    found, condition = page.found, page.condition
    if SIDES[condition.relation] and not (found.met or ("=" in condition.relation and not found.is_met_nowhere)):
        is_whole = found.complete and not found.not_excluded
        yield ("met nowhere" if is_whole else "not met in what was looked at") + _where(page)
    elif found.is_met_nowhere:
        yield ("no crossing" if SIDES[condition.relation] else "met nowhere") + _where(page)
    elif not (found.crossings or found.touches or found.brackets or found.not_excluded):
        yield "not met in what was looked at" + _where(page)
    yield from (_touch(page, each) for each in found.touches)
    yield from (_jump(page, each) for each in found.jumps)
    yield from (_bracket(page, each) for each in found.brackets)
    yield from (_not_excluded(page, each) for each in found.not_excluded)
    for each in found.unsolved:
        yield from _unsolved(page, each)
    if not found.complete:
        yield ENDED.format(count(len(found.samples), "variant"))


def _where(page: FoundPage) -> str:
    """The extremes that were found."""
    least, greatest = page.found.least, page.found.greatest
    if least is None or greatest is None:
        return ""
    ends = (f"{page.measure(each.gap or 0.0, each.error)} at {page.at(each.x, 0.0)}" for each in (least, greatest))
    return f": the least is {next(ends)}, the greatest {next(ends)}"


def _touch(page: FoundPage, each: Touch) -> str:
    ends = f"{page.at(each.low)} and {with_digits(each.high, 0.0)}"
    if not each.side:
        ends = f"from {page.at(each.low)} to {with_digits(each.high, 0.0)}" if each.low < each.high else "there"
        return f"not told from the value wherever it is known: {ends}"
    side = "above" if each.side > 0 else "below"
    place = f"touches the value at {page.at(each.sample.x)}, {side} it around"
    return f"{place}: not told from it within its error between {ends}"


def _jump(page: FoundPage, each: CourseJump) -> str:
    before, after = (page.measure(one.gap or 0.0, one.error) for one in each)
    width = rough(each.after.x - each.before.x)
    return f"jumps from {before} to {after} at {page.at(each.before.x)} (within {width}): the value is not met there"


def _bracket(page: FoundPage, each: OpenBracket) -> str:
    before, after = (page.measure(one.gap or 0.0, one.error) for one in each)
    ends = f"{page.at(each.before.x)}, and {after} at {page.at(each.after.x)}"
    return f"passes the value between {before} at {ends}: a crossing or a jump that the search did not close"


def _not_excluded(page: FoundPage, each: NotExcluded) -> str:
    before, after = (page.measure(one.gap or 0.0, one.error) for one in each)
    ends = f"{page.at(each.before.x)} ({before}) and {with_digits(each.after.x, 0.0)} ({after})"
    return f"not excluded between {ends}: the variants and their errors leave open whether the value is met there"


def _unsolved(page: FoundPage, each: UnsolvedStretch) -> Iterator[str]:
    """Where there is no measure, and how well its ends are known."""
    stretch = f"{page.at(each.low)} to {with_digits(each.high, 0.0)}"
    yield f"no measure from {stretch} ({count(each.variants, 'variant')}): {each.reason} [{each.code}]"
    ends = [(each.low, each.first, "last", "first"), (each.high, each.last, "first", "last")]
    for solved, failed, of_solved, of_failed in ends:
        if solved != failed:
            error = rough(abs(solved - failed))
            text = f"{of_solved} solved at {page.interval.text(solved)}, {of_failed} not solved at"
            yield f"  {text} {page.interval.text(failed)} (± {error})"
    for one in each.withheld[:MOST_ALONE]:
        yield f"  at {page.interval.text(one.x)} alone: {page.measure(one.withheld or 0.0, one.error)}"
    if len(each.withheld) > MOST_ALONE:
        yield f"  and {count(len(each.withheld) - MOST_ALONE, 'variant')} more in singular poses"


def to_json(page: FoundPage) -> str:
    """All that was found; measures in SI, places in the unit of the interval and in SI."""
    interval, condition, found = page.interval, page.condition, page.found
    return dump({
        "heun": 1, "title": page.title,
        "measure": condition.text, "relation": condition.relation, "value": condition.value, "unit": condition.unit,
        "unknown": {"name": interval.name, "from": interval.low, "to": interval.high, "unit": interval.unit},
        "runs": len(found.samples), "scan": page.scan, "spacing": found.spacing, "complete": found.complete,
        "crossings": [_crossing_block(page, each) for each in found.crossings],
        "touches": [
            {**_place(page, each.sample), "from": each.low, "to": each.high, "side": each.side}
            for each in found.touches
        ],
        "jumps": [{"from": _place(page, each.before), "to": _place(page, each.after)} for each in found.jumps],
        "brackets": [{"from": _place(page, each.before), "to": _place(page, each.after)} for each in found.brackets],
        "not_excluded": [
            {"from": _place(page, each.before), "to": _place(page, each.after)} for each in found.not_excluded
        ],
        "met": [{"from": each.low._asdict(), "to": each.high._asdict()} for each in found.met],
        "unsolved": [
            {
                "from": each.low, "to": each.high, "code": each.code, "reason": each.reason, "variants": each.variants,
                "first": each.first, "last": each.last,
                "from_error": each.first - each.low, "to_error": each.high - each.last,
                "alone": [_alone(page, one) for one in each.withheld],
            }
            for each in found.unsolved
        ],
        **{word: _place(page, each) for word, each in _extremes(found)}, "refined": found.refined,
        "course": [_place(page, each) for each in found.samples],
    })  # fmt: skip


def _extremes(found: CourseFindings) -> Iterator[tuple[str, Sample]]:
    """The least and the greatest that were found."""
    yield from ((word, each) for word, each in (("least", found.least), ("greatest", found.greatest)) if each)


def _crossing_block(page: FoundPage, each: Crossing) -> dict[str, Any]:
    way = WAYS[each.way] if each.way else None
    line = f"{page.interval.name}={page.interval.text(each.sample.x)}"
    return {**_place(page, each.sample), "error": each.error, "way": way, "flat": each.flat, "set": line}


def _place(page: FoundPage, sample: Sample) -> dict[str, Any]:
    """A place and the measure there."""
    size = parse_unit(page.interval.unit)[0] if page.interval.unit else 1.0
    told = {"x": sample.x, "si": sample.x * size}
    if sample.gap is None:
        return {**told, "measure": None, "code": sample.why[0]}
    return {**told, "measure": sample.gap + page.condition.value, "measure_error": sample.error}


def _alone(page: FoundPage, sample: Sample) -> dict[str, Any]:
    """A variant in a singular pose, with the measure that is no neighbour of the others."""
    return _place(page, sample._replace(gap=sample.withheld, withheld=None))


def to_csv(page: FoundPage) -> str:
    """A line each: crossings, touches, ends of jumps and of what is met, extremes, and every variant."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(CSV_COLUMNS)
    found = page.found
    for crossing in found.crossings:
        writer.writerow(_line(page, "crossing", crossing.sample, crossing.error, WAYS[crossing.way]))
    for touch in found.touches:
        writer.writerow(_line(page, "touch", touch.sample, touch.high - touch.low, ""))
    for jump in found.jumps:
        writer.writerow(_line(page, "jump", jump.before, 0.0, "before"))
        writer.writerow(_line(page, "jump", jump.after, 0.0, "after"))
    for bracket in found.brackets:
        writer.writerow(_line(page, "bracket", bracket.before, 0.0, "before"))
        writer.writerow(_line(page, "bracket", bracket.after, 0.0, "after"))
    for each in found.not_excluded:
        writer.writerow(_line(page, "not excluded", each.before, 0.0, "before"))
        writer.writerow(_line(page, "not excluded", each.after, 0.0, "after"))
    for met in found.met:
        for edge, word in zip(met, ("from", "to"), strict=True):
            writer.writerow(["met", edge.x, edge.error, page.interval.unit, "", "", "", word, edge.kind])
    for word, sample in _extremes(found):
        writer.writerow(_line(page, "extreme", sample, 0.0, word))
    for sample in found.samples:
        writer.writerow(_line(page, "course", sample, 0.0, sample.why[0]))
    return text.getvalue()


def _line(page: FoundPage, kind: str, sample: Sample, error: float, word: str) -> list[Any]:
    known = sample.gap is not None
    measure = (sample.gap or 0.0) + page.condition.value if known else ""
    told = [kind, sample.x, error, page.interval.unit, measure, sample.error if known else "", page.condition.unit]
    return [*told, word, sample.why[1]]


FORMS: dict[str, Callable[[FoundPage], str]] = {"table": table, "json": to_json, "csv": to_csv}
