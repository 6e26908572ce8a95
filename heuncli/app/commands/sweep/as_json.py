"""Write the rows of a sweep as one JSON object (manual/variants.md, "Files"), one row per line, each as it comes."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from typing import Any

from heuncli.analyses.sweep_rows import (
    JumpFinder,
    ParameterColumn,
    SweepColumns,
    SweepHead,
    SweptJump,
    SweptRow,
    explain_missing,
    make_columns,
    to_cell,
    to_finite,
)
from heuncli.analyses.variants.measures import NO_VALUE
from heuncli.analyses.variants.sample_statistics import CONFIDENCE, SobolIndices
from heuncli.app.commands.sweep.statistics import ColumnBuffer, MeasureStatistics, iter_statistics
from heuncli.base.text_safety import escape
from heuncli.output.documents.as_data import FORMAT


def iter_json(head: SweepHead, rows: Iterable[SweptRow]) -> Iterator[str]:
    """Yield the object in pieces; for a random sweep the measures are kept until its statistics are written."""
    columns = make_columns(head)
    for number, (key, value) in enumerate(_make_header(head, columns).items()):
        yield f"{',' if number else '{'}\n {_to_json(key)}: {_to_json(value)}"
    buffer = ColumnBuffer(len(head.measures))
    if head.plan.draws is not None:
        rows = buffer.record(rows)
    finder = JumpFinder(head.plan, len(head.measures))
    yield ',\n "rows": ['
    for number, row in enumerate(finder.record(rows)):
        yield f"{',' if number else ''}\n  {_to_json(_make_row_block(row, columns))}"
    yield "\n ]"
    if head.plan.draws is not None:
        yield ',\n "statistics": ['
        for number, statistics in enumerate(iter_statistics(head, buffer)):
            yield f"{',' if number else ''}\n  {_to_json(_make_statistics_block(statistics, head))}"
        yield "\n ]"
    if finder.jumps:
        yield ',\n "jumps": ['
        yield ",".join(f"\n  {_to_json(_make_jump_block(jump, head))}" for jump in finder.jumps)
        yield "\n ]"
    yield "\n}\n"


def _to_json(value: Any) -> str:
    return escape(json.dumps(value, ensure_ascii=False, allow_nan=False))


def _make_header(head: SweepHead, columns: SweepColumns) -> dict[str, Any]:
    """Return the keys before the rows."""
    draws = head.plan.draws
    laws = {law.name: law for law in draws.laws} if draws is not None else {}
    parameters = [_make_parameter_block(one) | _make_law_block(laws.get(one.name)) for one in columns.parameters]
    sampling = {} if draws is None else {"samples": len(draws.values) // draws.each, "seed": draws.seed}
    return {
        "heun": FORMAT,
        "version": head.version,
        "spec": {"path": head.path, "sha256": head.sha256},
        "title": head.title,
        "variants": head.plan.size,
        **sampling,
        "parameters": parameters,
        "measures": [{"measure": one.text, "unit": one.unit or None} for one in head.measures],
    }


def _make_parameter_block(one: ParameterColumn) -> dict[str, Any]:
    return {"parameter": one.name, "unit": one.unit or None}


def _make_law_block(law: Any) -> dict[str, Any]:
    return {} if law is None else {"law": law.law, "of": [law.a, law.b]}


def _make_row_block(row: SweptRow, columns: SweepColumns) -> dict[str, Any]:
    block: dict[str, Any] = {
        "number": row.number,
        "set": {name: to_cell(value) for name, value in row.values.items()},
    }
    measures = row.result.measures or (NO_VALUE,) * len(columns.measures)
    values = [(to_finite(one.value), to_finite(one.error), to_finite(one.time)) for one in measures]
    block["values"] = [dict(zip(("value", "error", "at"), one, strict=True)) for one in values]
    block |= {"code": row.result.code, "reason": explain_missing(row, columns.measures)}
    return block | ({"warnings": list(row.result.warnings)} if row.result.warnings else {})


def _make_jump_block(jump: SweptJump, head: SweepHead) -> dict[str, Any]:
    """Return a jump: the variants before and after it."""
    ends = {
        word: {
            "number": sample.number,
            "set": {name: to_cell(value) for name, value in head.plan.find_values(sample.number).items()},
            "value": sample.value,
        }
        for word, sample in (("before", jump.first), ("after", jump.second))
    }
    return {"measure": head.measures[jump.measure].text, **ends}


def _make_statistics_block(statistics: MeasureStatistics, head: SweepHead) -> dict[str, Any]:
    """Return the statistics of one measure at one combination of the axes."""
    measure = head.measures[statistics.measure]
    block: dict[str, Any] = {
        "set": {name: to_cell(value) for name, value in statistics.combination.items()},
        "measure": measure.text,
        "unit": measure.unit or None,
        "variants": statistics.drawn_count,
        "left_out": statistics.left_out,
        "error": statistics.error,
        "sure": CONFIDENCE,
    }
    if statistics.sample is not None:
        block |= {"mean": statistics.sample.mean._asdict(), "deviation": statistics.sample.deviation._asdict()}
        block["percentiles"] = [{"percent": p} | one._asdict() for p, one in statistics.sample.percentiles]
    if statistics.indices is not None and head.plan.draws is not None:
        names = (law.name for law in head.plan.draws.laws)
        indices = [{"parameter": n} | _make_index_block(one) for n, one in zip(names, statistics.indices, strict=True)]
        block |= {"samples": statistics.samples, "indices": indices}
    return block


def _make_index_block(one: SobolIndices) -> dict[str, dict[str, Any]]:
    return {"first": one.first._asdict(), "total": one.total._asdict()}
