"""The findings of `heun find` as JSON and CSV: all of them, with each variant of the scan."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from heuncli.analyses.find.results import (
    AT_END,
    FALLS,
    RISES,
    Crossing,
    FindResults,
    IntervalFindings,
    MeasureJump,
    PossibleMeeting,
    UnresolvedBracket,
)
from heuncli.analyses.variants.samples import Sample
from heuncli.base.units import parse_unit
from heuncli.output.documents.as_data import make_columns
from heuncli.output.documents.document import Cell

DIRECTIONS = {RISES: "rises", FALLS: "falls", AT_END: "at the end"}
CSV_COLUMNS = make_columns("kind value error unit measure measure_error measure_unit word reason")


def to_block(results: FindResults) -> dict[str, Any]:
    """Return all findings as the JSON has them; measures in SI, places in the unit of the interval and in SI."""
    interval, condition, findings = results.interval, results.condition, results.findings
    return {
        "heun": 1,
        "title": results.title,
        "measure": condition.measure,
        "relation": condition.relation,
        "value": condition.value,
        "unit": condition.unit,
        "unknown": {"name": interval.name, "from": interval.low, "to": interval.high, "unit": interval.unit},
        "runs": len(findings.samples),
        "scan": results.scan,
        "spacing": findings.spacing,
        "complete": findings.is_complete,
        "crossings": [_make_crossing_block(results, each) for each in findings.crossings],
        "touches": [
            {**_make_place_block(results, each.sample), "from": each.low, "to": each.high, "side": each.side}
            for each in findings.touches
        ],
        **{
            key: [
                {"from": _make_place_block(results, each.left), "to": _make_place_block(results, each.right)}
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
                "alone": [_make_withheld_block(results, one) for one in each.withheld],
            }
            for each in findings.unsolved_stretches
        ],
        **{word: _make_place_block(results, each) for word, each in _iter_extremes(findings)},
        "refined": findings.is_refined,
        "course": [_make_place_block(results, each) for each in findings.samples],
    }


def _list_pairs(
    findings: IntervalFindings,
) -> Mapping[str, Sequence[MeasureJump | UnresolvedBracket | PossibleMeeting]]:
    """Return the findings between two neighbouring samples, by their keys in JSON."""
    return {"jumps": findings.jumps, "brackets": findings.brackets, "not_excluded": findings.not_excluded}


def _iter_extremes(findings: IntervalFindings) -> Iterator[tuple[str, Sample]]:
    """Yield the least and the greatest sample that were found."""
    yield from ((word, each) for word, each in (("least", findings.least), ("greatest", findings.greatest)) if each)


def _make_crossing_block(results: FindResults, crossing: Crossing) -> dict[str, Any]:
    """Return a crossing as the JSON has it."""
    line = f"{results.interval.name}={results.interval.format_value(crossing.sample.x)}"
    return {
        **_make_place_block(results, crossing.sample),
        "error": crossing.error,
        "way": None
        if crossing.direction == AT_END
        else DIRECTIONS[crossing.direction],  # at an end it may not pass the value
        "flat": crossing.flat,
        "set": line,
    }


def _make_place_block(results: FindResults, sample: Sample) -> dict[str, Any]:
    """Make the JSON of a value of the unknown with the measure there."""
    size = parse_unit(results.interval.unit or "1")[0]
    block = {"x": sample.x, "si": sample.x * size}
    if sample.gap is None:
        return {**block, "measure": None, "code": sample.why[0]}
    return {**block, "measure": sample.gap + results.condition.value, "measure_error": sample.error}


def _make_withheld_block(results: FindResults, sample: Sample) -> dict[str, Any]:
    """Return a variant in a singular pose, whose measure does not continue that of its neighbours."""
    return _make_place_block(results, sample._replace(gap=sample.withheld_gap, withheld_gap=None))


def iter_records(results: FindResults) -> Iterator[tuple[Cell, ...]]:
    """Yield the rows of the CSV: crossings, touches, ends of jumps and of met intervals, extremes, every variant."""
    findings = results.findings
    for crossing in findings.crossings:
        yield _make_record(results, "crossing", crossing.sample, crossing.error, DIRECTIONS[crossing.direction])
    for touch in findings.touches:
        yield _make_record(results, "touch", touch.sample, touch.high - touch.low, "")
    for key, pairs in _list_pairs(findings).items():
        kind = key.removesuffix("s").replace("_", " ")
        for each in pairs:
            yield _make_record(results, kind, each.left, 0.0, "before")
            yield _make_record(results, kind, each.right, 0.0, "after")
    for met in findings.met_stretches:
        for edge, word in zip(met, ("from", "to"), strict=True):
            yield "met", edge.x, edge.error, results.interval.unit, "", "", "", word, edge.kind
    for word, sample in _iter_extremes(findings):
        yield _make_record(results, "extreme", sample, 0.0, word)
    for sample in findings.samples:
        yield _make_record(results, "course", sample, 0.0, sample.why[0])


def _make_record(results: FindResults, kind: str, sample: Sample, error: float, word: str) -> tuple[Cell, ...]:
    """Make a row of the CSV."""
    known = sample.gap is not None
    measure = (sample.gap or 0.0) + results.condition.value if known else None
    units = results.interval.unit, results.condition.unit
    cells = (kind, sample.x, error, units[0], measure, sample.error if known else None, units[1])
    return (*cells, word, sample.why[1])
