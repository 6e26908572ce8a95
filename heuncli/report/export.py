"""Results as JSON (manual/results.md) and as CSV in long form; all digits, nothing rounded.

Numbers go through `repr` or the C encoder of json in whole arrays: well below 1 µs each.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from heuncli.cut_rows import cut_numbers
from heuncli.errors import LimitError, Problem
from heuncli.foreign_text import shown
from heuncli.named_tuples import NamedTuple
from heuncli.report.labels import Labels
from heuncli.report.series import Series, walk, walk_impulse
from heuncli.results import Block, Results
from heuncli.results_schema import AT_A_BLOW, BLOWS, row_of

FORMAT = 1
MOST_NUMBERS = 200_000_000  # about 4 GB of text
ALWAYS = frozenset({"title", "spec", "version", "model", "status", "time"})
CERTAIN_SUM = row_of("certain_sums.NUMBER.value")
CSV_COLUMNS = ("time", "kind", "name", "quantity", "component", "unit", "value")  # and cause, where shares are told
CUT_COLUMNS = ("section", "cut", "s", "side")  # behind these, where there are sections


def to_json(results: Results) -> str:
    """The results as one JSON object: a line for each array, `null` for what is open."""
    _limit(results)
    chunks: list[str] = []
    _write({"heun": FORMAT, **present(results)}, "", chunks)
    return "".join(chunks) + "\n"


class CsvSeries(NamedTuple):
    """The lines of one series in CSV: kind and name, the instants it holds at, and the sections that it may be of."""

    series: Series
    kind: str
    name: str
    instants: list[str]
    sections: Block


def to_csv(results: Results, labels: Labels) -> str:
    """The results in long form, a line a number; an empty value is open, an empty time holds for all instants."""
    _limit(results)
    instants = [repr(t) for t in results.time.tolist()]
    rows = [
        CsvSeries(series, series.kind, series.name, [""] if series.static else instants, results.sections)
        for series in walk(results, labels)
    ]
    for number, block in enumerate(results.impulses):
        rows += _of_blow(number, block, labels)
    rows += [CsvSeries(series, series.kind, name, instants, {}) for name, series in _sums(results.certain_sums)]
    by_cause = any(row.series.cause for row in rows)
    cut = any(row.series.kind == "sections" for row in rows)
    lines = [",".join([*CSV_COLUMNS, *["cause"] * by_cause, *CUT_COLUMNS * cut]) + "\n"]
    for row in rows:
        ends = _cuts(row) if cut else [""] * len(row.series.components)
        # one text a series: of a short one a line, Python's own share is half of it
        lines.append("".join(_lines(row, [f",{row.series.cause}{end}" if by_cause else end for end in ends])))
    if results.events:
        from heuncli.report.event_table import csv_lines  # where there are conditions

        lines += csv_lines(results, "," * (by_cause + len(CUT_COLUMNS) * cut))
    return "".join(lines)


def _of_blow(number: int, block: Block, labels: Labels) -> Iterator[CsvSeries]:
    """The rows of one blow."""
    at, sections = [repr(float(block["time"]))], block.get("sections", {})
    for series in walk_impulse(block, labels):
        name = ".".join(part for part in (str(number), series.kind, series.name) if part)
        yield CsvSeries(series, BLOWS, name, at, sections)
    for name, series in _sums(block.get("certain_sums", ())):
        yield CsvSeries(series._replace(unit=AT_A_BLOW[series.unit]), BLOWS, f"{number}.certain_sums.{name}", at, {})


def _sums(sums: Sequence[Any]) -> Iterator[tuple[str, Series]]:
    """The certain sums by their numbers."""
    for number, certain in enumerate(sums):
        of_moments = not any(".force." in term for term in certain["terms"])
        values = np.atleast_1d(np.asarray(certain["value"], dtype=np.float64))[:, None]
        unit = CERTAIN_SUM.unit(turning=of_moments)
        yield str(number), Series("certain_sums", str(number), "value", unit, ("",), values)


def present(results: Results) -> dict[str, Any]:
    """The blocks that apply, in the order of manual/results.md, "Paths", by their names in the JSON."""
    blocks = {f.name: getattr(results, f.name) for f in fields(results)}
    return {name: block for name, block in blocks.items() if name in ALWAYS or len(block)}


def dump(value: Any) -> str:
    """Any small nest of plain data as JSON, laid out like the results."""
    chunks: list[str] = []
    _write(value, "", chunks)
    return "".join(chunks) + "\n"


def _write(value: Any, indent: str, chunks: list[str]) -> None:
    """Nested mappings a key a line, lists of mappings too; everything else on one line."""
    if isinstance(value, dict) and value:
        _write_members(((f"{_text(key)}: ", member) for key, member in value.items()), "{}", indent, chunks)
    elif isinstance(value, (list, tuple)) and any(isinstance(member, dict) for member in value):
        _write_members((("", member) for member in value), "[]", indent, chunks)
    else:
        chunks.append(_text(value))


def _write_members(members: Iterable[tuple[str, Any]], brackets: str, indent: str, chunks: list[str]) -> None:
    inner = indent + " "
    chunks.append(brackets[0])
    for number, (label, member) in enumerate(members):
        chunks.append(f"{',' if number else ''}\n{inner}{label}")
        _write(member, inner, chunks)
    chunks.append(f"\n{indent}{brackets[1]}")


def _text(value: Any) -> str:
    if isinstance(value, np.ndarray):
        value = _plain(value)
    elif isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not np.isfinite(value):
        value = None
    return shown(json.dumps(value, ensure_ascii=False, allow_nan=False, default=_plain))


def _plain(values: Any) -> Any:
    """Nested lists of the array's numbers, None where they are not finite, and no minus before a zero."""
    finite = np.isfinite(values)
    return (
        (values + 0.0).tolist()
        if finite.all()
        else np.where(finite, (values + 0.0).astype(object), np.array(None)).tolist()
    )


