"""The rows of a sweep as a table, CSV and JSON."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterable
from typing import Any

from heuncli.commands.sweep.rows import SweepHead, SweptRow
from heuncli.report.export import dump
from heuncli.report.text_table import WIDTH, TextColumn, TextTable, plain


def table(head: SweepHead, rows: Iterable[SweptRow]) -> str:
    """A line a variant."""
    columns = [TextColumn(name, "left") for name in head.plan.names]
    columns += [TextColumn(f"{one.text} [{one.unit}]" if one.unit else one.text, "point") for one in head.measures]
    body = tuple(
        (*row.values.values(), *(_cell(one.value, one.word) for one in row.answer.measures), row.answer.code)
        for row in rows
    )
    return plain(TextTable(f"SWEEP  {head.title}", (*columns, TextColumn("", "left")), body), WIDTH)


def _cell(value: float | None, word: str) -> str:
    return word if value is None else f"{value:.6g}"


def to_csv(head: SweepHead, rows: Iterable[SweptRow]) -> str:
    """A line a variant: its values, each measure with error and instant, and why there is none."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    measures = [part for one in head.measures for part in (one.text, f"{one.text}: error", f"{one.text}: at")]
    writer.writerow([*head.plan.names, *measures, "code", "reason"])
    for row in rows:
        found = [part for one in row.answer.measures for part in (one.value, one.error, one.at)]
        writer.writerow([*row.values.values(), *found, row.answer.code, row.answer.reason])
    return text.getvalue()


def to_json(head: SweepHead, rows: Iterable[SweptRow]) -> str:
    """All of it."""
    return dump({"heun": 1, "title": head.title, "rows": [_block(row) for row in rows]})


def _block(row: SweptRow) -> dict[str, Any]:
    return {"set": dict(row.values), "measures": [one._asdict() for one in row.answer.measures]}


FORMS: dict[str, Callable[[SweepHead, Iterable[SweptRow]], str]] = {"table": table, "csv": to_csv, "json": to_json}
