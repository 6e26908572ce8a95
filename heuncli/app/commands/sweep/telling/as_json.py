"""The rows of a sweep as one JSON object (manual/variants.md, "Files"); a row a line, and each as it comes."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from typing import Any

from heuncli.analyses.sweep_store.columns import ParameterColumn, SweepColumns, columns_of, finite, why
from heuncli.analyses.sweep_store.rows import SweepHead, SweptRow
from heuncli.analyses.variants.asking import Measured
from heuncli.analyses.variants.indices import SobolIndices
from heuncli.analyses.variants.sampling import SURE
from heuncli.app.commands.sweep.telling.gathered import GatheredRows
from heuncli.app.commands.sweep.telling.statistics import MeasureStatistics, statistics_of
from heuncli.base.foreign_text import shown
from heuncli.output.tables.export import FORMAT


def json_pieces(head: SweepHead, rows: Iterable[SweptRow]) -> Iterator[str]:
    """The object in pieces; of the rows of a random sweep the measures are held till its statistics are told."""
    columns = columns_of(head)
    for number, (key, value) in enumerate(_before(head, columns).items()):
        yield f"{',' if number else '{'}\n {_text(key)}: {_text(value)}"
    gathered = GatheredRows(len(head.measures))
    if head.plan.draws is not None:
        rows = gathered.passing(rows)
    yield ',\n "rows": ['
    for number, row in enumerate(rows):
        yield f"{',' if number else ''}\n  {_text(_row(row, columns))}"
    yield "\n ]"
    if head.plan.draws is not None:
        yield ',\n "statistics": ['
        for number, found in enumerate(statistics_of(head, gathered)):
            yield f"{',' if number else ''}\n  {_text(_statistics(found, head, columns))}"
        yield "\n ]"
    yield "\n}\n"


def _text(value: Any) -> str:
    return shown(json.dumps(value, ensure_ascii=False, allow_nan=False))


def _before(head: SweepHead, columns: SweepColumns) -> dict[str, Any]:
    """What stands before the rows."""
    draws = head.plan.draws
    laws = {law.name: law for law in draws.laws} if draws is not None else {}
    parameters = [_parameter(one) | _law(laws.get(one.name)) for one in columns.parameters]
    sampled = {} if draws is None else {"samples": len(draws.values) // draws.each, "seed": draws.seed}
    return {
        "heun": FORMAT,
        "version": head.version,
        "spec": {"path": head.path, "sha256": head.sha256},
        "title": head.title,
        "variants": head.plan.size,
        **sampled,
        "parameters": parameters,
        "measures": [{"measure": one.text, "unit": one.unit or None} for one in head.measures],
    }


def _parameter(one: ParameterColumn) -> dict[str, Any]:
    return {"parameter": one.name, "unit": one.unit or None}


def _law(law: Any) -> dict[str, Any]:
    return {} if law is None else {"law": law.law, "of": [law.a, law.b]}


def _row(row: SweptRow, columns: SweepColumns) -> dict[str, Any]:
    names = (one.name for one in columns.parameters)
    block: dict[str, Any] = {"number": row.number, "set": dict(zip(names, columns.values(row.values), strict=True))}
    found = row.answer.measures or (Measured(None),) * len(columns.measures)
    values = [(finite(one.value), finite(one.error), finite(one.at)) for one in found]
    block["values"] = [dict(zip(("value", "error", "at"), one, strict=True)) for one in values]
    block |= {"code": row.answer.code, "reason": why(row, columns.measures)}
    return block | ({"warnings": list(row.answer.warnings)} if row.answer.warnings else {})


def _statistics(found: MeasureStatistics, head: SweepHead, columns: SweepColumns) -> dict[str, Any]:
    """Of one measure at one combination of the axes."""
    measure = head.measures[found.measure]
    own = {one.name: one for one in columns.parameters}
    block: dict[str, Any] = {
        "set": {name: own[name].value(text) for name, text in found.combination.items()},
        "measure": measure.text,
        "unit": measure.unit or None,
        "variants": found.drawn,
        "left_out": found.left_out,
        "error": found.error,
        "sure": SURE,
    }
    if found.found is not None:
        block |= {"mean": found.found.mean._asdict(), "deviation": found.found.deviation._asdict()}
        block["percentiles"] = [{"percent": p} | one._asdict() for p, one in found.found.percentiles]
    if found.indices is not None and head.plan.draws is not None:
        names = (law.name for law in head.plan.draws.laws)
        indices = [{"parameter": n} | _indices(one) for n, one in zip(names, found.indices, strict=True)]
        block |= {"samples": found.samples, "indices": indices}
    return block


def _indices(one: SobolIndices) -> dict[str, dict[str, Any]]:
    return {"first": one.first._asdict(), "total": one.total._asdict()}