def _lines(row: CsvSeries, ends: Sequence[str]) -> Iterator[str]:
    """A line an instant and component; ends: what stands behind its number."""
    series = row.series
    for component, end, column in zip(series.components, ends, series.values.T, strict=True):
        middle = f",{row.kind},{row.name},{series.quantity},{component},{series.unit},"
        numbers, tail = list(map(repr, (column + 0.0).tolist())), f"{end}\n"
        for i in np.flatnonzero(~np.isfinite(column)).tolist():
            numbers[i] = ""
        yield from [f"{t}{middle}{number}{tail}" for t, number in zip(row.instants, numbers, strict=True)]


def _cuts(row: CsvSeries) -> list[str]:
    """The last four columns of the lines of each component: section, cut of a run, distance, side; empty elsewhere."""
    series = row.series
    if series.kind != "sections":
        return [",,,,"] * len(series.components)
    name = series.name.split(".")[0]
    if not series.of_cuts or "s" not in row.sections[name]:
        return [f",{name},,,"] * len(series.components)
    s = [repr(float(at)) for at in row.sections[name]["s"]]
    side = [word or "" for word in row.sections[name].get("side") or [None] * len(s)]
    rows = [int(component.partition(".")[0]) for component in series.components]
    cuts = cut_numbers(np.asarray(row.sections[name]["s"])).tolist()
    return [f",{name},{cuts[k]},{s[k]},{side[k]}" for k in rows]


def _limit(results: Results) -> None:
    count = sum(_count(block) for block in present(results).values())
    if count > MOST_NUMBERS:
        message = f"the results hold {count:,} numbers; at most {MOST_NUMBERS:,} are written"
        raise LimitError(Problem("output-size", message, hint="fewer samples, or --only with what is needed"))


def _count(block: Any) -> int:
    if isinstance(block, np.ndarray):
        return block.size
    if isinstance(block, dict):
        return sum(_count(member) for member in block.values())
    return sum(_count(member) for member in block) if isinstance(block, (list, tuple)) else 1
